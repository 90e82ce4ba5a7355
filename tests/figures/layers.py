# SPDX-License-Identifier: GPL-3.0-or-later
"""The ENDF paper's figures 14 to 18: coated surfaces beside recursive sampling."""

import itertools
from collections.abc import Iterable

import matplotlib.pyplot as plt
import numpy as np
from verglas.compare.methods import Picture
from verglas.compare.truth import Truth

from . import coatings, layout
from .coatings import TITLES, Coated, Coating
from .figure import Figure, Row
from .models import FOREST, MODELS, Model, about
from .studio import Studio

MONKEY = Model("monkey", FOREST, lens=63.0)

METHODS = ("opengl", "cpu", "endf", "weidlich_wilkie")
"""Beside the truth."""

WAYS = (
    "Ground truth follows light from interface to interface by recursive sampling; OpenGL and the CPU draw "
    "it in real time, without noise, OpenGL without what an object reflects of itself; ENDF path traced "
    "draws each bounce from one extended distribution of normals (Guo et al. 2015); Weidlich and Wilkie's "
    "light (2007) stays collimated in the layer and meets the base once. Percentages: mean error as a share "
    "of the mean light; the noise of the truth alone, of {samples} samples, makes {noise:.1f}."
)

ENLARGED = 8.0
"""Factor on the light of the second bounce."""

KAPPAS = (1e6, 1e3, 10.0, 1.0)
"""Of Fig. 18."""


def figure_14(studio: Studio) -> Figure:
    coated = Coated(coatings.model_setting(studio, MONKEY), Coating(kappa=1e2, base_kappa=1e4))
    truth = coated.truth()
    picture, axes = layout.sheet(1, 6)
    rows = _show(axes[0], coated, truth, {
        "Outer side alone": coated.changed(bounces=0).path_traced("truth"),
        "Base alone": coated.changed(ior=1.0).path_traced("truth"),
        **_pictures(coated, METHODS[:3]),
    })
    caption = (
        "A mirror under a clear, rough layer. One rough interface has either the reflection of the layer's "
        "outer side or, without the layer, that of the base, which is too sharp; with light that goes "
        "through the layer and back, the base is as blurred as both sides make it. Roughnesses are of our "
        "choice, as the paper doesn't say its own. " + _ways(rows, truth))
    return Figure("endf14", "One interface, or a layer", caption, picture, rows)


def figure_15(studio: Studio) -> Figure:
    whole = Coated(coatings.model_setting(studio, MONKEY), Coating(kappa=1e4, base_kappa=1e3, bounces=2))
    one, both = (whole.changed(surface=False, bounces=bounces) for bounces in (1, 2))
    truths = [coated.truth() for coated in (one, both, whole)]
    halves = _by_bounces(*(np.array(truth.halves) for truth in truths))
    picture, axes = layout.sheet(len(halves), len(METHODS) + 1)
    rows: list[Row] = []
    for column, method in zip(axes.T, ("truth", *METHODS)):
        made = (_by_bounces(*(coated.picture(method).pixels for coated in (one, both, whole)))
                if method in METHODS else {})
        for ax, (light, truth) in zip(column, halves.items()):
            pixels = made.get(light, truth.mean(axis=0))
            title = TITLES[method]
            if made:
                rows.append({"light": light, "method": method, **whole.coating.numbers,
                             **coatings.errors(pixels, truth, whole.mask)})
                title += f": {coatings.in_percent(rows[-1])}"
            layout.show(ax, (ENLARGED if light == "Two bounces" else 1.0) * pixels, title)
    for ax, light in zip(axes[:, 0], halves):
        ax.set_ylabel(light + (f", x {ENLARGED:g}" if light == "Two bounces" else ""))
    caption = (
        f"A mirror under a clear layer, {whole.coating.title}. Above, light that has met the base once; in "
        f"the middle, twice (made {ENLARGED:g} times brighter); below, all, with the reflection of the outer "
        "side. " + _ways([row for row in rows if row["light"] == "Total"], truths[-1]))
    return Figure("endf15", "Bounce by bounce", caption, picture, rows)


