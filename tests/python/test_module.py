# SPDX-License-Identifier: GPL-3.0-or-later
"""The core from Python, outside of Blender."""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import verglas_core as verglas
from conftest import cube, flat_faces, gradient_map, scene_of, settings_of, sphere


def test_sphere_shows_the_world_through_glass(renderer, glass_sphere):
    """A scripter loses: the picture, with the world upside down in it, as a solid sphere shows it."""
    frame = renderer.render(glass_sphere, settings_of(reflection=False))
    picture = frame.combined
    assert picture.shape == (96, 96, 4) and picture.dtype == np.float32
    assert np.isfinite(picture).all() and (picture[..., 3] == 1).all()
    middle = slice(40, 56)
    # blue is up and red is right in the background; through the sphere they are swapped
    assert picture[90, middle, 2].mean() > picture[5, middle, 2].mean()
    assert picture[58, middle, 2].mean() < picture[38, middle, 2].mean()
    assert picture[middle, 90, 0].mean() > picture[middle, 5, 0].mean()
    assert picture[middle, 58, 0].mean() < picture[middle, 38, 0].mean()


def test_white_world_shows_the_energy_of_glass(renderer, glass_sphere):
    """A user loses: glass that neither glows nor swallows light under a uniform world."""
    glass_sphere.environment_map = None
    glass_sphere.environment_color = (2, 2, 2)
    frame = renderer.render(glass_sphere, settings_of())
    inside = frame.depth < 1e9
    assert frame.combined[~inside][:, :3] == pytest.approx(2.0)
    assert frame.combined[inside][:, :3].max() < 2.05
    assert frame.combined[48, 48, 0] > 1.7  # straight through, only a little is reflected inside


def test_depth_and_normal(renderer, glass_sphere):
    """A compositor loses: depth along the camera's axis and normals in world space."""
    frame = renderer.render(glass_sphere, settings_of())
    assert frame.depth[48, 48] == pytest.approx(3.0, abs=0.02)
    assert frame.normal[48, 48] == pytest.approx([0, -1, 0], abs=0.05)
    assert frame.depth[0, 0] == pytest.approx(1e10) and not frame.normal[0, 0].any()


def test_region_is_a_part_of_the_whole(renderer, glass_sphere):
    """A user loses: render borders that show the same pixels as the whole picture."""
    whole = renderer.render(glass_sphere, settings_of(samples=2)).combined
    part = renderer.render(glass_sphere, settings_of(samples=2, region=(20, 30, 40, 25))).combined
    assert part.shape == (25, 40, 4)
    assert np.array_equal(part, whole[30:55, 20:60])


def test_transparent_film(renderer, glass_sphere):
    """A compositor loses: pictures without background, glass opaque in alpha as in Cycles."""
    frame = renderer.render(glass_sphere, settings_of(background_alpha=0.0))
    inside = frame.depth < 1e9
    assert (frame.combined[inside][:, 3] == 1).all() and not frame.combined[~inside].any()


@pytest.mark.parametrize("make", [verglas.Renderer, verglas.TracedRenderer])
def test_background_in_part(make, glass_sphere):
    """A user loses: a studio light that lights the glass but is faint behind it. A lobe takes of what
    is linear in the direction the part that its mean resultant length is."""
    sharp, faint = (make().render(glass_sphere, settings_of(**values)) for values in (
        {}, {"background_alpha": 0.25, "background_spread": 0.4}))
    alpha = faint.combined[..., 3]
    inside, outside = alpha == 1.0, alpha == 0.25
    assert inside.mean() > 0.2 and outside.mean() > 0.2 and alpha.min() == 0.25
    assert np.array_equal(faint.combined[inside], sharp.combined[inside])
    blurred = 0.5 + 0.6 * (sharp.combined[outside][:, :3] - 0.5)
    assert faint.combined[outside][:, :3] == pytest.approx(0.25 * blurred, abs=4e-3)  # levels lie apart


def test_samples_smooth_the_rim(renderer, glass_sphere):
    """A user loses: antialiasing: the rim's alpha takes values between 0 and 1."""
    alpha = renderer.render(glass_sphere, settings_of(samples=8, background_alpha=0.0)).combined[..., 3]
    assert ((alpha > 0.05) & (alpha < 0.95)).sum() > 50


