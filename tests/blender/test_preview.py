# SPDX-License-Identifier: GPL-3.0-or-later
"""Preview icons, as Blender asks for them: of a scene with an object "preview_…" among what isn't glass."""

import bpy
import numpy as np
import pytest
from scenes import add, add_sphere, frosted, new_material
from verglas import preview


def lacquer() -> bpy.types.Material:
    return new_material("Lacquer", "ShaderNodeBsdfPrincipled", Base_Color=(0.8, 0.2, 0.05, 1.0))


def picture_of(scene, progress=lambda *_: True) -> np.ndarray | None:
    """(64, 64, 4), scene-linear."""
    scene.render.film_transparent = True
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return preview.picture_of(depsgraph, depsgraph.scene_eval.camera, 64, 64, progress)


def icon(scene, material: bpy.types.Material) -> np.ndarray:
    """As picture_of's, of a material."""
    add_sphere(material).name = "preview_sphere"
    return picture_of(scene)


@pytest.mark.parametrize("roughness", [0.0, 0.4])
def test_icon_of_glass(scene, roughness):
    """Icons of glass would stay empty, be dark without the lamps that Blender lights them by, or be full."""
    picture = icon(scene, frosted(roughness))
    covered = picture[..., 3] > 0.5
    assert 0.05 < covered.mean() < 0.9
    assert picture[covered][:, :3].mean() > 0.1


def test_icons_tell_roughness(scene):
    """Polished and frosted glass would have the same icon."""
    polished = icon(scene, frosted(0.0))
    bpy.data.objects.remove(bpy.data.objects["preview_sphere"])
    frosty = icon(scene, frosted(0.8))
    inside = (polished[..., 3] == 1.0) & (frosty[..., 3] == 1.0)
    assert polished[inside][:, :3].std() > 1.3 * frosty[inside][:, :3].std()


def test_icon_of_what_is_opaque(scene):
    """Most materials of a scene would have an empty icon."""
    picture = icon(scene, lacquer())
    covered = picture[..., 3] > 0.99
    assert 0.05 < covered.mean() < 0.9
    colors = picture[covered][:, :3]
    assert colors / colors.sum(axis=1, keepdims=True) == pytest.approx(
        np.broadcast_to(np.array([0.8, 0.2, 0.05]) / 1.05, colors.shape), abs=1e-3)
    assert colors[:, 0].max() > 2.0 * colors[:, 0].min()


def test_icon_of_a_lamp(scene):
    """Lamps would have an empty icon."""
    lamp = bpy.data.lights.new("Lamp", 'POINT')
    lamp.color = (1.0, 0.5, 0.0)
    add(lamp, "preview_lamp")
    picture = picture_of(scene)
    assert picture[32, 32] == pytest.approx([1.0, 0.5, 0.0, 1.0], abs=0.02)
    assert picture[0, 0].max() < 0.01


@pytest.mark.parametrize("material", [frosted, lacquer], ids=["glass", "opaque"])
def test_icons_end_when_blender_wants_it(scene, material):
    """Blender would wait for the icons of a large library, when it opens another or quits."""
    add_sphere(material()).name = "preview_sphere"
    asked = []

    def progress(*_) -> bool:
        asked.append(True)
        return False
    assert picture_of(scene, progress) is None and len(asked) == 1