def _by_bounces(one: np.ndarray, both: np.ndarray, whole: np.ndarray) -> dict[str, np.ndarray]:
    """Fig. 15's kinds of light from pictures with up to one bounce, with up to two, and of all light."""
    return {"One bounce": one, "Two bounces": both - one, "Total": whole}


def figure_16(studio: Studio) -> Figure:
    cases = {MODELS["bunny"]: Coating(1e3, 1e3, absorption=(0.2, 0.8, 0.8), thickness=0.5),
             MODELS["dragon"]: Coating(10.0, 1e6, absorption=(0.8, 0.8, 0.2), thickness=0.5)}
    picture, axes = layout.sheet(len(cases), len(METHODS) + 1)
    rows: list[Row] = []
    for line, (model, coating) in zip(axes, cases.items()):
        coated = Coated(coatings.model_setting(studio, model), coating)
        truth = coated.truth()
        rows += _show(line, coated, truth, _pictures(coated, METHODS[::-1]))
    caption = (
        "Layers that absorb light on a mirror, with the paper's coefficients (0.2, 0.8, 0.8) and (0.8, 0.8, "
        f"0.2) at a thickness of 0.5, on the {' and the '.join(model.title for model in cases)} in place of "
        "its kitten and horse. " + _ways(rows, truth) + about(*cases))
    return Figure("endf16", "Absorption", caption, picture, rows)


def figure_17(studio: Studio) -> Figure:
    model = MODELS["bunny"]
    coated = Coated(coatings.model_setting(studio, model), Coating(1e4, 10.0, ior=2.0))
    truth = coated.truth()
    picture, axes = layout.sheet(1, 3)
    rows = _show(axes[0], coated, truth, _pictures(coated, METHODS[:2]))
    times = " and ".join(f"{row['ms_a_sample']:.0f} ms by {row['picture']}" for row in rows)
    caption = (
        f"A coated mirror, index of refraction 2, in real time ({times} for a sample; OpenGL on "
        f"{studio.device}) and path traced ({truth.seconds:.0f} s). " + _ways(rows, truth) + about(model))
    return Figure("endf17", "Real time against path tracing", caption, picture, rows)