def test_mirrored_object_is_the_mirrored_picture(renderer):
    """A user loses: mirrored instances, whose triangles are turned inside out."""
    squashed = np.diag([0.6, 1.0, 1.0, 1.0])
    squashed[0, 2] = 0.4  # sheared: not its own mirror image
    mirror = np.diag([-1.0, 1, 1, 1])
    material = verglas.Material("Glass")
    pictures = []
    for matrix in squashed, mirror @ squashed:
        scene = scene_of(("Sphere", sphere(), matrix), material=material)
        scene.environment_map = None
        scene.environment_color = (1, 1, 1)
        pictures.append(renderer.render(scene, settings_of()).combined)
    assert np.abs(pictures[0] - pictures[1][:, ::-1]).mean() < 2e-3


def test_objects_behind_each_other_keep_their_own_backs(renderer):
    """A user loses: glass in front of glass that looks as it does alone."""
    ball = sphere()
    alone = scene_of(("Front", ball, np.diag([0.4, 0.4, 0.4, 1.0])))
    behind = np.eye(4)
    behind[1, 3] = 3.0
    both = scene_of(("Behind", ball, behind), ("Front", ball, np.diag([0.4, 0.4, 0.4, 1.0])))
    settings = settings_of()
    single = renderer.render(alone, settings)
    pair = renderer.render(both, settings)
    front = single.depth < 1e9
    assert np.allclose(pair.combined[front], single.combined[front], atol=1e-5)
    assert (pair.depth < 1e9).sum() > front.sum()


@pytest.mark.parametrize("transport", ["BUNDLE", "PAPER", "SINGLE", "DEPTH_MIP"])
@pytest.mark.parametrize("intersection", ["NEWTON", "MARCH"])
def test_every_way_through_the_object(renderer, glass_sphere, transport, intersection):
    """A researcher loses: a baseline to compare with; all see about the same sphere."""
    usual = renderer.render(glass_sphere, settings_of()).combined
    frame = renderer.render(glass_sphere, settings_of(transport=transport, intersection=intersection))
    assert np.isfinite(frame.combined).all()
    assert np.abs(frame.combined - usual).mean() < 0.03


@pytest.mark.parametrize("tir", ["NONE", "INCIDENT", "CLAMP", "BOUNCE"])
def test_total_internal_reflection_modes(renderer, glass_sphere, tir):
    """A user loses: the choice of what becomes of total internal reflection; none is the darkest."""
    dropped = renderer.render(glass_sphere, settings_of(tir="NONE")).combined.mean()
    assert renderer.render(glass_sphere, settings_of(tir=tir)).combined.mean() >= dropped - 1e-6


@pytest.mark.parametrize("roughness", [0.0, 1.0])
@pytest.mark.parametrize("ior", [0.2, 0.75, 1.0, 1.5, 3.5])
@pytest.mark.parametrize("ndf", ["BECKMANN", "GGX", "BLINN_PHONG"])
@pytest.mark.parametrize("tir", ["CLAMP", "BOUNCE"])
def test_extreme_materials_stay_finite(renderer, roughness, ior, ndf, tir):
    """A user loses: sliders that may be drawn to their ends without black or burnt-out pixels."""
    material = verglas.Material("Extreme")
    material.roughness, material.ior, material.ndf = roughness, ior, ndf
    scene = scene_of(("Sphere", sphere(), np.eye(4)), material=material)
    picture = renderer.render(scene, settings_of(tir=tir)).combined
    assert np.isfinite(picture).all() and picture.min() >= 0 and picture.max() <= 1.05


def test_ior_one_is_invisible(renderer):
    """A user loses: IOR 1.0 as no glass at all (but for the masking of rough facets, as in Cycles)."""
    material = verglas.Material("Air")
    material.ior, material.roughness = 1.0, 0.05
    scene = scene_of(("Sphere", sphere(), np.eye(4)), material=material)
    seen = renderer.render(scene, settings_of()).combined
    empty = renderer.render(scene_of(), settings_of()).combined
    differs = np.abs(seen - empty).max(axis=-1) > 0.03
    assert differs.sum() <= 20  # of 3000 pixels: a few at the rim graze the sphere


