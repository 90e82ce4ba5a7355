# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of the tests that drive a real Blender window."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import blender_window
import pytest

pytest.register_assert_rewrite("checks")
sys.path.append(str(Path(__file__).resolve().parents[2] / "addon" / "compare"))  # for metrics


class _Shared:
    """One window for all tests; a new one after a crash."""

    def __init__(self):
        self.window: blender_window.Window | None = None

    def get(self) -> blender_window.Window:
        if self.window is not None and not self.window.is_alive:
            self.close()
        if self.window is None:
            self.window = blender_window.Window(640, 480, blender_window.SIMULATE_EVENTS, "--debug-gpu")
        return self.window

    def close(self) -> None:
        if self.window is not None:
            window, self.window = self.window, None
            window.close()


@pytest.fixture(scope="session")
def _shared():
    if reason := blender_window.why_not():
        pytest.skip(reason)
    shared = _Shared()
    yield shared
    shared.close()


@pytest.fixture(params=['OPENGL', 'CPU'])
def device(request) -> str:
    """Runs a test by each device."""
    return request.param


@pytest.fixture
def window(_shared, device) -> blender_window.Window:
    """Shows a new file's scene in one small rendered viewport. What Blender prints during the test must hold
    no error."""
    window = _shared.get()
    printed = len(window.log())
    _show_new_file(window, device)
    yield window
    if window.is_alive:
        log = window.log()[printed:]
        assert not [line for line in log.splitlines() if blender_window.is_error(line)], log


@pytest.fixture
def sleepy_window(device) -> Iterator[blender_window.Window]:
    """As window, in a Blender that sleeps where it has no events, as a user's does."""
    with _own_window(device) as window:
        yield window


@pytest.fixture
def strict_window() -> Iterator[blender_window.Window]:
    """As window, in a Blender that crashes where it uses memory that it has freed."""
    with _own_window('CPU', variables=blender_window.OVERWRITE_FREED_MEMORY) as window:
        yield window


@contextmanager
def _own_window(device: str, **arguments) -> Iterator[blender_window.Window]:
    """Of one test alone. arguments: of Window."""
    if reason := blender_window.why_not():
        pytest.skip(reason)
    window = blender_window.Window(640, 480, **arguments)
    try:
        _show_new_file(window, device)
        yield window
    finally:
        window.close()


def _show_new_file(window: blender_window.Window, device: str) -> None:
    window.call("edits.new_file", device)
    window.call("viewports.lay_out_one")
    window.call("viewports.cut", 360, 300)
