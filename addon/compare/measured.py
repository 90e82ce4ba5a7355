# SPDX-License-Identifier: GPL-3.0-or-later
"""A method's picture and what was measured of it."""

from collections.abc import Sequence
from dataclasses import dataclass

from . import metrics
from .methods import Picture
from .truth import Truth


@dataclass
class Measured:
    picture: Picture
    metrics: dict[str, float | None]
    """those of metrics.ALL, and relmse_net"""
    noise: float | None
    """of path-traced methods: relmse to another such picture"""
    convergence: list[dict[str, float]]
    """of path-traced methods: samples, seconds and relmse on the way to the picture"""

    @classmethod
    def against(cls, truth: Truth, pictures: Sequence[Picture], noise: float | None) -> "Measured":
        """Measures the last of the pictures; those before it are the way to it."""
        pixels, mask = truth.pixels, truth.mask
        found = metrics.measure(pictures[-1].pixels, pixels, mask)
        found["relmse_net"] = metrics.relmse_net(pictures[-1].pixels, truth.halves, mask)
        convergence = [
            {"samples": p.samples, "seconds": p.seconds, "relmse": metrics.relmse(p.pixels, pixels, mask)}
            for p in pictures] if noise is not None else []
        return cls(pictures[-1], found, noise, convergence)