def test_absorption_follows_beer_and_lambert(renderer, glass_sphere):
    """A user loses: coloured glass that darkens with its thickness; at the centre 2 units long."""
    clear = verglas.Material("Clear")
    clear.roughness = 0.0
    tinted = verglas.Material("Tinted")
    tinted.roughness, tinted.absorption = 0.0, (0.0, 0.5, 1.0)
    ratio = np.ones(3)
    pictures = []
    for material in clear, tinted:
        scene = scene_of(("Sphere", sphere(segments=256), np.eye(4)), material=material)
        pictures.append(renderer.render(scene, settings_of(reflection=False)).combined[48, 48, :3])
    ratio = pictures[1] / pictures[0]
    assert ratio == pytest.approx(np.exp([0.0, -1.0, -2.0]), rel=0.02)


def test_open_surface_bends_light_once(renderer):
    """A user loses: a plane of glass that is seen rather than black."""
    plane = verglas.Mesh("Plane", [[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], [[0, -1, 0]] * 4,
                         [[0, 1, 2], [0, 2, 3]])
    picture = renderer.render(scene_of(("Plane", plane, np.eye(4))), settings_of()).combined
    assert picture[48, 48, [0, 2]].min() > 0.3  # the gradient has no green before the camera


def test_camera_inside_or_object_behind_it(renderer):
    """A user loses: odd camera positions without fault or broken pixels."""
    for offset in 4.0, 8.0:
        matrix = np.eye(4)
        matrix[1, 3] = -offset
        picture = renderer.render(scene_of(("Sphere", sphere(), matrix)), settings_of()).combined
        assert np.isfinite(picture).all()


def test_progress_and_cancel(renderer, glass_sphere):
    """A user loses: a progress bar, and Esc."""
    seen = []

    def note(done, total):
        seen.append((done, total))
        return True

    renderer.render(glass_sphere, settings_of(samples=3), note)
    assert seen == [(1, 3), (2, 3), (3, 3)]
    assert renderer.render(glass_sphere, settings_of(samples=50), lambda done, total: done < 2) is None


def test_exception_in_progress_reaches_the_caller(renderer, glass_sphere):
    """A scripter loses: errors of their own callback."""
    def fail(done, total):
        raise KeyError("mine")
    with pytest.raises(KeyError):
        renderer.render(glass_sphere, settings_of(), fail)
    assert renderer.render(glass_sphere, settings_of()) is not None


def test_renders_are_deterministic(renderer, glass_sphere):
    """A user loses: animations without flicker: the same scene is the same picture, to the bit."""
    first = renderer.render(glass_sphere, settings_of(samples=4)).combined
    assert np.array_equal(first, renderer.render(glass_sphere, settings_of(samples=4)).combined)


@pytest.mark.parametrize("intersection", ["NEWTON", "MARCH"])
def test_earlier_pictures_leave_no_trace(intersection):
    """A user loses: frames that don't depend on what stood elsewhere in the frame before."""
    def at(x):
        matrix = np.diag([0.5, 0.5, 0.5, 1.0])
        matrix[0, 3] = x
        return scene_of(("Sphere", sphere(), matrix))

    settings = settings_of(intersection=intersection)
    used, fresh = verglas.Renderer(), verglas.Renderer()
    used.render(at(-0.6), settings)
    assert np.array_equal(used.render(at(0.6), settings).combined, fresh.render(at(0.6), settings).combined)


def test_errors_name_what_is_wrong(renderer, glass_sphere):
    """A scripter loses: a sentence that says which value is wrong."""
    with pytest.raises(verglas.Error, match="BUNDEL"):
        settings_of(transport="BUNDEL")
    with pytest.raises(verglas.Error, match="region"):
        renderer.render(glass_sphere, settings_of(region=(200, 0, 10, 10)))
    with pytest.raises(verglas.Error, match="Lost"):
        verglas.Scene().add_object("Lost", sphere(), np.eye(4), [0])
    with pytest.raises(verglas.Error, match="Skew"):
        glass_sphere.add_object("Skew", sphere(), np.full((4, 4), np.nan), [0])
    with pytest.raises(verglas.Error, match="pixels|room"):
        renderer.render(glass_sphere, settings_of(width=1000000))
    assert renderer.render(glass_sphere, settings_of()) is not None


def test_smallest_picture(renderer, glass_sphere):
    """A user loses: thumbnails down to one pixel."""
    assert renderer.render(glass_sphere, settings_of(width=1, height=1)).combined.shape == (1, 1, 4)


def test_environment_is_reused_and_exchanged(renderer, glass_sphere):
    """A user loses: a new world in the next frame."""
    first = renderer.render(glass_sphere, settings_of()).combined
    glass_sphere.environment_map = verglas.EnvironmentMap("black", np.zeros((4, 8, 3), np.float32))
    assert not renderer.render(glass_sphere, settings_of()).combined[..., :3].any()
    glass_sphere.environment_map = gradient_map()
    assert np.array_equal(first, renderer.render(glass_sphere, settings_of()).combined)


START = """
import time
begin = time.perf_counter()
import numpy as np
import verglas_core as verglas
from conftest import camera, scene_of, settings_of, sphere
scene = scene_of(("Sphere", sphere(segments=256), np.eye(4)))
pixels = np.random.default_rng(1).random((512, 1024, 3), np.float32)
scene.environment_map = verglas.EnvironmentMap("1k", pixels)
verglas.Renderer().render(scene, settings_of(width=512, height=512))
print(time.perf_counter() - begin)
"""


def test_start_to_first_pixel(renderer, glass_sphere, capsys):
    """A user loses: a first picture soon after the start; the time is printed, not judged."""
    renderer.render(glass_sphere, settings_of())  # fills the caches of tables and of the driver's shaders
    folder = str(Path(__file__).parent)
    result = run_elsewhere(START, PYTHONPATH=os.pathsep.join([folder, os.environ.get("PYTHONPATH", "")]))
    with capsys.disabled():
        print(f" start to first picture, 1k map, cached tables: {float(result.stdout):.2f} s ", end="")
    assert float(result.stdout) > 0.0


def run_elsewhere(code, **environment):
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                          env={**os.environ, **environment})