def figure_18(studio: Studio) -> Figure:
    """A small picture for each pair of roughnesses; of a sphere, which reflects nothing of itself, only the
    errors."""
    dragon = MODELS["dragon"]
    sphere = Model("sphere", dragon.world, lens=58.0)
    small = studio.of_size(max(studio.size // 4, 16))
    grids: dict[str, list[np.ndarray]] = {method: [] for method in ("truth", *METHODS)}
    rows: dict[Model, list[Row]] = {dragon: [], sphere: []}
    for model in rows:
        setting = coatings.model_setting(small, model)
        for kappa, base_kappa in itertools.product(KAPPAS[::-1], KAPPAS):
            coated = Coated(setting, Coating(kappa, base_kappa, metal='COPPER'))
            truth = coated.truth()
            pictures = {method: coated.picture(method).pixels for method in METHODS}
            rows[model] += [{"model": setting.name, "method": method, **coated.coating.numbers,
                             **coatings.errors(pixels, truth.halves, truth.mask)}
                            for method, pixels in pictures.items()]
            if model == dragon:
                for method, pixels in ({"truth": truth.pixels} | pictures).items():
                    grids[method].append(pixels)
    caption = (
        f"A copper {dragon.title} under a clear layer. From up to down the outer side gets smoother, κ₁ = 1, "
        "10, 10³, 10⁶; from left to right the base gets rougher, κ₂ = 10⁶, 10³, 10, 1. Lower right: errors "
        "on a sphere, which reflects nothing of itself. " + _ways(rows[sphere], truth) + about(dragon))
    picture = _draw_grids(grids, *rows.values())
    return Figure("endf18", "Roughnesses of both sides", caption, picture, rows[dragon] + rows[sphere])


def _pictures(coated: Coated, methods: Iterable[str]) -> dict[str, Picture]:
    return {TITLES[method]: coated.picture(method) for method in methods}


def _show(line: np.ndarray, coated: Coated, truth: Truth, pictures: dict[str, Picture]) -> list[Row]:
    """The pictures and the truth, last, in the axes; returns their numbers."""
    rows: list[Row] = []
    for ax, (name, made) in zip(line, pictures.items()):
        rows.append({"model": coated.setting.name, "picture": name, **coated.coating.numbers,
                     **coatings.errors(made.pixels, truth.halves, truth.mask), "samples": made.samples,
                     "ms_a_sample": 1e3 * made.seconds / made.samples})
        layout.show(ax, made.pixels, f"{name}: {coatings.in_percent(rows[-1])}")
    layout.show(line[-1], truth.pixels, TITLES["truth"])
    line[0].set_ylabel(coated.coating.title)
    return rows


def _ways(rows: list[Row], truth: Truth) -> str:
    """What a caption has to say of its methods, and of the noise of the truths that rows were measured by."""
    noise = float(np.mean([row["mean_relative_noise"] for row in rows]))
    return WAYS.format(noise=100.0 * noise, samples=truth.samples)


def _draw_grids(grids: dict[str, list[np.ndarray]], rows: list[Row], of_sphere: list[Row]) -> plt.Figure:
    """Fig. 18's pictures with their mean errors, and those of the sphere."""
    picture, axes = layout.sheet(2, 3, below=0.25)
    labels = [coatings.power(kappa) for kappa in KAPPAS]
    for ax, (method, pictures) in zip(axes.flat, grids.items()):
        errors = "" if method == "truth" else (
            f": {_mean_error(rows, method):.1f} %, sphere {_mean_error(of_sphere, method):.1f} %")
        _show_grid(ax, pictures, TITLES[method] + errors)
    for ax in axes[:, 0]:
        ax.set_yticklabels(labels)
        ax.set_ylabel("κ₁", rotation=0.0, labelpad=0.0)
    for ax in axes[1, :2]:
        ax.set_xticklabels(labels)
        ax.set_xlabel("κ₂", labelpad=0.0)
    axes[1, 2].axis('off')
    left = picture.get_size_inches()[0] - layout.PANEL
    _plot_errors(layout.axes_at(picture, left + 0.45, 0.4, layout.PANEL - 0.55, layout.PANEL - 0.35),
                 of_sphere)
    return picture


def _mean_error(rows: list[Row], method: str) -> float:
    """Over all pairs, in percent."""
    return 100.0 * float(np.mean([row["mean_relative_error"] for row in rows if row["method"] == method]))


def _show_grid(ax: plt.Axes, pictures: list[np.ndarray], title: str) -> None:
    """Of Fig. 18's pairs, row by row from above."""
    count = len(KAPPAS)
    lines = [np.concatenate(pictures[i * count:(i + 1) * count], axis=1) for i in range(count)]
    layout.show(ax, np.concatenate(lines[::-1], axis=0), title)  # row 0 is at the bottom
    places = [(i + 0.5) * pictures[0].shape[0] for i in range(count)]
    ax.set(xticks=places, yticks=places, xticklabels=[], yticklabels=[])
    ax.tick_params(length=0.0, pad=2.0, labelsize=7.0)


def _plot_errors(ax: plt.Axes, rows: list[Row]) -> None:
    """Over the pairs of concentrations, from up to down, a point for each method."""
    pairs = list(dict.fromkeys((row["kappa_1"], row["kappa_2"]) for row in rows))
    for method in METHODS:
        values = [100.0 * row["mean_relative_error"] for row in rows if row["method"] == method]
        ax.plot(values, range(len(pairs)), marker='o', markersize=3.0, linestyle='none', label=TITLES[method])
    ax.set_yticks(range(len(pairs)), [", ".join(map(coatings.power, pair)) for pair in pairs])
    ax.invert_yaxis()
    ax.set_xscale('log')
    marks = (1, 2, 5, 10, 20, 50, 100, 200, 500)
    ax.set_xticks(marks, [f"{mark}" for mark in marks])
    ax.set_xticks([], minor=True)
    ax.set_xlim(min(row["mean_relative_error"] for row in rows) * 80.0,
                max(row["mean_relative_error"] for row in rows) * 125.0)
    ax.grid(linewidth=0.3)
    ax.tick_params(labelsize=6.0)
    ax.set_xlabel("mean error in percent, by κ₁, κ₂", fontsize=7.0)
    ax.legend(frameon=False, fontsize=6.0, ncols=2, loc='lower center', bbox_to_anchor=(0.4, 1.0))
