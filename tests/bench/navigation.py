# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered viewport in a real window: pictures while a user turns the view, and the time until a change
of the material is seen."""

import math
import statistics
import time
from collections.abc import Iterator
from pathlib import Path

import blender_window
import bpy
from verglas.compare.progress import Progress

from .frames import Row
from .plan import Plan

SCENE = Path(__file__).resolve().parents[2] / "blend_files" / "monkey.blend"

DEVICES = {"bundle": 'OPENGL', "traced": 'CPU'}
"""By method."""

BARS = 48
"""Height of the window's bars at its top and bottom, in pixels."""


def rows(plan: Plan, progress: Progress, notes: list[str]) -> list[Row]:
    """In a window of which the viewport is all but the bars, without overlays. pictures_per_s: new ones on
    the screen while the view turns; redraw_ms: from one drawing to the next then, whether with a new picture
    or the last one; change_ms: from a new roughness to the first picture that shows it. notes: takes why
    nothing can be measured."""
    if reason := blender_window.why_not():
        notes.append(reason)
        return []
    progress.step("navigation in the viewport")
    width, height = plan.viewport_size
    window = blender_window.Window(width, height + BARS, blender_window.SIMULATE_EVENTS,
                                   blender=bpy.app.binary_path)
    try:
        window.call("viewports.lay_out_one")
        window.call("edits.load", str(SCENE))
        window.call("edits.set_setting", "viewport_samples", 1)
        return [_row(window, method, plan) for method in DEVICES]
    finally:
        window.close()


def _row(window: blender_window.Window, method: str, plan: Plan) -> Row:
    window.call("edits.set_setting", "device", DEVICES[method])
    window.settle()
    drawings, pictures, seconds = _turn(window, plan.viewport_seconds)
    window.call("edits.set_roughness", "Suzanne", 0.8)  # so that each of the values that follow is a change
    changes = [_change_ms(window, 0.2 + 0.5 * i / plan.viewport_changes)
               for i in range(plan.viewport_changes)]
    _, _, width, height = window.call("viewports.rectangle", 0)
    return {"method": method, "width": width, "height": height, "redraw_ms": 1e3 * seconds / drawings,
            "pictures_per_s": pictures / seconds, "change_ms": statistics.median(changes)}


def _turn(window: blender_window.Window, seconds: float) -> tuple[int, int, float]:
    """Moves the mouse in circles with its middle button down. Returns how many times the viewport was drawn,
    how many new pictures there were, and the time in seconds."""
    moves = 0
    x, y, width, height = window.call("viewports.rectangle", 0)
    start = time.perf_counter()

    def places() -> Iterator[tuple[int, int]]:
        nonlocal moves
        while (now := time.perf_counter() - start) < seconds:
            moves += 1
            yield (x + round(width * (0.5 + 0.2 * math.cos(2.0 * now))),
                   y + round(height * (0.5 + 0.2 * math.sin(2.0 * now))))
    before = _pictures(window)
    window.drag('MIDDLEMOUSE', places())
    return moves, _pictures(window) - before, time.perf_counter() - start


def _change_ms(window: blender_window.Window, roughness: float) -> float:
    window.settle()
    before = _pictures(window)
    start = time.perf_counter()
    window.call("edits.set_roughness", "Suzanne", roughness)
    window.wait_until(lambda: _pictures(window) != before, "the picture of another roughness", pause=0.0)
    return 1e3 * (time.perf_counter() - start)


def _pictures(window: blender_window.Window) -> int:
    (_, pictures, _), = window.call("viewports.states")
    return pictures
