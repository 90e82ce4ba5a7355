# SPDX-License-Identifier: GPL-3.0-or-later
"""How much glass blurs, in scenes whose world is a single far sun: the sun's picture shows the lobe of light
that leaves the glass. Its concentration, kappa, is that of the spherical Gaussian whose mean vector is as
long.

That is exact where the sides of the glass are parallel, as the lobe of each pixel then lies around its line
of sight, and a measure of the blur elsewhere.
"""

from collections.abc import Mapping

import numpy as np

from .. import verglas_core as core

POINT_SUN = 3000.0
"""Concentration from which on a world's light is a point beside what rough glass makes of it: a standard
deviation of one degree."""


def kappas(scene: core.Scene, pictures: Mapping[str, np.ndarray], mask: np.ndarray) -> dict[str, float]:
    """Of the sun inside the mask of every picture, (H, W, 3), by the picture's name; without those where it
    isn't seen, and none where the world isn't a point sun or the camera has no perspective."""
    projection = np.float64(scene.camera.projection)
    if projection[3, 3] != 0.0 or not _is_point_sun(scene.environment_map):
        return {}
    directions = lines_of_sight(projection, *mask.shape)[mask]
    solid_angles = -directions[:, 2] ** 3  # of pixels on the image plane
    lights = {name: picture[mask].mean(axis=-1) * solid_angles for name, picture in pictures.items()}
    return {name: concentration(light, directions) for name, light in lights.items() if light.any()}


def lines_of_sight(projection: np.ndarray, height: int, width: int) -> np.ndarray:
    """(H, W, 3) unit directions through the pixels' centres in the space of a camera with perspective, which
    looks along -Z. projection: (4, 4), as of core.Camera."""
    x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    clip = np.stack([2.0 * x - 1.0, 2.0 * y - 1.0, np.ones_like(x), np.ones_like(x)], axis=-1)
    points = clip @ np.linalg.inv(projection).T
    directions = points[..., :3] / points[..., 3:]
    return directions / np.linalg.norm(directions, axis=-1, keepdims=True)


def concentration(light: np.ndarray, directions: np.ndarray) -> float:
    """kappa of light (N,), not all 0, along unit directions (N, 3), by the approximation of Banerjee et al.
    2005, which is within 1 % from kappa = 10 on."""
    length = np.linalg.norm(light @ directions) / light.sum()
    return float(length * (3.0 - length ** 2) / max(1.0 - length ** 2, 1e-12))


def _is_point_sun(environment: core.EnvironmentMap | None) -> bool:
    if environment is None:
        return False
    light = environment.pixels.mean(axis=-1, dtype=np.float64)
    height, width = light.shape
    theta, azimuth = np.meshgrid((np.arange(height) + 0.5) / height * np.pi,
                                 (np.arange(width) + 0.5) / width * 2.0 * np.pi, indexing="ij")
    sine = np.sin(theta)
    directions = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), np.cos(theta)], axis=-1)
    light *= sine
    return light.any() and concentration(light.ravel(), directions.reshape(-1, 3)) >= POINT_SUN
