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
    methods = {"bundle": "Ours (bundle)", "traced": "Ours (traced)", "paper": "The paper's method"}
    pictures = {"truth": truth.pixels, **{method: studio.picture(case, method) for method in methods}}
    rows = [studio.errors(case, method, pictures[method]) for method in methods]
    names = [f"Ground truth, {truth.samples} samples", *methods.values()]
    errors = ["", *(f": relative MSE {row['relmse']:.4f}" for row in rows)]

    picture, axes = layout.sheet(1, len(pictures), below=1.9)
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
        "what is totally reflected being lost. Path traced; with four rays that each find their own exit in "
        "screen space (bundle) or in the geometry itself (traced); with one lobe against the mean normal of "
        "the exits (the paper's method). Below, the luminance along the red line.")
    return Figure("10", "A scan line against ground truth", caption, picture, rows)


def figure_11(studio: Studio) -> Figure:
    caption = (
        "Ground truth, our pictures (bundle, traced), and their luminance minus the truth's, relative to the "
        f"truth's; Blinn-Phong exponent {EXPONENT:g}. What is totally reflected is lost in the truth and in "
        "bundle.")
    return _beside_truth(studio, "11", "Without total internal reflection", caption, False,
                         ("bundle", "traced"))


def figure_12(studio: Studio) -> Figure:
    caption = (
        "As Fig. 11, but the truth follows totally reflected light inside the glass until it leaves; ours "
        "refracts it as at the critical angle, so that it leaves along the surface (clamp).")
    return _beside_truth(studio, "12", "With total internal reflection", caption, True, ("bundle",))


def _beside_truth(studio: Studio, number: str, title: str, caption: str, tir: bool,
                  methods: tuple[str, ...]) -> Figure:
    """Truth, then the picture of each method and its difference, a row for each model."""
    cases = [Case(MODELS[name], EXPONENT, tir) for name in ("monkey", "bunny", "dragon")]
    rows = []
    picture, axes = layout.sheet(len(cases), 1 + 2 * len(methods), right=0.5)
    for line, case in zip(axes, cases):
        truth = studio.truth(case)
        line[0].set_ylabel(case.model.title)
        layout.show(line[0], truth.pixels, f"Ground truth, {truth.samples} samples")
        for method, ours, difference in zip(methods, line[1::2], line[2::2]):
            pixels = studio.picture(case, method, tir='CLAMP' if tir else 'NONE')
            rows.append(studio.errors(case, method, pixels))
            layout.show(ours, pixels, f"Ours ({method}): relative MSE {rows[-1]['relmse']:.4f}")
            layout.show_difference(difference, plots.relative_difference(pixels, truth.pixels), truth.mask,
                                   "Relative difference", with_bar=difference is line[-1])
    return Figure(number, title, caption + about(*(case.model for case in cases)), picture, rows)
