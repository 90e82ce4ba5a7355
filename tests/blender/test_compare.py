# SPDX-License-Identifier: GPL-3.0-or-later
"""Scripted comparisons: what they measure, what they write, and what they say when something is missing."""

import importlib.util
import json
import math
import re
import subprocess
import sys
from io import StringIO
from pathlib import Path

import bpy
import numpy as np
import pytest
import verglas
from scenes import (
    add, add_monkey, add_node, add_sphere, frosted, new_group, new_material, node_of, render, sample_map,
    set_map,
)
from verglas import operators, renderer
from verglas.compare import cases, images, methods, metrics, notes, overview, runner, truth
from verglas.compare.comparison import Options, compare
from verglas.compare.measured import Measured
from verglas.compare.progress import Progress
from verglas.faults import Fault

COMPARE = Path(verglas.__file__).parent / "cli" / "compare.py"

SUNLIT_SLAB = str(Path(__file__).parents[2] / "blend_files" / "sunlit_slab.blend")

SMALL = methods.Conditions(48, 36, samples=2)


@pytest.fixture
def glass(scene) -> bpy.types.Scene:
    """A frosted sphere in the sample map, 48 x 36 pixels, two samples."""
    set_map(scene)
    add_sphere(frosted(0.4))
    scene.render.resolution_x, scene.render.resolution_y = SMALL.width, SMALL.height
    scene.verglas.samples = SMALL.samples
    return scene


