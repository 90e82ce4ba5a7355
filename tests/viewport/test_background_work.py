# SPDX-License-Identifier: GPL-3.0-or-later
"""What the viewport costs when nothing happens, and beside a final frame."""

import time

from blender_window import Window
from checks import assert_same, final_picture, settle
from interaction import orbit

IDLE_SECONDS = 5.0

IDLE = 0.02
"""Share of one core that a viewport left alone may use."""

ROUNDING = 0.005
"""of such a share, on a machine where Blender alone uses more than that"""


def usage(window: Window) -> float:
    """Share of one core that Blender uses while nothing happens."""
    window.call("agent.rest", IDLE_SECONDS + 1.0)
    time.sleep(0.5)
    before = window.cpu_seconds()
    time.sleep(IDLE_SECONDS)
    return (window.cpu_seconds() - before) / IDLE_SECONDS


def test_left_alone(sleepy_window):
    """The fan would run, and the battery empty, for a picture that is finished."""
    settle(sleepy_window)
    rendered = usage(sleepy_window)
    sleepy_window.call("viewports.set_shading", 0, 'SOLID')
    sleepy_window.call("agent.ready")
    solid = usage(sleepy_window)
    print(f"{rendered:.2%} of a core, in solid shading {solid:.2%}")
    assert rendered <= max(IDLE, solid + ROUNDING)


def test_final_frame_beside(window):
    """F12 would stop the viewport, or either spoil the other's picture."""
    settle(window)
    before = window.call("viewports.states")[0][1]
    window.call("edits.press_f12", 560, 320)
    orbit(window)
    seen = 0
    while window.call("edits.is_rendering"):
        seen = window.call("viewports.states")[0][1] - before
    assert seen > 0
    frame = window.call("truth.last_frame")
    final_picture(window)
    assert_same(frame, window.call("truth.camera_frame"))
