# SPDX-License-Identifier: GPL-3.0-or-later
"""A method's picture and what was measured of it."""

from dataclasses import dataclass

from . import metrics
from .methods import Picture
from .truth import Truth


@dataclass
class Rendered:
    """What a method made of a subject."""
    picture: Picture
    way: list[Picture]
    """with 1, 2, 4, … or 1, 4, 16, … samples, of methods that converge to the truth; else empty"""
    noise: float | None = None
    """of path-traced methods: relmse to another such picture"""


@dataclass
class Measured:
    picture: Picture
    metrics: dict[str, float | None]
    """those of metrics.ALL, and relmse_net"""
    noise: float | None
    """as Rendered's"""
    convergence: list[dict[str, float]]
    """samples, seconds, relmse and relmse_net of each picture of the way"""

    @classmethod
    def against(cls, truth: Truth, rendered: Rendered) -> "Measured":
        pixels, mask = truth.pixels, truth.mask
        found = metrics.measure(rendered.picture.pixels, pixels, mask)
        found["relmse_net"] = metrics.relmse_net(rendered.picture.pixels, truth.halves, mask)
        convergence = [
            {"samples": picture.samples, "seconds": picture.seconds,
             "relmse": metrics.relmse(picture.pixels, pixels, mask),
             "relmse_net": metrics.relmse_net(picture.pixels, truth.halves, mask)}
            for picture in rendered.way]
        return cls(rendered.picture, found, rendered.noise, convergence)
