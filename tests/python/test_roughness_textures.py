# SPDX-License-Identifier: GPL-3.0-or-later
"""Roughness from textures on the OpenGL device, against the path tracer with the same textures."""

import numpy as np
import pytest
import verglas_core as verglas
from conftest import flat_faces, scene_of, settings_of, sphere


def pane(uvs=((0, 0), (1, 0), (1, 1), (0, 1))):
    """A quad of 2 x 2 that faces the camera, without a back."""
    return flat_faces("Pane", [[(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)]], uvs)


def stripes():
    """A world of soft stripes, a few degrees wide, which fade the more, the rougher the glass before them."""
    v, u = np.meshgrid((np.arange(256) + 0.5) / 256, (np.arange(512) + 0.5) / 512, indexing="ij")
    waves = [0.5 + 0.5 * np.cos(2 * np.pi * (12 * u + shift)) * np.cos(2 * np.pi * 6 * v)
             for shift in (0, 0.25, 0.5)]
    return verglas.EnvironmentMap("stripes", np.stack(waves, -1))


def glass_of(texture, *objects):
    material = verglas.Material("Glass")
    material.roughness_texture = texture
    scene = scene_of(*objects, material=material)
    scene.environment_map = stripes()
    return scene


def picture(renderer, mesh, texture, **settings):
    scene = glass_of(texture, ("Object", mesh, np.eye(4)))
    return renderer.render(scene, settings_of(reflection=False, **settings)).combined[..., :3]


def truth(mesh, texture, samples=64, **attributes):
    settings = verglas.PathSettings()
    settings.width = settings.height = 96
    settings.mode = "TWO_INTERFACE"
    for name, value in attributes.items():
        setattr(settings, name, value)
    tracer = verglas.PathTracer(glass_of(texture, ("Object", mesh, np.eye(4))), settings)
    tracer.render(samples)
    return tracer.frame().combined[..., :3]


@pytest.mark.parametrize("extension", ["REPEAT", "EXTEND", "CLIP"])
def test_front_reads_its_texture_as_the_path_tracer(renderer, extension):
    """A user loses: painted roughness on the front, the right way up, and what lies beyond its borders."""
    values = np.array([[0.1, 0.9, 0.3], [0.6, 0.2, 1.0]])
    mesh = pane([(-0.6, -0.5), (1.7, -0.5), (1.7, 1.4), (-0.6, 1.4)])
    texture = verglas.Texture("Six", values, extension)
    seen, expected = picture(renderer, mesh, texture), truth(mesh, texture)
    flat = picture(renderer, mesh, verglas.Texture("Mean", [[values.mean()]]))
    inside = np.s_[22:74, 22:74]
    error, of_flat = (np.abs(shown - expected)[inside].mean() for shown in (seen, flat))
    print(f"{extension}: mean difference {error:.4f}; of the mean roughness {of_flat:.4f}")
    assert error < 0.2 * of_flat


def test_textures_finer_than_pixels_are_averaged(renderer):
    """A user loses: fine textures far away that neither flicker nor show patterns that aren't there."""
    values = 0.2 + 0.6 * (np.indices((512, 512)).sum(0) % 2)
    fine = picture(renderer, pane([(0, 0), (3, 0), (3, 3), (0, 3)]), verglas.Texture("Checker", values))
    mean = picture(renderer, pane(), verglas.Texture("Mean", [[0.5]]))
    assert fine[24:72, 24:72] == pytest.approx(mean[24:72, 24:72], abs=1e-3)