@pytest.fixture
def file(glass, tmp_path) -> str:
    """That scene on disk, open in Blender."""
    path = str(tmp_path / "glass.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    return path


def silent() -> Progress:
    return Progress()


# Metrics

A = np.float32([[[1.0, 2.0, 3.0], [0.0, 0.0, 0.0]]])
B = np.float32([[[1.0, 1.0, 1.0], [9.0, 9.0, 9.0]]])
LEFT = np.array([[True, False]])


def test_metrics_by_hand():
    """Every number of a report would be wrong. The right pixel is outside of the object."""
    assert metrics.relmse(A, B, LEFT) == pytest.approx((0 + 1 + 4) / 3 / 1.01)
    assert metrics.rmse(A, B, LEFT) == pytest.approx(math.sqrt(5 / 3))
    assert metrics.bias(A, B, LEFT) == pytest.approx(1.0)
    assert metrics.psnr(0.0 * B, B, LEFT) == pytest.approx(0.0, abs=1e-5)
    grey = np.full((1, 2, 3), 0.5, np.float32)
    assert metrics.psnr(grey, 0.0 * grey, LEFT) == pytest.approx(-20 * math.log10(0.735357), abs=1e-4)


def test_equal_pictures():
    """A perfect method would get a bad mark, or end the comparison."""
    picture = np.random.default_rng(1).random((16, 16, 3), np.float32)
    found = metrics.measure(picture, picture, np.ones((16, 16), bool))
    assert (found["relmse"], found["rmse"], found["bias"], found["psnr"]) == (0.0, 0.0, 0.0, None)
    assert found["ssim"] == pytest.approx(1.0)


def test_ssim_sees_structure():
    """Blurred glass would be as good as sharp glass, by the only metric that looks at structure."""
    random = np.random.default_rng(2)
    picture = random.random((32, 32, 3))
    blurred = 0.5 * (picture + np.roll(picture, 1, axis=0))
    shifted = picture + math.sqrt(np.mean((blurred - picture) ** 2)) * 0.3
    mask = np.ones((32, 32), bool)
    assert metrics.ssim(blurred, picture, mask) < 0.9 * metrics.ssim(shifted, picture, mask)


def test_noise_and_net_error():
    """A truth's noise would be misjudged, and stay part of what is called the net error."""
    random = np.random.default_rng(3)
    clean = np.full((100, 100, 3), 1.0)
    mask = np.ones((100, 100), bool)
    halves = tuple(clean + random.normal(0.0, 0.03, clean.shape) for _ in range(2))
    method = clean + 0.05
    variance = 0.03 ** 2 / 1.01  # of a half; the whole has half of it, the difference of two wholes all of it
    assert metrics.noise(halves, mask) == pytest.approx(variance, rel=0.05)
    assert metrics.relmse_net(method, halves, mask) == pytest.approx(0.05 ** 2 / 1.01, rel=0.05)
    error = metrics.relmse(method, 0.5 * (halves[0] + halves[1]), mask)
    assert error == pytest.approx((0.05 ** 2 + 0.5 * 0.03 ** 2) / 1.01, rel=0.05)


# Methods

def test_export_is_that_of_a_final_frame(glass):
    """A comparison would show another scene than F12: modifiers and visibility of the viewport."""
    sphere = bpy.context.object
    modifier = sphere.modifiers.new("Subdivision", 'SUBSURF')
    modifier.levels, modifier.render_levels = 0, 1
    hidden = add(sphere.data, "Not Rendered", location=(0, 0, 1))
    hidden.hide_render = True
    before = {name: getattr(glass.render, name) for name in ("engine", "resolution_x", "use_compositing")}
    subject = methods.Subject(glass, SMALL, pytest.fail)
    assert subject.triangles == 2 * (4 * 32 * 14 + 3 * 32 * 2)  # each corner of a face becomes a quad
    assert 400 < subject.mask.sum() < 600
    assert before == {name: getattr(glass.render, name) for name in before}


def test_whole_picture(glass):
    """A border, a percentage or a second view layer would leave pictures that don't fit each other."""
    glass.render.use_border = glass.render.use_crop_to_border = True
    glass.render.border_max_x = 0.5
    glass.render.resolution_percentage = 50
    glass.view_layers.new("Second").use = True
    with_border = methods.Subject(glass, SMALL, pytest.fail)
    cycles = with_border.cycles(2).pixels
    assert with_border.mask.shape == cycles.shape[:2] == (36, 48)
    assert np.array_equal(with_border.mask, with_border.mask[:, ::-1])
    assert cycles[:, 40:].mean() > 0.1
    assert (glass.render.use_border, glass.view_layers["Second"].use) == (True, True)


def test_nothing_to_compare(scene):
    """A file without camera or glass would end in a traceback."""
    with pytest.raises(Fault, match="shows no glass"):
        methods.Subject(scene, SMALL, print)
    scene.camera = None
    with pytest.raises(Fault, match="'Scene' has no camera"):
        methods.Subject(scene, SMALL, print)


def test_conditions(glass):
    """Light that the truth leaves out would count as an error of the real-time methods."""
    material = bpy.context.object.material_slots[0].material
    material.node_tree.nodes.remove(node_of(material.node_tree, "ShaderNodeBsdfRefraction"))
    shader = add_node(material.node_tree, "ShaderNodeBsdfGlass", distribution='BECKMANN', Roughness=0.3)
    output = node_of(material.node_tree, "ShaderNodeOutputMaterial")
    material.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])
    full = methods.Subject(glass, SMALL, print)
    two = methods.Subject(glass, methods.Conditions(48, 36, 2, 'two_interface'), print)
    assert full.real_time("bundle", 1).pixels[full.mask].mean() > 1.02 * (
        two.real_time("bundle", 1).pixels[two.mask].mean())
    assert full.reference(8).pixels[full.mask].mean() > 1.02 * two.reference(8).pixels[two.mask].mean()


def test_real_time_picture_is_that_of_a_final_frame(glass):
    """The comparison would judge other pictures than users get."""
    picture = methods.Subject(glass, SMALL, pytest.fail).real_time("bundle", 1)
    assert np.allclose(picture.pixels, render(glass).rgb, atol=1e-5)
    assert picture.samples == 2 and picture.seconds > 0.0 and picture.pass_seconds["refraction"] > 0.0


def test_modes_of_total_internal_reflection(glass):
    """The modes would show one and the same picture, or the file's mode and transport."""
    subject = methods.Subject(glass, SMALL, pytest.fail)
    shown = [subject.real_time("bundle", 1, tir=tir).pixels for tir in methods.TIR_MODES.values()]
    glass.verglas.transport, glass.verglas.tir = 'SINGLE', 'INCIDENT'
    for method, expected in zip(methods.TIR_MODES, shown):
        assert np.array_equal(subject.real_time(method, 1).pixels, expected)
    assert not any(np.array_equal(a, b) for a, b in zip(shown, shown[1:]))


