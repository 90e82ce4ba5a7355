# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures 10, 11 and 12: pictures against the truth of light that crosses two interfaces."""

import numpy as np
from verglas.compare import plots

from . import layout
from .figure import Figure
from .models import MODELS, about
from .studio import Case, Studio

EXPONENT = 24.0

SCAN_LINE = 0.66
"""Height of Fig. 10's row in the picture, 0 … 1."""


def figure_10(studio: Studio) -> Figure:
    case = Case(MODELS["monkey"], EXPONENT, tir=False)
    truth, mask = studio.truth(case), studio.subject(case).mask
    pictures = {"truth": truth.pixels, "bundle": studio.picture(case, "bundle"),
                "paper": studio.picture(case, "paper")}
    rows = [studio.errors(case, method, pictures[method]) for method in ("bundle", "paper")]
    names = [f"Ground truth, {truth.samples} samples", "Ours (bundle)", "The paper's method"]
    errors = ["", *(f": relative MSE {row['relmse']:.4f}" for row in rows)]

    picture, axes = layout.sheet(1, 3, below=1.9)
    plot = layout.axes_at(picture, 0.55, 0.4, picture.get_size_inches()[0] - 0.65, 1.5)
    line = int(SCAN_LINE * studio.size)
    for ax, (method, pixels), name, error in zip(axes[0], pictures.items(), names, errors):
        layout.show(ax, pixels, name + error)
        ax.axhline(line, color="red", linewidth=0.6)
        luminance = np.where(mask[line], pixels[line] @ plots.LUMINANCE, np.nan)
        width, alpha = (4.0, 0.6) if method == "truth" else (1.2, 1.0)
        plot.plot(luminance, color=plots.COLORS[method], linewidth=width, alpha=alpha, label=name)
    plot.set(xlabel="pixel", ylabel="luminance along the line", xlim=(0, studio.size - 1))
    plot.set_ylim(bottom=0.0)
    plot.legend(frameon=False)
    caption = (
        f"A monkey of frosted glass, Blinn-Phong exponent {EXPONENT:g}: light refracted at two interfaces, "
        "what is totally reflected being lost. Path traced; with four rays that each find their own exit "
        "(bundle); with one lobe against the mean normal of the exits (the paper's method). Below, the "
        "luminance along the red line.")
    return Figure("10", "A scan line against ground truth", caption, picture, rows)


def figure_11(studio: Studio) -> Figure:
    caption = (
        "Ground truth, our picture (bundle), and its luminance minus the truth's, relative to the truth's; "
        f"Blinn-Phong exponent {EXPONENT:g}. What is totally reflected is lost in both.")
    return _beside_truth(studio, "11", "Without total internal reflection", caption, tir=False)


def figure_12(studio: Studio) -> Figure:
    caption = (
        "As Fig. 11, but the truth follows totally reflected light inside the glass until it leaves; ours "
        "refracts it as at the critical angle, so that it leaves along the surface (clamp).")
    return _beside_truth(studio, "12", "With total internal reflection", caption, tir=True)


def _beside_truth(studio: Studio, number: str, title: str, caption: str, tir: bool) -> Figure:
    """Truth, ours and the difference, a row for each model."""
    cases = [Case(MODELS[name], EXPONENT, tir) for name in ("monkey", "bunny", "dragon")]
    truths = [studio.truth(case) for case in cases]
    ours = [studio.picture(case, "bundle", tir='CLAMP' if tir else 'NONE') for case in cases]
    differences = [plots.relative_difference(pixels, truth.pixels) for pixels, truth in zip(ours, truths)]
    rows = [studio.errors(case, "bundle", pixels) for case, pixels in zip(cases, ours)]

    picture, axes = layout.sheet(len(cases), 3, right=0.5)
    for line, case, truth, pixels, values, row in zip(axes, cases, truths, ours, differences, rows):
        line[0].set_ylabel(case.model.title)
        layout.show(line[0], truth.pixels, f"Ground truth, {truth.samples} samples")
        layout.show(line[1], pixels, f"Ours (bundle): relative MSE {row['relmse']:.4f}")
        layout.show_difference(line[2], values, truth.mask, "Relative difference")
    return Figure(number, title, caption + about(*(case.model for case in cases)), picture, rows)