def test_machine_without_egl_gets_one_sentence(tmp_path):
    """A user loses: a clear sentence where no OpenGL is to be had."""
    empty = tmp_path / "egl_vendor.d"
    empty.mkdir()
    code = "import verglas_core; verglas_core.Renderer()"
    result = run_elsewhere(code, __EGL_VENDOR_LIBRARY_DIRS=str(empty))
    assert result.returncode == 1
    assert "Verglas found no OpenGL 4.5 through EGL" in result.stderr.splitlines()[-1]


def test_device_can_be_chosen():
    """A user loses: the choice of the GPU, and a sentence where the number is none."""
    code = "import verglas_core; print(verglas_core.Renderer().device)"
    assert run_elsewhere(code, VERGLAS_EGL_DEVICE="0").stdout.strip()
    assert "VERGLAS_EGL_DEVICE is '99'" in run_elsewhere(code, VERGLAS_EGL_DEVICE="99").stderr


def test_module_exports_nothing_but_its_entry():
    """A user loses: Blender, which would crash on symbols that clash with its own libraries."""
    nm = subprocess.run(["nm", "-D", "--defined-only", verglas.__file__], capture_output=True, text=True)
    names = [line.split()[-1] for line in nm.stdout.splitlines()]
    assert names == ["PyInit_verglas_core"]


def test_threads_take_turns(renderer, glass_sphere):
    """A user loses: F12 while the viewport draws, both through one renderer."""
    expected = renderer.render(glass_sphere, settings_of(samples=4)).combined
    with ThreadPoolExecutor(3) as pool:
        frames = pool.map(lambda _: renderer.render(glass_sphere, settings_of(samples=4)).combined, range(6))
        assert all(np.array_equal(frame, expected) for frame in frames)


def trace(scene, samples=64, **attributes):
    settings = verglas.PathSettings()
    settings.width = settings.height = 96
    for name, value in attributes.items():
        setattr(settings, name, value)
    tracer = verglas.PathTracer(scene, settings)
    assert tracer.render(samples) and tracer.samples == samples
    return tracer.frame()


