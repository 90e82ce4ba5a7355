# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on as a part of Blender: registering, panels, a core that doesn't load."""

import os
import shutil
import subprocess
import textwrap

import addon_utils
import bpy
import pytest
import verglas


def test_engine_is_offered():
    """Verglas wouldn't stand in the list of engines."""
    bpy.context.scene.render.engine = 'VERGLAS'
    assert bpy.context.engine == 'VERGLAS'


def test_standard_panels_stay():
    """Users would miss Blender's own panels: output, colour management, camera, shader nodes, world."""
    for name in ("RENDER_PT_format", "RENDER_PT_output", "RENDER_PT_color_management", "DATA_PT_lens",
                 "EEVEE_MATERIAL_PT_context_material", "EEVEE_MATERIAL_PT_surface", "EEVEE_WORLD_PT_surface"):
        assert 'VERGLAS' in getattr(bpy.types, name).COMPAT_ENGINES, name
    assert 'VERGLAS' not in bpy.types.RENDER_PT_stereoscopy.COMPAT_ENGINES


def test_off_and_on_again():
    """Switching the add-on off would leave panels behind, or it couldn't be switched on again."""
    addon_utils.disable("verglas")
    try:
        assert not hasattr(bpy.types.Scene, "verglas") and not hasattr(bpy.types, "VERGLAS_RENDER_PT_glass")
        assert 'VERGLAS' not in bpy.types.RENDER_PT_format.COMPAT_ENGINES
    finally:
        addon_utils.enable("verglas")
    assert hasattr(bpy.types.Scene, "verglas") and 'VERGLAS' in bpy.types.RENDER_PT_format.COMPAT_ENGINES
    bpy.context.scene.render.engine = 'VERGLAS'


@pytest.mark.parametrize("fault", ["missing", "damaged"])
def test_core_that_does_not_load(tmp_path, fault):
    """A core that was built for another Blender would take the whole add-on down, or crash."""
    addons = tmp_path / "addons"
    shutil.copytree(os.path.dirname(verglas.__file__), addons / "verglas",
                    ignore=shutil.ignore_patterns("verglas_core*", "__pycache__"))
    if fault == "damaged":
        (addons / "verglas" / "verglas_core.py").write_text("raise ImportError('wrong version')")
    script = textwrap.dedent("""
        import addon_utils, bpy
        assert addon_utils.enable("verglas")
        bpy.context.scene.render.engine = 'VERGLAS'
        try:
            bpy.ops.render.render()
        except RuntimeError as error:
            print("said:", error)
        addon_utils.disable("verglas")
        print("goes on")
    """)
    done = subprocess.run(
        [bpy.app.binary_path, "--background", "--factory-startup", "--python-expr", script],
        env=os.environ | {"BLENDER_USER_SCRIPTS": str(tmp_path)}, capture_output=True, text=True, timeout=60)
    assert "said: Error: Verglas can't render, because its core (verglas_core) doesn't load" in done.stdout
    assert "goes on" in done.stdout and done.returncode >= 0, done.stdout + done.stderr
