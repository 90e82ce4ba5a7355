# SPDX-License-Identifier: GPL-3.0-or-later
"""Coated surfaces on both devices, against recursive sampling of both interfaces by the path tracer."""

import itertools

import numpy as np
import pytest
import verglas_core as verglas
from test_panes import FOREST, camera_at, device, forest, scene_of, square  # noqa: F401
from conftest import flat_faces, gradient_map

KAPPAS = (1.0, 10.0, 1e3, 1e6)
ANGLES = (10, 35, 60, 75)
SIZE = 4


def coating_of(kappa, base_kappa, **attributes):
    """Roughness of both sides by the concentration of their normals, 2 / alpha^2. A white mirror as base."""
    material = verglas.Material("Coating")
    material.kind = 'COATED'
    material.roughness = (2 / kappa) ** 0.25
    material.layer.roughness = (2 / base_kappa) ** 0.25
    material.layer.base_color = (1, 1, 1)
    for name, value in attributes.items():
        setattr(material.layer, name, value)
    return material


def coated_scene(material, degrees, light):
    return scene_of(flat_faces("Plane", [square(50)]), [material], degrees, light)


def rendered(device, scene, samples):  # noqa: F811
    """(3,) in the mean over a few pixels."""
    settings = verglas.Settings()
    settings.width = settings.height = SIZE
    settings.samples = samples
    return device.render(scene, settings).combined[..., :3].mean((0, 1))


def path_traced(scene, paths, layers='RECURSIVE', bounce=None):
    settings = verglas.PathSettings()
    settings.width = settings.height = SIZE
    settings.layers = layers
    settings.bounce = bounce
    tracer = verglas.PathTracer(scene, settings)
    tracer.render(paths)
    return tracer.frame().combined[..., :3].mean((0, 1))


@pytest.mark.parametrize("kappa", KAPPAS)
@pytest.mark.parametrize("base_kappa", KAPPAS)
def test_furnace(device, kappa, base_kappa):  # noqa: F811
    """A lacquer would add light that isn't there, or swallow some."""
    for degrees in ANGLES:
        scene = coated_scene(coating_of(kappa, base_kappa), degrees, 1.0)
        scene.camera = camera_at(degrees, focal=100)
        energy = rendered(device, scene, 1).mean()
        paths = 4096 if kappa == 1.0 or base_kappa == 1.0 else 1024  # fewer get out there
        truth = path_traced(scene, paths).mean()
        print(f"{degrees} degrees: {energy:.3f}, truth {truth:.3f}")
        assert energy < 1.0
        assert energy == pytest.approx(truth, rel=0.05)


@pytest.mark.parametrize("degrees", ANGLES)
def test_diffuse_base(device, degrees):  # noqa: F811
    """Lacquered wood and car paint would be too bright or too dark."""
    scene = coated_scene(coating_of(1e3, 10.0, diffuse=True, base_color=(0.8, 0.4, 0.1)), degrees, 1.0)
    assert rendered(device, scene, 1) == pytest.approx(path_traced(scene, 512), rel=0.04)


def test_absorption_is_that_of_both_ways(device):  # noqa: F811
    """Tinted lacquer would be too pale or too dark."""
    material = coating_of(1e6, 1e6, thickness=0.5, bounces=1)
    material.absorption = (0.2, 0.5, 1.0)
    material.reflection_color = (0, 0, 0)
    clear = coating_of(1e6, 1e6, bounces=1)
    clear.reflection_color = (0, 0, 0)
    ratio = (rendered(device, coated_scene(material, 0, 1.0), 1)
             / rendered(device, coated_scene(clear, 0, 1.0), 1))
    assert ratio == pytest.approx(np.exp([-0.2, -0.5, -1.0]), rel=0.01)


@pytest.mark.parametrize("degrees", ANGLES)
def test_without_bounces_the_outer_side_alone_reflects(device, degrees):  # noqa: F811
    """A glossy surface, with which coatings are compared, would be another one, or cost as much as they."""
    alone = coated_scene(coating_of(1e3, 10.0, bounces=0), degrees, 1.0)
    over_black = coated_scene(coating_of(1e3, 10.0, diffuse=True, base_color=(0, 0, 0)), degrees, 1.0)
    assert rendered(device, alone, 1) == pytest.approx(rendered(device, over_black, 1), rel=1e-3)
    for layers in 'RECURSIVE', 'ENDF', 'WEIDLICH_WILKIE':
        truth = path_traced(over_black, 512)
        assert path_traced(alone, 512, layers) == pytest.approx(truth, rel=0.02), layers