def test_analytic_lobes(glass):
    """The method would show the tables' picture, or that of the file's way through the glass."""
    subject = methods.Subject(glass, SMALL, pytest.fail)
    expected = subject.real_time("bundle", 1, lobes='ANALYTIC').pixels
    assert not np.array_equal(subject.real_time("bundle", 1).pixels, expected)
    glass.verglas.transport = 'SINGLE'
    assert np.array_equal(subject.real_time("analytic", 1).pixels, expected)
    glass.verglas.lobes = 'ANALYTIC'
    assert np.array_equal(subject.real_time("bundle", 1).pixels, expected)


def test_cycles_shows_the_same(glass):
    """Cycles as truth or method would show another picture: turned, of another size or filter, or clamped;
    and the user's settings would be gone afterwards."""
    glass.cycles.samples, glass.cycles.sample_clamp_indirect = 7, 1.0
    subject = methods.Subject(glass, SMALL, pytest.fail)
    reference = subject.reference(64).pixels
    cycles = subject.cycles(64)
    assert cycles.samples == 64
    assert metrics.relmse(cycles.pixels, reference, subject.mask) < 0.02
    background = ~subject.mask
    assert metrics.relmse(cycles.pixels, reference, background) < 0.01
    assert (glass.cycles.samples, glass.cycles.sample_clamp_indirect) == (7, 1.0)
    assert glass.render.engine == 'VERGLAS'


def test_eevee_without_a_display(glass, monkeypatch):
    """The comparison would crash on a server where EEVEE can't run."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PATH", "")
    with pytest.raises(Fault, match="EEVEE needs a display"):
        methods.Subject(glass, SMALL, print).eevee()


@pytest.mark.slow
def test_eevee(glass):
    """EEVEE would be compared by a picture that isn't of this scene, where another one is open."""
    bpy.context.window.scene = bpy.data.scenes.new("Open")
    subject = methods.Subject(glass, SMALL, pytest.fail)
    picture = subject.eevee()
    reference = subject.reference(64).pixels
    assert metrics.relmse(picture.pixels, reference, ~subject.mask) < 0.05
    assert picture.seconds > 0.0 and picture.samples > 1


def test_traced_has_the_conditions(glass, monkeypatch):
    """The CPU device would be judged by light that the truth leaves out, or not be the one that renders."""
    chosen = []

    def note(device, _, settings, progress=None):
        chosen.append((device, settings.transport, settings.max_interfaces, settings.paths, settings.samples))
        return render_by(device, _, settings, progress)

    render_by = renderer.render
    monkeypatch.setattr(renderer, "render", note)
    glass.verglas.max_interfaces, glass.verglas.transport = 5, 'PAPER'
    methods.Subject(glass, SMALL, print).real_time("traced", 1)
    two = methods.Subject(glass, methods.Conditions(48, 36, 2, 'two_interface'), print)
    two.real_time("traced", 1, samples=4)
    two.real_time("single", 1)
    assert chosen == [('CPU', 'PAPER', 5, 'FULL', 2), ('CPU', 'PAPER', 5, 'TWO_INTERFACE', 4),
                      ('OPENGL', 'SINGLE', 5, 'TWO_INTERFACE', 2)]


def test_without_denoiser(glass):
    """A Cycles without its denoiser, as Debian's, would end the comparison, or pass its noisy picture off."""
    if methods._has_denoiser():
        pytest.skip("this Cycles has one")
    done = compare(glass, Options(methods=("single", "cycles_denoised"), spp=2, method_spp=1), silent())
    assert list(done.methods) == ["single"]
    assert any("cycles_denoised isn't in this report: this Blender's Cycles is built without" in note
               for note in done.notes)


# Truth

def test_truth_becomes_better(glass):
    """The truth's noise would be unknown, or not fall with its samples."""
    subject = methods.Subject(glass, SMALL, pytest.fail)
    found = truth.Truth("reference", subject)
    noises = []
    for samples in (4, 12, 48):
        found.add(samples)
        noises.append(found.noise)
    assert found.samples == 64 and noises[2] < 0.4 * noises[1] < 0.4 * 0.8 * noises[0]
    other = subject.reference(512, seed=77).pixels
    assert metrics.relmse(found.pixels, other, subject.mask) < 2.0 * found.noise


