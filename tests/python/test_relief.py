# SPDX-License-Identifier: GPL-3.0-or-later
"""Normal maps and bump maps: on the OpenGL device, the CPU device and in the path tracer."""

import numpy as np
import pytest
import verglas_core as verglas
from conftest import scene_of, settings_of, sphere

DEVICES = ["OPENGL", "CPU"]


def renderer_of(device, renderer):
    return renderer if device == "OPENGL" else verglas.TracedRenderer()


def slab(**coordinates):
    """From -1 to 1 in X and Z, a front to the camera at Y = -0.2 and a back at Y = 0.2, without sides: rays
    near the middle see no more of it. u along X, v along Z; the tangents are those of the front."""
    x, z = np.array([-1, 1, 1, -1.0]), np.array([-1, -1, 1, 1.0])
    front, back = (np.stack([x, np.full(4, y), z], axis=-1) for y in (-0.2, 0.2))
    normals = np.repeat([[0, -1, 0], [0, 1, 0]], 4, axis=0)
    triangles = [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]]
    positions = np.concatenate([front, back])
    return verglas.Mesh("Slab", positions, normals, triangles, [0, 0, 1, 1], **coordinates)


def coordinates():
    uvs = np.tile([[0, 0], [1, 0], [1, 1], [0, 1]], (2, 1))
    return {"normal_uvs": uvs, "height_uvs": uvs, "tangents": np.tile([1.0, 0, 0, 1], (8, 1))}


def glass(roughness=0.1, **attributes):
    material = verglas.Material("Glass")
    material.roughness, material.fresnel = roughness, False
    for name, value in attributes.items():
        setattr(material, name, value)
    return material


def normal_glass(colors, strength=1.0, space="TANGENT", **attributes):
    material = glass(**attributes)
    material.normal_map.texture = verglas.VectorTexture("Normals", np.asarray(colors, np.float32))
    material.normal_map.strength, material.normal_map.space = strength, space
    return material


def bumped_glass(heights, distance=1.0, strength=1.0, extension="EXTEND", **attributes):
    material = glass(**attributes)
    material.bump_map.height = verglas.Texture("Heights", np.asarray(heights, np.float32), extension)
    material.bump_map.strength, material.bump_map.distance = strength, distance
    return material


def slab_scene(front, back=None):
    """A slab whose front has relief and whose back is plain."""
    scene = scene_of()
    slots = [scene.add_material(front), scene.add_material(back or glass())]
    scene.add_object("Slab", slab(**coordinates()), np.eye(4), slots)
    return scene


def refracted(d, n, eta):
    """By Snell's law. n: against d."""
    cosine = -d @ n
    return d / eta + (cosine / eta - np.sqrt(1 - (1 - cosine ** 2) / eta ** 2)) * n


def gradient_radiance(d):
    return 0.5 + 0.5 * d * [1, -1, 1]


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("kind", ["normal map", "bump map", "object space", "world space"])
def test_tilted_front_bends_light_by_snells_law(renderer, device, kind):
    """A user loses: relief that looks as deep as it is, and on the side where it was painted."""
    tilt = np.array([0.3, -1.0, 0.2]) / np.linalg.norm([0.3, -1.0, 0.2])
    in_tangent_space = tilt @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]).T
    if kind == "bump map":
        line = (np.arange(256) + 0.5) / 256
        material = bumped_glass(-0.3 * 2 * line[None] - 0.2 * 2 * line[:, None], roughness=0.03)
    elif kind == "normal map":
        material = normal_glass([[0.5 + 0.5 * in_tangent_space]], roughness=0.03)
    else:
        material = normal_glass([[0.5 + 0.5 * tilt]], space=kind.split()[0].upper(), roughness=0.03)
    picture = renderer_of(device, renderer).render(slab_scene(material, glass(0.03)), settings_of())
    d = np.array([0, 1.0, 0])
    inside = refracted(d, tilt, 1.5)
    expected = gradient_radiance(refracted(inside, np.array([0, -1.0, 0]), 1 / 1.5))
    assert picture.combined[46:50, 46:50, :3].mean((0, 1)) == pytest.approx(expected, abs=0.004)
    assert picture.normal[48, 48] == pytest.approx(tilt, abs=1e-3)