@pytest.mark.parametrize("kind, radius", [('SPHERE', 0.0), ('SPHERE', 1.0), ('SUN', 0.05)])
@pytest.mark.parametrize("kappa, base_kappa", [(10.0, 10.0), (1e3, 10.0), (10.0, 1e3), (1e3, 1e3)])
def test_lamps_shine_where_they_are_mirrored(device, kappa, base_kappa, kind, radius):  # noqa: F811
    """Highlights on lacquer would be too bright or too dark, or change once further samples come."""
    material = coating_of(kappa, base_kappa)
    material.ndf = 'GGX'  # which says nothing of coatings
    scene = coated_scene(material, 35, 0.0)
    scene.environment_color = (0, 0, 0)
    scene.camera = camera_at(35, focal=100)
    toward = -np.asarray(camera_at(35).view)[2, :3] * [1, 1, -1]
    scene.add_light("Lamp", kind, toward if kind == 'SUN' else 5 * toward, [25] * 3, radius=radius)
    lit = rendered(device, scene, 1)
    assert lit == pytest.approx(path_traced(scene, 4096), rel=0.15)
    assert rendered(device, scene, 16) == pytest.approx(lit, rel=0.01)


@pytest.mark.parametrize("layers", ['RECURSIVE', 'ENDF', 'WEIDLICH_WILKIE'])
@pytest.mark.parametrize("fresnel", [True, False])
@pytest.mark.parametrize("kappa, base_kappa", [(1e3, 10.0), (10.0, 1e3)])
def test_light_is_the_sum_of_its_bounces(kappa, base_kappa, fresnel, layers):
    """What a researcher sees of one bounce would not be that part of the whole, or have another weight."""
    for degrees in ANGLES:
        material = coating_of(kappa, base_kappa, bounces=3)
        material.fresnel = fresnel
        scene = coated_scene(material, degrees, gradient_map())
        scene.camera = camera_at(degrees, focal=100)
        parts = [path_traced(scene, 512, layers, bounce) for bounce in range(5)]
        assert (parts[4] == 0).all()  # the coating has three
        assert (parts[0] > 0).all() == fresnel
        assert (parts[1] > 0).all()
        assert np.sum(parts, axis=0) == pytest.approx(path_traced(scene, 1024, layers), rel=0.02)


def relative_errors(picture, truth):
    """Of a few pixels, in the mean of the colours."""
    return np.abs(picture - truth).mean() / truth.mean()


QUICK_KAPPAS = {(1.0, 10.0), (10.0, 10.0), (1e3, 1e3)}


@pytest.mark.parametrize("kappa, base_kappa", [
    pytest.param(*pair, marks=() if pair in QUICK_KAPPAS else pytest.mark.slow)
    for pair in itertools.product(KAPPAS, KAPPAS)])
def test_is_as_recursive_sampling_has_it(device, forest, kappa, base_kappa):  # noqa: F811
    """Lacquer would be too bright or too dark, or lit from the wrong side; or no better than by the simplest
    of layered models. In the mean of twelve directions, each seen through a narrow field."""
    errors = []
    for degrees, azimuth in itertools.product(ANGLES, (0.7, 2.8, 4.9)):
        scene = coated_scene(coating_of(kappa, base_kappa), degrees, forest)
        scene.camera = camera_at(degrees, azimuth, focal=100)
        truth = path_traced(scene, 4096 if (kappa, base_kappa) in QUICK_KAPPAS else 8192)
        others = rendered(device, scene, 16), path_traced(scene, 256, 'WEIDLICH_WILKIE')
        errors.append([relative_errors(other, truth) for other in others])
    ours, baseline = np.mean(errors, axis=0)
    print(f"kappa {kappa:g}, {base_kappa:g}: {ours:.3f}, Weidlich and Wilkie {baseline:.3f}")
    assert ours < 0.05
    assert ours < baseline


def test_textures_of_both_roughnesses(device, forest):  # noqa: F811
    """Fingerprints and worn varnish would show at the wrong strength: tables are interpolated between
    roughnesses there."""
    for value in (0.3, 0.5, 0.7):
        material, uniform = coating_of(10.0, 10.0), coating_of(10.0, 10.0)
        uniform.roughness, uniform.layer.roughness = value, 1.1 - value
        texels = np.array([[0.1, value, 1.0]], np.float32)
        material.roughness_texture = verglas.Texture("outer", texels, interpolation='CLOSEST')
        material.layer.roughness_texture = verglas.Texture("inner", 1.1 - texels, interpolation='CLOSEST')
        pictures = []
        for one in (material, uniform):
            scene = scene_of(flat_faces("Plane", [square(50)], uvs=np.full((4, 2), 0.5)), [one], 35, forest)
            scene.camera = camera_at(35, focal=100)
            pictures.append(rendered(device, scene, 1))
        assert pictures[0] == pytest.approx(pictures[1], rel=0.05)  # of the points of both tables
