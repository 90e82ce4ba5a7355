# SPDX-License-Identifier: GPL-3.0-or-later
"""Table 2 of the ENDF paper: what light that meets the base several times costs a path tracer."""

import time
from collections.abc import Iterator

import matplotlib.pyplot as plt
import numpy as np
from verglas.compare.methods import Picture
from verglas.compare.metrics import RELATIVE_FLOOR

from . import coatings, layout
from .coatings import Coated, Coating
from .figure import Figure, Row
from .models import FOREST, Model
from .studio import Studio

SUBJECTS = (Model("sphere", FOREST, lens=75.0), Model("monkey", FOREST, lens=160.0))
"""They nearly fill the picture: the background costs both methods as much."""

METHODS = {"truth": "recursive", "endf": "ENDF"}

PAPER = {1: 1.66, 2: 2.51, 3: 3.42, 4: 4.28}
"""Its speedup by bounces, at equal samples."""

MAX_INTERFACES = 16
"""that paths meet. Further ones change the monkey's mean by less than 1e-4 of it, but paths of ENDF, which
aren't lost in the layer, go on in hollows until there are no more: with 64 they take 1.4 times as long."""

SAMPLES = 16
SEEDS = 8
"""Pictures of as many samples, whose variance is the noise."""

COLUMNS = ("model", "bounces", "light", "recursive,\nms", "recursive,\nnoise", "ENDF,\nms", "ENDF,\nnoise",
           "speedup,\nsamples", "speedup,\nnoise", "the\npaper's")


LIGHT = {"one": "last alone", "all": "all"}
"""Of a row's bounces, the light that is followed. The paper's is that of one alone."""


def table_2(studio: Studio) -> Figure:
    small = studio.of_size(studio.size // 2)
    rows: list[Row] = []
    for model in SUBJECTS:
        setting = coatings.model_setting(small, model)
        for bounces, speedup in PAPER.items():
            studio.progress.step(f"path tracing the {model.name}, {bounces} bounces")
            coated = Coated(setting, Coating(kappa=1e4, base_kappa=1e3, bounces=bounces))
            for costs in measure_both(coated, SAMPLES, 2 if studio.quick else SEEDS):
                rows.append({"model": model.name, "object_pixels": int(coated.mask.sum()),
                             **coated.coating.numbers, **costs, "speedup_in_the_paper": speedup})
    caption = (
        f"A mirror under a clear layer, {coated.coating.title}, path traced in {small.size} x {small.size} "
        "pixels: light that has met the base so often and no other, as in the paper, and all light with up "
        "to so many bounces. Milliseconds: CPU time of all threads for one sample of every pixel. Noise: "
        f"variance of pictures of {SAMPLES} samples, each with a seed of its own, about their mean and "
        "relative to its square. Speedups are at equal samples and at equal noise, where the ratios of both "
        "are multiplied. For the light of one bounce, recursion takes a path through all of the layer's "
        "interfaces, whose cost and noise grow with the bounces; ENDF's is one draw. For all light, it "
        "follows one branch, which stays inside with the probability of the reflection there, mostly some "
        f"percent, so that further bounces cost neither much. Paths end after {MAX_INTERFACES} interfaces.")
    return Figure("endf_table2", "Cost by bounces", caption, _draw(rows), rows)


def measure_both(coated: Coated, samples: int, seeds: int) -> Iterator[Row]:
    """A row for each of LIGHT."""
    for light in LIGHT:
        bounce = coated.coating.bounces if light == "one" else None
        yield {"light": light, **measure(coated, samples, seeds, bounce)}


def measure(coated: Coated, samples: int, seeds: int, bounce: int | None = None) -> Row:
    """Cost of a sample and noise of both methods, whose pictures take turns, and what they make of it.
    bounce: the one whose light is followed; None for all light."""
    pictures: dict[str, list[np.ndarray]] = {method: [] for method in METHODS}
    seconds: dict[str, list[float]] = {method: [] for method in METHODS}
    for seed in range(1, seeds + 1):
        for method in METHODS:
            tracer = coated.path_tracer(seed, method, MAX_INTERFACES, bounce)
            start = time.process_time()
            tracer.render(samples)
            seconds[method].append((time.process_time() - start) / samples)
            pictures[method].append(Picture.of(tracer).pixels[coated.mask])
    row: Row = {}
    for method, name in METHODS.items():
        row[f"{name}_ms_a_sample"] = 1e3 * min(seconds[method])
        row[f"{name}_noise"] = noise(np.array(pictures[method], np.float64))
    row["speedup_at_equal_samples"] = row["recursive_ms_a_sample"] / row["ENDF_ms_a_sample"]
    row["speedup_at_equal_noise"] = (row["speedup_at_equal_samples"] * row["recursive_noise"]
                                     / row["ENDF_noise"])
    return row


def noise(pictures: np.ndarray) -> float:
    """Mean relative variance of independent pictures (N, pixels, 3) about their mean, as metrics.relmse has
    it; with the mean light as unit, so that dark ones compare to bright ones."""
    pictures = pictures / pictures.mean()
    return float(np.mean(pictures.var(axis=0, ddof=1) / (pictures.mean(axis=0) ** 2 + RELATIVE_FLOOR)))


def _draw(rows: list[Row]) -> plt.Figure:
    picture, (top, ax) = layout.plots(2, 1, height_ratios=(2.6, 1.5), figsize=(7.2, 7.4))
    layout.table(top, [_line(row) for row in rows], COLUMNS)
    of_one = [row for row in rows if row["light"] == "one"]
    for model, line in zip(SUBJECTS, ('-', '--')):
        for name, color in (("noise", "C0"), ("samples", "C1")):
            speedups = [row[f"speedup_at_equal_{name}"] for row in of_one if row["model"] == model.name]
            ax.plot(list(PAPER), speedups, marker='o', linestyle=line, color=color,
                    label=f"{model.name}, at equal {name}")
    ax.plot(list(PAPER), list(PAPER.values()), marker='o', color="C2", label="the paper's, at equal samples")
    ax.set(xlabel="bounce, its light alone", ylabel="speedup over recursive sampling", xticks=list(PAPER))
    ax.set_ylim(bottom=0.0)
    ax.grid(linewidth=0.3)
    ax.legend(frameon=False, loc='upper center', bbox_to_anchor=(0.5, -0.18), ncols=3)
    return picture


def _line(row: Row) -> tuple[str, ...]:
    return (row["model"], f"{row['bounces']}", LIGHT[row["light"]],
            f"{row['recursive_ms_a_sample']:.1f}", f"{row['recursive_noise']:.4f}",
            f"{row['ENDF_ms_a_sample']:.1f}", f"{row['ENDF_noise']:.4f}",
            *(f"{row[name]:.2f}" for name in ("speedup_at_equal_samples", "speedup_at_equal_noise",
                                              "speedup_in_the_paper")))
