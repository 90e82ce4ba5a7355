# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that is reflected inside, by the OpenGL device's mode BOUNCE of total internal reflection."""

import numpy as np
import pytest
import verglas_core as verglas
from conftest import cube, cube_faces, flat_faces, scene_of, settings_of

SIZE = 96


def porro_prism():
    """A right-angled prism whose longest side, 2 x 2, faces the camera: two reflections at 45 degrees, beyond
    the critical angle of glass, turn what enters there around."""
    front = [(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)]
    upper = [(-1, 0, 1), (1, 0, 1), (1, 1, 0), (-1, 1, 0)]
    lower = [(1, 0, -1), (-1, 0, -1), (-1, 1, 0), (1, 1, 0)]
    left = [(-1, 0, -1), (-1, 0, 1), (-1, 1, 0), (-1, 1, 0)]
    right = [(1, 0, 1), (1, 0, -1), (1, 1, 0), (1, 1, 0)]
    return flat_faces("Prism", [front, upper, lower, left, right])


def glass_of(roughness=0.3, **attributes):
    material = verglas.Material("Glass")
    material.roughness = roughness
    for name, value in attributes.items():
        setattr(material, name, value)
    return material


def turned():
    """The matrix of a cube that is seen from a corner."""
    turn_z, turn_x = 0.7, 0.6
    about_z = [[np.cos(turn_z), -np.sin(turn_z), 0], [np.sin(turn_z), np.cos(turn_z), 0], [0, 0, 1]]
    about_x = [[1, 0, 0], [0, np.cos(turn_x), -np.sin(turn_x)], [0, np.sin(turn_x), np.cos(turn_x)]]
    matrix = np.eye(4)
    matrix[:3, :3] = 0.7 * np.array(about_x) @ about_z
    return matrix


def turned_cube(material, uvs=None):
    """All of its faces are front or back."""
    return scene_of(("Cube", cube(uvs=uvs), turned()), material=material)


