# SPDX-License-Identifier: GPL-3.0-or-later
"""The VERGLAS render engine: final frames and a simple rendered viewport."""

import bpy
import numpy as np

from . import compat, devices, faults, preview, renderer, sync, viewport
from . import verglas_core as core
from .sync import camera, settings


class VerglasRenderEngine(bpy.types.RenderEngine):
    bl_idname = 'VERGLAS'
    bl_label = "Verglas"
    bl_use_shading_nodes_custom = False
    bl_use_eevee_viewport = True
    bl_use_preview = True

    viewport_view: viewport.View | None = None
    told: tuple[int, int] | None = None
    """Samples done, and all of them, as the user has been told."""

    def update_render_passes(self, scene, view_layer):
        self.register_pass(scene, view_layer, "Combined", 4, "RGBA", 'COLOR')
        if view_layer.use_pass_z:
            self.register_pass(scene, view_layer, "Depth", 1, "Z", 'VALUE')
        if view_layer.use_pass_normal:
            self.register_pass(scene, view_layer, "Normal", 3, "XYZ", 'VECTOR')

    def render(self, depsgraph):
        """One view layer of one frame, or a preview icon."""
        if self.is_preview:
            self._render_preview(depsgraph)
            return
        try:
            frame = self._frame(depsgraph)
        except (faults.Fault, core.Error) as fault:
            faults.report(self, fault)
            return
        if frame is not None:
            self._write(_passes(frame), depsgraph.view_layer.name)

    def _render_preview(self, depsgraph: bpy.types.Depsgraph) -> None:
        """A fault leaves the icon empty: it is told of where the user renders."""
        camera_object = depsgraph.scene_eval.camera
        try:
            picture = preview.picture_of(depsgraph, camera_object, self.resolution_x, self.resolution_y,
                                         lambda *_: not self.test_break())
        except core.Error:
            return
        if picture is not None:
            self._write({"Combined": picture}, depsgraph.view_layer.name)

    def _frame(self, depsgraph: bpy.types.Depsgraph) -> core.Frame | None:
        """None when the user has cancelled."""
        warn = faults.warner(self)
        camera_object = self.camera_override or depsgraph.scene_eval.camera
        if camera_object is None:
            raise faults.Fault(f"Scene '{depsgraph.scene.name}' has no camera.")
        self.update_stats("", "Verglas | scene")
        width, height = self.resolution_x, self.resolution_y
        scene = sync.scene_from(depsgraph, warn)
        scene.camera = camera.from_blender(
            camera_object.evaluated_get(depsgraph), depsgraph, width, height, warn)
        blender_scene = depsgraph.scene_eval
        if blender_scene.verglas.method == 'REFERENCE':
            path_settings = settings.reference(blender_scene, width, height, warn)
            return self._trace(core.PathTracer(scene, path_settings), blender_scene.verglas.reference_samples,
                               depsgraph.view_layer.name)
        render_settings = settings.from_blender(blender_scene, width, height, warn)
        return renderer.render(devices.of_final_frames(blender_scene), scene, render_settings, self._progress)

    def _trace(self, tracer: core.PathTracer, samples: int, view_layer: str) -> core.Frame | None:
        """The reference. Whenever the samples have doubled, the picture so far is shown; what there is
        when the user cancels is kept."""
        def progress(done: int, _) -> bool:
            return self._progress(before + done, samples)

        while (before := tracer.samples) < samples:
            if before and not bpy.app.background:
                self._write(_passes(tracer.frame()), view_layer)
            if not tracer.render(min(max(before, 1), samples - before), progress):
                break
        return tracer.frame() if tracer.samples else None

    def _progress(self, done: int, total: int) -> bool:
        """Whether to go on. The CPU device asks often within a sample; that is told once."""
        if self.told != (done, total):
            self.told = done, total
            self.update_progress(done / total)
            self.update_stats("", f"Verglas | sample {done}/{total}")
        return not self.test_break()

    def _write(self, pictures: dict[str, np.ndarray], view_layer: str) -> None:
        """pictures: (H, W) or (H, W, C) by their passes' names."""
        height, width = pictures["Combined"].shape[:2]
        result = self.begin_result(0, 0, width, height, layer=view_layer)
        for render_pass in result.layers[0].passes:
            if render_pass.name in pictures:
                compat.write_pass(render_pass, pictures[render_pass.name])
        self.end_result(result)

    def view_update(self, context, depsgraph):
        self._view().update(context, depsgraph)
        self.tag_redraw()  # by scripts' changes Blender doesn't

    def view_draw(self, context, depsgraph):
        self._view().draw(context, depsgraph)

    def _view(self) -> viewport.View:
        if self.viewport_view is None:
            self.viewport_view = viewport.View(self)
        return self.viewport_view


def _passes(frame: core.Frame) -> dict[str, np.ndarray]:
    return {"Combined": frame.combined, "Depth": frame.depth, "Normal": frame.normal}


def register():
    faults.register()
    renderer.register()
    sync.register()
    bpy.utils.register_class(VerglasRenderEngine)


def unregister():
    bpy.utils.unregister_class(VerglasRenderEngine)
    viewport.unregister()
    sync.unregister()
    renderer.unregister()
    faults.unregister()
