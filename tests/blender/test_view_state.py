# SPDX-License-Identifier: GPL-3.0-or-later
"""A 3D viewport's own settings: what it shows, and its studio light."""

import math

import bpy
import numpy as np
import pytest
from scenes import add_sphere, frosted, set_background, world_map
from verglas import sync
from verglas.sync import meshes, settings

pytestmark = pytest.mark.usefixtures("scene")


@pytest.fixture
def spaces():
    """Two viewports with Rendered shading."""
    found = [space for screen in bpy.data.screens for area in screen.areas for space in area.spaces
             if space.type == 'VIEW_3D'][:2]
    before = [space.shading.type for space in found]
    for space in found:
        space.shading.type = 'RENDERED'
        space.shading.use_scene_world_render = True
    yield found
    for space, kind in zip(found, before):
        space.show_object_viewport_mesh = space.show_object_viewport_font = True
        space.shading.use_scene_world_render = True
        space.shading.type = kind


def scene_of(space, warn=pytest.fail):
    return sync.scene_from(bpy.context.evaluated_depsgraph_get(), warn, space)


def test_hidden_types(spaces):
    """Objects that the viewport hides by their type would be seen in it."""
    sphere = add_sphere(frosted(), 8, 4)
    first, second = spaces
    before = sync.view_state(first)
    assert scene_of(first).triangle_count == scene_of(second).triangle_count > 0
    first.show_object_viewport_mesh = False
    assert sync.view_state(first) != before
    assert scene_of(first).triangle_count == 0 and scene_of(second).triangle_count > 0
    assert sphere.visible_get()


def test_hidden_text(spaces, warned):
    """Text is a mesh to a render engine, but not to the viewport that hides it."""
    bpy.ops.object.text_add()
    bpy.context.object.data.extrude = 0.1
    bpy.context.object.data.materials.append(frosted())
    assert scene_of(spaces[0], warned.append).triangle_count > 0
    spaces[0].show_object_viewport_font = False
    assert scene_of(spaces[0]).triangle_count == 0


def test_what_one_viewport_hides_is_kept_for_the_other(spaces, monkeypatch):
    """With two viewports, one of them in local view, each edit would export the whole scene."""
    add_sphere(frosted(), 8, 4)
    first, second = spaces
    second.show_object_viewport_mesh = False
    for space in spaces:
        scene_of(space)
    monkeypatch.setattr(meshes, "read", lambda _: pytest.fail("read again"))
    monkeypatch.setattr(meshes.core, "Mesh", lambda *_: pytest.fail("made again"))
    for space in (first, second, second, first):
        scene_of(space)
    second.show_object_viewport_mesh = True
    assert scene_of(second).triangle_count > 0


def test_studio_light(spaces):
    """The popover's picture, strength and rotation would not light the glass."""
    set_background(bpy.context.scene)
    space = spaces[0]
    states = {sync.view_state(space)}
    shading = space.shading
    shading.use_scene_world_render = False
    shading.studio_light = "forest.exr"
    states.add(sync.view_state(space))
    shading.studiolight_rotate_z = math.radians(90.0)
    states.add(sync.view_state(space))
    shading.studiolight_intensity = 1.5
    states.add(sync.view_state(space))
    assert len(states) == 4
    scene = scene_of(space)
    assert np.allclose(scene.environment_color, 1.5)
    expected = sync.core.EnvironmentMap.load(world_map("forest"))
    assert np.array_equal(scene.environment_map.pixels, expected.pixels)
    assert np.allclose(scene.environment_rotation @ (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), atol=1e-6)
    shading.studiolight_intensity, shading.studiolight_rotate_z = 1.0, 0.0
    other = scene_of(spaces[1])
    assert other.environment_map is None


def test_studio_light_behind_the_objects(spaces):
    """The popover's Background and Blur would do nothing; the scene's own world would be faint."""
    def background() -> tuple[float, float]:
        wanted = settings.viewport(bpy.context.scene, 64, 64)
        sync.set_background(wanted, spaces[0])
        return wanted.background_alpha, wanted.background_spread
    shading = spaces[0].shading
    shading.studiolight_background_alpha, shading.studiolight_background_blur = 0.3, 0.5
    assert background() == (1.0, 0.0)
    shading.use_scene_world_render = False
    alpha, blurred = background()
    shading.studiolight_background_blur = 0.2
    _, sharper = background()
    shading.studiolight_background_blur = 0.0
    assert alpha == pytest.approx(0.3) and 0.2 > blurred > 10.0 * sharper > 0.0 and background()[1] == 0.0
    bpy.context.scene.render.film_transparent = True
    assert background()[0] == 0.0


def test_studio_light_that_nobody_chose(spaces):
    """The glass would be lit in magenta until a picture is chosen, where EEVEE has Blender's default one."""
    space = spaces[1]
    space.shading.use_scene_world_render = False
    pixels = scene_of(space).environment_map.pixels
    assert np.array_equal(pixels, sync.core.EnvironmentMap.load(world_map("forest")).pixels)
