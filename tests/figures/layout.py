# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures side by side, by matplotlib; lengths in inches."""

from collections.abc import Sequence

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from verglas.compare import metrics

matplotlib.use('Agg')

STYLE = {"figure.dpi": 200.0, "savefig.dpi": 200.0, "font.size": 8.0, "axes.titlesize": 8.0,
         "axes.titlepad": 4.0, "axes.linewidth": 0.6}
"""matplotlib's settings, under which the figures are made."""

PANEL = 2.56
"""Side of a picture: 512 pixels are shown one to one."""
GAP = 0.06
TITLE = 0.24
LABEL = 0.24
"""Room for a row's name, on the left."""

DIFFERENCE_LIMIT = 0.5
"""Relative differences beyond it are all of one colour."""


def sheet(rows: int, columns: int, below: float = 0.0, right: float = 0.0) -> tuple[plt.Figure, np.ndarray]:
    """A figure with axes (rows, columns) for pictures, and room for more below and to the right of them."""
    width = LABEL + columns * (PANEL + GAP) + right
    height = rows * (PANEL + TITLE) + GAP + below
    grid = {"left": LABEL / width, "right": 1.0 - (GAP + right) / width, "top": 1.0 - TITLE / height,
            "bottom": (GAP + below) / height, "wspace": GAP / PANEL, "hspace": TITLE / PANEL}
    picture, axes = plt.subplots(rows, columns, figsize=(width, height), squeeze=False, gridspec_kw=grid)
    for ax in axes.flat:
        ax.set(xticks=[], yticks=[])
        ax.spines[:].set_visible(False)
    return picture, axes


def plots(rows: int, columns: int, **arguments) -> tuple[plt.Figure, np.ndarray]:
    """A figure with axes for plots; arguments as of plt.subplots."""
    return plt.subplots(rows, columns, layout='constrained', **arguments)


def axes_at(picture: plt.Figure, left: float, bottom: float, width: float, height: float) -> plt.Axes:
    """Further axes in a sheet."""
    across, up = picture.get_size_inches()
    return picture.add_axes([left / across, bottom / up, width / across, height / up])


def table(ax: plt.Axes, lines: Sequence[Sequence[str]], columns: Sequence[str],
          names: Sequence[str] | None = None) -> None:
    """A table of cells in place of axes; columns, names: of the columns and lines."""
    ax.axis('off')
    cells = ax.table(lines, colLabels=columns, rowLabels=names, colLoc='right', cellLoc='right',
                     edges='horizontal', bbox=(0.0, 0.0, 1.0, 1.0))
    cells.auto_set_font_size(False)
    for cell in cells.get_celld().values():
        cell.set_linewidth(0.4)


def show(ax: plt.Axes, pixels: np.ndarray, title: str = "") -> None:
    """pixels: (H, W, 3), scene-linear, row 0 at the bottom."""
    ax.imshow(metrics.display(pixels), origin='lower')
    ax.set_title(title)


def show_difference(ax: plt.Axes, differences: np.ndarray, mask: np.ndarray, title: str,
                    with_bar: bool = True) -> None:
    """differences: (H, W), as plots.relative_difference gives them; drawn inside the mask, from blue, too
    dark, to red, too bright. with_bar: a colour bar on the right, where the sheet has room for it."""
    shown = ax.imshow(np.ma.array(differences, mask=~mask), origin='lower', cmap="RdBu_r",
                      vmin=-DIFFERENCE_LIMIT, vmax=DIFFERENCE_LIMIT)
    ax.set_title(title)
    if with_bar:
        bar = ax.figure.colorbar(shown, cax=ax.inset_axes([1.03, 0.0, 0.04, 1.0]), extend='both')
        bar.outline.set_visible(False)