def test_truth_is_the_same_again(glass):
    """The command in a report would give other numbers."""
    def pixels():
        found = truth.Truth("reference", methods.Subject(glass, SMALL, print))
        found.add(4)
        return found.pixels

    assert np.array_equal(pixels(), pixels())


def test_truth_by_cycles(glass):
    """Cycles as truth would repeat its noise with every addition, or pretend to two_interface paths."""
    found = truth.Truth("cycles", methods.Subject(glass, SMALL, print))
    found.add(2)
    first = found.noise
    found.add(14)
    assert found.samples == 16 and found.noise < 0.5 * first
    two = methods.Subject(glass, methods.Conditions(48, 36, 2, 'two_interface'), print)
    with pytest.raises(Fault, match="Cycles can't be the truth of two_interface"):
        truth.Truth("cycles", two)


def test_automatic_samples(glass):
    """A truth would stop while its noise hides the differences between methods, or never stop."""
    done = compare(glass, Options(methods=("bundle", "single")), silent())
    errors = [measured.metrics["relmse"] for measured in done.methods.values()]
    assert done.truth.noise < 0.1 * min(errors)
    assert not any("noisy" in note for note in done.notes)
    noisy = compare(glass, Options(methods=("bundle",), spp=1), silent())
    assert noisy.truth.samples == 2
    assert any("truth is noisy: with 2 samples" in note for note in noisy.notes)


# Cases

def test_combinations_have_names_of_their_own():
    """One case's report would overwrite another's."""
    found = cases.combinations(["a/x.blend", "b/x.blend"], [0.1, 0.25], ["maps/m.hdr"])
    assert [case.name for case in found] == ["x_r0.1_m", "x_r0.25_m", "x_r0.1_m_2", "x_r0.25_m_2"]
    assert [case.name for case in cases.combinations(["x.blend"])] == ["x"]


def test_roughness_of_all_glass(scene, tmp_path):
    """Cases would be labelled with a roughness that isn't rendered: textures, groups, sharp glass."""
    textured = new_material("Textured", distribution='GGX')
    noise = add_node(textured.node_tree, "ShaderNodeTexNoise")
    glass = node_of(textured.node_tree, "ShaderNodeBsdfGlass")
    textured.node_tree.links.new(noise.outputs["Fac"], glass.inputs["Roughness"])
    group = new_group("ShaderNodeTree", {}, {"BSDF": "NodeSocketShader"})
    grouped = add_node(group, "ShaderNodeBsdfRefraction", Roughness=0.9)
    opaque = node_of(new_material("Opaque", "ShaderNodeBsdfPrincipled", Roughness=0.7).node_tree,
                     "ShaderNodeBsdfPrincipled")
    cases.set_roughness("x.blend", 0.25)
    assert not glass.inputs["Roughness"].is_linked
    assert glass.inputs["Roughness"].default_value == grouped.inputs["Roughness"].default_value == 0.25
    assert opaque.inputs["Roughness"].default_value == pytest.approx(0.7)


def test_roughness_without_glass(scene):
    """A whole series would be rendered in which nothing changes."""
    with pytest.raises(Fault, match="'x.blend' has no glass node"):
        cases.set_roughness("x.blend", 0.25)


def test_map_of_the_world(scene):
    """A case would be rendered under another map than it says."""
    texture = set_map(scene)
    texture.image = None
    cases.set_map(scene, sample_map())
    assert texture.image.filepath == sample_map()
    scene.world = None
    cases.set_map(scene, sample_map())
    assert node_of(scene.world.node_tree, "ShaderNodeTexEnvironment").image.filepath == sample_map()


def test_map_that_cannot_be_read(scene, tmp_path):
    """A case would be rendered in magenta."""
    (tmp_path / "text.hdr").write_text("no picture")
    for path in ("missing.exr", str(tmp_path / "text.hdr")):
        with pytest.raises(Fault, match=re.escape(path)):
            cases.set_map(scene, path)


