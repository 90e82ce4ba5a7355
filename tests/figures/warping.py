# SPDX-License-Identifier: GPL-3.0-or-later
"""The ENDF paper's figures 5 to 8: what facets of von Mises-Fisher normals make of a beam.

The exact distributions are evaluated by numpy and share nothing with the core. The mean normal is n = +Z,
the beam's mean direction o = (sin theta_o, 0, cos theta_o). Fresnel's factor and masking don't count, as in
the paper; normals and directions that don't face each other turn nothing.
"""

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from verglas import verglas_core as core

from . import btdf, layout
from .figure import Figure, Row
from .studio import Studio

COLLIMATED = 1e9
"""kappa of a beam that has no width to be seen"""

REACH = 4.0
"""Widths, 1 / sqrt(kappa), that are drawn on either side of the mean direction."""

CURVES = (
    "Distributions of directions in the plane of incidence, per steradian, over the angle to the normal: "
    "exact (red; eqs. 16 and 20 by integration over the beam's directions), and the spherical Gaussians of "
    "the renderer's moments (blue) and of the paper's Jacobians (green; eqs. 12, 13, 18, 21). The numbers "
    "are their concentrations, the exact one that of the mean vector of directions drawn at random."
)
SHAPES = (
    " At flat angles a warp stretches distributions in the plane of incidence otherwise than across it: no "
    "spherical Gaussian has the shape then. That of the moments has the mean vector, in whose length both "
    "widths count; the paper's is too narrow by it, and stays in the direction of reflection or refraction "
    "by the mean normal, from which the mean has moved."
)


def mean_length(kappa: float) -> float:
    """A3."""
    return float(1.0 / np.tanh(kappa) - 1.0 / kappa)


def directions(u: np.ndarray, kappa: float, cosine: float) -> np.ndarray:
    """u: (N, 2) in [0, 1)^2. Returns (N, 3) of this concentration about (sine, 0, cosine)."""
    versine = -np.log1p(u[:, 0] * np.expm1(-2.0 * kappa)) / kappa
    sine = np.sqrt(versine * (2.0 - versine))
    phi = 2.0 * np.pi * u[:, 1]
    x, y, z = sine * np.cos(phi), sine * np.sin(phi), 1.0 - versine
    tilt = np.sqrt(1.0 - cosine ** 2)
    return np.stack([cosine * x + tilt * z, y, cosine * z - tilt * x], axis=-1)


@dataclass(frozen=True)
class Warp:
    """Facets and a beam. eta: n_behind / n_before of a refraction into what is denser; None reflects."""
    cosine: float
    kappa_o: float
    kappa_m: float
    eta: float | None

    def leaving(self, o: np.ndarray, m: np.ndarray) -> np.ndarray:
        """(N, 3) where o goes by m, of those that face each other."""
        o_m = np.sum(o * m, axis=-1, keepdims=True)
        o, m, o_m = (values[o_m[:, 0] > 0.0] for values in (o, m, o_m))
        if self.eta is None:
            return 2.0 * o_m * m - o
        return (o_m / self.eta - np.sqrt(1.0 - (1.0 - o_m ** 2) / self.eta ** 2)) * m - o / self.eta

    def drawn_mean(self, count: int) -> np.ndarray:
        """The mean vector of what leaves."""
        random = np.random.default_rng(1)
        o = directions(random.random((count, 2)), self.kappa_o, self.cosine)
        return self.leaving(o, directions(random.random((count, 2)), self.kappa_m, 1.0)).mean(axis=0)

    def density(self, leaving: np.ndarray, count: int) -> np.ndarray:
        """(N,) exact density in directions (N, 3): of the facets that turn each o there, and the Jacobian of
        their normals, the mean over `count` of o."""
        i = np.arange(count)
        lattice = np.stack([(i + 0.5) / count, i * (np.sqrt(5.0) - 1.0) / 2.0 % 1.0], axis=-1)
        o = directions(lattice, self.kappa_o, self.cosine)
        return np.array([self._density_by(o, direction).mean() for direction in leaving])

    def _density_by(self, o: np.ndarray, leaving: np.ndarray) -> np.ndarray:
        half = o + leaving if self.eta is None else -(o + self.eta * leaving)
        m = half / np.linalg.norm(half, axis=-1, keepdims=True)
        o_m, leaving_m = np.sum(o * m, axis=-1), m @ leaving
        if self.eta is None:
            faces, jacobian = o_m > 0.0, 1.0 / (4.0 * np.maximum(o_m, 1e-9))
        else:
            faces = (o_m > 0.0) & (leaving_m < 0.0)
            jacobian = self.eta ** 2 * np.abs(leaving_m) / (o_m + self.eta * leaving_m) ** 2
        return np.where(faces, btdf.gaussian(m, 1.0, self.kappa_m, (0.0, 0.0, 1.0)) * jacobian, 0.0)

    def plane(self, degrees: np.ndarray) -> np.ndarray:
        """(N, 3) at these angles in the plane of incidence, to the normal's side of what leaves; those of the
        beam's side are below 0."""
        radians = np.radians(degrees)
        side = 1.0 if self.eta is None else -1.0
        return np.stack([-np.sin(radians), np.zeros_like(radians), side * np.cos(radians)], axis=-1)

    def degrees(self, direction: np.ndarray) -> float:
        """The inverse of plane."""
        up = direction[2] if self.eta is None else -direction[2]
        return float(np.degrees(np.arctan2(-direction[0], up)))

    def specular(self) -> np.ndarray:
        """Where the mean o goes by n, as the paper has it."""
        o = np.array([[np.sqrt(1.0 - self.cosine ** 2), 0.0, self.cosine]])
        return self.leaving(o, np.array([[0.0, 0.0, 1.0]]))[0]


