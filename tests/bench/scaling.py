# SPDX-License-Identifier: GPL-3.0-or-later
"""The cost of a frame: of several models, against triangles, pixels and threads, by what is known of a
roughness that varies, and by where lobes come from."""

import functools
import os

from figures.models import MODELS
from verglas import renderer
from verglas.compare.methods import TRACED
from verglas.compare.progress import Progress

from . import subjects
from .frames import METHODS, Row, cost, costs, device, settings, update_ms
from .plan import Plan

BALL_SIZE = 512
"""Pixels a side of the pictures for cost against triangles."""

ROUGHNESS_BALL_EDGE = 37
"""Squares along the edge of the ball whose roughness varies: 16,428 triangles."""


def by_model(plan: Plan, progress: Progress) -> list[Row]:
    rows = []
    for model in subjects.models()[:plan.model_limit]:
        progress.step(f"frames of the {model.title}")
        for size in plan.model_sizes:
            subject = subjects.subject(model, size, progress)
            common = {"model": model.title, "triangles": subject.triangles,
                      "object_pixels": int(subject.mask.sum())}
            rows += [common | cost(subject.core_scene, method, size, plan) for method in METHODS]
    return rows


def by_triangles(plan: Plan, progress: Progress) -> list[Row]:
    """Of balls that cover the same pixels. upload_ms is the time until the device has the triangles: they are
    on the GPU, or their tree is built."""
    size = (BALL_SIZE, BALL_SIZE)
    view = subjects.subject(MODELS["sphere"], size, progress).core_scene
    rows = []
    for squares in plan.ball_edges:
        scene = subjects.ball_scene(squares, view)
        progress.step(f"frames of {scene.triangle_count:,} triangles")
        upload_ms = {name: update_ms(functools.partial(renderer.render, name), scene, settings(method, size))
                     for name, method in (('OPENGL', "single"), ('CPU', TRACED))}
        rows += [{"triangles": scene.triangle_count, "upload_ms": upload_ms[device(method)]}
                 | cost(scene, method, size, plan) for method in METHODS]
    return rows


def by_pixels(plan: Plan, progress: Progress) -> list[Row]:
    """Of the monkey, in pictures of several sizes."""
    rows = []
    for size in plan.pixel_sizes:
        progress.step(f"frames of {size[0]} x {size[1]} pixels")
        subject = subjects.subject(MODELS["monkey"], size, progress)
        common = {"pixels": size[0] * size[1], "object_pixels": int(subject.mask.sum())}
        rows += [common | cost(subject.core_scene, method, size, plan) for method in METHODS]
    return rows


def by_roughness(plan: Plan, progress: Progress) -> list[Row]:
    """Of a ball under OpenGL: with the same roughness all over, and with a texture of all roughnesses, of
    which the back has the mean or classes."""
    progress.step("frames by roughness")
    view = subjects.subject(MODELS["sphere"], plan.engine_size, progress).core_scene
    kinds = {"uniform": (False, {}), "mean on the back": (True, {"back_roughness": 'SIMPLE'}),
             **{f"{count} classes on the back": (True, {"roughness_classes": count}) for count in (2, 4, 8)}}
    cases = [(subjects.ball_scene(ROUGHNESS_BALL_EDGE, view, is_textured), attributes)
             for is_textured, attributes in kinds.values()]
    rows = costs(cases, "bundle", plan.engine_size, plan)
    return [{"roughness": name} | row for name, row in zip(kinds, rows)]


def by_lobes(plan: Plan, progress: Progress) -> list[Row]:
    """Of the monkey, by lobes from tables and in closed form."""
    progress.step("frames by lobes")
    scene = subjects.subject(MODELS["monkey"], plan.engine_size, progress).core_scene
    kinds = ("TABLE", "ANALYTIC")
    return [{"lobes": kind.lower()} | row for method in ("bundle", TRACED)
            for kind, row in zip(kinds, costs([(scene, {"lobes": kind}) for kind in kinds], method,
                                              plan.engine_size, plan))]


def by_threads(plan: Plan, progress: Progress) -> list[Row]:
    """Of the monkey, traced by 1, 2, 4, … threads up to one for each core."""
    progress.step("frames by numbers of threads")
    subject = subjects.subject(MODELS["monkey"], plan.engine_size, progress)
    cores = len(os.sched_getaffinity(0))
    counts = sorted({*(1 << i for i in range(cores.bit_length())), cores})
    return [{"threads": count} | cost(subject.core_scene, TRACED, plan.engine_size, plan, threads=count)
            for count in counts]
