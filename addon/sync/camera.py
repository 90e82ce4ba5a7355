# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender cameras to core cameras."""

import bpy
import numpy as np

from .. import verglas_core as core
from ..faults import Fault, Warn


def from_blender(camera: bpy.types.Object, depsgraph: bpy.types.Depsgraph, width: int, height: int,
                 warn: Warn) -> core.Camera:
    """The camera for a whole frame of width x height pixels: sensor fit, shift, clipping and pixel
    aspect included; the object's scale doesn't count. Raises Fault for panoramas."""
    if camera.type == 'CAMERA':
        _check_lens(camera, warn)
    render = depsgraph.scene_eval.render
    projection = camera.calc_matrix_camera(
        depsgraph, x=width, y=height, scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y)
    view = camera.matrix_world.normalized().inverted_safe()
    return core.Camera(np.array(view), np.array(projection))


def _check_lens(camera: bpy.types.Object, warn: Warn) -> None:
    lens = camera.data
    if lens.type not in {'PERSP', 'ORTHO'}:
        raise Fault(f"Camera '{camera.name}' is of type {lens.type.title()}; "
                    "Verglas renders perspective and orthographic cameras.")
    if lens.dof.use_dof:
        warn(f"Camera '{camera.name}' has depth of field, which isn't supported yet; everything is in focus.")


def viewport_border(context: bpy.types.Context,
                    scene: bpy.types.Scene) -> tuple[int, int, int, int] | None:
    """(x, y, width, height) of the pixels that a 3D viewport renders, which may be none; None where it is all
    of them. Through a camera it is the scene's render border in the camera's frame, else that of the view."""
    space, region, view = context.space_data, context.region, context.region_data
    if view.view_perspective == 'CAMERA' and space.camera is not None:
        render = scene.render
        if not render.use_border:
            return None
        frame = _camera_frame(space.camera, scene, region, view)
        low = (render.border_min_x, render.border_min_y)
        high = (render.border_max_x, render.border_max_y)
    elif space.use_render_border:
        frame = np.array([(0.0, 0.0), (region.width, region.height)])
        low = (space.render_border_min_x, space.render_border_min_y)
        high = (space.render_border_max_x, space.render_border_max_y)
    else:
        return None
    size = (region.width, region.height)
    begin, end = (np.clip(np.rint(frame[0] + corner * (frame[1] - frame[0])), 0, size).astype(int)
                  for corner in (np.array(low), np.array(high)))
    return *begin.tolist(), *(end - begin).tolist()


def _camera_frame(camera: bpy.types.Object, scene: bpy.types.Scene, region: bpy.types.Region,
                  view: bpy.types.RegionView3D) -> np.ndarray:
    """(2, 2): lower left and upper right corner of what the camera sees, in pixels of the region."""
    corners = np.ones((4, 4))
    corners[:, :3] = camera.data.view_frame(scene=scene)
    to_clip = np.array(view.perspective_matrix) @ np.array(camera.matrix_world.normalized())
    clip = corners @ to_clip.T
    pixels = (0.5 * clip[:, :2] / clip[:, 3:] + 0.5) * (region.width, region.height)
    return np.array([pixels.min(axis=0), pixels.max(axis=0)])
