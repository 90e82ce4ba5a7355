# SPDX-License-Identifier: GPL-3.0-or-later
"""The process's core renderers: one for each device, and one for preview icons. Each is made when it is first
needed, and what it has prepared stays with it from frame to frame. It makes one picture at a time; they don't
wait for each other."""

import atexit
import threading
from collections.abc import Callable

from . import devices
from . import verglas_core as core

Progress = Callable[[int, int], bool]
"""As the core's: takes samples done and all, and returns whether to go on."""


class _Device:
    """A core renderer and whose turn it is."""

    def __init__(self, make: Callable[[], core.Renderer] | Callable[[], core.TracedRenderer]):
        self._make = make
        self._renderer: core.Renderer | core.TracedRenderer | None = None
        self._making = threading.Lock()
        self._busy = threading.Lock()

    @property
    def renderer(self) -> core.Renderer | core.TracedRenderer:
        """Raises core.Error where it can't be had."""
        with self._making:
            if self._renderer is None:
                self._renderer = self._make()
            return self._renderer

    def render(self, scene: core.Scene, settings: core.Settings,
               progress: Progress | None) -> core.Frame | None:
        with self._busy:
            return self.renderer.render(scene, settings, progress)

    def render_if_idle(self, scene: core.Scene, settings: core.Settings) -> core.Frame | None:
        if not self._busy.acquire(blocking=False):
            return None
        try:
            return self.renderer.render(scene, settings)
        finally:
            self._busy.release()

    def free(self) -> None:
        self._renderer = None


_devices = {'OPENGL': _Device(core.Renderer), 'CPU': _Device(core.TracedRenderer)}

_previews = _Device(core.TracedRenderer)
"""Its own, so that icons wait for no final frame, nor a viewport for them."""


def render_preview(scene: core.Scene, settings: core.Settings) -> core.Frame:
    """Raises core.Error."""
    return _previews.render(scene, settings, None)


def render(device: str, scene: core.Scene, settings: core.Settings,
           progress: Progress | None = None) -> core.Frame | None:
    """Waits for its turn and for the picture; None when progress ends it. device: 'OPENGL', 'CPU' or 'AUTO'.
    Raises core.Error, also where the device can't be had."""
    return _devices[resolved(device)].render(scene, settings, progress)


def render_if_idle(device: str, scene: core.Scene, settings: core.Settings) -> core.Frame | None:
    """For the viewport, which must not wait for a final frame: None while the device makes another one."""
    return _devices[resolved(device)].render_if_idle(scene, settings)


def resolved(device: str) -> str:
    """'OPENGL' or 'CPU'. 'AUTO' is OpenGL on a GPU, and the CPU where OpenGL computes on it, too, or can't be
    had; the first time that is asked, OpenGL is started."""
    if device != 'AUTO':
        return device
    if devices.automatic is None:
        name = opengl_name()
        devices.automatic = 'CPU' if name is None or devices.is_software(name) else 'OPENGL'
    return devices.automatic


def opengl_name() -> str | None:
    """The driver's name for what renders by OpenGL; None where it can't be had."""
    try:
        return _devices['OPENGL'].renderer.device
    except core.Error:
        return None


def _free() -> None:
    devices.automatic = None
    for device in (*_devices.values(), _previews):
        device.free()


def register():
    atexit.register(_free)


def unregister():
    atexit.unregister(_free)
    _free()
