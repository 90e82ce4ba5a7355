# SPDX-License-Identifier: GPL-3.0-or-later
"""The path-traced reference: a render method of the engine, checked against Cycles."""

import bpy
import numpy as np
import pytest
from scenes import (
    add_absorption, add_hollow_sphere, add_monkey, add_nested_spheres, add_overlapping_spheres, add_sphere,
    add_spheres_in_a_row, frosted, new_material, node_of, render, set_background, set_map,
    set_smooth, world_map,
)
from verglas.compare import methods, metrics
from verglas.engine import VerglasRenderEngine


@pytest.fixture
def reference(scene) -> bpy.types.Scene:
    set_map(scene)
    scene.verglas.method = 'REFERENCE'
    scene.verglas.reference_samples = 64
    return scene


def test_shows_the_same_glass(reference):
    """A frame could not be checked: the reference would show another scene than the real-time method."""
    add_sphere(frosted(0.4), 64, 32)
    truth = render(reference)
    reference.verglas.method, reference.verglas.samples = 'REAL_TIME', 16
    picture = render(reference)
    inside = truth.mask & picture.mask
    assert inside.mean() > 0.95 * truth.mask.mean()
    assert np.abs(picture.rgb - truth.rgb)[inside].mean() < 0.05 * truth.rgb[inside].mean()
    assert np.abs(picture.depth - truth.depth)[inside].max() < 0.05
    assert np.abs(picture.rgb - truth.rgb)[~(truth.mask | picture.mask)].mean() < 0.01


def test_border_and_film(reference):
    """A border would show another part of the picture, or a transparent film would be opaque."""
    add_sphere(frosted(0.4))
    reference.verglas.reference_samples = 4
    reference.render.film_transparent = True
    whole = render(reference)
    assert (whole.combined[~whole.mask][..., 3] < 1.0).all() and whole.combined[0, 0, 3] == 0.0
    reference.render.use_border = reference.render.use_crop_to_border = True
    reference.render.border_min_x, reference.render.border_max_x = 0.25, 0.75
    reference.render.border_min_y, reference.render.border_max_y = 0.5, 1.0
    assert np.array_equal(render(reference).combined, whole.combined[24:48, 16:48])


def test_paths(reference):
    """Which light is followed could not be chosen, to see what a real-time method leaves out."""
    set_background(reference)
    add_monkey(new_material(Roughness=0.2, IOR=1.5, Color=(1, 1, 1, 1)), subdivisions=1)
    energy = {}
    for name, paths, tir in (("full", 'FULL', False), ("lost", 'TWO_INTERFACE', False),
                             ("followed", 'TWO_INTERFACE', True)):
        reference.verglas.reference_paths, reference.verglas.reference_tir = paths, tir
        picture = render(reference)
        energy[name] = picture.rgb[picture.mask].mean()
    assert energy["lost"] < 0.97 * energy["followed"] < energy["full"] < 1.01


def test_priority_gives_media_their_own_index(reference):
    """Glass in glass could be had only with relative IORs, worked out by hand."""
    outer, inner = frosted(0.1, 1.5), frosted(0.1, 1.3)
    add_nested_spheres(outer, inner)
    outer.verglas.priority, inner.verglas.priority = 1, 2
    nested = render(reference)
    outer.verglas.priority = inner.verglas.priority = 0
    assert metrics.relmse(nested.rgb, render(reference).rgb, nested.mask) > 0.01
    node_of(inner.node_tree, "ShaderNodeBsdfRefraction").inputs["IOR"].default_value = 1.3 / 1.5
    assert metrics.relmse(nested.rgb, render(reference).rgb, nested.mask) < 1e-4


