# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered viewport: one picture of one sample, made anew when scene or view change."""

import bpy
import numpy as np

from . import devices, renderer, sync
from . import verglas_core as core
from .sync import settings


class Picture:
    """One state of the scene as one viewport shows it."""

    def __init__(self, engine: bpy.types.RenderEngine, depsgraph: bpy.types.Depsgraph):
        warnings: list[str] = []
        self._scene = sync.scene_from(depsgraph, warnings.append)
        self._view: tuple | None = None
        self._texture = None
        engine.update_stats("", _summary(warnings))

    def draw(self, engine: bpy.types.RenderEngine, context: bpy.types.Context,
             scene: bpy.types.Scene) -> None:
        """Renders first if the view isn't the one of the last drawing."""
        # Only where Blender draws: in background the gpu module can't be used
        import gpu
        from gpu_extras.presets import draw_texture_2d

        region, view3d = context.region, context.region_data
        view = (region.width, region.height, view3d.view_matrix.copy(), view3d.window_matrix.copy())
        if view != self._view:
            self._render(engine, scene, view)
        if self._texture is None:
            return
        gpu.state.blend_set('ALPHA_PREMULT')
        engine.bind_display_space_shader(scene)
        draw_texture_2d(self._texture, (0, 0), region.width, region.height)
        engine.unbind_display_space_shader()
        gpu.state.blend_set('NONE')

    def _render(self, engine: bpy.types.RenderEngine, scene: bpy.types.Scene, view: tuple) -> None:
        """Makes the texture for a view. While a final frame is rendered the old one stays."""
        import gpu

        width, height, view_matrix, window_matrix = view
        self._scene.camera = core.Camera(np.array(view_matrix), np.array(window_matrix))
        try:
            frame = renderer.render_if_idle(
                devices.of_viewport(scene), self._scene, settings.viewport(scene, width, height))
        except core.Error as fault:
            engine.update_stats("", f"Verglas | {fault}")
            self._view, self._texture = view, None
            return
        if frame is not None:
            pixels = np.ascontiguousarray(frame.combined, np.float32).reshape(-1)
            buffer = gpu.types.Buffer('FLOAT', len(pixels), pixels)
            self._view = view
            self._texture = gpu.types.GPUTexture((width, height), format='RGBA32F', data=buffer)


def _summary(warnings: list[str]) -> str:
    """The first warning, and how many more there are."""
    distinct = list(dict.fromkeys(warnings))
    if not distinct:
        return ""
    return distinct[0] if len(distinct) == 1 else f"{distinct[0]} ({len(distinct) - 1} more warnings)"
