# SPDX-License-Identifier: GPL-3.0-or-later
"""The command that measures what Verglas costs."""

import dataclasses
import json
import sys
from pathlib import Path

import numpy as np
import pytest
from verglas import verglas_core as core
from verglas.compare.methods import Subject
from verglas.compare.progress import Progress
from verglas.faults import Fault

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS), str(TESTS / "viewport")]

import blender_window  # noqa: E402
from bench import engines, frames, plan, run, subjects, summary  # noqa: E402
from figures.cost import PASSES  # noqa: E402


def test_quick_run_writes_what_it_says(tmp_path, capfd):
    """The command would end well and leave measurements, plots or the summary out."""
    assert run.main(["--out", str(tmp_path), "--quick"]) == 0
    results = json.loads((tmp_path / "bench.json").read_text())
    assert set(results["machine"]) == {"cpu", "cores", "opengl", "blender", "verglas", "commit"}
    for kind in "models", "triangles", "pixels":
        assert {row["method"] for row in results[kind]} == set(frames.METHODS)
        assert (tmp_path / f"{kind}.png").stat().st_size > 5000
    assert [row["threads"] for row in results["threads"]][0] == 1
    assert [row["roughness"] for row in results["roughness"]][::3] == ["uniform", "4 classes on the back"]
    assert [row["lobes"] for row in results["lobes"]] == ["table", "analytic"] * 2
    assert {row["method"] for row in results["updates"]} == {"bundle", "traced"}
    assert {(row["method"], row["bounces"]) for row in results["coatings"]} == {
        (method, bounces) for method in ("bundle", "traced") for bounces in (0, 1, 2)}
    assert [(row["bounces"], row["light"]) for row in results["bounces"]] == [
        (bounces, light) for bounces in plan.QUICK.bounces for light in ("one", "all")]
    assert {row["engine"] for row in results["engines"]} == {*frames.METHODS, "reference", "cycles"}
    assert (tmp_path / "engines.png").is_file() and (tmp_path / "preparation.png").is_file()
    if blender_window.why_not() is None:
        assert {row["method"] for row in results["navigation"]} == {"bundle", "traced"}
        assert (tmp_path / "navigation.png").is_file()
    kinds = ("preparation", "engines", "refraction", "updates", "navigation")
    numbers = [row[name] for kind in kinds for row in results[kind] for name in row if name.endswith("ms")]
    numbers += [row["frame_ms"] for row in results["models"]] + list(results["ratios"].values())
    assert min(numbers) > 0.0 and np.isfinite(numbers).all()
    printed = capfd.readouterr().out
    assert results["machine"]["opengl"] in printed and "reference / cycles, one sample" in printed


@pytest.mark.parametrize("method", frames.METHODS)
def test_passes_add_up(method):
    """The bars of the passes would show other times than the frames take, or leave a pass out."""
    subject = subjects.subject(subjects.models()[0], (256, 256), Progress())
    row = frames.cost(subject.core_scene, method, (256, 256), plan.QUICK)
    named = {"tracing"} if method == "traced" else {"back_faces", "front_faces", "refraction", "readback"}
    assert named <= set(row["passes_ms"]) <= set(PASSES)
    # Passes of a driver with several threads may overlap a little.
    assert 0.4 * row["frame_ms"] < sum(row["passes_ms"].values()) < 1.6 * row["frame_ms"]


@pytest.mark.parametrize("squares", [1, 7])
def test_ball_is_closed_and_turned_outward(squares):
    """Cost against triangles would be measured on something that isn't the same ball each time."""
    mesh = subjects.ball(squares)
    assert mesh.triangle_count == 12 * squares ** 2 and not mesh.warnings
    scene = core.Scene()
    scene.add_object("Ball", mesh, np.eye(4), [scene.add_material(core.Material("Glass"))])
    directions = np.random.default_rng(0).normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    hits = core.RayScene(scene).intersect(np.zeros_like(directions), directions)
    assert np.isfinite(hits["t"]).all() and hits["t"].max() < 1.0001
    assert ((hits["geometric_normal"] * directions).sum(1) > 0.5).all()


def test_engine_that_cannot_run_is_named(monkeypatch):
    """Without a display for EEVEE the whole measurement would be lost, or EEVEE missing without a word."""
    def no_display(self):
        raise Fault("EEVEE needs a display.")

    monkeypatch.setattr(Subject, "eevee", no_display)
    notes = []
    rows = engines.engines(dataclasses.replace(plan.QUICK, with_eevee=True), Progress(), notes)
    assert notes == ["EEVEE needs a display."]
    assert rows[-1]["engine"] == "cycles"


def test_ratios():
    """The summary would praise the wrong method."""
    models = [{"model": model, "width": 4, "height": 4, "method": method, "frame_ms": factor * milliseconds}
              for model, milliseconds in (("a", 1.0), ("b", 100.0))
              for method, factor in (("bundle", 2.0), ("traced", 1.5), ("paper", 8.0), ("single", 1.0),
                                     ("specular", 0.5))]
    rows = [{"engine": "bundle", "sample_ms": 2.0}, {"engine": "traced", "sample_ms": 1.0},
            {"engine": "reference", "sample_ms": 4.0},
            {"engine": "cycles", "sample_ms": 8.0},
            {"engine": "eevee", "sample_ms": 1.0, "picture_ms": 64.0}]
    threads = [{"threads": 1, "frame_ms": 9.0}, {"threads": 2, "frame_ms": 5.0}]
    refraction = [{"engine": "traced", "sample_ms": 0.5}, {"engine": "cycles", "sample_ms": 6.0}]
    roughness = [{"roughness": "uniform", "frame_ms": 4.0}, {"roughness": "4 classes", "frame_ms": 6.0}]
    lobes = [{"method": "bundle", "lobes": "table", "frame_ms": 4.0},
             {"method": "bundle", "lobes": "analytic", "frame_ms": 2.0}]
    bounces = [{"bounces": 2, "light": "all", "speedup_at_equal_samples": 1.5, "speedup_at_equal_noise": 9.0}]
    coated = [{"base": "sharp", "method": "traced", "bounces": count, "frame_ms": 4.0 + count}
              for count in (0, 2)]
    found = summary.ratios({"models": models, "engines": rows, "refraction": refraction, "threads": threads,
                            "roughness": roughness, "lobes": lobes, "bounces": bounces,
                            "coatings": coated})
    assert found["coating, sharp, 2 bounces / glossy layer, traced"] == pytest.approx(1.5)
    assert found["recursive / ENDF at equal noise, all of 2"] == 9.0
    assert found["analytic / table lobes, bundle"] == pytest.approx(0.5)
    assert found["4 classes / uniform roughness"] == pytest.approx(1.5)
    assert found["cycles with 512 samples / traced with one, refraction only"] == pytest.approx(512 * 12.0)
    assert found["paper / bundle, frames of 4 x 4"] == pytest.approx(4.0)
    assert found["specular / bundle, frames of 4 x 4"] == pytest.approx(0.25)
    assert found["reference / cycles, one sample"] == pytest.approx(0.5)
    assert found["cycles with 512 samples / bundle with one"] == pytest.approx(2048.0)
    assert found["cycles with 512 samples / traced with one"] == pytest.approx(4096.0)
    assert found["traced, 1 thread / 2 threads"] == pytest.approx(1.8)
    assert found["eevee's picture / bundle with one sample"] == pytest.approx(32.0)
