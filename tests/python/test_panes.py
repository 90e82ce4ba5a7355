# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin panes on both devices, against path tracing of a thin box with two rough sides."""

import functools
import itertools
from pathlib import Path

import numpy as np
import pytest
import verglas_core as verglas
from conftest import flat_faces, gradient_map, sphere

FOREST = Path("/usr/share/blender/datafiles/studiolights/world/forest.exr")
SIZE = 16
ROUGHNESSES = (0.1, 0.3, 0.6)
CORNERS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
THICKNESS = 5e-4


@pytest.fixture(scope="module")
def forest():
    if not FOREST.exists():
        pytest.skip("Blender's studio maps are not where Debian puts them")
    return verglas.EnvironmentMap.load(str(FOREST))


@pytest.fixture(scope="module", params=[verglas.Renderer, verglas.TracedRenderer])
def device(request):
    return request.param()


def glass_of(roughness, **attributes):
    material = verglas.Material("Glass")
    material.roughness = roughness
    for name, value in attributes.items():
        setattr(material, name, value)
    return material


def pane_of(roughness, inner_roughness, **attributes):
    material = glass_of(roughness, kind='PANE', **attributes)
    material.layer.roughness = inner_roughness
    return material


def square(half, z=0.0, down=False):
    corners = np.concatenate([half * CORNERS, np.full((4, 1), z)], 1)
    return corners[::-1] if down else corners


def thin_box(half):
    """Slot 0 is the side that looks up, 1 the other; those around are too far away to be seen."""
    low, high = square(half, -THICKNESS / 2), square(half, THICKNESS / 2)
    around = [[low[i], low[(i + 1) % 4], high[(i + 1) % 4], high[i]] for i in range(4)]
    slots = np.array([0, 0, 1, 1] + [0] * 8)
    return flat_faces("Box", [high, low[::-1], *around], slots=slots)


def camera_at(degrees, azimuth=0.7, focal=4):
    """Four units from the origin, by so much off the Z axis; azimuth in radians. The field of view is 28
    degrees, or 2 atan(1 / focal)."""
    theta, phi = np.radians(degrees), azimuth
    matrix = np.eye(4)
    matrix[:3, 2] = [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]
    matrix[:3, 0] = [-np.sin(phi), np.cos(phi), 0]
    matrix[:3, 1] = np.cross(matrix[:3, 2], matrix[:3, 0])
    matrix[:3, 3] = 4 * matrix[:3, 2]
    near, far = 0.1, 100.0
    return verglas.Camera(
        view=np.linalg.inv(matrix),
        projection=[[focal, 0, 0, 0], [0, focal, 0, 0],
                    [0, 0, (far + near) / (near - far), 2 * far * near / (near - far)], [0, 0, -1, 0]])


def scene_of(mesh, materials, degrees, light):
    """light: a map, whose horizon lies behind the pane, or a radiance."""
    scene = verglas.Scene()
    scene.camera = camera_at(degrees)
    scene.environment_color = (1, 1, 1)
    if isinstance(light, verglas.EnvironmentMap):
        scene.environment_map = light
    scene.environment_rotation = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    scene.add_object(mesh.name, mesh, np.eye(4), [scene.add_material(material) for material in materials])
    return scene


def pane_scene(material, degrees, light, corners=None):
    mesh = flat_faces("Pane", [square(200) if corners is None else corners])
    return scene_of(mesh, [material], degrees, light)


def render(device, scene, samples=16):
    settings = verglas.Settings()
    settings.width = settings.height = SIZE
    settings.samples = samples
    return device.render(scene, settings).combined[..., :3]


@pytest.fixture(scope="module")
def truths(forest):
    """Two independent pictures of a box, by path tracing; made once for both devices."""
    known = {}

    def make(roughness, inner_roughness, degrees):
        key = roughness, inner_roughness, degrees
        if key not in known:
            materials = [glass_of(roughness), glass_of(inner_roughness)]
            known[key] = path_traced_twice(scene_of(thin_box(200), materials, degrees, forest),
                                           512 if (roughness, inner_roughness) in QUICK_PAIRS else 4096)
        return known[key]
    return make


def path_traced_twice(scene, samples):
    """Two independent pictures."""
    pictures = []
    for seed in range(2):
        settings = verglas.PathSettings()
        settings.width = settings.height = SIZE
        settings.seed = seed
        tracer = verglas.PathTracer(scene, settings)
        tracer.render(samples)
        pictures.append(tracer.frame().combined[..., :3])
    return pictures


def relative_mse(picture, truths):
    """Net of the truths' noise, as that of one is independent of the other's."""
    first, second = truths
    return np.mean((picture - first) * (picture - second)) / np.mean(first * second)


# Pairs whose truth has less noise than the rest within half a second
QUICK_PAIRS = {(0.1, 0.1), (0.3, 0.1), (0.3, 0.3)}
PAIRS = [pytest.param(*pair, marks=() if pair in QUICK_PAIRS else pytest.mark.slow)
         for pair in itertools.product(ROUGHNESSES, ROUGHNESSES)]


@pytest.mark.parametrize("degrees, bar", [(0, 0.01), (60, 0.03)])
@pytest.mark.parametrize("roughness, inner_roughness", PAIRS)
def test_is_what_two_rough_sides_make(device, truths, forest, roughness, inner_roughness, degrees, bar):
    """A window with a frosted side would be too sharp, too bright or too dark."""
    picture = render(device, pane_scene(pane_of(roughness, inner_roughness), degrees, forest), samples=64)
    error = relative_mse(picture, truths(roughness, inner_roughness, degrees))
    print(f"relative MSE {error:.4f}")
    assert error < bar


