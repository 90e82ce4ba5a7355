# SPDX-License-Identifier: GPL-3.0-or-later
"""Preview icons of materials and worlds. Blender renders them on a thread of their own, of a scene of its
own: an object "preview_…" with the material, among lamps and an opaque floor, which are left out here."""

import functools
from collections.abc import Iterator

import bpy
import numpy as np

from . import compat, renderer, sync
from . import verglas_core as core
from .sync import camera, materials, meshes, objects, settings, world

SAMPLES = 4


def picture_of(depsgraph: bpy.types.Depsgraph, camera_object: bpy.types.Object, width: int, height: int,
               progress: renderer.Progress) -> np.ndarray | None:
    """(H, W, 4), scene-linear, premultiplied; None when progress ends it. What isn't glass looks matte, and
    a lamp is a glow. Raises core.Error. What can't be rendered isn't warned of: it would be of Blender's
    scene, and a material is warned of where the user renders it."""
    lamp = next((obj for obj in _shown(depsgraph) if obj.type == 'LIGHT'), None)
    if lamp is not None:
        return _glow(lamp.data, width, height)
    scene = core.Scene()
    with sync.lock:
        if _has_own_light(depsgraph):
            world.set_environment(scene, compat.world_of(depsgraph), _ignore)
        else:
            scene.environment_map = _studio()
            scene.environment_color = (1.0, 1.0, 1.0)
        objects.add_objects(scene, depsgraph, _ignore, with_lights=False)
    scene.camera = camera.from_blender(camera_object, depsgraph, width, height, _ignore)
    of_preview = settings.viewport(depsgraph.scene_eval, width, height)
    of_preview.samples = SAMPLES
    of_preview.threads = 1
    frame = renderer.render_preview(scene, of_preview, progress)
    if frame is None or scene.triangle_count > 0:
        return frame and frame.combined
    return _with_matte(frame.combined, scene, depsgraph, of_preview, progress)


def _shown(depsgraph: bpy.types.Depsgraph) -> Iterator[bpy.types.Object]:
    """The objects that a preview is of."""
    for instance in depsgraph.object_instances:
        if instance.object.name.startswith("preview_"):
            yield instance.object


def _glow(lamp: bpy.types.Light, width: int, height: int) -> np.ndarray:
    """In the lamp's colour. As picture_of's."""
    y, x = np.mgrid[-1.0:1.0:height * 1j, -1.0:1.0:width * 1j]
    alpha = np.exp(-5.0 * (x * x + y * y))[..., None]
    return np.concatenate([alpha * lamp.color, alpha], axis=-1)


def _with_matte(background: np.ndarray, scene: core.Scene, depsgraph: bpy.types.Depsgraph,
                of_preview: core.Settings, progress: renderer.Progress) -> np.ndarray | None:
    """The objects of opaque materials before a picture without them, in light from over the viewer's left
    shoulder. As picture_of."""
    color = _add_opaque(scene, depsgraph)
    if color is None:
        return background
    of_preview.background_alpha = 0.0
    frame = renderer.render_preview(scene, of_preview, progress)
    if frame is None:
        return None
    light = np.linalg.inv(scene.camera.view)[:3, :3] @ (-0.4, 0.5, 0.77)
    alpha = frame.combined[..., 3:]
    shade = 0.2 + 0.8 * np.maximum(frame.normal @ light, 0.0)[..., None]
    return np.concatenate([alpha * shade * color, alpha], axis=-1) + (1.0 - alpha) * background


def _add_opaque(scene: core.Scene, depsgraph: bpy.types.Depsgraph) -> np.ndarray | None:
    """Adds the preview's objects, whatever they are made of. Returns the colour of their material; None where
    there are none."""
    color = None
    with sync.lock:
        for obj in _shown(depsgraph):
            if obj.type != 'MESH' or not obj.material_slots or obj.material_slots[0].material is None:
                continue
            color = materials.base_color(obj.material_slots[0].material)
            arrays = meshes.read(obj)
            mesh = meshes.to_core(obj.name, arrays, frozenset(arrays.used_slots), {})
            glass = scene.add_material(materials.default_glass(""))
            scene.add_object(obj.name, mesh, np.array(obj.matrix_world, np.float32),
                             [glass] * (1 + max(arrays.used_slots, default=0)))
    return color


def _has_own_light(depsgraph: bpy.types.Depsgraph) -> bool:
    """Of worlds, and of materials with Preview World. Their icons, which alone are transparent, have
    Blender's world all the same."""
    found = [slot.material for obj in _shown(depsgraph) for slot in obj.material_slots
             if slot.material is not None]
    if not found:
        return True
    return any(material.use_preview_world for material in found) \
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
