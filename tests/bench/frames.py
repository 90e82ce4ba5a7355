# SPDX-License-Identifier: GPL-3.0-or-later
"""The cost of one frame."""

import statistics
import time
from collections.abc import Callable

from figures.cost import passes_of
from verglas import renderer
from verglas import verglas_core as core
from verglas.compare.methods import TRACED

from .plan import Plan, Size

METHODS = ("bundle", TRACED, "paper", "single", "specular")

Row = dict[str, str | int | float | dict[str, float]]


def settings(method: str, size: Size) -> core.Settings:
    """Verglas' defaults, with one sample."""
    result = core.Settings()
    result.width, result.height = size
    result.samples = 1
    if method != TRACED:
        result.transport = method.upper()
    return result


def device(method: str) -> str:
    """As renderer.render() takes it."""
    return 'CPU' if method == TRACED else 'OPENGL'


def cost(scene: core.Scene, method: str, size: Size, plan: Plan, **attributes) -> Row:
    """Of the median of several frames after one that warms up: wall time (frame_ms), GPU time by pass with
    the wall time of the readback (passes_ms), and the wall time outside of these (other_ms). attributes: of
    core.Settings, other than its defaults."""
    return costs([(scene, attributes)], method, size, plan)[0]


def costs(cases: list[tuple[core.Scene, dict[str, object]]], method: str, size: Size,
          plan: Plan) -> list[Row]:
    """As cost(), of scenes with attributes whose frames take turns: their ratios hold even where the machine
    is busy for a while."""
    chosen = []
    for _, attributes in cases:
        chosen.append(settings(method, size))
        for name, value in attributes.items():
            setattr(chosen[-1], name, value)

    def take_turns() -> list[core.Frame]:
        return [renderer.render(device(method), scene, own) for (scene, _), own in zip(cases, chosen)]
    take_turns()
    rounds: list[list[core.Frame]] = []
    end = time.perf_counter() + plan.seconds * len(cases)
    while len(rounds) < plan.least_frames or (len(rounds) < plan.most_frames and time.perf_counter() < end):
        rounds.append(take_turns())
    return [_cost_of(frames, method, size) for frames in zip(*rounds)]


def _cost_of(frames: tuple[core.Frame, ...], method: str, size: Size) -> Row:
    median = statistics.median_low(frame.seconds for frame in frames)
    frame = next(frame for frame in frames if frame.seconds == median)
    passes = {name: 1e3 * seconds for name, seconds in passes_of(frame).items()}
    return {"method": method, "width": size[0], "height": size[1], "frame_ms": 1e3 * frame.seconds,
            "passes_ms": passes, "other_ms": max(1e3 * frame.seconds - sum(passes.values()), 0.0),
            "frames": len(frames)}


def update_ms(render: Callable[[core.Scene, core.Settings], core.Frame], scene: core.Scene,
              chosen: core.Settings) -> float:
    """Wall time of a frame besides its pixels: what it takes until a device has the scene as it now is."""
    start = time.perf_counter()
    frame = render(scene, chosen)
    return 1e3 * (time.perf_counter() - start - frame.seconds)
