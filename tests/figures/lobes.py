# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure 3: the tables' spherical Gaussians against the exact BTDF."""

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import MaxNLocator
from verglas import verglas_core as core

from . import btdf, layout
from .figure import Figure, Row
from .models import roughness_of
from .studio import Studio

EXPONENTS = (24.0, 6.4)
INDEX = 1.51
ANGLES = (0, 30, 60, 80, 88)
"""degrees between the viewer and the normal"""

LEAST_ENERGY = 0.05
"""Lobes that let less through aren't drawn: beyond the critical angle little is left."""

CAPTION = (
    "One crossing of a rough interface: the exact BTDF times the cosine (red; Walter et al. 2007, evaluated "
    "by numpy apart from the renderer) and the spherical Gaussian that the renderer's tables hold for it "
    "(blue), in the plane of incidence, per steradian. The numbers inside the arcs are the viewer's angles "
    "to the normal; the arcs' are the angle behind the interface. Left: light enters the glass (1.51); "
    "right: it leaves it (1/1.51), where the critical angle is 41.5°; lobes with less than "
    f"{LEAST_ENERGY:.0%} of the energy aren't drawn, and their relative errors don't matter. The paper "
    "doesn't name its two roughnesses; these are Blinn-Phong exponents of its Fig. 19. The Gaussian has the "
    "BTDF's energy and mean direction; where the BTDF is skewed, their peaks differ. Relative L2 error: root "
    "of the squared difference over the squared BTDF, both integrated over all directions behind the "
    "interface."
)


@dataclass
class Lobe:
    """The exact lobe of one crossing, and the tables'."""
    exponent: float
    eta: float
    angle: int
    """degrees between the viewer and the normal"""

    def __post_init__(self):
        self.cosine = np.cos(np.radians(self.angle))
        energy, kappa, direction = core.interface_lobe(
            'BLINN_PHONG', roughness_of(self.exponent), self.eta, self.cosine, 'REFRACT')
        self.energy, self.kappa, self.direction = energy, kappa, np.array(direction)

    def exact(self, i: np.ndarray) -> np.ndarray:
        return btdf.lobe(i, self.cosine, self.eta, self.exponent)

    def gaussian(self, i: np.ndarray) -> np.ndarray:
        return btdf.gaussian(i, self.energy, self.kappa, self.direction)

    def numbers(self, hemisphere: btdf.Hemisphere) -> Row:
        exact, gaussian = self.exact(hemisphere.directions), self.gaussian(hemisphere.directions)
        mean = hemisphere.mean_vector(exact)
        error = hemisphere.integral((gaussian - exact) ** 2) / hemisphere.integral(exact ** 2)
        return {
            "exponent": self.exponent, "eta": self.eta, "angle": self.angle,
            "energy_exact": hemisphere.integral(exact), "energy": self.energy,
            "degrees_exact": _degrees(mean), "degrees": _degrees(self.direction),
            "kappa_exact": btdf.kappa_from_mean_length(float(np.linalg.norm(mean))), "kappa": self.kappa,
            "relative_l2_error": float(np.sqrt(error)),
        }


def figure_3(studio: Studio) -> Figure:
    hemisphere = btdf.Hemisphere.grid(200 if studio.quick else 700)
    picture, axes = layout.plots(2, 2, figsize=(7.2, 7.0), subplot_kw={"projection": "polar"})
    rows = []
    for row, exponent in zip(axes, EXPONENTS):
        for ax, (event, eta) in zip(row, (("entering", INDEX), ("leaving", 1.0 / INDEX))):
            lobes = [Lobe(exponent, eta, angle) for angle in ANGLES]
            rows += [lobe.numbers(hemisphere) for lobe in lobes]
            _draw(ax, [lobe for lobe in lobes if lobe.energy >= LEAST_ENERGY])
            name = "1.51" if event == "entering" else "1/1.51"
            ax.set_title(rf"{event}, $\eta$ = {name}, exponent {exponent:g}")
    handles, _ = axes[0, 0].get_legend_handles_labels()
    picture.legend(handles[:2], ["exact BTDF", "spherical Gaussian of the tables"], ncols=2, frameon=False,
                   loc='lower center')
    picture.get_layout_engine().set(rect=(0.02, 0.04, 0.98, 0.96))
    return Figure("3", "Lobes of one rough interface", CAPTION, picture, rows)


def _degrees(direction: np.ndarray) -> float:
    """Angle behind the interface to -n, positive on the side away from the viewer."""
    return float(np.degrees(np.arctan2(-direction[0], -direction[2])))


def _draw(ax: plt.Axes, lobes: list[Lobe]) -> None:
    """Polar plot of the lobes in the quarter plane behind the interface."""
    theta = np.radians(np.linspace(-15.0, 90.0, 1501)[:-1])
    plane = np.stack([-np.sin(theta), np.zeros_like(theta), -np.cos(theta)], axis=-1)
    curves = [(lobe, lobe.exact(plane), lobe.gaussian(plane)) for lobe in lobes]
    top = max(max(exact.max(), gaussian.max()) for _, exact, gaussian in curves)
    for lobe, exact, gaussian in curves:
        ax.plot(theta, exact, color="C3", linewidth=1.1, label="exact")
        ax.plot(theta, gaussian, color="C0", linewidth=1.1, linestyle=(0, (4, 2)), label="gaussian")
        angle = np.radians(_degrees(lobe.direction))
        tip = 1.03 * max(exact.max(), gaussian.max())
        ax.plot([angle, angle], [tip, 1.04 * top], color="0.6", linewidth=0.5, linestyle=":")
        ax.text(angle, 1.09 * top, f"{lobe.angle}°", ha='center', va='center')
    ax.set_theta_zero_location('S')
    ax.set_thetamin(-15)
    ax.set_thetamax(90)
    ax.set_ylim(0.0, 1.16 * top)
    ax.set_thetagrids(range(0, 91, 15), color="0.4", fontsize=7)
    ax.yaxis.set_major_locator(MaxNLocator(4))
    ax.tick_params(axis='y', labelsize=7, labelcolor="0.4")
    ax.grid(linewidth=0.4, color="0.85")
