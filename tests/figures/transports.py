# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures 17 and 18: ways to cross the object, and what becomes of total internal reflection."""

import numpy as np

from . import layout
from .figure import Figure, Row
from .models import MODELS, about
from .studio import Case, Studio

EXPONENT = 24.0

TIR_MODES = {"NONE": "None", "INCIDENT": "Incident", "CLAMP": "Clamp"}


def figure_17(studio: Studio) -> Figure:
    models = [MODELS[name] for name in ("bunny", "dragon")]
    picture, axes = layout.sheet(len(models), 3)
    rows = []
    for line, model in zip(axes, models):
        case = Case(model, EXPONENT, tir=True)
        truth = studio.truth(case)
        layout.show(line[1], truth.pixels, f"Ground truth, {truth.samples} samples")
        line[0].set_ylabel(model.title)
        for ax, method, name in zip((line[0], line[2]), ("depth_mip", "bundle"), ("Blur by depth", "Ours")):
            pixels = studio.picture(case, method, tir='CLAMP')
            rows.append(studio.errors(case, method, pixels))
            layout.show(ax, pixels, f"{name}: relative MSE {rows[-1]['relmse']:.4f}")
    caption = (
        "Left: one sharply refracted ray, and a level of the blurred environment chosen by the depth that it "
        "has travelled inside (after Eisemann and Décoret). Middle: ground truth with total internal "
        f"reflection. Right: ours. Blinn-Phong exponent {EXPONENT:g}.")
    return Figure("17", "One ray, or a lobe", caption + about(*models), picture, rows)


def figure_18(studio: Studio) -> Figure:
    case = Case(MODELS["bunny"], EXPONENT, tir=True)
    picture, axes = layout.sheet(2, 4)
    rows = []
    for ax, (tir, name) in zip(axes[0], TIR_MODES.items()):
        pixels = studio.picture(case, "bundle", tir=tir)
        rows.append({"tir": tir, **studio.errors(case, "bundle", pixels)})
        layout.show(ax, pixels, f"{name}: relative MSE {rows[-1]['relmse']:.4f}")
    truth = studio.truth(case)
    layout.show(axes[0, 3], truth.pixels, f"Ground truth, {truth.samples} samples")
    rows += _all_light(studio, axes[1])
    caption = (
        "Above: what becomes of totally reflected light with bundle: it is lost (none), goes on along its "
        "incident direction (incident), or is refracted as at the critical angle (clamp); and the truth, "
        "which follows it, without any other reflection. Below: all light, with reflections in front and "
        "inside, by bundle, which has those in front, and traced, which follows those inside, too. "
        f"Blinn-Phong exponent {EXPONENT:g} everywhere: the paper's two roughnesses wait for "
        "textures in the real-time renderer.")
    return Figure("18", "Total internal reflection", caption + about(case.model), picture, rows)


def _all_light(studio: Studio, axes: np.ndarray) -> list[Row]:
    """The bunny by bundle, by traced with one sample and with many, and its truth."""
    case = Case(MODELS["bunny"], EXPONENT, tir=True, paths='full')
    shown = {"Bundle": ("bundle", {}), "Traced, 1 sample": ("traced", {"samples": 1}),
             f"Traced, {studio.samples} samples": ("traced", {})}
    rows = []
    for ax, (name, (method, overrides)) in zip(axes, shown.items()):
        pixels = studio.picture(case, method, **overrides)
        rows.append({**overrides, **studio.errors(case, method, pixels)})
        layout.show(ax, pixels, f"{name}: relative MSE {rows[-1]['relmse']:.4f}")
    truth = studio.truth(case)
    layout.show(axes[3], truth.pixels, f"Ground truth, {truth.samples} samples")
    return rows
