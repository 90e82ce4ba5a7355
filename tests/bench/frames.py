# SPDX-License-Identifier: GPL-3.0-or-later
"""The cost of one frame."""

import statistics
import time

from verglas import renderer
from verglas import verglas_core as core

from .plan import Plan, Size

METHODS = ("bundle", "paper", "single", "specular")

Row = dict[str, str | int | float | dict[str, float]]


def settings(method: str, size: Size) -> core.Settings:
    """Verglas' defaults, with one sample."""
    result = core.Settings()
    result.width, result.height = size
    result.samples = 1
    result.transport = method.upper()
    return result


def cost(scene: core.Scene, method: str, size: Size, plan: Plan) -> Row:
    """Of the median of several frames after one that warms up: wall time (frame_ms), GPU time by pass with
    the wall time of the readback (passes_ms), and the wall time outside of these (other_ms)."""
    chosen = settings(method, size)
    renderer.render(scene, chosen)
    frames: list[core.Frame] = []
    end = time.perf_counter() + plan.seconds
    while len(frames) < plan.least_frames or (len(frames) < plan.most_frames and time.perf_counter() < end):
        frames.append(renderer.render(scene, chosen))
    median = statistics.median_low(frame.seconds for frame in frames)
    frame = next(frame for frame in frames if frame.seconds == median)
    passes = {name: 1e3 * seconds for name, seconds in frame.pass_seconds.items()}
    return {"method": method, "width": size[0], "height": size[1], "frame_ms": 1e3 * frame.seconds,
            "passes_ms": passes, "other_ms": max(1e3 * frame.seconds - sum(passes.values()), 0.0),
            "frames": len(frames)}
