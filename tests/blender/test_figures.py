# SPDX-License-Identifier: GPL-3.0-or-later
"""The command that makes the papers' figures."""

import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from verglas import verglas_core as core
from verglas.compare.progress import Progress

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from figures import btdf, coatings, layer_cost, layers, masking, models, run, warping  # noqa: E402
from figures.figure import label  # noqa: E402
from figures.studio import Case, Studio  # noqa: E402


@pytest.mark.parametrize("eta", (1.51, 1.0 / 1.51))
@pytest.mark.parametrize("degrees", (0, 30, 75))
def test_exact_lobe_has_the_moments_of_the_tables(eta, degrees):
    """Fig. 3 would blame the tables for an error of its own curves, or both would be wrong alike."""
    exponent, cosine = 24.0, math.cos(math.radians(degrees))
    hemisphere = btdf.Hemisphere.grid(300)
    exact = btdf.lobe(hemisphere.directions, cosine, eta, exponent)
    roughness = models.roughness_of(exponent)
    energy, kappa, direction = core.interface_lobe('BLINN_PHONG', roughness, eta, cosine, 'REFRACT')
    assert hemisphere.integral(exact) == pytest.approx(energy, abs=0.01)
    if energy > 0.05:
        mean = hemisphere.mean_vector(exact)
        length = float(np.linalg.norm(mean))
        assert mean @ direction / length > math.cos(math.radians(0.5))
        assert btdf.kappa_from_mean_length(length) == pytest.approx(kappa, rel=0.05)


def test_gaussian_has_its_energy():
    """The blue curves of Fig. 3 would be too high or too low."""
    hemisphere = btdf.Hemisphere.grid(300)
    values = btdf.gaussian(hemisphere.directions, 0.7, 40.0, np.array([0.0, 0.0, -1.0]))
    assert hemisphere.integral(values) == pytest.approx(0.7, rel=1e-3)


@pytest.mark.parametrize("cosine, kappa_o, kappa_m", ((1.0, 50.0, 200.0), (0.707, 100.0, 100.0)))
def test_exact_warp_is_that_of_drawn_directions(cosine, kappa_o, kappa_m):
    """The curves of the ENDF paper's figures would belong to other beams than their numbers."""
    warp = warping.Warp(cosine, kappa_o, kappa_m, 1.5)
    hemisphere = btdf.Hemisphere.grid(100)
    density = warp.density(hemisphere.directions.reshape(-1, 3), 1000).reshape(100, 100)
    assert hemisphere.integral(density) == pytest.approx(1.0, abs=0.02)
    mean = hemisphere.mean_vector(density)
    assert np.linalg.norm(mean - warp.drawn_mean(20_000) * (1.0, 0.0, 1.0)) < 0.003


def test_quadrature_of_masking_is_exact_where_that_is_known():
    """Fig. 2 of the ENDF paper would blame the closed forms for an error of its own."""
    for kappa in (1.0, 10.0, 100.0):
        straight = (1.0 - (1.0 - math.exp(-kappa)) / kappa) / (1.0 - math.exp(-2.0 * kappa))
        assert masking.facing_area(kappa, 1.0) == pytest.approx(straight, rel=1e-4)
        # What faces the other side is as much less as the mean of o.m.
        assert masking.facing_area(kappa, 0.3) - masking.facing_area(kappa, -0.3) == pytest.approx(
            0.3 * warping.mean_length(kappa), rel=1e-4)


def test_quick_run_writes_what_it_says(tmp_path):
    """The command would end well and leave figures, numbers or the page out."""
    made = ("3", "10", "endf2", "endf6", "endf14", "endf_table2")
    assert run.main(["--out", str(tmp_path), "--only", ",".join(made), "--size", "64", "--quick"]) == 0
    figures = json.loads((tmp_path / "figures.json").read_text())["figures"]
    assert set(figures) == set(made)
    page = (tmp_path / "index.html").read_text()
    for record in figures.values():
        assert (tmp_path / record["picture"]).stat().st_size > 10000
        assert record["picture"] in page
        assert record["command"] in page
        values = [value for row in record["numbers"] for value in row.values() if isinstance(value, float)]
        assert values and np.isfinite(values).all()
    assert {row["method"] for row in figures["10"]["numbers"]} == {"bundle", "traced", "paper"}
    assert "Fig. 16" in page  # among those that aren't made yet


def test_figures_of_both_papers_have_their_labels():
    """The page would show the ENDF paper's figures as the other's."""
    assert label("13") == "Rough refraction, Fig. 13"
    assert label("endf5") == "Thin layers (ENDF), Fig. 5"
    assert label("endf_table2") == "Thin layers (ENDF), Table 2"


def test_unknown_figure_is_refused(tmp_path, capsys):
    """A mistyped number would make nothing, or all, without a word."""
    with pytest.raises(SystemExit):
        run.main(["--out", str(tmp_path / "new"), "--only", "16"])
    assert "no figure 16" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_sample_scenes_stand_in_for_missing_models(tmp_path, monkeypatch):
    """Without the Stanford models the command would fail, or credit pictures to the wrong people."""
    monkeypatch.setattr(models, "ASSETS", tmp_path)
    for model in (models.MODELS[name] for name in ("bunny", "buddha", "dragon")):
        assert "Stanford" not in models.about(model)
        subject = Studio(32, True, Progress()).subject(Case(model, 24.0, tir=False))
        assert 0.05 < subject.mask.mean() < 0.6
    assert "bottle stands in" in models.about(models.MODELS["bunny"])


@pytest.fixture
def coated_monkey():
    setting = coatings.model_setting(Studio(64, True, Progress()), layers.MONKEY)
    return coatings.Coated(setting, coatings.Coating(kappa=1e4, base_kappa=1e3))


@pytest.mark.parametrize("method", coatings.DEVICES)
def test_kinds_of_light_in_a_layer_add_up(coated_monkey, method):
    """Fig. 15 of the ENDF paper would show light as that of one bounce which isn't."""
    kinds = ({"surface": False, "bounces": 1}, {"surface": False}, {})
    pictures = [coated_monkey.changed(**kind).picture(method).pixels for kind in kinds]
    one, both, whole = (float(pixels[coated_monkey.mask].mean(dtype=np.float64)) for pixels in pictures)
    assert 0.0 < both - one < 0.2 * one
    assert whole > both


def test_noise_is_the_variance_of_pictures():
    """Speedups at equal noise would be those at some other noise."""
    pictures = 2.0 + 0.1 * np.random.default_rng(1).normal(size=(64, 500, 3))
    assert layer_cost.noise(pictures) == pytest.approx(0.01 / 4.01, rel=0.05)