def test_file_that_cannot_be_opened(tmp_path):
    """A wrong path would end in a traceback."""
    text = tmp_path / "text.blend"
    text.write_text("no blend")
    for path in ("missing.blend", str(text)):
        with pytest.raises(Fault, match=re.escape(path)):
            cases.open_case(cases.Case(path))


# Reports

def command(case: cases.Case | None, folder: Path) -> str:
    return f"make {case.name if case else 'all'} in {folder}"


def run(case_list, folder, **options) -> bool:
    options = Options(**{"methods": ("bundle", "single"), "spp": 8, **options})
    return runner.run(case_list, options, folder, command, silent())


def references(page: Path) -> set[str]:
    """Paths in a page's links, pictures and lists of pictures."""
    found = re.findall(r'(?:src|href|value)="([^"]*\.[a-z]+)"', page.read_text(encoding="utf-8"))
    return set(found)


def test_report(file, tmp_path):
    """What scripts read from report.json, and what the page shows, would be missing."""
    before = Path(file).read_bytes()
    folder = tmp_path / "out"
    assert run([cases.Case(file, name="glass")], folder,
               methods=("bundle", "reference", "cycles", "nonsense"), method_spp=4)
    report = json.loads((folder / "report.json").read_text())
    assert (report["scene"], report["size"], report["triangles"]) == ("glass", [48, 36], 960)
    assert 400 < report["object_pixels"] < 600
    assert (report["truth"]["method"], report["truth"]["spp"]) == ("reference", 8)
    assert report["truth"]["seconds"] > 0.0 and report["truth"]["noise"] > 0.0
    assert list(report["methods"]) == ["bundle", "reference", "cycles"]
    for entry in report["methods"].values():
        assert {"seconds", "relmse", "rmse", "psnr", "ssim", "flip", "bias", "relmse_net"} <= set(entry)
        assert entry["seconds"] > 0.0 and 0.0 < entry["relmse"] < 10.0
    assert report["methods"]["reference"]["noise"] > 0.0
    assert [point["samples"] for point in report["methods"]["reference"]["convergence"]] == [1, 2, 4]
    assert report["command"] == f"make glass in {folder}"
    assert any("There is no method 'nonsense'" in note for note in report["notes"])
    assert Path(file).read_bytes() == before

    linked = references(folder / "index.html")
    assert {"truth.png", "bundle.exr", "bundle_difference.png", "cycles_error.png", "scan_line.svg",
            "error_over_cost.svg"} <= linked
    assert all((folder / path).is_file() for path in linked)
    assert "http" not in re.sub(r"http://www.w3.org\S*", "", (folder / "index.html").read_text())


@pytest.mark.parametrize("roughness", (0.35, 0.5))
def test_blur_of_a_flat_slab(tmp_path, roughness):
    """A user loses: a slab, frosted on one side, that blurs what is behind it as much as it should, and a
    researcher the numbers that tell how far the paper's method, which drops the front's blur here, is off."""
    scene = cases.open_case(cases.Case(SUNLIT_SLAB))
    front = scene.objects["Sunlit Slab"].data.materials[0]
    node_of(front.node_tree, 'ShaderNodeBsdfGlass').inputs["Roughness"].default_value = roughness
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "slab.blend"))
    assert run([cases.Case(str(tmp_path / "slab.blend"), name="slab")], tmp_path, methods=("bundle", "paper"),
               paths='two_interface', spp=32, samples=1, size=(96, 96))
    report = json.loads((tmp_path / "report.json").read_text())
    truth = report["truth"]["kappa"]
    bundle, paper = (report["methods"][method]["kappa"] for method in ("bundle", "paper"))
    print(f"slab, rough front {roughness}, smooth back: kappa {truth:.1f}, bundle {bundle:.1f}, "
          f"paper {paper:.1f}")
    # Beckmann's slopes have the variance alpha^2 / 2 each way; where all angles are small, a facet that is
    # tilted by t turns light by (1 - 1 / eta) t, and the back makes (eta - 1) t of that.
    assert truth == pytest.approx(2.0 / (roughness ** 2 * 0.5) ** 2, rel=0.1)
    assert bundle == pytest.approx(truth, rel=0.1)
    assert f"<td class=\"\">{paper:.4g}</td>" in (tmp_path / "index.html").read_text()


