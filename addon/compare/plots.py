# SPDX-License-Identifier: GPL-3.0-or-later
"""Difference pictures and plots, by matplotlib. They are transparent, with lettering in a grey that can be
read on light and dark pages."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..faults import Fault
from .comparison import Comparison
from .metrics import RELATIVE_FLOOR

LUMINANCE = np.array((0.2126, 0.7152, 0.0722))
"""of linear Rec. 709 RGB"""

COLORS = {
    "truth": "#808080", "bundle": "#d55e00", "traced": "#c1121f", "paper": "#0072b2", "single": "#56b4e9",
    "depth_mip": "#009e73", "specular": "#e69f00", "reference": "#cc79a7", "cycles": "#8c6bb1",
    "cycles_denoised": "#4d9221", "eevee": "#a6761d", "tir_none": "#1b1b1b", "tir_incident": "#7fa6c9",
    "tir_clamp": "#f0a58f", "tir_bounce": "#6a3d9a", "analytic": "#b8a300",
}
"""Of lines and points: Okabe and Ito's palette, which colour-blind readers can tell apart, and nine more."""

LETTERING = "#808080"

STYLE = {
    "axes.edgecolor": LETTERING, "axes.labelcolor": LETTERING, "text.color": LETTERING,
    "xtick.color": LETTERING, "ytick.color": LETTERING, "axes.facecolor": "none", "figure.facecolor": "none",
    "savefig.facecolor": "none", "grid.color": LETTERING, "grid.alpha": 0.25,
    "axes.spines.top": False, "axes.spines.right": False, "font.size": 9.0, "svg.hashsalt": "verglas",
    "legend.frameon": False,
}

PICTURE_PIXELS = 320
"""Smaller difference pictures are enlarged by a whole factor to about this width."""


def relative_difference(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(H, W) signed difference of luminance, relative to the truth b as in metrics.relmse."""
    a, b = a @ LUMINANCE, b @ LUMINANCE
    return (a - b) / np.sqrt(b ** 2 + RELATIVE_FLOOR)


def relative_error(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(H, W) root mean square over RGB of the relative difference; metrics.relmse is its mean square."""
    return np.sqrt(np.mean((a - b) ** 2 / (b ** 2 + RELATIVE_FLOOR), axis=-1, dtype=np.float64))


def scale(differences: Sequence[np.ndarray], mask: np.ndarray) -> float:
    """A round number that 99 % of all differences inside the mask stay below."""
    if not differences:
        return 1.0
    limit = np.quantile(np.abs([values[mask] for values in differences]), 0.99)
    if limit == 0.0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(limit))
    return float(next(step * power for step in (1, 2, 5, 10) if step * power >= limit * (1 - 1e-9)))


def draw_differences(path: Path, values: np.ndarray, mask: np.ndarray, limit: float) -> None:
    """values: (H, W), signed, on a scale from -limit to limit around white, with a colour bar."""
    _draw_map(path, values, mask, (-limit, limit), "RdBu_r", "both",
              "(method − truth) / √(truth² + 0.01), luminance")


def draw_errors(path: Path, values: np.ndarray, mask: np.ndarray, limit: float) -> None:
    """values: (H, W), at least 0, on a scale from 0 to limit, with a colour bar."""
    _draw_map(path, values, mask, (0.0, limit), "magma", "max",
              "|method − truth| / √(truth² + 0.01)")