@pytest.mark.parametrize("device", DEVICES)
def test_flat_relief_changes_nothing(renderer, device):
    """A user loses: that an unpainted map is smooth glass."""
    with_map = normal_glass([[[0.5, 0.5, 1.0]]])
    with_map.bump_map.height = verglas.Texture("Heights", np.full((4, 4), 0.7))
    flat, plain = (renderer_of(device, renderer).render(slab_scene(front), settings_of()).combined
                   for front in (with_map, glass()))
    assert flat == pytest.approx(plain, abs=1e-4)


def bumpy_sphere(kind):
    """Bumps of a few degrees that fade toward the poles."""
    u, v = np.meshgrid((np.arange(512) + 0.5) / 512, (np.arange(256) + 0.5) / 256)
    heights = 0.02 * np.sin(2 * np.pi * 8 * u) * np.sin(np.pi * v) ** 2 * np.sin(2 * np.pi * 6 * v)
    if kind == "bump map":
        return bumped_glass(heights, extension="REPEAT", roughness=0.25)
    # Of the same heights, along u and v on the unit sphere
    along_u = (np.roll(heights, -1, 1) - np.roll(heights, 1, 1)) * 256 / (2 * np.pi * np.sin(np.pi * v))
    along_v = np.gradient(heights, axis=0) * 256 / np.pi
    normals = np.stack([-along_u, -along_v, np.ones_like(along_u)], -1)
    return normal_glass(0.5 + 0.5 * normals / np.linalg.norm(normals, axis=-1, keepdims=True), roughness=0.25)


def sphere_scene(material, stretch=1.2):
    uvs = np.stack(np.meshgrid(np.linspace(0, 1, 65), np.linspace(1, 0, 33)), -1).reshape(-1, 2)
    azimuth = 2 * np.pi * uvs[:, 0]
    tangents = np.stack([-np.sin(azimuth), np.cos(azimuth), 0 * azimuth, 1 + 0 * azimuth], -1)
    mesh = sphere(normal_uvs=uvs, height_uvs=uvs, tangents=tangents)
    return scene_of(("Sphere", mesh, np.diag([1, 1, stretch, 1])), material=material)


@pytest.mark.parametrize("kind", ["normal map", "bump map"])
def test_devices_see_the_same_bumps(renderer, kind):
    """A user loses: the viewport's relief in the final frame, where another device renders that."""
    scene = sphere_scene(bumpy_sphere(kind))
    by_opengl, by_cpu = (renderer_of(device, renderer).render(scene, settings_of()) for device in DEVICES)
    plain = renderer.render(sphere_scene(glass(0.25)), settings_of())
    assert np.abs(by_opengl.normal - by_cpu.normal).max() < 0.01
    assert np.abs(by_opengl.normal - plain.normal).max() > 0.1


def test_bump_map_bends_as_the_normal_map_of_the_same_heights(renderer):
    """A user loses: the freedom to use either, in world units."""
    normals = [renderer.render(sphere_scene(bumpy_sphere(kind), stretch=1.0), settings_of()).normal
               for kind in ("normal map", "bump map")]
    assert np.abs(normals[0] - normals[1]).mean() < 0.01


def test_traced_bumps_converge_to_the_path_tracer(renderer):
    """A user loses: glass with relief as bright and as clear as it should be."""
    scene = sphere_scene(bumpy_sphere("bump map"))
    picture = verglas.TracedRenderer().render(scene, settings_of(samples=32, paths="TWO_INTERFACE"))
    settings = verglas.PathSettings()
    settings.width = settings.height = 96
    settings.mode = "TWO_INTERFACE"
    tracer = verglas.PathTracer(scene, settings)
    tracer.render(128)
    truth = tracer.frame().combined
    print("brightness", picture.combined[..., :3].mean() / truth[..., :3].mean(),
          "RMS", np.sqrt(((picture.combined - truth) ** 2).mean()))
    assert picture.combined[..., :3].mean() == pytest.approx(truth[..., :3].mean(), rel=0.005)
    assert np.sqrt(((picture.combined - truth) ** 2).mean()) < 0.01


def test_wrong_shapes_are_told():
    """A user loses: a message in place of a crash."""
    with pytest.raises(verglas.Error, match="8 vertices but 3 tangents"):
        slab(tangents=np.zeros((3, 4)))
    with pytest.raises(verglas.Error, match="H, W, 3"):
        verglas.VectorTexture("Normals", np.zeros((4, 4)))
