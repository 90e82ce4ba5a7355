# SPDX-License-Identifier: GPL-3.0-or-later
"""The core's scene just as a final render of a Blender scene gives it."""

import bpy

from .. import sync
from .. import verglas_core as core
from ..faults import Fault, Warn
from ..sync import camera
from .temporary import changed, plain_picture


def core_scene(scene: bpy.types.Scene, width: int, height: int, warn: Warn) -> core.Scene:
    """The scene in its current frame with the camera for a picture of this size. Raises Fault without a
    camera that Verglas can render, core.Error for data that the core refuses."""
    if scene.camera is None:
        raise Fault(f"Scene '{scene.name}' has no camera.")
    result: list[core.Scene | Exception] = []

    class Exporter(bpy.types.RenderEngine):
        """Takes the scene and renders nothing: only an engine sees modifiers and visibility as they are
        in final frames."""
        bl_idname = 'VERGLAS_EXPORTER'
        bl_label = "Verglas Exporter"
        bl_use_shading_nodes_custom = False

        def render(self, depsgraph):
            try:
                exported = sync.scene_from(depsgraph, warn)
                exported.camera = camera.from_blender(
                    scene.camera.evaluated_get(depsgraph), depsgraph, width, height, warn)
                result.append(exported)
            except (Fault, core.Error) as fault:
                result.append(fault)

    bpy.utils.register_class(Exporter)
    try:
        with plain_picture(scene, width, height), changed(scene.render, engine=Exporter.bl_idname):
            bpy.ops.render.render(scene=scene.name)
    except RuntimeError as error:
        raise Fault(f"Scene '{scene.name}' can't be rendered: {error}") from error
    finally:
        bpy.utils.unregister_class(Exporter)
    if isinstance(result[0], Exception):
        raise result[0]
    return result[0]
