# SPDX-License-Identifier: GPL-3.0-or-later
"""The process's one core renderer: it owns the GL thread, and what has been uploaded stays there
from frame to frame. It makes one picture at a time."""

import atexit
import threading
from collections.abc import Callable

from . import verglas_core as core

_renderer: core.Renderer | None = None
_busy = threading.Lock()


def render(scene: core.Scene, settings: core.Settings,
           progress: Callable[[int, int], bool] | None = None) -> core.Frame | None:
    """Waits for its turn and for the picture; None when progress ends it. Raises core.Error, also
    where OpenGL can't be had."""
    with _busy:
        return _get().render(scene, settings, progress)


def render_if_idle(scene: core.Scene, settings: core.Settings) -> core.Frame | None:
    """For the viewport, which must not wait for a final frame: None while another picture is made."""
    if not _busy.acquire(blocking=False):
        return None
    try:
        return _get().render(scene, settings)
    finally:
        _busy.release()


def device() -> str:
    """The driver's name for what renders. Raises core.Error where OpenGL can't be had."""
    return _get().device


def _get() -> core.Renderer:
    global _renderer
    if _renderer is None:
        _renderer = core.Renderer()
    return _renderer


def _free() -> None:
    global _renderer
    _renderer = None


def register():
    atexit.register(_free)


def unregister():
    atexit.unregister(_free)
    _free()
