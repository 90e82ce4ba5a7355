# SPDX-License-Identifier: GPL-3.0-or-later
"""What is done once before the first frame: tables of lobes, and the environment's filtered levels."""

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
from .frames import Row, settings
from .plan import Plan


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
                       "ms": 1e3 * _prepare_seconds(core.Renderer(), scene)["tables"]}


def _environments(plan: Plan) -> Iterator[Row]:
    path = subjects.WORLD.path
    start = time.perf_counter()
    first = core.EnvironmentMap.load(str(path))
    yield {"step": f"map of {first.width} x {first.height}, read from its file",
           "ms": 1e3 * (time.perf_counter() - start)}
    renderer = core.Renderer()
    _prepare_seconds(renderer, core.Scene())  # warms up: the first filtering compiles its shader
    noise = np.random.default_rng(0)
    for width in plan.map_widths:
        scene = core.Scene()
        pixels = noise.random((width // 2, width, 3), np.float32)
        scene.environment_map = core.EnvironmentMap("Noise", pixels)
        yield {"step": f"map of {width} x {width // 2}, uploaded and filtered",
               "ms": 1e3 * _prepare_seconds(renderer, scene)["environment"]}


def _prepare_seconds(renderer: core.Renderer, scene: core.Scene) -> dict[str, float]:
    return renderer.render(scene, settings("bundle", (16, 16))).prepare_seconds


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