def test_overlapping_parts_of_equal_priority_are_joined(reference):
    """Parts that reach into each other would show their inner walls, unless they are joined by a Boolean."""
    glass = add_absorption(frosted(0.1))
    left, right = add_overlapping_spheres(glass, glass)
    for part in left, right:
        set_smooth(part.data, False)  # a Boolean's smooth normals are others along the seam
    apart = render(reference)
    glass.verglas.priority = 1
    joined = render(reference)
    union = left.modifiers.new("Union", 'BOOLEAN')
    union.operation, union.object = 'UNION', right
    right.hide_render = True
    truth = render(reference)
    assert metrics.relmse(joined.rgb, truth.rgb, truth.mask) < 1e-4
    assert metrics.relmse(apart.rgb, truth.rgb, truth.mask) > 0.01


class _Host:
    """What the engine's method that path-traces asks of its engine; the user cancels after some calls."""

    def __init__(self, calls: int):
        self.calls = calls

    def _progress(self, done: int, total: int) -> bool:
        self.done, self.calls = done, self.calls - 1
        return self.calls > 0


class _Tracer:
    """A tracer whose every pass takes one call."""
    samples = 0

    def render(self, samples, progress):
        for done in range(1, samples + 1):
            self.samples += 1
            if not progress(done, samples):
                return False
        return True

    def frame(self):
        return self.samples


@pytest.mark.parametrize("calls, samples", [(3, 3), (100, 10)])
def test_cancelled_reference_keeps_what_there_is(calls, samples):
    """A long render that is cancelled would leave nothing, or go on, or not end at its samples."""
    host = _Host(calls)
    assert VerglasRenderEngine._trace(host, _Tracer(), 10, "Layer") == samples
    assert host.done == samples


def add_slab(material: bpy.types.Material) -> None:
    bpy.ops.mesh.primitive_cube_add(size=2)
    slab = bpy.context.object
    slab.scale, slab.rotation_euler = (1.0, 0.15, 1.0), (0.0, 0.0, 0.5)
    slab.data.materials.append(material)


SHAPES = {
    "sphere": lambda material: add_sphere(material, 144, 72),
    "monkey": lambda material: add_monkey(material, subdivisions=3),
    "slab": add_slab,
    "hollow": lambda material: add_hollow_sphere(material, 144, 72),
    "nested": lambda material: add_nested_spheres(*[add_absorption(material)] * 2, 144, 72),
    "overlapping": lambda material: add_overlapping_spheres(*[add_absorption(material)] * 2, 144, 72),
    "spheres in a row": lambda material: add_spheres_in_a_row(material, material, 144, 72),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("distribution", ['BECKMANN', 'GGX'])
@pytest.mark.parametrize("node", ["Refraction", "Glass"])
def test_agrees_with_cycles(reference, shape, distribution, node):
    """The ground truth would be none: it differs from Cycles' picture by no more than both pictures' noise.
    Each is made twice, with other seeds, to know that noise."""
    if node == "Glass" and bpy.app.version < (4, 0, 0):
        pytest.skip("before Blender 4.0 Cycles' Glass takes Fresnel's factor at the mesh's normal")
    set_map(reference, world_map("forest"))
    SHAPES[shape](new_material("Glass", f"ShaderNodeBsdf{node}", distribution=distribution, Roughness=0.4,
                               IOR=1.5, Color=(1, 1, 1, 1)))
    subject = methods.Subject(reference, methods.Conditions(64, 64, samples=1), print)
    ours = [subject.reference(256, seed).pixels for seed in (0, 1)]
    theirs = [subject.cycles(256, seed).pixels for seed in (0, 1)]
    noise = (metrics.noise(ours, subject.mask) + metrics.noise(theirs, subject.mask)) / 2.0
    a, b = np.mean(ours, axis=0), np.mean(theirs, axis=0)
    found, brightness = metrics.relmse(a, b, subject.mask), a[subject.mask].mean() / b[subject.mask].mean()
    print(f"{shape}, {distribution}, {node}: "
          f"relative MSE {found:.4f}, noise {noise:.4f}, brightness {brightness:.4f}")
    assert found <= 1.4 * noise
    assert brightness == pytest.approx(1.0, abs=0.015 if node == "Refraction" else 0.05)
