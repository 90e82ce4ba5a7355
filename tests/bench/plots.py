# SPDX-License-Identifier: GPL-3.0-or-later
"""The measurements as plots, by matplotlib."""

from collections.abc import Callable

import matplotlib.pyplot as plt
from figures import layout
from figures.cost import PASSES
from verglas.compare.plots import COLORS

from .frames import METHODS, Row


def models(rows: list[Row]) -> plt.Figure:
    """A column for each size of picture, a stacked bar for each model and method."""
    sizes = list(dict.fromkeys((row["width"], row["height"]) for row in rows))
    picture, axes = layout.plots(1, len(sizes), sharey=True, squeeze=False,
                                 figsize=(3.6 * len(sizes), 1.2 + 0.12 * len(rows) / len(sizes)))
    for size, ax in zip(sizes, axes[0]):
        shown = [row for row in rows if (row["width"], row["height"]) == size]
        places = [i + 0.8 * (i // len(METHODS)) for i in range(len(shown))]
        _stack(ax, places, shown)
        ax.set_yticks(places, [f"{row['model']}, {row['method']}" for row in shown], fontsize=6)
        ax.set_title(f"{size[0]} x {size[1]}")
        ax.set_xlabel("milliseconds")
    axes[0, 0].invert_yaxis()
    axes[0, -1].legend(frameon=False, fontsize=6)
    return picture


def _stack(ax: plt.Axes, places: list[float], rows: list[Row]) -> None:
    """Horizontal bars of the passes' times, one after the other."""
    done = [0.0] * len(rows)
    for name, color in zip((*PASSES, "other"), plt.get_cmap("Set3").colors):
        times = [row["other_ms"] if name == "other" else row["passes_ms"].get(name, 0.0) for row in rows]
        ax.barh(places, times, left=done, color=color, label=name.replace("_", " "), height=0.85)
        done = [a + b for a, b in zip(done, times)]
    ax.spines[['top', 'right']].set_visible(False)


def triangles(rows: list[Row]) -> plt.Figure:
    return _lines(rows, "triangles", "upload", lambda row: row["upload_ms"])


def pixels(rows: list[Row]) -> plt.Figure:
    return _lines(rows, "pixels", "readback", lambda row: row["passes_ms"]["readback"])


def _lines(rows: list[Row], x: str, part: str, part_of: Callable[[Row], float]) -> plt.Figure:
    """Frames' times over x, both logarithmic: a line for each method, and a dashed one for a part of the work
    that the methods by OpenGL have in common."""
    picture, ax = layout.plots(1, 1, figsize=(4.6, 3.0))
    for method in METHODS:
        shown = [row for row in rows if row["method"] == method]
        ax.plot([row[x] for row in shown], [row["frame_ms"] for row in shown], marker='.',
                color=COLORS[method], label=method)
    shown = [row for row in rows if row["method"] == METHODS[0]]
    ax.plot([row[x] for row in shown], [part_of(row) for row in shown], linestyle='--', color=COLORS["truth"],
            label=part)
    ax.set(xscale='log', yscale='log', xlabel=x, ylabel="milliseconds")
    ax.spines[['top', 'right']].set_visible(False)
    ax.legend(frameon=False)
    return picture


def preparation(rows: list[Row]) -> plt.Figure:
    return _bars([row["step"] for row in rows], [row["ms"] for row in rows], COLORS["bundle"])


def engines(rows: list[Row]) -> plt.Figure:
    names = [row["engine"] for row in rows]
    picture = _bars(names, [row["sample_ms"] for row in rows], [COLORS[name] for name in names])
    picture.axes[0].set_xlabel("milliseconds for each sample")
    return picture


def navigation(rows: list[Row]) -> plt.Figure:
    """What a user of the viewport waits for, by method."""
    waits = []
    for row in rows:
        color = COLORS[row["method"]]
        waits += [(f"{row['method']}, next drawing while turning", row["redraw_ms"], color),
                  (f"{row['method']}, next picture while turning", 1e3 / row["pictures_per_s"], color),
                  (f"{row['method']}, changed roughness", row["change_ms"], color)]
    names, milliseconds, colors = zip(*waits)
    return _bars(list(names), list(milliseconds), list(colors))


def _bars(names: list[str], values: list[float], color: str | list[str]) -> plt.Figure:
    """On a logarithmic axis, each with its value."""
    picture, ax = layout.plots(1, 1, figsize=(4.6, 0.6 + 0.22 * len(names)))
    bars = ax.barh(names, values, color=color)
    ax.bar_label(bars, [f" {value:.3g}" for value in values])
    ax.set(xscale='log', xlabel="milliseconds")
    ax.invert_yaxis()
    ax.margins(x=0.15)
    ax.spines[['top', 'right']].set_visible(False)
    return picture
