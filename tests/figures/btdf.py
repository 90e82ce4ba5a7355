# SPDX-License-Identifier: GPL-3.0-or-later
"""The exact lobe of one rough refraction, evaluated by numpy and sharing nothing with the core.

Walter, Marschner, Li, Torrance: Microfacet Models for Refraction through Rough Surfaces (EGSR 2007), with
the Blinn-Phong distribution. Directions: n = +Z, the viewer in o = (sin theta_o, 0, cos theta_o), light from
a unit direction i with i.z < 0. eta = n_behind / n_before.
"""

from dataclasses import dataclass

import numpy as np


def fresnel(cos_theta: np.ndarray, eta: float) -> np.ndarray:
    """Reflectance for unpolarised light, 0 … 1, by Snell's law and Fresnel's two amplitudes."""
    sin_t = np.sqrt(1.0 - np.square(cos_theta)) / eta
    cos_t = np.sqrt(np.clip(1.0 - sin_t ** 2, 0.0, None))
    perpendicular = (cos_theta - eta * cos_t) / (cos_theta + eta * cos_t)
    parallel = (eta * cos_theta - cos_t) / (eta * cos_theta + cos_t)
    return np.where(sin_t < 1.0, 0.5 * (perpendicular ** 2 + parallel ** 2), 1.0)


def distribution(cos_theta: np.ndarray, exponent: float) -> np.ndarray:
    """Blinn-Phong density of microfacet normals per solid angle (Walter et al., eq. 30)."""
    return (exponent + 2.0) / (2.0 * np.pi) * np.clip(cos_theta, 0.0, None) ** exponent


def masking(cos_theta: np.ndarray, exponent: float) -> np.ndarray:
    """Smith's factor of one direction, 0 … 1: eq. 27 with Blinn-Phong's a = sqrt(exponent / 2 + 1) / tan."""
    tangent = np.sqrt(1.0 - np.square(cos_theta)) / np.maximum(cos_theta, 1e-9)
    a = np.sqrt(0.5 * exponent + 1.0) / np.maximum(tangent, 1e-9)
    return np.where(a < 1.6, (3.535 * a + 2.181 * a ** 2) / (1.0 + 2.276 * a + 2.577 * a ** 2), 1.0)


def lobe(i: np.ndarray, cos_theta_o: float, eta: float, exponent: float) -> np.ndarray:
    """f_t |i.n| (eq. 21), without the compression of radiance by eta^2, so that it integrates over i to
    the energy that is let through. i: (..., 3). Returns (...), per steradian."""
    o = np.array([np.sqrt(1.0 - cos_theta_o ** 2), 0.0, cos_theta_o])
    h = o + eta * i
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    h *= np.where(h[..., 2:] < 0.0, -1.0, 1.0)
    o_h = h @ o
    i_h = np.sum(i * h, axis=-1)
    o_facing = np.clip(o_h, 1e-9, 1.0)
    jacobian = eta ** 2 * np.abs(i_h) / (o_h + eta * i_h) ** 2  # of h for i (eq. 17)
    value = (o_facing / cos_theta_o * (1.0 - fresnel(o_facing, eta)) * distribution(h[..., 2], exponent)
             * masking(cos_theta_o, exponent) * masking(-i[..., 2], exponent) * jacobian)
    return np.where((o_h > 0.0) & (i_h < 0.0), value, 0.0)


@dataclass
class Hemisphere:
    """Directions behind the interface with y >= 0 on a grid, and the solid angle of each, for integrals
    over what is symmetric about the plane of incidence."""
    directions: np.ndarray
    """(N, N, 3)"""
    solid_angles: np.ndarray
    """(N, 1) steradians; they add up to a full hemisphere's."""

    @classmethod
    def grid(cls, resolution: int) -> "Hemisphere":
        theta, phi = ((np.arange(resolution) + 0.5) / resolution * end for end in (np.pi / 2.0, np.pi))
        theta, phi = np.meshgrid(theta, phi, indexing='ij')
        x, y = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi)
        directions = np.stack([x, y, -np.cos(theta)], axis=-1)
        edges = np.cos(np.linspace(0.0, np.pi / 2.0, resolution + 1))
        rings = (edges[:-1] - edges[1:])[:, None]
        return cls(directions, rings * 2.0 * np.pi / resolution)

    def integral(self, values: np.ndarray) -> float:
        """values: (N, N)."""
        return float(np.sum(values * self.solid_angles))

    def mean_vector(self, values: np.ndarray) -> np.ndarray:
        """(3,) mean direction weighted by values; its y is 0 by symmetry."""
        x, z = (self.integral(values * self.directions[..., axis]) for axis in (0, 2))
        return np.array([x, 0.0, z]) / self.integral(values)


def kappa_from_mean_length(length: float) -> float:
    """Concentration of the spherical Gaussian whose mean vector has this length: the inverse of
    coth(kappa) - 1 / kappa (start by Banerjee et al. 2005, then Newton's steps)."""
    kappa = length * (3.0 - length ** 2) / (1.0 - length ** 2)
    for _ in range(4):
        mean = 1.0 / np.tanh(kappa) - 1.0 / kappa
        kappa += (length - mean) / (1.0 - mean ** 2 - 2.0 * mean / kappa)
    return float(kappa)


def gaussian(i: np.ndarray, energy: float, kappa: float, direction: np.ndarray) -> np.ndarray:
    """The spherical Gaussian with this energy over the whole sphere. i: (..., 3). Returns (...)."""
    amplitude = energy * kappa / (2.0 * np.pi * -np.expm1(-2.0 * kappa))
    return amplitude * np.exp(kappa * (i @ np.asarray(direction) - 1.0))
