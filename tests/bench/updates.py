# SPDX-License-Identifier: GPL-3.0-or-later
"""What an animation costs besides its pixels: until a device has the scene as it now is."""

import functools
import statistics

import numpy as np
from verglas import renderer
from verglas import verglas_core as core
from verglas.compare.progress import Progress

from . import subjects
from .frames import Row, device, settings, update_ms
from .plan import Plan, Size

METHODS = ("bundle", "traced")
"""One for each device."""

SIZE: Size = (64, 64)

REPEATS = 3


def steps(plan: Plan, progress: Progress) -> list[Row]:
    """Of one mesh of many triangles: new, moved as a whole, and deformed, which leaves its triangles and
    moves their corners."""
    squares = plan.moving_edge
    points, triangles = subjects.ball_mesh(squares)
    progress.step(f"updates of {len(triangles):,} triangles")
    meshes = [core.Mesh("Ball", points * (1.0 + i * points[:, :1] / 32.0), points, triangles)
              for i in range(1 + REPEATS)]
    identity, shifted = np.eye(4), np.eye(4)
    shifted[0, 3] = 0.1
    rows = []
    for method in METHODS:
        update = functools.partial(_update, functools.partial(renderer.render, device(method)), method)
        times = {
            "new": [update(meshes[0], identity)],
            "moved": [update(meshes[0], matrix) for matrix in (shifted, identity, shifted)],
            "deformed": [update(mesh, identity) for mesh in meshes[1:]],
        }
        rows += [{"update": kind, "triangles": len(triangles), "method": method,
                  "ms": statistics.median(found)} for kind, found in times.items()]
    return rows


def _update(render, method: str, mesh: core.Mesh, matrix: np.ndarray) -> float:
    scene = subjects.scene_of(mesh, matrix)
    return update_ms(render, scene, settings(method, SIZE))
