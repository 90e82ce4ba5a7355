# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures 13 and 15: roughness that varies over the surface."""

from collections.abc import Iterable

import matplotlib.pyplot as plt

from . import layout
from .figure import Figure, Row
from .models import GLOBE, MODELS, about
from .studio import Case, Studio

SMOOTH = 100.0
"""Blinn-Phong exponent of what is less rough: the globe's oceans, and the models' ground."""

PICTURES = {
    "Simple back": ("bundle", {"back_roughness": 'SIMPLE'}),
    "Coverage": ("bundle", {}),
    "The paper's, coverage": ("paper", {}),
    "Traced, 1 sample": ("traced", {"samples": 1}),
    "Traced": ("traced", {}),
}
"""Methods and what of core.Settings is to differ for them, by title."""


def figure_13(studio: Studio) -> Figure:
    case = Case(GLOBE, SMOOTH, tir=False, rough_exponent=4.2)
    picture, axes = layout.sheet(2, 3)
    rows = _show(studio, case, (axes[0, 0], axes[0, 1], *axes[1]), PICTURES)
    truth = studio.truth(case)
    layout.show(axes[0, 2], truth.pixels, f"Ground truth, {truth.samples} samples")
    caption = (
        f"A globe whose continents have the Blinn-Phong exponent {case.rough_exponent:g}, and its oceans "
        f"{case.exponent:g}, refracted at two interfaces; what is totally reflected is lost. Through the "
        "front, the continents of the far side are seen where the back's roughness counts: by the part that "
        "each roughness covers of what a lobe reaches (coverage), or at the point where each ray leaves "
        "(traced). With one mean roughness for all of the back (simple) they are gone.")
    return Figure("13", "A globe of two roughnesses", caption, picture, rows)


def figure_15(studio: Studio) -> Figure:
    cases = [Case(MODELS[name], SMOOTH, tir=True, paths='full', rough_exponent=3.4)
             for name in ("bunny", "dragon")]
    titles = ("Simple back", "Coverage", "Traced")
    shown = {title: PICTURES[title] for title in titles}
    picture, axes = layout.sheet(len(cases), len(shown) + 1)
    rows = []
    for line, case in zip(axes, cases):
        line[0].set_ylabel(f"{case.model.title}, {case.model.world.name}")
        rows += _show(studio, case, line, shown)
        truth = studio.truth(case)
        layout.show(line[-1], truth.pixels, f"Ground truth, {truth.samples} samples")
    caption = (
        f"Spots with the Blinn-Phong exponent {cases[0].rough_exponent:g} on glass with {SMOOTH:g}, made by "
        "a noise texture in the objects' coordinates; all light, with reflections in front and inside. What "
        "is totally reflected inside is refracted as at the critical angle (clamp) by OpenGL, and followed "
        "by traced.")
    caption += about(*(case.model for case in cases))
    return Figure("15", "Patterns of two roughnesses", caption, picture, rows)


def _show(studio: Studio, case: Case, axes: Iterable[plt.Axes],
          pictures: dict[str, tuple[str, dict[str, object]]]) -> list[Row]:
    """A picture in each of the first axes; returns their numbers. pictures: as PICTURES."""
    rows = []
    for ax, (title, (method, overrides)) in zip(axes, pictures.items()):
        made = studio.subject(case).real_time(method, repeats=1, **overrides)
        rows.append({"picture": title, **studio.errors(case, method, made.pixels), "samples": made.samples,
                     "frame_ms": 1e3 * made.seconds})
        layout.show(ax, made.pixels, f"{title}: relative MSE {rows[-1]['relmse']:.4f}")
    return rows
