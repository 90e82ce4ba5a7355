# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of what is wrong with the scene, of render jobs and viewports."""

import gc

import pytest
from scenes import add_sphere, new_material, render
from verglas import faults, renderer
from verglas import verglas_core as core


@pytest.fixture(autouse=True)
def nothing_listed(scene):
    """Without what earlier tests have left."""
    gc.collect()
    faults._job.clear()


@pytest.mark.parametrize("sentence, subject", [
    ("Material 'Glass': only its first glass node is rendered.", "Material 'Glass'"),
    ("Object 'Ball' (mesh 'Sphere'): 1 vertex isn't a number.", "Object 'Ball'"),
    ("Hair curves 'Fur' isn't supported yet; it is left out.", "Hair curves 'Fur'"),
    ("Material 'Bob's glass' doesn't use nodes.", "Material 'Bob's glass'"),
    ("The scene has no world: nothing lights the glass.", ""),
])
def test_subject(sentence, subject):
    """Warnings would be listed under the wrong object or material."""
    assert faults.subject(sentence) == subject


def test_viewports_and_render_jobs_are_listed_together(scene):
    """A user who works in the viewport alone would see no warning, or one for each viewport."""
    add_sphere(new_material("Clay", "ShaderNodeBsdfDiffuse"))
    render(scene)
    (of_job,) = faults.warnings()
    left, right = faults.Collector(), faults.Collector()
    for view in (left, right):
        view.warn(of_job)
    sky = "World 'Sky' has no Background: nothing lights the glass."
    right.warn(sky)
    left.fault = right.fault = "OpenGL is out of memory."
    broken, groups = faults.listed()
    assert broken == ("OpenGL is out of memory.",)
    assert groups == {faults.subject(of_job): (of_job,), "World 'Sky'": (sky,)}


def test_what_is_mended_is_not_listed(scene):
    """Warnings would stay in the panel after the user has done what they ask for, or closed the viewport."""
    view = faults.Collector()
    view.warn("Material 'Glass' has a fault.")
    view.clear()
    assert faults.listed() == ((), {})
    view.warn("Material 'Glass' has a fault.")
    del view
    gc.collect()
    assert faults.listed() == ((), {})


def test_fault_of_a_render_job_is_listed(scene, monkeypatch):
    """Blender's error popup would be all that a user has, and gone with the next click."""
    def broken(*_):
        raise core.Error("OpenGL is out of memory.")

    monkeypatch.setattr(renderer, "render", broken)
    with pytest.raises(RuntimeError, match="out of memory"):
        render(scene)
    assert faults.listed() == (("OpenGL is out of memory.",), {})
