# SPDX-License-Identifier: GPL-3.0-or-later
"""What is done once before the first frame: tables of lobes, and the environment's filtered levels, by each
device."""

import contextlib
import os
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from verglas import verglas_core as core
from verglas.compare.progress import Progress

from . import subjects
from .frames import Row, settings, update_ms
from .plan import Plan

SMALL = settings("bundle", (16, 16))


def steps(plan: Plan, progress: Progress) -> list[Row]:
    progress.step("tables and environments")
    return [*_tables(plan), *_environments(plan)]


def _tables(plan: Plan) -> Iterator[Row]:
    """In a cache of its own, empty at first: later renderers of a user load what the first has built."""
    with tempfile.TemporaryDirectory() as folder, _environment_variable("XDG_CACHE_HOME", folder):
        for ndf in plan.ndfs:
            for way in ("built", "loaded"):
                material = core.Material("Glass")
                material.ndf = ndf
                scene = core.Scene()
                scene.add_material(material)
                yield {"step": f"tables of {ndf.replace('_', '-').title()}, {way}",
                       "ms": 1e3 * core.Renderer().render(scene, SMALL).prepare_seconds["tables"]}


def _environments(plan: Plan) -> Iterator[Row]:
    path = subjects.WORLD.path
    start = time.perf_counter()
    first = core.EnvironmentMap.load(str(path))
    yield {"step": f"map of {first.width} x {first.height}, read from its file",
           "ms": 1e3 * (time.perf_counter() - start)}
    renderer, traced = core.Renderer(), core.TracedRenderer()
    for device in renderer, traced:
        device.render(core.Scene(), SMALL)  # warms up: the first filtering by OpenGL compiles its shader
    noise = np.random.default_rng(0)
    for width in plan.map_widths:
        scene = core.Scene()
        pixels = noise.random((width // 2, width, 3), np.float32)
        scene.environment_map = core.EnvironmentMap("Noise", pixels)
        yield {"step": f"map of {width} x {width // 2}, uploaded and filtered",
               "ms": 1e3 * renderer.render(scene, SMALL).prepare_seconds["environment"]}
        yield {"step": f"map of {width} x {width // 2}, filtered by the CPU",
               "ms": update_ms(traced.render, scene, SMALL)}


@contextlib.contextmanager
def _environment_variable(name: str, value: str | Path) -> Iterator[None]:
    old = os.environ.get(name)
    os.environ[name] = str(value)
    try:
        yield
    finally:
        if old is None:
            del os.environ[name]
        else:
            os.environ[name] = old