def figure_5(studio: Studio) -> Figure:
    picture, axes = layout.plots(2, 4, figsize=(9.2, 4.6))
    rows = []
    for line, eta in zip(axes, (None, 1.5)):
        for ax, degrees in zip(line, (0, 30, 45, 60)):
            warp = Warp(float(np.cos(np.radians(degrees))), COLLIMATED, 100.0, eta)
            rows.append({"angle": degrees, "kappa_m": 100.0, "eta": eta, **_panel(ax, warp, studio)})
            ax.set_title(f"{degrees}°")
        line[0].set_ylabel("reflected" if eta is None else r"refracted, $\eta$ = 1.5")
    axes[0, 0].legend(frameon=False, loc='upper left')
    caption = f"Collimated light on facets of kappa 100, at four angles to the normal. {CURVES}{SHAPES}"
    return Figure("endf5", "Spherical warping", caption, picture, rows)


def figure_6(studio: Studio) -> Figure:
    return _examples(studio, "endf6", "Joint spherical warping by reflection", None)


def figure_7(studio: Studio) -> Figure:
    return _examples(studio, "endf7", "Joint spherical warping by refraction", 1.5)


def _examples(studio: Studio, figure_id: str, title: str, eta: float | None) -> Figure:
    picture, axes = layout.plots(1, 3, figsize=(7.6, 2.7))
    rows = []
    examples = ((1.0, 50.0, 200.0), (0.707, 100.0, 100.0), (0.5, 200.0, 50.0))
    for number, (ax, (cosine, kappa_o, kappa_m)) in enumerate(zip(axes, examples), start=1):
        rows.append({"example": number, "cosine": cosine, "kappa_o": kappa_o, "kappa_m": kappa_m, "eta": eta,
                     **_panel(ax, Warp(cosine, kappa_o, kappa_m, eta), studio)})
        ax.set_title(rf"$\mu_o \cdot \mu_m$ = {cosine:g}, $\kappa_o$ = {kappa_o:g}, $\kappa_m$ = {kappa_m:g}")
    axes[0].legend(frameon=False, loc='upper left')
    caption = ("A beam with a distribution of its own on rough facets, the paper's three examples; its "
               f"Fig. 8 shows the second. {CURVES}{SHAPES}")
    return Figure(figure_id, title, caption, picture, rows)


def _panel(ax: plt.Axes, warp: Warp, studio: Studio) -> Row:
    """Draws the three distributions, and returns the numbers of their moments."""
    mean = warp.drawn_mean(20_000 if studio.quick else 1_000_000)
    exact_kappa = btdf.kappa_from_mean_length(float(np.linalg.norm(mean)))
    kappa, direction = core.warped_beam(warp.kappa_o, warp.kappa_m, warp.cosine, warp.eta)
    paper_kappa = core.kappa_by_jacobians(warp.kappa_o, warp.kappa_m, warp.cosine, warp.eta)

    middle = warp.degrees(warp.specular())
    reach = np.degrees(REACH / np.sqrt(exact_kappa))
    degrees = middle + np.linspace(-reach, reach, 51 if studio.quick else 201)
    plane = warp.plane(degrees)
    ax.plot(degrees, warp.density(plane, 1000 if studio.quick else 20_000), color="C3", linewidth=1.1,
            label="exact")
    ax.plot(degrees, btdf.gaussian(plane, 1.0, kappa, direction), color="C0", linewidth=1.1,
            linestyle=(0, (4, 2)), label="ours")
    ax.plot(degrees, btdf.gaussian(plane, 1.0, paper_kappa, warp.specular()), color="C2", linewidth=1.1,
            linestyle=(0, (1, 1)), label="paper")
    for line, (value, color) in enumerate(((exact_kappa, "C3"), (kappa, "C0"), (paper_kappa, "C2"))):
        ax.text(0.97, 0.95 - 0.09 * line, rf"$\kappa$ = {value:.1f}", color=color, ha='right', va='top',
                transform=ax.transAxes)
    ax.set_xlabel("degrees to the normal")
    ax.set_xlim(degrees[0], degrees[-1])
    ax.set_ylim(bottom=0.0)
    ax.grid(linewidth=0.4, color="0.85")

    exact_degrees = warp.degrees(mean)
    return {
        "kappa_exact": exact_kappa, "kappa": kappa, "kappa_error": kappa / exact_kappa - 1.0,
        "kappa_paper": paper_kappa, "kappa_error_paper": paper_kappa / exact_kappa - 1.0,
        "degrees_exact": exact_degrees, "degrees": warp.degrees(direction),
        "degrees_error": warp.degrees(direction) - exact_degrees,
        "degrees_error_paper": middle - exact_degrees,
    }
