# SPDX-License-Identifier: GPL-3.0-or-later
"""Preview icons, as Blender asks for them: of a scene with an object "preview_…" among what isn't glass."""

import bpy
import numpy as np
import pytest
from scenes import add_sphere, frosted
from verglas import preview


def icon(scene, roughness: float) -> np.ndarray:
    """(64, 64, 4) scene-linear."""
    add_sphere(frosted(roughness)).name = "preview_sphere"
    scene.render.film_transparent = True
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return np.array(preview.frame_of(depsgraph, depsgraph.scene_eval.camera, 64, 64).combined)


@pytest.mark.parametrize("roughness", [0.0, 0.4])
def test_icon_of_glass(scene, roughness):
    """Icons of glass would stay empty, be dark without the lamps that Blender lights them by, or be full."""
    picture = icon(scene, roughness)
    covered = picture[..., 3] > 0.5
    assert 0.05 < covered.mean() < 0.9
    assert picture[covered][:, :3].mean() > 0.1


def test_icons_tell_roughness(scene):
    """Polished and frosted glass would have the same icon."""
    polished = icon(scene, 0.0)
    bpy.data.objects.remove(bpy.data.objects["preview_sphere"])
    frosty = icon(scene, 0.8)
    inside = (polished[..., 3] == 1.0) & (frosty[..., 3] == 1.0)
    assert polished[inside][:, :3].std() > 1.3 * frosty[inside][:, :3].std()
