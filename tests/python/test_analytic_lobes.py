# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures with lobes in closed form, Settings.lobes = 'ANALYTIC'."""

import numpy as np
import pytest
import verglas_core as verglas
from conftest import scene_of, settings_of, sphere


def glass(**attributes):
    material = verglas.Material("Glass")
    for name, value in attributes.items():
        setattr(material, name, value)
    return material


def ball_of(material):
    return scene_of(("Sphere", sphere(), np.eye(4)), material=material)


def picture(renderer, scene, **settings):
    return renderer.render(scene, settings_of(**settings)).combined[..., :3]


@pytest.mark.parametrize("make", [verglas.Renderer, verglas.TracedRenderer])
def test_nothing_is_built_or_loaded(make, monkeypatch, tmp_path):
    """An artist loses: the first picture at once, without seconds for tables, and without a cache."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    renderer = make()
    for ndf in "BECKMANN", "GGX", "BLINN_PHONG":
        frame = renderer.render(ball_of(glass(ndf=ndf)), settings_of(lobes="ANALYTIC"))
        assert frame.prepare_seconds["tables"] < 0.05
        assert np.ptp(frame.combined) > 0.1
    assert not (tmp_path / "verglas").exists()


@pytest.mark.parametrize("event", ["REFRACT", "REFRACT_WITHOUT_FRESNEL", "REFLECT"])
@pytest.mark.parametrize("ndf", ["BECKMANN", "GGX", "BLINN_PHONG"])
def test_any_crossing_has_a_lobe(ndf, event):
    """A user loses: glass without black or glaring pixels, at flat angles, without a step of the index, with
    the greatest and the least roughness."""
    for roughness in 0.0, 1e-3, 0.1, 0.5, 1.0:
        for eta in 0.2, 0.75, 0.999, 1.0, 1.001, 1.5, 3.5:
            for cos_theta_o in 0.0, 1e-4, 0.1, 0.5, 0.9, 1.0:
                W, kappa, p = verglas.interface_lobe(ndf, roughness, eta, cos_theta_o, event, "ANALYTIC")
                assert 0.0 <= W <= 1.001 and kappa > 0.0 and np.isfinite([kappa, *p]).all()
                assert np.linalg.norm(p) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("ndf", ["BECKMANN", "GGX", "BLINN_PHONG"])
def test_both_devices_show_the_same(renderer, ndf):
    """A user loses: a final frame by the CPU that looks as the viewport's by OpenGL. They differ as much as
    with tables, by their ways through the glass."""
    scene = ball_of(glass(ndf=ndf, roughness=0.4))
    traced = verglas.TracedRenderer()
    apart = {}
    for lobes in "TABLE", "ANALYTIC":
        settings = {"lobes": lobes, "reflection": False, "paths": "TWO_INTERFACE", "tir": "NONE"}
        pictures = [picture(device, scene, **settings) for device in (renderer, traced)]
        apart[lobes] = np.abs(pictures[0] - pictures[1]).mean()
    print(f"{ndf}: the devices' pictures differ by", {name: round(value, 5) for name, value in apart.items()})
    assert apart["ANALYTIC"] < 1.3 * apart["TABLE"] + 5e-4


def pane():
    material = glass(kind="PANE", roughness=0.4)
    material.layer.roughness = 0.3
    return material


def textured():
    values = np.tile(np.float32([[0.2, 0.6], [0.6, 0.2]]), (4, 4))
    return glass(roughness_texture=verglas.Texture("Checks", values))


@pytest.mark.parametrize("make_renderer", [verglas.Renderer, verglas.TracedRenderer])
@pytest.mark.parametrize("make_material", [glass, textured, pane])
def test_looks_about_as_with_tables(make_renderer, make_material):
    """A user loses: the choice between both for all kinds of glass, or a choice that is taken back."""
    renderer, scene = make_renderer(), ball_of(make_material())
    table, analytic, again = (picture(renderer, scene, lobes=lobes)
                              for lobes in ("TABLE", "ANALYTIC", "TABLE"))
    difference = np.abs(analytic - table).mean()
    print(f"{make_material.__name__}: mean {table.mean():.3f}, difference {difference:.5f}")
    assert np.array_equal(table, again)
    assert 0.0 < difference < 0.04 * table.mean()