def test_blur_is_only_told_of_a_point_sun(glass):
    """Under a sky the number would mean nothing."""
    assert not compare(glass, Options(("bundle",), spp=2), silent()).kappas


def test_report_of_traced(file, tmp_path):
    """How the CPU device's picture comes closer to the truth would be missing, or measured at other samples
    than users set."""
    assert run([cases.Case(file, name="glass")], tmp_path, methods=("traced", "cycles"), method_spp=4,
               paths='two_interface', tir=True)
    report = json.loads((tmp_path / "report.json").read_text())
    entry = report["methods"]["traced"]
    way = entry["convergence"]
    assert [point["samples"] for point in way] == [1, 2, 4] and "noise" not in entry
    assert entry["samples"] == SMALL.samples and entry["relmse"] == way[1]["relmse"]
    assert all(point["seconds"] > 0.0 for point in way)
    told = [note for note in report["notes"] if "traced takes" in note]
    assert len(told) == 1 and "with one sample; cycles is" in told[0]
    assert any("can't follow totally reflected light" in note for note in report["notes"])


def test_truth_is_good_enough_for_the_first_sample_of_traced(glass):
    """The truth would need endless time, as traced comes as close to it as one likes, or be too noisy for its
    first picture."""
    done = compare(glass, Options(methods=("traced",), method_spp=2), silent())
    assert done.truth.noise < 0.1 * done.methods["traced"].convergence[0]["relmse"]


def test_report_holds_the_pictures_that_were_measured(file, tmp_path):
    """The numbers in a report could not be checked by its pictures."""
    run([cases.Case(file, name="glass")], tmp_path)
    report = json.loads((tmp_path / "report.json").read_text())
    subject = methods.Subject(bpy.context.scene, SMALL, pytest.fail)
    bundle, true = (images.read_exr(tmp_path / f"{name}.exr") for name in ("bundle", "truth"))
    assert np.array_equal(bundle, subject.real_time("bundle", 1).pixels)
    found = metrics.relmse(bundle, true, subject.mask)
    assert found == pytest.approx(report["methods"]["bundle"]["relmse"])


def test_many_cases(file, tmp_path):
    """The table of all cases would be wrong, or one bad case would end all others."""
    folder = tmp_path / "out"
    listed = cases.combinations([file], [0.2, 0.5], [sample_map(), "missing.exr"])
    assert not run(listed, folder)
    summary = json.loads((folder / "summary.json").read_text())
    assert list(summary["cases"]) == ["glass_r0.2_sample", "glass_r0.5_sample"]
    assert set(summary["faults"]) == {"glass_r0.2_missing", "glass_r0.5_missing"}
    ratios = []
    for name, case in summary["cases"].items():
        report = json.loads((folder / name / "report.json").read_text())
        error = {method: report["methods"][method]["relmse"] for method in ("bundle", "single")}
        assert case["relmse"] == error and case["best"] == min(error, key=error.get)
        ratios.append(error["bundle"] / error["single"])
    assert summary["mean_ratio"] == pytest.approx(sum(ratios) / 2)
    assert summary["wins"] == sum(ratio < 1.0 for ratio in ratios) and summary["judged"] == 2
    pages = [folder / "index.html", *folder.glob("*/index.html")]
    assert len(pages) == 3
    for page in pages:
        assert all((page.parent / path).is_file() for path in references(page)), page


def test_without_matplotlib(file, tmp_path, monkeypatch):
    """Without matplotlib there would be no report at all, in place of one without plots."""
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert run([cases.Case(file, name="glass")], tmp_path)
    report = json.loads((tmp_path / "report.json").read_text())
    assert any("need matplotlib" in note for note in report["notes"])
    assert all((tmp_path / path).is_file() for path in references(tmp_path / "index.html"))


def test_old_report_does_not_stay(file, tmp_path):
    """After a run that failed an old report would pass for its result."""
    assert run([cases.Case(file, name="glass")], tmp_path)
    assert not run([cases.Case("missing.blend", name="glass")], tmp_path)
    assert not (tmp_path / "report.json").exists() and not (tmp_path / "index.html").exists()


