# SPDX-License-Identifier: GPL-3.0-or-later
"""The transports with sharp refraction that others are compared with: SPECULAR and DEPTH_MIP."""

import numpy as np
import pytest
import verglas_core as verglas
from conftest import camera, scene_of, settings_of, sphere

IOR = 1.5


def sphere_of(roughness, segments=64):
    material = verglas.Material("Glass")
    material.roughness, material.ior = roughness, IOR
    return scene_of(("Sphere", sphere(segments=segments), np.eye(4)), material=material)


def box(x, y, z):
    """A cuboid around the origin with edges of these lengths."""
    half = 0.5 * np.array([x, y, z])
    positions, normals = [], []
    for axis in range(3):
        for side in -1, 1:
            normal = np.zeros(3)
            normal[axis] = side
            u, v = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
            corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
            positions += [half * (normal + a * side * u + b * v) for a, b in corners]
            normals += [normal] * 4
    corner = 4 * np.arange(6)[:, None, None]
    triangles = (corner + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3)
    return verglas.Mesh("Box", np.array(positions), np.array(normals), triangles)


def fresnel(cos_i, eta):
    """Reflectance for unpolarised light, from Fresnel's amplitudes."""
    cos_t = np.sqrt(1 - (1 - cos_i ** 2) / eta ** 2)
    s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t)
    p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t)
    return 0.5 * (s ** 2 + p ** 2)


def sharp_sphere(size):
    """(size, size, 3) of a clear unit sphere under the gradient, by Snell's and Fresnel's laws, and where its
    middle is: (size, size) bool. Pixels beside it are NaN."""
    c = camera()
    pixel = (np.arange(size) + 0.5) / size * 2 - 1
    x, z = np.meshgrid(pixel / c.projection[0, 0], pixel / c.projection[1, 1])
    d = np.stack([x, np.ones_like(x), z], -1)
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    eye = np.array([0, -4, 0])
    along = -(d @ eye)
    b = np.sqrt(eye @ eye - along ** 2)  # distance of the ray from the centre
    with np.errstate(invalid="ignore"):
        p = eye + (along - np.sqrt(1 - b ** 2))[..., None] * d
        theta_i = np.arcsin(b)
        # In the plane of incidence the ray is turned twice by theta_i - theta_t, toward the centre.
        turn = 2 * (theta_i - np.arcsin(b / IOR))
        inward = -p + (p * d).sum(-1, keepdims=True) * d
        inward /= np.linalg.norm(inward, axis=-1, keepdims=True)
        out = np.cos(turn)[..., None] * d + np.sin(turn)[..., None] * inward
        energy = (1 - fresnel(np.cos(theta_i), IOR)) ** 2
        return energy[..., None] * (0.5 + 0.5 * out * [1, -1, 1]), b < 0.9


def test_specular_is_snells_law(renderer):
    """A researcher loses: a baseline that is exact where all else is: a clear ball."""
    expected, inside = sharp_sphere(256)
    scene = sphere_of(0.7, segments=512)
    settings = settings_of(width=256, height=256, transport="SPECULAR", reflection=False)
    picture = renderer.render(scene, settings).combined[..., :3]
    difference = np.abs(picture - expected)[inside]
    assert difference.mean() < 0.005 and np.percentile(difference, 99) < 0.03


def test_specular_reflection_is_the_energy_that_is_not_refracted(renderer):
    """A user loses: sharp glass whose front mirrors the world by Fresnel's law."""
    scene = sphere_of(0.7)
    scene.environment_map = None
    scene.environment_color = (1, 1, 1)
    pictures = [renderer.render(scene, settings_of(transport="SPECULAR", reflection=reflection)).combined
                for reflection in (False, True)]
    mirrored = (pictures[1] - pictures[0])[48, 48, 0]
    assert mirrored == pytest.approx(fresnel(1.0, IOR), abs=1e-3)
    assert pictures[0][48, 48, 0] == pytest.approx((1 - mirrored) ** 2, abs=1e-3)


def test_specular_knows_no_roughness(renderer):
    """A researcher loses: the picture without any blur, of every material."""
    settings = settings_of(transport="SPECULAR")
    clear, rough = (renderer.render(sphere_of(roughness), settings).combined for roughness in (0.1, 0.9))
    assert np.array_equal(clear, rough)


@pytest.mark.parametrize("ior", [0.8, 1.5])
def test_all_agree_on_clear_glass(renderer, ior):
    """A researcher loses: methods that differ by roughness alone: without it, all are as the path tracer."""
    material = verglas.Material("Clear")
    material.roughness, material.ior = 0.0, ior
    scene = scene_of(("Sphere", sphere(segments=256), np.eye(4)), material=material)
    paths = verglas.PathSettings()
    paths.width = paths.height = 96
    paths.mode, paths.filter_width = "TWO_INTERFACE", 0.01
    tracer = verglas.PathTracer(scene, paths)
    tracer.render(16)
    truth = tracer.frame()
    for transport in ("BUNDLE", "PAPER", "SINGLE", "DEPTH_MIP", "SPECULAR"):
        frame = renderer.render(scene, settings_of(transport=transport, tir="NONE", reflection=False))
        difference = np.abs(frame.combined - truth.combined)[(frame.depth < 1e9) & (truth.depth < 1e9)]
        print(f"clear sphere, index {ior}, {transport.lower()}: mean difference {difference.mean():.4f}")
        assert difference.mean() < 0.012 and np.percentile(difference, 99) < 0.2, transport


def edge_width(renderer, thickness, roughness, transport):
    """Pixels over which a world that is bright on the right and black on the left fades through a pane."""
    material = verglas.Material("Pane")
    material.roughness = roughness
    scene = scene_of(("Pane", box(2, thickness, 2), np.eye(4)), material=material)
    u = (np.arange(1024) + 0.5) / 1024
    bright = np.cos((0.5 - u) * 2 * np.pi) > 0
    scene.environment_map = verglas.EnvironmentMap("edge", np.tile(bright[None, :, None], (512, 1, 3)))
    settings = settings_of(width=384, height=384, transport=transport, reflection=False)
    row = renderer.render(scene, settings).combined[192, 120:264, 0]
    return ((row > 0.2 * row.max()) & (row < 0.8 * row.max())).sum()


def test_depth_mip_blurs_by_roughness_and_distance(renderer):
    """A researcher loses: the baseline whose blur is the distance's, where the bundle's is the glass's."""
    def width(thickness, roughness, transport="DEPTH_MIP"):
        return edge_width(renderer, thickness, roughness, transport)

    assert width(0.2, 0.35) > width(0.2, 0.2) > width(0.2, 0.0)
    assert width(1.5, 0.2) > 1.2 * width(0.1, 0.2)
    assert abs(width(1.5, 0.2, "SINGLE") - width(0.1, 0.2, "SINGLE")) <= 1
