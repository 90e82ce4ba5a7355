# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside the Blender of blender_window.py: final renders of what a viewport shows."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np
import scenes
import viewports
from mathutils import Matrix

SENSOR = 36.0
"""Width of the camera's film in mm; any would do."""

LEAST_CLIP = 0.001
"""Nearest distance at which an orthographic camera sees."""


def picture(index: int) -> np.ndarray:
    """(H, W, 4) float32, scene-linear: a final frame of the scene, seen as by a viewport and as large."""
    _, _, width, height = viewports.rectangle(index)
    view, projection = viewports.matrices(index)
    with _copied_scene(width, height) as scene, _only_visible(viewports.space_of(index)):
        scene.camera = _camera(scene, view, projection, width / height)
        return next(iter(scenes.render_layers(scene).values())).combined


@contextmanager
def _copied_scene(width: int, height: int) -> Iterator[bpy.types.Scene]:
    """With the same objects, but render settings of its own, so that the viewport's scene stays as it is."""
    scene = bpy.context.scene.copy()
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.use_border = False
    try:
        yield scene
    finally:
        bpy.data.scenes.remove(scene)


@contextmanager
def _only_visible(space: bpy.types.SpaceView3D) -> Iterator[None]:
    """Final frames show the objects that the viewport shows."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    hidden = [obj for obj in bpy.context.scene.objects if not obj.hide_render
              and not obj.evaluated_get(depsgraph).visible_in_viewport_get(space)]
    for obj in hidden:
        obj.hide_render = True
    try:
        yield
    finally:
        for obj in hidden:
            obj.hide_render = False


def _camera(scene: bpy.types.Scene, view: np.ndarray, projection: np.ndarray,
            aspect: float) -> bpy.types.Object:
    """That sees what these matrices see; it goes with the scene. aspect: width / height of the picture."""
    lens = bpy.data.cameras.new("Truth")
    camera = bpy.data.objects.new("Truth", lens)
    scene.collection.objects.link(camera)
    camera.matrix_world = Matrix(view.tolist()).inverted()
    lens.sensor_fit = 'HORIZONTAL'
    lens.sensor_width = SENSOR
    is_ortho = projection[3, 3] == 1.0
    if is_ortho:
        lens.type = 'ORTHO'
        lens.ortho_scale = 2.0 / projection[0, 0]
        offset = -projection[:2, 3]
        center, half = projection[2, 3] / projection[2, 2], -1.0 / projection[2, 2]
        # The viewport sees behind itself, too; a camera has to step back
        camera.matrix_world @= Matrix.Translation((0.0, 0.0, half - center + LEAST_CLIP))
        lens.clip_start, lens.clip_end = LEAST_CLIP, LEAST_CLIP + 2.0 * half
    else:
        lens.lens = 0.5 * SENSOR * projection[0, 0]
        offset = projection[:2, 2]
        lens.clip_start = projection[2, 3] / (projection[2, 2] - 1.0)
        lens.clip_end = projection[2, 3] / (projection[2, 2] + 1.0)
    # Shifts are in widths of the picture; clip space is two units wide and high
    lens.shift_x, lens.shift_y = 0.5 * offset[0], 0.5 * offset[1] / aspect
    return camera


def last_frame() -> np.ndarray:
    """(H, W, 4), scene-linear: the final frame that Blender shows."""
    image = bpy.data.images["Render Result"]
    scenes.write_layers(bpy.context.scene)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "frame.exr")
        image.save_render(path)
        return next(iter(scenes.read_layers(path).values())).combined


def camera_frame() -> np.ndarray:
    """(H, W, 4), scene-linear: a final frame of the scene's camera."""
    return next(iter(scenes.render_layers(bpy.context.scene).values())).combined


def displayed(picture: np.ndarray) -> np.ndarray:
    """(H, W, 3), 0 … 255: what Blender saves of a scene-linear picture, (H, W, 4), under the scene's view
    transform."""
    height, width, _ = picture.shape
    image = bpy.data.images.new("Displayed", width, height, alpha=True, float_buffer=True)
    image.pixels.foreach_set(np.ascontiguousarray(picture, np.float32).ravel())
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "displayed.png")
        image.save_render(path)
        bpy.data.images.remove(image)
        saved = bpy.data.images.load(path)
        saved.colorspace_settings.name = 'Non-Color'
        pixels = np.empty(height * width * 4, np.float32)
        saved.pixels.foreach_get(pixels)
        bpy.data.images.remove(saved)
    return 255.0 * pixels.reshape(height, width, 4)[..., :3]
