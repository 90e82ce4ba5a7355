# SPDX-License-Identifier: GPL-3.0-or-later
"""What is on the screen."""

import numpy as np
import pytest
from blender_window import Window
from checks import settled_picture

MEAN, MOST = 0.5, 2.0
"""Differences of 8-bit values that rounding and the tables of the view transform may leave: the mean one,
and that of nearly all pixels."""


def screen_of(window: Window, index: int = 0) -> np.ndarray:
    """(H, W, 3), 0 … 255: a viewport's part of the screen."""
    x, y, width, height = window.call("viewports.rectangle", index)
    return window.screen.picture()[y:y + height, x:x + width].astype(float)


def assert_displayed(window: Window, screen: np.ndarray, picture: np.ndarray, part=()) -> None:
    """The screen shows a scene-linear picture. part: index of what is compared."""
    difference = np.abs(screen - window.call("truth.displayed", picture))[part]
    assert difference.mean() < MEAN and np.percentile(difference, 99.0) <= MOST


@pytest.mark.parametrize("transform", ['Standard', 'Filmic'])
def test_picture_is_drawn_under_the_view_transform(window, transform):
    """The picture would be upside down, shifted, scaled or in other colors than F12's, or not be drawn."""
    window.call("edits.set_view_transform", transform)
    picture = settled_picture(window)
    screen = screen_of(window)
    corner = 12  # Blender rounds the corners of areas, and shows there how to open what is hidden
    middle = slice(corner, -corner)
    assert_displayed(window, screen, picture, (middle, middle))


def test_border_is_drawn_in_its_place(window):
    """A render border's picture would stand elsewhere in the camera view, or stretched."""
    window.call("viewports.toggle_camera_view", 0)
    window.call("edits.set_border", 0.2, 0.35, 0.6, 0.9)
    window.call("edits.set_view_transform", 'Standard')
    picture = settled_picture(window)
    left, bottom, right, top = window.call("viewports.border", 0)
    assert_displayed(window, screen_of(window)[bottom:top, left:right], picture)