def test_path_tracer_agrees_with_the_bundle(renderer, glass_sphere):
    """A researcher loses: a ground truth of the very scene that the renderer draws."""
    truth = trace(glass_sphere, mode="TWO_INTERFACE")
    frame = renderer.render(glass_sphere, settings_of(samples=4, tir="NONE", reflection=False))
    inside = (truth.depth < 1e9) & (frame.depth < 1e9)
    assert np.abs(truth.depth - frame.depth)[inside].max() < 0.05
    a, b = frame.combined[inside][:, :3], truth.combined[inside][:, :3]
    assert ((a - b) ** 2 / (b ** 2 + 0.01)).mean() < 0.01
    assert a.mean() == pytest.approx(b.mean(), rel=0.02)


def test_path_tracer_follows_total_reflection():
    """A researcher loses: the truth for the ways of treating total reflection. Glass of index 1.5 lets
    nothing out beside the face where it came in; followed, all of the white world's light arrives."""
    glass = verglas.Material("Glass")
    glass.roughness, glass.fresnel = 0.05, False
    turned = np.eye(4)
    turned[:2, :2] = [[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]]
    scene = scene_of(("Cube", cube(), 0.6 * turned + 0.4 * np.diag([0, 0, 0, 1])), material=glass)
    scene.environment_map, scene.environment_color = None, (1, 1, 1)
    lost, kept = (trace(scene, 16, mode="TWO_INTERFACE", tir=tir) for tir in (False, True))
    inside = lost.depth < 1e9
    for shift, axis in ((2, 0), (-2, 0), (2, 1), (-2, 1)):
        inside &= np.roll(inside, shift, axis)
    assert kept.combined[inside][:, 0] == pytest.approx(1.0, abs=0.02)
    assert kept.combined[inside][:, 0].mean() == pytest.approx(1.0, abs=0.001)
    dark = lost.combined[inside][:, 0] < 0.01
    assert 0.1 < dark.mean() < 0.9


@pytest.mark.parametrize("interpolation, expected", [
    ("LINEAR", [0.25, 0.0, 0.5]), ("CLOSEST", [0.0, 0.0, 1.0])])
def test_texture_between_its_texels(interpolation, expected):
    """A pixelated mask would be smeared, or a smooth one have steps."""
    texture = verglas.Texture("Steps", [[0.0, 1.0]], "EXTEND", interpolation)
    assert texture.sample([(0.375, 0.5), (-3.0, 0.5), (0.5, 0.5)]) == pytest.approx(expected)


@pytest.mark.parametrize("extension, expected", [("REPEAT", 0.75), ("EXTEND", 0.25), ("CLIP", 0.0)])
def test_closest_texel_beyond_the_borders(extension, expected):
    """Texture coordinates far outside would crash, or find another extension."""
    texture = verglas.Texture("Steps", [[0.25, 0.75]], extension, "CLOSEST")
    near, far = texture.sample([(-2.25, 0.5), (-1e30, 0.5)])
    assert near == pytest.approx(expected)
    assert far in {0.25, 0.75} if extension == "REPEAT" else far == pytest.approx(expected)


def test_path_tracer_reads_roughness_from_a_texture():
    """A researcher loses: the truth of glass whose roughness varies, and the right way up."""
    def picture(texture):
        material.roughness_texture = texture
        scene = scene_of(*objects, material=material)
        return trace(scene, 16, mode="TWO_INTERFACE").combined

    corners = [[(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)]]
    pane = flat_faces("Pane", corners, [(0, 0), (1, 0), (1, 1), (0, 1)])
    objects, material = [("Pane", pane, np.eye(4))], verglas.Material("Glass")
    values = np.full((8, 8), 0.2)
    values[4:, :4] = 1.0  # upper left
    mixed = picture(verglas.Texture("Quarter", values, "EXTEND"))
    sharp = picture(verglas.Texture("Sharp", np.full((1, 1), 0.2)))
    rough = picture(verglas.Texture("Rough", np.full((1, 1), 1.0)))
    upper_left, lower_left, right = np.s_[60:70, 25:38], np.s_[25:38, 25:38], np.s_[25:70, 60:70]
    assert mixed[upper_left] == pytest.approx(rough[upper_left], abs=1e-3)
    assert mixed[lower_left] == pytest.approx(sharp[lower_left], abs=1e-3)
    assert mixed[right] == pytest.approx(sharp[right], abs=1e-3)
    assert np.abs(rough[lower_left] - sharp[lower_left]).max() > 0.02