def _draw_map(path: Path, values: np.ndarray, mask: np.ndarray, limits: tuple[float, float], colors: str,
              extend: str, label: str) -> None:
    """One value to one pixel, or to a square of them in small pictures."""
    dpi, bar, margin = 100, 90, 12
    factor = max(1, PICTURE_PIXELS // mask.shape[1])
    height, width = (factor * size for size in mask.shape)
    with _style():
        figure = _figure(((width + bar) / dpi, (height + 2 * margin) / dpi), layout="none")
        whole = width + bar, height + 2 * margin
        axes = figure.add_axes((0, margin / whole[1], width / whole[0], height / whole[1]))
        axes.set_axis_off()
        shown = axes.imshow(np.ma.array(values, mask=~mask), origin="lower", cmap=colors, vmin=limits[0],
                            vmax=limits[1], interpolation="nearest", aspect="auto")
        bar_axes = figure.add_axes(((width + 14) / whole[0], margin / whole[1], 14 / whole[0],
                                    height / whole[1]))
        figure.colorbar(shown, cax=bar_axes, extend=extend, extendfrac=0.03).set_label(label, fontsize=8)
        figure.savefig(path, dpi=dpi, metadata={"Software": None})


def draw_scan_line(path: Path, comparison: Comparison) -> None:
    """Luminance along the row through the object's middle, of the truth and all methods."""
    mask = comparison.subject.mask
    row = middle_row(mask)
    columns = np.flatnonzero(mask[row])
    first, last = max(0, columns[0] - 4), min(mask.shape[1], columns[-1] + 5)
    x = np.arange(first, last)
    with _style():
        figure = _figure((8.0, 3.6))
        axes = figure.add_subplot()
        axes.grid(True)
        axes.plot(x, comparison.truth.pixels[row, first:last] @ LUMINANCE, color=COLORS["truth"], linewidth=4,
                  alpha=0.6, label="truth")
        for method, measured in comparison.methods.items():
            axes.plot(x, measured.picture.pixels[row, first:last] @ LUMINANCE, color=COLORS[method],
                      linewidth=1.2, label=method)
        top = np.quantile(comparison.truth.pixels[row, first:last] @ LUMINANCE, 0.99)
        axes.set_ylim(0.0, 1.3 * top or 1.0)
        axes.set_xlabel(f"column (pixels) in row {mask.shape[0] - 1 - row} from the top")
        axes.set_ylabel("luminance (scene-linear)")
        _legend(axes)
        figure.savefig(path, metadata={"Date": None})


def middle_row(mask: np.ndarray) -> int:
    """The row of the mask, which isn't empty, that is nearest to the middle of its lowest and highest."""
    rows = np.flatnonzero(mask.any(axis=1))
    return int(rows[np.argmin(np.abs(rows - 0.5 * (rows[0] + rows[-1])))])


def draw_error_over_cost(path: Path, comparison: Comparison) -> None:
    """Relative MSE over seconds, both logarithmic: a point for each method, a line for what those that
    converge pass on their way, and the truth's own noise."""
    with _style():
        figure = _figure((8.0, 4.2))
        axes = figure.add_subplot()
        axes.grid(True)
        axes.set_xscale("log")
        axes.set_yscale("log")
        for method, measured in comparison.methods.items():
            way = [point for point in measured.convergence if point["relmse"] > 0.0]
            axes.plot([point["seconds"] for point in way], [point["relmse"] for point in way], marker=".",
                      color=COLORS[method], linewidth=1.0)
            if measured.metrics["relmse"] > 0.0:
                axes.plot(measured.picture.seconds, measured.metrics["relmse"], marker="o",
                          color=COLORS[method], linestyle="none", label=method)
        axes.axhline(comparison.truth.noise, color=COLORS["truth"], linestyle="--", linewidth=1.0,
                     label="noise of the truth")
        axes.set_xlabel("seconds to render")
        axes.set_ylabel("relative MSE")
        _legend(axes)
        figure.savefig(path, metadata={"Date": None})


def _legend(axes) -> None:
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))


def _figure(size: tuple[float, float], layout: str = "constrained"):
    """Of a size in inches, drawn without any display."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout=layout)
    FigureCanvasAgg(figure)
    return figure


def _style():
    """Raises Fault without matplotlib."""
    try:
        import matplotlib
    except ImportError as error:
        raise Fault("There are no plots and difference pictures in this report: they need matplotlib (on "
                    "Debian: python3-matplotlib).") from error
    return matplotlib.rc_context(STYLE)