@pytest.mark.parametrize("roughness", ROUGHNESSES)
@pytest.mark.parametrize("degrees, orthographic", [(0, False), (50, False), (20, True)])
def test_what_is_behind_is_seen_through_it(device, degrees, orthographic, roughness):
    """A window would hide the room behind it, or show it too sharp or at another place."""
    empty, scene = (pane_scene(pane_of(roughness, roughness), degrees, gradient_map()) for _ in range(2))
    paint = verglas.Material("Paint")
    paint.kind, paint.roughness = 'COATED', 0.2
    paint.layer.diffuse, paint.layer.base_color = True, (0.9, 0.2, 0.1)
    matrix = np.diag([0.5, 0.5, 0.5, 1.0])
    matrix[2, 3] = -0.6
    scene.add_object("Ball", sphere(), matrix, [scene.add_material(paint)])
    if orthographic:
        scene.camera = verglas.Camera(view=scene.camera.view, projection=np.diag([0.8, 0.8, -0.02, 1.0]))
        empty.camera = scene.camera
    truths = path_traced_twice(scene, 64)
    error, blank = (relative_mse(render(device, one), truths) for one in (scene, empty))
    print(f"relative MSE {error:.4f}, without the ball {blank:.4f}")
    assert error < 0.004
    assert blank > 5 * error


def test_sides_change_places_from_behind(device, forest):
    """A pane would look the same from both of its sides, or be missing from one."""
    front = render(device, pane_scene(pane_of(0.1, 0.5), 30, forest))
    behind = render(device, pane_scene(pane_of(0.5, 0.1), 30, forest, square(200, down=True)))
    assert front.min() > 0.0
    np.testing.assert_allclose(behind, front, atol=2e-3)
    other = render(device, pane_scene(pane_of(0.5, 0.1), 30, forest))
    assert np.abs(other - front).max() > 0.02


@pytest.mark.parametrize("inner_reflections", [True, False])
@pytest.mark.parametrize("samples", [1, 16])
def test_smooth_sides_have_the_series(device, inner_reflections, samples):
    """Clear window glass would be darker or brighter than the sum of all reflections between its sides."""
    material = pane_of(0.0, 0.0)
    material.layer.inner_reflections = inner_reflections
    material.reflection_color = (0, 0, 0)
    picture = render(device, pane_scene(material, 0, 1.0), samples)
    R = 0.2 ** 2  # Fresnel at straight incidence, 1.5
    expected = (1 - R) ** 2 / (1 - R * R) if inner_reflections else (1 - R) ** 2
    if inner_reflections:
        expected += R * (1 - R) ** 2 / (1 - R * R)  # reflected by the far side
    assert picture.mean() == pytest.approx(expected, rel=3e-3)


def test_tint_is_that_of_two_refractions(device):
    """Tinted panes would be too pale or too dark beside solid glass of the same colour."""
    material = pane_of(0.3, 0.3, color=(0.9, 0.5, 0.1), reflection_color=(0, 0, 0))
    plain = pane_of(0.3, 0.3, reflection_color=(0, 0, 0))
    ratio = render(device, pane_scene(material, 20, 1.0)) / render(device, pane_scene(plain, 20, 1.0))
    np.testing.assert_allclose(ratio, np.broadcast_to([0.81, 0.25, 0.01], ratio.shape), rtol=2e-3)


def capped_map(cos_cap, height=512):
    """White about -Z, black elsewhere; a row's share of the cap is its radiance."""
    edges = np.cos(np.pi * (1 - np.arange(height + 1) / height))  # cosines to +Z, from the bottom
    share = np.clip((-cos_cap - edges[:-1]) / np.diff(edges), 0, 1)
    return verglas.EnvironmentMap("Cap", np.tile(share[:, None, None], (1, 2 * height, 3)))


def straight_view(scene):
    """Through the origin alone."""
    scene.camera = camera_at(0)
    scene.camera.projection = np.diag([400.0, 400, 1, 1]) @ np.linalg.inv(
        np.diag([4.0, 4, 1, 1])) @ scene.camera.projection
    scene.environment_rotation = np.eye(3)
    return scene


@functools.cache
def radiance_of_cap(roughness, cos_cap):
    """What the traced device converges to with the cap as environment."""
    material = pane_of(roughness, roughness, reflection_color=(0, 0, 0))
    scene = straight_view(pane_scene(material, 0, capped_map(cos_cap)))
    return render(verglas.TracedRenderer(), scene, samples=128).mean()


@pytest.mark.parametrize("distance", [1.0, 2.0, 5.0, 20.0])
@pytest.mark.parametrize("roughness", ROUGHNESSES)
def test_sphere_light_is_the_integral_of_its_radiance(device, distance, roughness):
    """Lamps behind frosted glass would glow too bright or too dark."""
    material = pane_of(roughness, roughness, reflection_color=(0, 0, 0))
    truth = radiance_of_cap(roughness, np.sqrt(1 - 1 / distance ** 2))
    scene = straight_view(pane_scene(material, 0, 0.0))
    scene.add_light("Lamp", 'SPHERE', (0, 0, -distance), [np.pi] * 3, radius=1.0)
    scene.environment_color = (0, 0, 0)
    lit = render(device, scene, samples=1).mean()
    print(f"lit / integrated {lit / truth:.4f}")
    assert lit == pytest.approx(truth, rel=0.03)
