# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures 17 and 18: ways to cross the object, and what becomes of total internal reflection."""

import statistics

import matplotlib.pyplot as plt

from . import layout
from .figure import Figure, Row
from .models import FOREST, MODELS, Model, about, exponent_of
from .patterns import SMOOTH
from .studio import Case, Studio

EXPONENT = 24.0

TIR_METHODS = {
    **{mode.title(): ("bundle", {"tir": mode}) for mode in ('NONE', 'INCIDENT', 'CLAMP', 'BOUNCE')},
    "Traced": ("traced", {}),
}
"""Methods and what of core.Settings is to differ for them, by title."""


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
    case = Case(MODELS["monkey"], SMOOTH, tir=True, paths='full', rough_exponent=3.4)
    picture, axes = layout.sheet(2, 3, below=1.7)
    rows = []
    for ax, (name, (method, overrides)) in zip(axes.flat, TIR_METHODS.items()):
        pixels = studio.picture(case, method, **overrides)
        rows.append({**overrides, **studio.errors(case, method, pixels)})
        layout.show(ax, pixels, f"{name}: relative MSE {rows[-1]['relmse_net']:.4f}")
    truth = studio.truth(case)
    layout.show(axes[1, 2], truth.pixels, f"Ground truth, {truth.samples} samples")
    across = picture.get_size_inches()[0]
    table = layout.axes_at(picture, 0.9, 0.1, across - 1.0, 1.5)
    rows += _table_of_tir(studio.of_size(studio.size // 2), table)
    caption = (
        "What becomes of light that is reflected inside: with bundle, what is totally reflected is lost "
        "(none), goes on along its incident direction (incident), or is refracted as at the critical angle "
        "(clamp), or all that is reflected is followed to where it leaves next, three times, in what the "
        "camera sees (bounce); traced follows it in the geometry itself. All light, spots with the "
        f"Blinn-Phong exponent {case.rough_exponent:g} on glass with {case.exponent:g}. Below, pictures of "
        f"half the size under the map {FOREST.name}, with one roughness each (in Blender's units), and their "
        "mean. All without the part of the error that is the truth's noise.")
    return Figure("18", "Total internal reflection", caption + about(case.model), picture, rows)


def _table_of_tir(studio: Studio, ax: plt.Axes) -> list[Row]:
    """A line for each of TIR_METHODS, a column for each model and roughness."""
    models = [Model("monkey", FOREST, lens=MODELS["monkey"].lens), Model("bottle", FOREST, lens=50.0),
              Model("gem", FOREST, lens=50.0)]
    cases = {f"{model.name} {roughness:g}": Case(model, exponent_of(roughness), tir=True, paths='full')
             for model in models for roughness in (0.25, 0.55)}
    rows, lines = [], []
    for method, overrides in TIR_METHODS.values():
        made = [{**overrides, **studio.errors(case, method, studio.picture(case, method, **overrides))}
                for case in cases.values()]
        rows += made
        errors = [row["relmse_net"] for row in made]
        lines.append([f"{error:.4f}" for error in (*errors, statistics.fmean(errors))])
    layout.table(ax, lines, (*cases, "mean"), list(TIR_METHODS))
    return rows
