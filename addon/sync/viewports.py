# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scene depends on of a 3D viewport's own settings: the objects that it shows, and its studio
light."""

import math
from collections.abc import Hashable

import bpy
import numpy as np

from .. import verglas_core as core
from ..faults import Warn
from . import world

TYPES = {'CURVE': "curve", 'FONT': "font", 'LIGHT': "light", 'MESH': "mesh", 'META': "meta",
         'SURFACE': "surf"}
"""The viewport's properties show_object_viewport_* of object types that are rendered."""

DEFAULT_STUDIO_LIGHT = "forest.exr"


def view_state(space: bpy.types.SpaceView3D) -> Hashable:
    """Differs when the scene has to be synchronised again. Looks at single objects only where the viewport's
    local view or local collections choose among them."""
    shading = space.shading
    light = (_path(shading), shading.studiolight_rotate_z,
             shading.studiolight_intensity) if has_studio_light(space) else None
    shown = None
    if space.local_view is not None or space.use_local_collections:
        shown = tuple(obj.visible_in_viewport_get(space) for obj in bpy.context.view_layer.objects)
    return light, _has_scene_lights(space), _shown_types(space), shown


def shows(space: bpy.types.SpaceView3D, obj: bpy.types.Object) -> bool:
    """obj: of an instance, which goes with its instancer."""
    kind = TYPES.get(obj.original.type)
    if kind == "light" and not _has_scene_lights(space):
        return False
    return obj.visible_in_viewport_get(space) and (
        kind is None or getattr(space, f"show_object_viewport_{kind}"))


def _has_scene_lights(space: bpy.types.SpaceView3D) -> bool:
    return space.shading.type != 'RENDERED' or space.shading.use_scene_lights_render


def _shown_types(space: bpy.types.SpaceView3D) -> tuple[bool, ...]:
    return tuple(getattr(space, f"show_object_viewport_{kind}") for kind in TYPES.values())


def has_studio_light(space: bpy.types.SpaceView3D) -> bool:
    """Whether Rendered shading has a picture of its own in place of the scene's world."""
    return space.shading.type == 'RENDERED' and not space.shading.use_scene_world_render


def set_studio_light(scene: core.Scene, shading: bpy.types.View3DShading, warn: Warn) -> None:
    """As Cycles and EEVEE place it."""
    path = _path(shading)
    try:
        environment = world.load_file(path, is_srgb=not path.lower().endswith((".exr", ".hdr")))
    except core.Error as fault:
        warn(f"The viewport's studio light is rendered in magenta. {fault}")
        environment = None
    scene.environment_map = environment
    color = world.MISSING_COLOR if environment is None else np.ones(3)
    scene.environment_color = shading.studiolight_intensity * color
    scene.environment_rotation = _about_z(shading.studiolight_rotate_z)


def set_background(settings: core.Settings, space: bpy.types.SpaceView3D) -> None:
    """How a studio light is seen behind the objects. The spread for a blur is what comes closest to EEVEE's
    pictures."""
    if not has_studio_light(space):
        return
    settings.background_alpha *= space.shading.studiolight_background_alpha
    settings.background_spread = min(space.shading.studiolight_background_blur ** 8, 0.25)


def _path(shading: bpy.types.View3DShading) -> str:
    """Of the picture. Until one is chosen Blender takes its default one."""
    chosen = shading.selected_studio_light
    if chosen.type == 'WORLD' and chosen.path:
        return chosen.path
    lights = bpy.context.preferences.studio_lights
    worlds = {light.name: light.path for light in lights if light.type == 'WORLD'}
    return worlds.get(DEFAULT_STUDIO_LIGHT) or next(iter(worlds.values()), "")


def _about_z(angle: float) -> np.ndarray:
    """(3, 3) counterclockwise by an angle in radians."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
