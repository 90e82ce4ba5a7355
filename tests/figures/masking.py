# SPDX-License-Identifier: GPL-3.0-or-later
"""The ENDF paper's figure 2: masking by facets of von Mises-Fisher normals."""

import numpy as np
from matplotlib.ticker import MultipleLocator
from verglas import verglas_core as core

from . import layout
from .figure import Figure, Row
from .studio import Studio
from .warping import mean_length

KAPPAS = (1.0, 10.0, 100.0)

CAPTION = (
    "The area of facets that look toward a direction o, the integral of <o,m> over normals m of a von "
    "Mises-Fisher distribution of concentration kappa (top), and the masking G1 that follows from it (eq. 7; "
    "bottom), over the angle between o and the surface's normal: by quadrature over the normals (red), by "
    "the closed form that the path tracer's table stands on (blue), and by the paper's eq. 8 as it is "
    "printed (green). At flat angles its area is too small, and so too little is hidden. Another exponent "
    "of A3 than its 1/3 doesn't mend that: the area at 90° asks for 0.41 at kappa 1, 0.85 at 10, 2.6 at 100."
)


def facing_area(kappa: float, cos_theta_o: float) -> float:
    """By quadrature in the frame of o, about which a normal's angles are theta and phi: Gauss-Legendre over
    theta up to 90°, the trapezoidal rule over phi."""
    nodes, weights = np.polynomial.legendre.leggauss(256)
    theta = (nodes + 1.0) * np.pi / 4.0
    phi = np.arange(512) * 2.0 * np.pi / 512
    sin_theta_o = np.sqrt(1.0 - cos_theta_o ** 2)
    cosines = np.cos(theta)[:, None] * cos_theta_o + np.sin(theta)[:, None] * sin_theta_o * np.cos(phi)
    density = kappa / (2.0 * np.pi * -np.expm1(-2.0 * kappa)) * np.exp(kappa * (cosines - 1.0))
    rings = density.mean(axis=1) * 2.0 * np.pi
    return float(np.sum(weights * rings * np.cos(theta) * np.sin(theta)) * np.pi / 4.0)


def printed_area(kappa: float, cos_theta_o: float) -> float:
    """Eq. 8."""
    a = 0.25 * (mean_length(kappa) + 1.0) ** 2
    b = mean_length(kappa) ** (1.0 / 3.0)
    return float(a * np.cos(b * np.arccos(cos_theta_o)))


WAYS = {"quadrature": (facing_area, {"color": "C3"}),
        "ours": (core.vmf_facing_area, {"color": "C0", "linestyle": (0, (4, 2))}),
        "eq. 8": (printed_area, {"color": "C2", "linestyle": (0, (1, 1))})}
"""How the area is found, and how it is drawn."""


def figure_2(studio: Studio) -> Figure:
    degrees = np.arange(0.0, 91.0, 5.0 if studio.quick else 1.0)
    cosines = np.clip(np.cos(np.radians(degrees)), 0.0, 1.0)
    picture, axes = layout.plots(2, len(KAPPAS), figsize=(7.2, 4.8), sharex=True, sharey='row')
    rows: list[Row] = []
    for column, kappa in zip(axes.T, KAPPAS):
        areas = {way: np.array([area(kappa, cosine) for cosine in cosines])
                 for way, (area, _) in WAYS.items()}
        maskings = {way: mean_length(kappa) * cosines / area for way, area in areas.items()}
        for ax, curves in zip(column, (areas, maskings)):
            for way, values in curves.items():
                ax.plot(degrees, values, linewidth=1.1, label=way, **WAYS[way][1])
            ax.grid(linewidth=0.4, color="0.85")
        rows += [{"kappa": kappa, "way": way, **_furthest("area", degrees, areas, way),
                  **_furthest("G1", degrees, maskings, way)} for way in ("ours", "eq. 8")]
        column[0].set_title(rf"$\kappa$ = {kappa:g}")
        column[1].set_xlabel("angle to the normal, degrees")
    axes[0, 0].set_ylabel("area")
    axes[1, 0].set_ylabel("G1")
    axes[0, 0].xaxis.set_major_locator(MultipleLocator(30.0))
    axes[0, 0].legend(frameon=False)
    return Figure("endf2", "Masking by von Mises-Fisher normals", CAPTION, picture, rows)


def _furthest(name: str, degrees: np.ndarray, curves: dict[str, np.ndarray], way: str) -> Row:
    """Where a curve is farthest from quadrature's, and by how much."""
    differences = curves[way] - curves["quadrature"]
    i = int(np.argmax(np.abs(differences)))
    return {f"{name}_error": float(differences[i]), f"{name}_error_at_degrees": float(degrees[i])}
