# SPDX-License-Identifier: GPL-3.0-or-later
"""The cost of a frame: of several models, against triangles, and against pixels."""

from figures.models import MODELS
from verglas import renderer
from verglas.compare.progress import Progress

from . import subjects
from .frames import METHODS, Row, cost, settings
from .plan import Plan

BALL_SIZE = 512
"""Pixels a side of the pictures for cost against triangles."""


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
    """Of balls that cover the same pixels. upload_ms is the time until the triangles are on the GPU."""
    size = (BALL_SIZE, BALL_SIZE)
    view = subjects.subject(MODELS["sphere"], size, progress).core_scene
    rows = []
    for squares in plan.ball_edges:
        scene = subjects.ball_scene(squares, view)
        progress.step(f"frames of {scene.triangle_count:,} triangles")
        upload = renderer.render(scene, settings("single", size)).prepare_seconds["meshes"]
        common = {"triangles": scene.triangle_count, "upload_ms": 1e3 * upload}
        rows += [common | cost(scene, method, size, plan) for method in METHODS]
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