def test_progress_is_readable_in_a_log():
    """Long work would look dead in a log, or fill it."""
    stream = StringIO()
    progress = Progress(stream)
    progress.subject("1/2 sphere")
    progress.step("tracing")
    assert progress.part(1, 100) and progress.part(2, 100)
    progress.close()
    assert stream.getvalue() == "verglas: 1/2 sphere: tracing\n"


def test_ratio_is_that_of_screen_space():
    """The overview would say that bundle loses where it is the best of its kind, or hide that traced is
    better."""
    errors = {"bundle": 0.2, "traced": 0.01, "paper": 0.4, "single": 0.5, "cycles": 0.001}
    report = {"file": "", "roughness": None, "map": None, "truth": {"noise": 0.0, "spp": 2},
              "methods": {name: {"relmse": error} for name, error in errors.items()}}
    case = overview._case(report)
    assert case["ratio"] == pytest.approx(0.5) and case["best"] == "traced" and case["relmse"] == errors


# Notes

def converging(*points: tuple[int, float, float], noise: float | None = None) -> Measured:
    """Of these samples, seconds and errors."""
    way = [{"samples": samples, "seconds": seconds, "relmse": error} for samples, seconds, error in points]
    picture = methods.Picture(A, points[-1][1], samples=points[-1][0])
    return Measured(picture, {"relmse": points[-1][2]}, noise, way if len(way) > 1 else [])


def test_cost_of_the_same_error():
    """A report would tell wrong how much longer a path tracer takes."""
    cycles = converging((1, 0.5, 1.6), (4, 2.0, 0.4), (16, 8.0, 0.1), noise=0.1)
    found = notes.explain_cost({
        "bundle": converging((16, 0.2, 0.2)), "cycles": cycles,
        "traced": converging((1, 0.1, 0.8), (2, 0.2, 0.2), (32, 4.0, 0.05))})
    assert found == [
        "bundle takes 0.2 s; cycles is as close to the truth with 8 samples, after 4 s, 20 times the time.",
        "traced takes 0.1 s with one sample; cycles is as close to the truth with 2 samples, after 1 s, "
        "10 times the time.",
        # traced at 0.5 s: 0.2 * (0.2 / 0.5)^(log 4 / log 20); at 4 s: cycles has 0.2
        "In equal times from 0.5 to 4 s the relative MSE of cycles is 4 to 12 times that of traced."]
    exact = notes.explain_cost({"bundle": converging((1, 0.2, 0.05)), "cycles": cycles})
    assert exact == ["bundle takes 0.2 s; cycles isn't as close to the truth with 16 samples, after 8 s, "
                     "40 times the time."]


def test_kinds_of_pixels(scene):
    """Notes would blame geometry that isn't there."""
    set_map(scene)
    add_sphere(frosted(0.1), 96, 48)
    subject = methods.Subject(scene, methods.Conditions(64, 64, 1), pytest.fail)
    share = kind_shares(subject)
    assert share["plain"] > 0.7 and share["outline"] > 0.02
    assert share["open"] == share["hidden"] == share["again"] == 0.0


def test_kinds_of_pixels_of_a_monkey(scene):
    """Notes would miss what the method can't know, meshes that intersect themselves, or blame what it knows:
    both backs of an ear before a head."""
    set_map(scene)
    add_monkey(frosted(0.2), 1)
    share = kind_shares(methods.Subject(scene, methods.Conditions(96, 96, 1), pytest.fail))
    assert share["hidden"] < 0.01 and share["open"] > 0.02 and share["total"] > 0.02


def kind_shares(subject: methods.Subject) -> dict[str, float]:
    kinds = notes.kinds_of_pixels(subject)
    return {name: float(np.mean(kinds == i)) for i, name in enumerate(notes.KINDS)}


def test_explanation_names_the_pixels(glass):
    """A note would name other pixels than those with the error."""
    subject = methods.Subject(glass, SMALL, pytest.fail)
    found = truth.Truth("reference", subject)
    found.add(2)
    wrong = found.pixels.copy()
    outline = np.zeros_like(subject.mask)
    outline[subject.mask] = notes.kinds_of_pixels(subject) == list(notes.KINDS).index("outline")
    wrong[outline] += 1.0
    pictures = {"bundle": methods.Picture(wrong, 1.0), "single": methods.Picture(found.pixels, 1.0)}
    first, second, third = notes.explain(subject, found, pictures)
    assert "100% lies in the" in first and "on the outline" in first and ";" not in first
    assert "above that of single" in second and "on the outline" in second
    assert "march" in third
    assert notes.explain(subject, found, {"bundle": methods.Picture(found.pixels, 1.0)}) == []


