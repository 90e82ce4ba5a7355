# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user's hand does."""

import numpy as np
from blender_window import Window


def orbit(window: Window, index: int = 0, across: float = 0.2, up: float = 0.1, moves: int = 6) -> None:
    """Drags with the middle mouse button over a part of the viewport's width and height."""
    x, y, width, height = window.call("viewports.rectangle", index)
    way = np.linspace(0.0, 1.0, moves + 1)
    xs = x + width * (0.5 + across * (way - 0.5))
    ys = y + height * (0.5 + up * (way - 0.5))
    window.drag('MIDDLEMOUSE', zip(xs.astype(int).tolist(), ys.astype(int).tolist()))
