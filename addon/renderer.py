# SPDX-License-Identifier: GPL-3.0-or-later
"""The process's core renderers: for each device one of final frames and one of viewports, and one of preview
icons, so that none waits for another. Each is made when it is first needed, and what it has prepared stays
with it from frame to frame."""

import atexit
import threading
from collections.abc import Callable
from typing import TypeVar

from . import devices
from . import verglas_core as core

Progress = Callable[[int, int], bool]
"""As the core's: takes samples done and all, and returns whether to go on."""

Core = core.Renderer | core.TracedRenderer
Made = TypeVar("Made")

MAKERS: dict[str, Callable[[], Core]] = {'OPENGL': core.Renderer, 'CPU': core.TracedRenderer}
"""By device. Each raises core.Error where it can't be had."""

_making = threading.Lock()
_final: dict[str, Core] = {}
_previews: dict[str, Core] = {}
_viewports: dict[str, core.ViewportRenderer] = {}


def _made(kept: dict[str, Made], device: str, make: Callable[[], Made] | None = None) -> Made:
    """What is kept for a device, 'OPENGL' or 'CPU'. make: the device's own maker where it is left out. Raises
    core.Error where the device can't be had."""
    with _making:
        if device not in kept:
            kept[device] = (make or MAKERS[device])()
        return kept[device]


def of_viewports(device: str) -> core.ViewportRenderer:
    """device: 'OPENGL' or 'CPU'. Raises core.Error where it can't be had."""
    return _made(_viewports, device, lambda: core.ViewportRenderer(MAKERS[device]()))


def render(device: str, scene: core.Scene, settings: core.Settings,
           progress: Progress | None = None) -> core.Frame | None:
    """A final frame. Waits for the picture; None when progress ends it. device: 'OPENGL', 'CPU' or 'AUTO'.
    Raises core.Error, also where the device can't be had."""
    return _made(_final, resolved(device)).render(scene, settings, progress)


def render_preview(scene: core.Scene, settings: core.Settings, progress: Progress) -> core.Frame | None:
    """By the CPU. None when progress ends it. Raises core.Error."""
    return _made(_previews, 'CPU').render(scene, settings, progress)


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
        return _made(_final, 'OPENGL').device
    except core.Error:
        return None


def _free() -> None:
    devices.automatic = None
    for viewports in _viewports.values():
        viewports.stop()
    for kept in (_viewports, _final, _previews):
        kept.clear()


def register():
    atexit.register(_free)


def unregister():
    atexit.unregister(_free)
    _free()