def cube_of(*glasses):
    """The same, of three glasses: one for each two sides that face each other."""
    scene = scene_of()
    mesh = flat_faces("Cube", cube_faces(), slots=np.repeat(np.arange(6) // 2, 2))
    scene.add_object("Cube", mesh, turned(), [scene.add_material(glass) for glass in glasses])
    return scene


def orthographic():
    near, far = 0.1, 100.0
    return verglas.Camera(
        view=[[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, -4], [0, 0, 0, 1]],
        projection=[[0.6, 0, 0, 0], [0, 0.6, 0, 0],
                    [0, 0, 2 / (near - far), (far + near) / (near - far)], [0, 0, 0, 1]])


def render(renderer, scene, tir, **settings):
    return renderer.render(scene, settings_of(width=SIZE, height=SIZE, tir=tir, **settings))


def truth(scene, samples=64):
    settings = verglas.PathSettings()
    settings.width = settings.height = SIZE
    tracer = verglas.PathTracer(scene, settings)
    tracer.render(samples)
    return tracer.frame()


def errors(renderer, scene):
    """Relative MSE of CLAMP and BOUNCE against the path tracer, where pixels show glass."""
    true = truth(scene)
    inside = true.depth < 1e9
    b = true.combined[inside][:, :3]

    def error(tir):
        a = render(renderer, scene, tir, samples=4).combined[inside][:, :3]
        assert np.isfinite(a).all()
        return ((a - b) ** 2 / (b ** 2 + 0.01)).mean()

    return error("CLAMP"), error("BOUNCE")


@pytest.mark.parametrize("camera", ["perspective", "orthographic"])
def test_prism_shows_what_is_behind_the_camera(renderer, camera):
    """A user loses: light's way through facets. All that enters a Porro prism straight leaves it toward where
    it came from: (1 - F)^2 of the picture is the light behind the camera, which is green, and F that of the
    front's reflection; F^2 and less comes after more reflections."""
    scene = scene_of(("Prism", porro_prism(), np.eye(4)), material=glass_of(0.03))
    if camera == "orthographic":
        scene.camera = orthographic()
    above_middle = (slice(52, 57), slice(44, 52), 1)
    F = ((1.5 - 1) / (1.5 + 1)) ** 2
    followed = render(renderer, scene, "BOUNCE").combined[above_middle]
    assert followed == pytest.approx((1 - F) ** 2 + F, abs=0.04)
    assert render(renderer, scene, "CLAMP").combined[above_middle].max() < 0.5


@pytest.mark.parametrize("attributes, camera", [
    ({}, "perspective"), ({"roughness": 0.6}, "orthographic"), ({"ndf": "GGX"}, "orthographic"),
    ({"absorption": (0.1, 0.3, 0.6)}, "perspective"), ({"color": (0.9, 0.7, 0.5)}, "perspective"),
])
def test_cube_against_path_tracer(renderer, attributes, camera):
    """A user loses: facets that look as glass does: half of the error of light that is clamped, at most."""
    scene = turned_cube(glass_of(**attributes))
    if camera == "orthographic":
        scene.camera = orthographic()
    clamped, followed = errors(renderer, scene)
    assert followed <= 0.5 * clamped


def test_textured_roughness_against_path_tracer(renderer):
    """A user loses: roughness that is painted, where light meets it from inside, on backs and fronts."""
    corners = np.tile([(0, 0), (1, 0), (1, 1), (0, 1)], (6, 1))
    checker = np.kron(np.indices((2, 2)).sum(0) % 2, np.ones((8, 8)))
    texture = verglas.Texture("Checker", 0.15 + 0.4 * checker)
    scene = turned_cube(glass_of(roughness_texture=texture), corners)
    clamped, followed = errors(renderer, scene)
    assert followed <= 0.5 * clamped


@pytest.mark.parametrize("glasses", [
    (glass_of(0.1), glass_of(0.3), glass_of(0.6)),
    (glass_of(color=(0.9, 0.5, 0.4)), glass_of(reflection_color=(0.4, 0.9, 0.5)), glass_of()),
    (glass_of(ndf="GGX"), glass_of(), glass_of(0.5, ndf="BLINN_PHONG")),
    (glass_of(), glass_of(fresnel=False), glass_of()),
], ids=["roughness", "color", "distribution", "without reflection"])
def test_several_materials_against_path_tracer(renderer, glasses):
    """A user loses: what leaves through a face by its own material, whichever the light has come from."""
    clamped, followed = errors(renderer, cube_of(*glasses))
    print(f"relative MSE: clamped {clamped:.4f}, followed {followed:.4f}")
    assert followed <= 0.5 * clamped


@pytest.mark.parametrize("roughness", [0.05, 0.3, 0.8])
@pytest.mark.parametrize("ndf", ["BECKMANN", "GGX"])
def test_white_world(renderer, glass_sphere, roughness, ndf):
    """A user loses: glass that makes up no light, and less that is black, under a uniform world."""
    for scene in turned_cube(glass_of(roughness, ndf=ndf)), glass_sphere:
        scene.environment_map = None
        frame = render(renderer, scene, "BOUNCE")
        inside = frame.depth < 1e9
        picture = frame.combined[inside][:, 0]
        assert picture.max() <= 1.001
        lost = render(renderer, scene, "NONE").combined[inside][:, 0]
        assert (picture >= lost - 1e-3).all() and picture.mean() > lost.mean()


@pytest.mark.parametrize("size, y", [(1.0, 4.0), (0.3, 0.0)], ids=["behind", "inside"])
def test_other_objects_leave_bounces_alone(renderer, size, y):
    """A user loses: objects before others, or around them, that look as they do alone: OpenGL sees the first
    object of a pixel."""
    alone = turned_cube(glass_of())
    both = turned_cube(glass_of())
    matrix = np.diag([size, size, size, 1.0])
    matrix[1, 3] = y
    both.add_object("Other", cube(), matrix, [both.add_material(glass_of(0.6, ndf="GGX"))])
    single, pair = render(renderer, alone, "BOUNCE"), render(renderer, both, "BOUNCE")
    front = single.depth < 1e9
    assert np.allclose(pair.combined[front], single.combined[front], atol=1e-5)


@pytest.mark.parametrize("settings", [
    {"intersection": "MARCH"}, {"transport": "PAPER"}, {"transport": "SINGLE"}])
def test_other_ways_clamp(renderer, settings):
    """A user loses: light, as these ways have no layers to follow it in."""
    scene = turned_cube(glass_of())
    assert np.array_equal(render(renderer, scene, "BOUNCE", **settings).combined,
                          render(renderer, scene, "CLAMP", **settings).combined)


def test_open_surface(renderer):
    """A user loses: finite pictures of surfaces without a back, and with holes."""
    for kept in slice(2, 3), slice(0, 4), slice(2, 6):
        part = flat_faces("Part", cube_faces()[kept])
        scene = scene_of(("Part", part, np.diag([0.7, 0.7, 0.7, 1.0])), material=glass_of())
        picture = render(renderer, scene, "BOUNCE").combined
        assert np.isfinite(picture).all() and picture.min() >= 0.0 and picture.max() <= 1.01
