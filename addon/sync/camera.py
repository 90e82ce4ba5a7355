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
