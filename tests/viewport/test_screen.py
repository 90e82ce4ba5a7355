# SPDX-License-Identifier: GPL-3.0-or-later
"""What is on the screen."""

import numpy as np
import pytest
from blender_window import Window
from checks import settled_picture

ROUNDING = 1.0
"""Mean difference of 8-bit values that rounding and dithering may leave."""


def screen_of(window: Window, index: int = 0) -> np.ndarray:
    """(H, W, 3), 0 … 255: a viewport's part of the screen."""
    x, y, width, height = window.call("viewports.rectangle", index)
    return window.screen.picture()[y:y + height, x:x + width].astype(float)


@pytest.mark.parametrize("transform", ['Standard', 'Filmic'])
def test_picture_is_drawn_under_the_view_transform(window, transform):
    """The picture would be upside down, shifted, scaled or in other colors than F12's, or not be drawn."""
    window.call("edits.set_view_transform", transform)
    picture = settled_picture(window)
    expected = window.call("truth.displayed", picture)
    corner = 12  # Blender rounds the corners of areas, and shows there how to open what is hidden
    middle = slice(corner, -corner)
    difference = np.abs(screen_of(window)[middle, middle] - expected[middle, middle])
    assert difference.mean() < ROUNDING


def test_border_is_drawn_in_its_place(window):
    """A render border's picture would stand elsewhere in the camera view, or stretched."""
    window.call("viewports.toggle_camera_view", 0)
    window.call("edits.set_border", 0.2, 0.35, 0.6, 0.9)
    window.call("edits.set_view_transform", 'Standard')
    expected = window.call("truth.displayed", settled_picture(window))
    left, bottom, right, top = window.call("viewports.border", 0)
    assert np.abs(screen_of(window)[bottom:top, left:right] - expected).mean() < ROUNDING
