# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendered viewports: each shows the newest picture that the core has made for it, and never waits for it."""

import weakref

import bpy
import numpy as np

from . import devices, faults, message, preferences, renderer, sync
from . import verglas_core as core
from .sync import camera, settings

POLL_SECONDS = 0.01
"""Between two looks for new pictures, as long as some are being made."""

_views: weakref.WeakSet["View"] = weakref.WeakSet()


def views() -> list["View"]:
    """All that are shown."""
    return list(_views)


class View:
    """What one 3D viewport shows."""

    def __init__(self, engine: bpy.types.RenderEngine):
        self._engine = weakref.ref(engine)
        self._messages = faults.Collector()
        self._scene: core.Scene | None = None
        self._device = ""
        self._core: core.ViewportView | None = None
        self._asked = None
        """what was asked for last, and when it differs is asked for again"""
        self._state = None
        """the viewport's own settings with which the scene was read"""
        self._texture = None
        self.region = 0
        """its address at the last drawing"""
        self.frame: core.Frame | None = None
        """what was drawn last"""
        self.shown: core.Settings | None = None
        """what it was made by"""
        self.pictures = 0
        """how many different ones were drawn"""
        _views.add(self)

    @property
    def fault(self) -> str:
        """The sentence over the picture; "" where there is none."""
        return self._messages.fault or (self._core.fault if self._core else "")

    @property
    def has_news(self) -> bool:
        return self._core is not None and self._core.has_news

    @property
    def is_done(self) -> bool:
        """Whether all that it asked for is drawn."""
        if self._core is None:
            return bool(self.fault)
        return self._core.is_done and not self.has_news

    def tag_redraw(self) -> None:
        engine = self._engine()
        if engine is not None:
            engine.tag_redraw()

    def update(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        """Reads the scene. With a fault, the last one stays."""
        before = self._messages.fault, self._messages.warnings
        self._messages.clear()
        self._state = sync.view_state(context.space_data)
        try:
            scene = sync.scene_from(depsgraph, self._messages.warn, context.space_data)
            if self._scene is not None:
                scene.camera = self._scene.camera
            if scene != self._scene or self.fault:  # selecting something, say, changes nothing to be seen
                self._scene, self._asked = scene, None
        except (faults.Fault, core.Error) as fault:
            self._messages.fault = str(fault)
        except MemoryError:
            self._messages.fault = "There isn't enough memory to read the scene."
        if before != (self._messages.fault, self._messages.warnings):
            _redraw_panels(context)

    def draw(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        """The newest picture. If the view isn't that of the last drawing, another one is asked for."""
        self.region = context.region.as_pointer()
        if self._scene is None or self._state != sync.view_state(context.space_data):
            self.update(context, depsgraph)
        scene = depsgraph.scene_eval
        try:
            self._ask(context)
        except core.Error as fault:
            self._messages.fault = str(fault)
        self._take()
        if self._texture is not None:
            self._draw_texture(scene, context.region)
        if self.fault:
            message.draw(context, self.fault)

    def _ask(self, context: bpy.types.Context) -> None:
        if self._scene is None:
            return
        # Not the evaluated scene: changes of these settings alone evaluate nothing
        scene, region, view = context.scene, context.region, context.region_data
        wanted = settings.viewport(scene, region.width, region.height)
        wanted.region = camera.viewport_border(context, scene)
        sync.set_background(wanted, context.space_data)
        device = renderer.resolved(devices.of_viewport(scene))
        asked = device, wanted, _numbers(view.view_matrix), _numbers(view.window_matrix)
        if asked == self._asked:
            return
        if device != self._device:
            self._core = core.ViewportView(renderer.of_viewports(device))
            self._device = device
        self._asked = asked
        self._scene.camera = core.Camera(np.array(view.view_matrix), np.array(view.window_matrix))
        self._core.show(self._scene, wanted, 0.5 / preferences.viewport_fps(context))
        _watch()

    def _take(self) -> None:
        import gpu

        taken = self._core and self._core.take()
        if not taken:
            return
        self.frame, self.shown = taken
        height, width = self.frame.depth.shape
        pixels = np.ascontiguousarray(self.frame.combined, np.float32).reshape(-1)
        buffer = gpu.types.Buffer('FLOAT', len(pixels), pixels)
        self._texture = gpu.types.GPUTexture((width, height), format='RGBA32F', data=buffer)
        self.pictures += 1

    def _draw_texture(self, scene: bpy.types.Scene, region: bpy.types.Region) -> None:
        """A picture of another size is stretched until one of this size is there."""
        import gpu
        from gpu_extras.presets import draw_texture_2d

        shown = self.shown
        x, y, width, height = shown.region or (0, 0, shown.width, shown.height)
        across, up = region.width / shown.width, region.height / shown.height
        gpu.state.blend_set('ALPHA_PREMULT')
        engine = self._engine()
        engine.bind_display_space_shader(scene)
        draw_texture_2d(self._texture, (x * across, y * up), width * across, height * up)
        engine.unbind_display_space_shader()
        gpu.state.blend_set('NONE')


def _numbers(matrix) -> tuple[tuple[float, ...], ...]:
    return tuple(map(tuple, matrix))


def _redraw_panels(context: bpy.types.Context) -> None:
    """Of messages."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == 'PROPERTIES':
                area.tag_redraw()


def _watch() -> None:
    if not bpy.app.timers.is_registered(_poll):
        bpy.app.timers.register(_poll, persistent=True)


def _poll() -> float | None:
    """Has new pictures drawn; ends when there will be no more."""
    going_on = False
    for view in views():
        if view.has_news:
            view.tag_redraw()
        going_on = going_on or not view.is_done
    return POLL_SECONDS if going_on else None


def unregister() -> None:
    if bpy.app.timers.is_registered(_poll):
        bpy.app.timers.unregister(_poll)
