# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests ask of the window's viewports."""

import metrics
import numpy as np
from blender_window import Window

SAME = 0.002
"""Relative MSE below which a viewport shows the picture of the final frame."""

OTHER = 2 * SAME
"""Relative MSE above which a change is seen."""


def relmse(picture: np.ndarray, truth: np.ndarray) -> float:
    """Over all pixels and channels, alpha too."""
    assert picture.shape == truth.shape
    return metrics.relmse(picture, truth, np.ones(truth.shape[:2], bool))


def settle(window: Window) -> None:
    """Waits until all viewports have drawn their last picture, without a fault."""
    window.settle()
    assert not any(fault for _, _, fault in window.call("viewports.states"))


def settled_picture(window: Window, index: int = 0) -> np.ndarray:
    """(H, W, 4), scene-linear."""
    settle(window)
    return window.call("viewports.picture", index)


def assert_same(picture: np.ndarray, truth: np.ndarray) -> None:
    error = relmse(picture, truth)
    assert error <= SAME


def assert_other(picture: np.ndarray, before: np.ndarray) -> None:
    """A change is seen."""
    error = relmse(picture, before)
    assert error >= OTHER


def final_picture(window: Window, index: int = 0) -> np.ndarray:
    """What a viewport shows, (H, W, 4), which is what a final frame of the same state shows."""
    picture = settled_picture(window, index)
    assert_same(picture, window.call("truth.picture", index))
    return picture