# The operator and the command line

def test_operator_offers_all_methods():
    """A method would be missing in Blender's menu."""
    items = bpy.ops.verglas.compare.get_rna_type().properties["methods"].enum_items
    assert tuple(item.identifier for item in items) == methods.METHODS


def test_operator(file, tmp_path):
    """The menu's command would write no report of what is on screen, or save over the user's file."""
    before = Path(file).read_bytes()
    bpy.context.object.location.x = 0.5  # not saved
    folder = tmp_path / "out"
    done = bpy.ops.verglas.compare(methods={'bundle', 'single'}, spp=4, folder=str(folder))
    assert done == {'FINISHED'}
    report = json.loads((folder / "report.json").read_text())
    assert set(report["methods"]) == {"bundle", "single"} and report["truth"]["spp"] == 4
    assert Path(file).read_bytes() == before and bpy.data.filepath == file
    shown = methods.Subject(bpy.context.scene, SMALL, pytest.fail).real_time("bundle", 1)
    assert np.array_equal(images.read_exr(folder / "bundle.exr"), shown.pixels)


def test_operator_says_what_is_wrong(file, tmp_path):
    """A user would wait for a report that never opens."""
    bpy.context.scene.camera = None
    with pytest.raises(RuntimeError, match="'Scene' has no camera"):
        bpy.ops.verglas.compare(methods={'bundle'}, spp=2, folder=str(tmp_path / "out"))
    with pytest.raises(RuntimeError, match="choose a method"):
        bpy.ops.verglas.compare(methods=set(), folder=str(tmp_path / "out"))
    (tmp_path / "file").write_text("")
    with pytest.raises(RuntimeError, match="can't start"):
        bpy.ops.verglas.compare(folder=str(tmp_path / "file" / "out"))


def test_cancelling_the_operator(file, tmp_path):
    """A cancelled comparison would go on in the background, and slow the machine down."""
    running = operators._Comparison(tmp_path / "out", ["--spp", "1000000", "--methods", "bundle"])
    assert running.is_running
    running.kill()
    assert not running.is_running and not running.has_succeeded


def test_command_makes_the_report_again(file, tmp_path):
    """The command that a report gives would fail, or make another report."""
    def compare_by(*words: str) -> dict:
        done = subprocess.run(words, capture_output=True, text=True, cwd=tmp_path, timeout=120)
        assert done.returncode == 0, done.stdout + done.stderr
        assert "verglas: rendering bundle" in done.stdout and "Fra:" not in done.stdout
        return json.loads((tmp_path / "out" / "report.json").read_text())

    first = compare_by(
        bpy.app.binary_path, "--background", "--python", str(COMPARE), "--", "glass.blend", "--methods",
        "bundle", "--spp", "4", "--size", "32x24", "--roughness", "0.3", "--out", "out")
    again = compare_by(*first["command"].split())
    assert first["size"] == [32, 24] and first["roughness"] == 0.3
    for report in (first, again):
        report["truth"].pop("seconds")
        report["methods"]["bundle"] = report["methods"]["bundle"]["relmse"]
    assert first == again


@pytest.mark.parametrize("words, sentence", [
    (("--size", "big"), "big isn't a size such as 512x512"),
    (("--size", "0x9"), "0x9 isn't a size such as 512x512"),
    (("--roughness", "0.1,2"), "2 isn't a roughness from 0 to 1"),
    (("--spp", "0"), "0 isn't a number of samples"),
    (("--truth", "eevee"), "choose from 'reference', 'cycles'"),
])
def test_bad_options(words, sentence, capsys):
    """A typing error would cost a whole run, or be a riddle."""
    spec = importlib.util.spec_from_file_location("compare_script", COMPARE)
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    with pytest.raises(SystemExit):
        script.argument_parser().parse_args(["glass.blend", *words])
    assert sentence in capsys.readouterr().err
