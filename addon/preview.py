# SPDX-License-Identifier: GPL-3.0-or-later
"""Preview icons of materials and worlds. Blender renders them on a thread of their own, of a scene of its
own: an object "preview_…" with the material, among lamps and an opaque floor, which are left out here."""

import functools

import bpy
import numpy as np

from . import compat, renderer, sync
from . import verglas_core as core
from .sync import camera, objects, settings, world

SAMPLES = 4


def frame_of(depsgraph: bpy.types.Depsgraph, camera_object: bpy.types.Object, width: int,
             height: int) -> core.Frame:
    """Raises core.Error. What can't be rendered isn't warned of: it would be of Blender's scene, and a
    material is warned of where the user renders it."""
    scene = core.Scene()
    with sync.lock:
        if _has_own_light(depsgraph):
            world.set_environment(scene, compat.world_of(depsgraph), _ignore)
        else:
            scene.environment_map = _studio()
            scene.environment_color = (1.0, 1.0, 1.0)
        objects.add_objects(scene, depsgraph, _ignore)
    scene.camera = camera.from_blender(camera_object, depsgraph, width, height, _ignore)
    of_preview = settings.viewport(depsgraph.scene_eval, width, height)
    of_preview.samples = SAMPLES
    of_preview.threads = 1
    return renderer.render_preview(scene, of_preview)


def _has_own_light(depsgraph: bpy.types.Depsgraph) -> bool:
    """Of worlds, and of materials with Preview World. Their icons, which alone are transparent, have
    Blender's world all the same."""
    materials = [slot.material for instance in depsgraph.object_instances
                 for slot in instance.object.material_slots
                 if instance.object.name.startswith("preview_") and slot.material is not None]
    if not materials:
        return True
    return any(material.use_preview_world for material in materials) \
        and not depsgraph.scene_eval.render.film_transparent


@functools.cache
def _studio() -> core.EnvironmentMap:
    """A grey room, lighter above, with two bright soft boxes: edges that show how rough glass is."""
    elevation, azimuth = np.mgrid[-0.5:0.5:64j, -1.0:1.0:128j] * np.pi
    grey = 0.25 + 0.2 * np.sin(elevation)
    for at, width, radiance in ((-2.3, 0.45, 4.0), (0.6, 0.25, 2.5)):
        grey[(np.abs(azimuth - at) < width) & (np.abs(elevation - 0.5) < 0.4)] = radiance
    pixels = np.repeat(grey[..., None], 3, axis=2).astype(np.float32)
    return core.EnvironmentMap("Studio", pixels)


def _ignore(_sentence: str) -> None:
    pass
