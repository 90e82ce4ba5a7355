# SPDX-License-Identifier: GPL-3.0-or-later
"""A flat slab, rough in front and smooth behind, before a far sun."""

import numpy as np
import pytest
import verglas_core as verglas
from conftest import camera, flat_faces

SIZE = 96
FOCAL = 2.0


def slab_before_a_sun(roughness):
    """The front, toward the camera at -Y, is rough, the back smooth; the sun stands straight behind them."""
    front, back = verglas.Material("Rough"), verglas.Material("Smooth")
    front.roughness, back.roughness = roughness, 0.0
    scene = verglas.Scene()
    scene.camera = camera(focal=FOCAL)
    sky = np.zeros((256, 512, 3), np.float32)
    sky[127:129, 127:129] = 1e4  # along +Y, 1.4 degrees wide
    scene.environment_map, scene.environment_color = verglas.EnvironmentMap("Sun", sky), (1, 1, 1)
    corners = np.array([(-9, 0, -9), (9, 0, -9), (9, 0, 9), (-9, 0, 9)])
    materials = [scene.add_material(material) for material in (front, back)]
    slab = flat_faces("Slab", [corners, corners[::-1] + (0, 0.3, 0)], slots=[0, 0, 1, 1])
    scene.add_object("Slab", slab, np.eye(4), materials)
    return scene


def kappa_of(picture):
    """Concentration of the sun's picture: of parallel sides the exit lobe points along the line of sight."""
    place = (np.arange(SIZE) + 0.5) / SIZE * 2.0 - 1.0
    x, z = np.meshgrid(place / FOCAL, place / FOCAL)
    direction = np.stack([x, np.ones_like(x), z], axis=-1)
    length = np.linalg.norm(direction, axis=-1)
    weight = picture[..., 1].astype(float) / length ** 3  # a pixel's solid angle
    mean = (weight[..., None] * direction / length[..., None]).sum((0, 1)) / weight.sum()
    R = np.linalg.norm(mean)
    return R * (3.0 - R ** 2) / (1.0 - R ** 2)


@pytest.mark.parametrize("roughness", [0.35, 0.5])
def test_blur_of_a_flat_slab(renderer, roughness):
    """A user loses: a pane, frosted on one side, that blurs what is behind it as much as it should.
    The truth is path-traced."""
    scene = slab_before_a_sun(roughness)
    paths = verglas.PathSettings()
    paths.width = paths.height = SIZE
    paths.mode = "TWO_INTERFACE"
    tracer = verglas.PathTracer(scene, paths)
    tracer.render(64)
    truth = kappa_of(tracer.frame().combined)
    found = {}
    for transport in ("BUNDLE", "PAPER", "SINGLE"):
        settings = verglas.Settings()
        settings.width = settings.height = SIZE
        settings.samples, settings.tir, settings.reflection, settings.transport = 1, "NONE", False, transport
        found[transport] = kappa_of(renderer.render(scene, settings).combined)
    print(f"slab, rough front {roughness}, smooth back: kappa {truth:.1f},",
          ", ".join(f"{name.lower()} {kappa:.1f}" for name, kappa in found.items()))
    assert found["BUNDLE"] / truth == pytest.approx(1.0, abs=0.1)