def test_rays_meet_what_was_added():
    """A tool that asks what lies where loses: the distance, the side, and which object and material it is."""
    scene = verglas.Scene()
    materials = [scene.add_material(verglas.Material(name)) for name in ("Front", "Back")]
    empty = verglas.Mesh("Empty", np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3)))
    scene.add_object("Empty", empty, np.eye(4), materials)
    for material, y in zip(materials, (0.0, 5.0)):
        matrix = np.eye(4)
        matrix[1, 3] = y
        scene.add_object("Cube", cube(), matrix, [material])
    hits = verglas.RayScene(scene).intersect([[0, -9, 0], [0, 0, 0], [0, 2, 0], [0, 2, 0]],
                                             [[0, 1, 0], [0, 3, 0], [0, 1, 0], [1, 0, 0]])
    assert hits["t"] == pytest.approx([8, 1, 2, np.inf])
    assert hits["geometric_normal"] == pytest.approx(np.array([[0, -1, 0], [0, 1, 0], [0, -1, 0], [0, 0, 0]]))
    assert hits["normal"] == pytest.approx(hits["geometric_normal"])
    assert hits["material"].tolist() == [0, 0, 1, -1] and hits["object"].tolist() == [1, 1, 2, -1]
    assert [material.name for material in scene.materials] == ["Front", "Back"]
    assert scene.triangle_count == 24
    with pytest.raises(verglas.Error, match="as many origins as directions"):
        verglas.RayScene(scene).intersect([[0, 0, 0]], [[0, 1, 0], [0, 1, 0]])


def test_times_of_what_is_new():
    """A user loses: knowing what a frame waits for; unchanged meshes, tables and maps cost nothing again."""
    def scene(map_, ior=1.5):
        material = verglas.Material("Glass")
        material.ior = ior
        result = scene_of(("Ball", ball, np.eye(4)), material=material)
        result.environment_map = map_
        return result

    def new(picture):
        seconds = own.render(picture, settings_of()).prepare_seconds
        assert set(seconds) == {"meshes", "textures", "tables", "environment"}
        assert min(seconds.values()) >= 0.0
        return {name for name, value in seconds.items() if value > 0.0}

    own, ball, first_map = verglas.Renderer(), sphere(), gradient_map()
    assert new(scene(first_map)) == {"meshes", "tables", "environment"}
    assert new(scene(first_map)) == set()
    assert new(scene(first_map, ior=1.3)) == {"tables"}
    assert new(scene(gradient_map(), ior=1.3)) == {"environment"}
    ball = sphere(segments=32)
    assert new(scene(first_map, ior=1.3)) == {"meshes", "environment"}


def test_times_of_passes(renderer, glass_sphere):
    """A developer loses: where a frame's time goes."""
    frame = renderer.render(glass_sphere, settings_of(samples=2))
    passes = {"back_faces", "inner_layers", "front_faces", "refraction", "background", "data", "readback"}
    assert set(frame.pass_seconds) == passes and min(frame.pass_seconds.values()) > 0.0
    assert frame.pass_seconds["readback"] < frame.seconds


def test_scenes_are_compared_by_what_they_hold():
    """The viewport would begin anew when something is selected, or keep its picture when a slider moves."""
    def scene(roughness: float, mesh: verglas.Mesh) -> verglas.Scene:
        material = verglas.Material("Glass")
        material.roughness = roughness
        result = verglas.Scene()
        result.add_object("Object", mesh, np.eye(4), [result.add_material(material)])
        return result

    corners = np.eye(3, dtype=np.float32)
    mesh, other = (verglas.Mesh("Triangle", corners, corners, [[0, 1, 2]]) for _ in range(2))
    assert scene(0.3, mesh) == scene(0.3, mesh)
    assert scene(0.3, mesh) != scene(0.4, mesh)
    assert scene(0.3, mesh) != scene(0.3, other)
    assert scene(0.3, mesh) is not None and scene(0.3, mesh) != None  # noqa: E711