def test_patches_of_an_atlas_stay_apart(renderer):
    """A user loses: baked roughness without a mesh's edges drawn into it: of what lies beside a face in the
    atlas, not on the surface."""
    side, texels = 32, 4  # faces along the pane's sides, and a face's texels in the atlas
    x, z = np.meshgrid(np.arange(side), np.arange(side))
    faces = np.stack([x, z], -1).reshape(-1, 1, 2)
    corners = np.zeros((side * side, 4, 3))
    corners[:, :, [0, 2]] = 2 * (faces + [(0, 0), (1, 0), (1, 1), (0, 1)]) / side - 1
    place = np.random.default_rng(3).permutation(side * side)
    cells = np.stack([place % side, place // side], -1)[:, None]
    inner = (np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) * (texels - 1) + 0.5) / texels
    values = np.empty(side * side)
    values[place] = np.where(faces[:, 0, 0] < side / 2, 0.2, 0.7)  # left, right
    values = np.kron(values.reshape(side, side), np.ones((texels, texels)))
    texture = verglas.Texture("Atlas", values, "EXTEND", is_atlas=True)
    shown = picture(renderer, flat_faces("Pane", corners, (cells + inner).reshape(-1, 2) / side), texture)
    for half, roughness in ((np.s_[24:72, 24:46], 0.2), (np.s_[24:72, 50:72], 0.7)):
        flat = picture(renderer, pane(), verglas.Texture("Flat", [[roughness]]))
        assert shown[half] == pytest.approx(flat[half], abs=1e-3)


def test_objects_have_textures_of_their_own(renderer):
    """A user loses: several painted materials in a scene, beside plain ones, on the slots of one mesh."""
    corners = [[(x, 0, -1), (x + 0.7, 0, -1), (x + 0.7, 0, 1), (x, 0, 1)] for x in (-1.05, -0.35, 0.35)]
    mesh = flat_faces("Panes", corners, 3 * [(0, 0), (1, 0), (1, 1), (0, 1)], [0, 0, 1, 1, 2, 2])
    roughnesses = 0.2, 0.5, 0.8

    def drawn(textured):
        scene = scene_of()
        slots = []
        for roughness, with_texture in zip(roughnesses, textured):
            material = verglas.Material("Glass")
            material.roughness = 0.0 if with_texture else roughness
            if with_texture:
                material.roughness_texture = verglas.Texture("Flat", np.full((3, 5), roughness))
            slots.append(scene.add_material(material))
        scene.add_object("Panes", mesh, np.eye(4), slots)
        return renderer.render(scene, settings_of()).combined

    plain = drawn((False, False, False))
    assert drawn((True, False, True)) == pytest.approx(plain, abs=1e-3)
    assert drawn((True, True, True)) == pytest.approx(plain, abs=1e-3)


def test_painting_uploads_no_mesh(renderer):
    """A user loses: strokes on a texture that show at once, however many triangles carry it."""
    ball = sphere()
    material = verglas.Material("Glass")

    def frame(values):
        if values is not None:
            material.roughness_texture = verglas.Texture("Painted", values)
        scene = scene_of(("Ball", ball, np.eye(4)), material=material)
        scene.environment_map, scene.environment_color = None, (1, 1, 1)
        return renderer.render(scene, settings_of(reflection=False))

    smooth = frame(np.full((4, 4), 0.1))
    rough = frame(np.full((4, 4), 0.9))
    assert rough.prepare_seconds["textures"] > 0 and rough.prepare_seconds["meshes"] == 0
    assert np.abs(rough.combined - smooth.combined).max() > 0.05
    again = frame(None)
    assert again.prepare_seconds["textures"] == 0 and np.array_equal(again.combined, rough.combined)


def relative_mse(seen, expected, inside):
    return (((seen - expected) ** 2) / (expected ** 2 + 0.01))[inside].mean()


@pytest.mark.parametrize("transport", ["BUNDLE", "SINGLE"])
def test_coverage_shows_the_pattern_of_the_back(renderer, transport):
    """A user loses: what is painted on the far side of the glass, seen through it instead of blurred away."""
    v, u = np.indices((128, 256)) / [[[128]], [[256]]]
    spots = (u < 0.5) & (np.sin(2 * np.pi * 8 * u) * np.sin(2 * np.pi * 4 * v) > 0)  # u < 0.5: the back
    mesh, texture = sphere(segments=128), verglas.Texture("Spots", np.where(spots, 0.75, 0.35))
    expected = truth(mesh, texture)
    inside = np.hypot(*(np.indices((96, 96)) - 47.5)) < 27
    error = {}
    for back in ("SIMPLE", "COVERAGE"):
        shown = picture(renderer, mesh, texture, samples=4, tir="NONE", transport=transport,
                        back_roughness=back)
        error[back] = relative_mse(shown, expected, inside)
    print(f"{transport}, relative MSE: simple {error['SIMPLE']:.5f}, coverage {error['COVERAGE']:.5f}")
    assert error["COVERAGE"] < 0.5 * error["SIMPLE"]


def test_first_traced_sample_has_no_streaks(renderer):
    """A user loses: the CPU's first picture of painted roughness, which shows each of its edges once for
    every ray of the bundle."""
    v, u = np.indices((128, 256)) / [[[128]], [[256]]]
    spots = np.sin(2 * np.pi * 8 * u) * np.sin(2 * np.pi * 4 * v) > 0
    mesh, texture = sphere(segments=128), verglas.Texture("Spots", np.where(spots, 0.75, 0.35))
    expected = truth(mesh, texture, samples=128, tir=False)
    inside = np.hypot(*(np.indices((96, 96)) - 47.5)) < 27
    coverage, traced = (
        relative_mse(picture(device, mesh, texture, tir="NONE", paths="TWO_INTERFACE"), expected, inside)
        for device in (renderer, verglas.TracedRenderer()))
    print(f"relative MSE: coverage {coverage:.5f}, traced {traced:.5f}")
    assert traced < 0.5 * coverage


def slab(thickness=0.3):
    """Two squares of 2 x 2 that face each other, u from left to right on both."""
    y = 0.5 * thickness
    corners = [[(-1, -y, -1), (1, -y, -1), (1, -y, 1), (-1, -y, 1)],
               [(1, y, -1), (-1, y, -1), (-1, y, 1), (1, y, 1)]]
    uvs = [(0, 0), (1, 0), (1, 1), (0, 1), (1, 0), (0, 0), (0, 1), (1, 1)]
    return flat_faces("Slab", corners, uvs)


def test_footprint_across_two_materials(renderer):
    """A user loses: a plain material beside a painted one on the far side, without a seam where rays of a
    pixel leave through both."""
    y, corners = 0.3, [[(-1, -0.3, -1), (1, -0.3, -1), (1, -0.3, 1), (-1, -0.3, 1)]]
    corners += [[(x + 1, y, -1), (x, y, -1), (x, y, 1), (x + 1, y, 1)] for x in (-1, 0)]
    mesh = flat_faces("Slab", corners, 3 * [(0, 0), (1, 0), (1, 1), (0, 1)], [0, 0, 1, 1, 2, 2])

    def scene_with(textured):
        scene = scene_of()
        scene.environment_map = stripes()
        slots = []
        for roughness, with_texture in zip((0.4, 0.3, 0.6), textured):
            material = verglas.Material("Glass")
            material.roughness = roughness
            if with_texture:
                material.roughness_texture = verglas.Texture("Flat", np.full((4, 4), roughness))
            slots.append(scene.add_material(material))
        if any(textured):  # two classes for all: of a texture that no object has
            material.roughness_texture = verglas.Texture("Two", [[0.1, 0.9]])
            scene.add_material(material)
        scene.add_object("Slab", mesh, np.eye(4), slots)
        return scene
    settings = settings_of(reflection=False, tir="NONE", samples=4)
    plain = renderer.render(scene_with((False, False, False)), settings).combined
    mixed = renderer.render(scene_with((False, True, False)), settings).combined
    difference = np.abs(mixed - plain)[32:64, 32:64]
    print(f"beside the seam: mean difference {difference.mean():.4f}, most {difference.max():.4f}")
    assert difference.max() < 0.03


def test_gradients_stay_smooth(renderer):
    """A user loses: soft transitions: classes of roughness that show as bands."""
    mesh, ramp = slab(), verglas.Texture("Ramp", [np.linspace(0.05, 0.9, 256)], "EXTEND")
    region = 28, 40, 40, 16
    expected = truth(mesh, ramp, samples=1024, region=region).mean(0)
    seen = picture(renderer, mesh, ramp, samples=4, tir="NONE", region=region).mean(0)
    bends = [np.abs(np.diff(columns_of, 2, axis=0)).max() for columns_of in (seen, expected)]
    print(f"greatest second difference of columns: coverage {bends[0]:.4f}, truth {bends[1]:.4f}")
    assert bends[0] < 2 * bends[1]


def test_classes_are_counted(renderer):
    """A user loses: a plain word where the number of classes makes no sense; and more classes that are no
    worse."""
    texture = verglas.Texture("Ramp", [np.linspace(0.05, 0.9, 256)])
    for wrong in (1, 9):
        with pytest.raises(verglas.Error, match="2 to 8 classes"):
            picture(renderer, pane(), texture, roughness_classes=wrong)
    four, eight = (picture(renderer, slab(), texture, roughness_classes=count) for count in (4, 8))
    assert 0 < np.abs(four - eight).mean() < 0.05


def test_constant_texture_is_the_constant(renderer):
    """A user loses: a texture of one value that looks as the slider at that value."""
    ball = sphere()
    material = verglas.Material("Glass")
    material.roughness = 0.4
    plain = scene_of(("Ball", ball, np.eye(4)), material=material)
    material.roughness_texture = verglas.Texture("Flat", np.full((2, 2), 0.4))
    textured = scene_of(("Ball", ball, np.eye(4)), material=material)
    for transport in ("BUNDLE", "PAPER", "SINGLE", "DEPTH_MIP"):
        pictures = [renderer.render(scene, settings_of(transport=transport)).combined
                    for scene in (plain, textured)]
        assert pictures[0] == pytest.approx(pictures[1], abs=1e-3), transport
