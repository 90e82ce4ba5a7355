# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin panes, and the lamps behind them."""

import math

import bpy
import numpy as np
import pytest
from scenes import add, add_camera, frosted, new_material, node_of, render, set_background, set_map
from test_against_cycles import render_cycles
from verglas import compat, faults
from verglas import verglas_core as core
from verglas.sync import objects


def add_pane(material: bpy.types.Material, thickness: float = 0.0) -> bpy.types.Object:
    """Upright, 6 x 6, before the camera, its front outward; of a thickness, a box."""
    if thickness > 0.0:
        bpy.ops.mesh.primitive_cube_add(size=1)
        bpy.context.object.scale = (6.0, thickness, 6.0)
    else:
        bpy.ops.mesh.primitive_plane_add(size=6, rotation=(0.5 * math.pi, 0.0, 0.0))
    bpy.context.object.data.materials.append(material)
    return bpy.context.object


def pane_material(roughness: float, inner_roughness: float, **settings) -> bpy.types.Material:
    material = frosted(roughness)
    material.verglas.kind = 'PANE'
    material.verglas.inner_roughness = inner_roughness
    for name, value in settings.items():
        setattr(material.verglas, name, value)
    return material


def add_lamp(kind: str) -> bpy.types.Object:
    """Behind the pane, toward the camera."""
    lamp = bpy.data.lights.new("Lamp", kind)
    lamp.color, lamp.energy = (1.0, 0.5, 0.25), 3.0 if kind == 'SUN' else 100.0
    if kind == 'SUN':
        lamp.angle = 0.4
    elif kind == 'AREA':
        lamp.shape, lamp.size, lamp.size_y = 'RECTANGLE', 2.0, 1.0
    else:
        lamp.shadow_soft_size = 0.5
    return add(lamp, "Lamp", location=(0.3, 3.0, 0.2), rotation_euler=(-0.5 * math.pi, 0.0, 0.0))


@pytest.fixture
def small(scene):
    add_camera(scene, tilt=90.0, location=(0.0, -5.2, 0.0))
    scene.render.resolution_x, scene.render.resolution_y = 32, 24
    return scene


@pytest.mark.parametrize("kind", ['POINT', 'SUN', 'AREA'])
@pytest.mark.usefixtures("device")
def test_lamp_is_as_bright_as_in_cycles(small, kind):
    """A scene lit in Cycles or EEVEE would be too dark or too bright, or lit from elsewhere."""
    set_background(small, (0.0, 0.0, 0.0))
    add_lamp(kind)
    box = add_pane(frosted(0.5), 0.001)
    truth = render_cycles(small, 256)[0].rgb
    bpy.data.objects.remove(box)
    add_pane(pane_material(0.5, 0.5))
    picture = render(small).rgb
    assert picture.mean((0, 1)) == pytest.approx(truth.mean((0, 1)), rel=0.05)
    assert ((picture - truth) ** 2).mean() / (truth ** 2).mean() < 0.02
    assert not faults.warnings()


@pytest.mark.usefixtures("device")
def test_inner_side_has_its_own_roughness(small):
    """A pane would be as rough on both sides, whichever is set."""
    set_map(small)
    add_pane(pane_material(0.0, 0.0))
    clear = render(small).rgb
    material = bpy.context.object.data.materials[0]
    material.verglas.inner_roughness = 0.8
    assert np.abs(render(small).rgb - clear).max() > 0.1
    material.verglas.inner_roughness = 0.0
    np.testing.assert_allclose(render(small).rgb, clear, atol=1e-6)


def image_of(name: str, values: np.ndarray) -> bpy.types.Image:
    """values: (H, W)."""
    image = bpy.data.images.new(name, values.shape[1], values.shape[0], float_buffer=True, is_data=True)
    image.pixels.foreach_set(np.repeat(values, 4).astype(np.float32))
    return image


@pytest.mark.usefixtures("device")
def test_image_is_painted_on_the_inner_side(small):
    """A pattern that is etched into the back of a window wouldn't be seen, or not where it is."""
    set_map(small)
    pane = add_pane(pane_material(0.0, 0.0))
    halves = np.repeat([[0.0, 0.8]], 2, axis=0).repeat(8, axis=1).repeat(8, axis=0)
    pane.data.materials[0].verglas.inner_image = image_of("Halves", halves)
    both = render(small).rgb
    expected = []
    for roughness in (0.0, 0.8):
        pane.data.materials[0] = pane_material(0.0, roughness)
        expected.append(render(small).rgb)
    np.testing.assert_allclose(both[:, :12], expected[0][:, :12], atol=2e-3)
    np.testing.assert_allclose(both[:, 20:], expected[1][:, 20:], atol=2e-3)


@pytest.mark.usefixtures("device")
def test_both_sides_have_textures_of_their_own(small):
    """Two textures of roughness that lie differently on the pane would be mixed up."""
    set_map(small)
    material = pane_material(0.0, 0.0)
    tree = material.node_tree
    checker = tree.nodes.new("ShaderNodeTexChecker")
    checker.inputs["Color1"].default_value = checker.inputs["Color2"].default_value = (0.5, 0.5, 0.5, 1.0)
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Object"], checker.inputs["Vector"])
    tree.links.new(checker.outputs["Color"], next(
        node for node in tree.nodes if node.type == 'BSDF_REFRACTION').inputs["Roughness"])
    material.verglas.inner_image = image_of("Even", np.full((4, 4), 0.3))
    pane = add_pane(material)
    picture = render(small).rgb
    pane.data.materials[0] = pane_material(0.5, 0.3)
    np.testing.assert_allclose(picture, render(small).rgb, atol=3e-3)


@pytest.mark.parametrize("side", ["inner", "outer"])
def test_image_that_is_missing_is_named(small, side):
    """A pane or a lacquer whose image is gone would be clear without a word."""
    material = pane_material(0.2, 0.4) if side == "inner" else lacquer(0.1)
    material.name = "Etched"
    image = bpy.data.images.new("Lost", 4, 4)
    image.source, image.filepath = 'FILE', "//lost.png"
    setattr(material.verglas, f"{side}_image", image)
    add_pane(material)
    render(small)
    assert any("'Etched'" in text and "'Lost'" in text for text in faults.warnings())


def test_cone_of_a_spot_is_named(small):
    """A spot would light all around without a word."""
    add_lamp('SPOT')
    render(small)
    assert any("'Lamp'" in text and "cone" in text for text in faults.warnings())


def core_material(material: bpy.types.Material) -> core.Material:
    """As the core gets it."""
    add_pane(material)
    made = core.Scene()
    objects.add_objects(made, bpy.context.evaluated_depsgraph_get(), pytest.fail)
    return made.materials[0]


def principled(metallic: float, coat_roughness: float) -> bpy.types.Material:
    material = new_material("Lacquer", "ShaderNodeBsdfPrincipled", Metallic=metallic, Roughness=0.5,
                            Base_Color=(0.8, 0.2, 0.1, 1.0))
    node = node_of(material.node_tree, "ShaderNodeBsdfPrincipled")
    node.inputs[next(name for name in compat.COAT if name in node.inputs)].default_value = 1.0
    node.inputs[next(name for name in compat.COAT_ROUGHNESS
                     if name in node.inputs)].default_value = coat_roughness
    return material


@pytest.mark.parametrize("metallic", [0.0, 1.0])
@pytest.mark.usefixtures("scene")
def test_coat_of_principled_is_a_coating(metallic):
    """Car paint and lacquer would be left out, or have the roughness of the wrong side."""
    made = core_material(principled(metallic, 0.1))
    assert made.kind == 'COATED' and made.layer.diffuse == (metallic == 0.0)
    assert made.roughness == pytest.approx(0.1)
    assert made.layer.roughness == pytest.approx(0.5 if metallic else 0.25)
    assert made.layer.base_color == pytest.approx((0.8, 0.2, 0.1))


@pytest.mark.usefixtures("scene")
def test_metal_under_a_coating():
    """Gold would look as whatever metal, or as gold in air."""
    material = new_material("Gilt", "ShaderNodeBsdfDiffuse")
    material.verglas.kind, material.verglas.metal = 'COATED', 'GOLD'
    made = core_material(material)
    assert made.kind == 'COATED' and not made.layer.diffuse
    red, green, blue = made.layer.base_color
    assert 0.9 < red < 1.0 and 0.5 < green < red and blue < 0.5 * red
    # ((n - 1.5)^2 + k^2) / ((n + 1.5)^2 + k^2) with n = 0.183, k = 3.424
    assert red == pytest.approx(0.9255, abs=0.005)


def lacquer(outer_roughness: float) -> bpy.types.Material:
    material = new_material("Lacquer", "ShaderNodeBsdfGlossy", Color=(0.8, 0.4, 0.2, 1.0))
    node_of(material.node_tree, "ShaderNodeBsdfGlossy").inputs["Roughness"].default_value = 0.2
    material.verglas.kind, material.verglas.outer_roughness = 'COATED', outer_roughness
    return material


@pytest.mark.usefixtures("device")
def test_image_is_painted_on_a_lacquer(small):
    """Fingerprints on a varnish wouldn't be seen, or not where they are."""
    set_map(small)
    thing = add_pane(lacquer(0.3))
    halves = np.repeat([[0.1, 0.8]], 2, axis=0).repeat(8, axis=1).repeat(8, axis=0)
    thing.data.materials[0].verglas.outer_image = image_of("Halves", halves)
    both = render(small).rgb
    expected = []
    for roughness in (0.1, 0.8):
        thing.data.materials[0] = lacquer(roughness)
        expected.append(render(small).rgb)
    assert np.abs(expected[0] - expected[1]).max() > 0.02
    np.testing.assert_allclose(both[:, :12], expected[0][:, :12], rtol=0.03)
    np.testing.assert_allclose(both[:, 20:], expected[1][:, 20:], rtol=0.03)


@pytest.mark.usefixtures("device")
def test_without_bounces_a_lacquer_hides_its_base(small):
    """What the layer's outer side alone looks like couldn't be seen."""
    set_background(small)
    material = lacquer(0.2)
    material.verglas.bounces = 0
    add_pane(material)
    color = render(small).rgb.mean((0, 1))
    assert color == pytest.approx(np.full(3, 0.04), rel=0.05)


@pytest.mark.parametrize("diffuse", [False, True])
@pytest.mark.usefixtures("device")
def test_coating_is_as_the_reference_has_it(small, diffuse):
    """Lacquered objects would be too dark or too bright beside the reference's."""
    set_background(small)
    material = new_material("Lacquer", "ShaderNodeBsdfDiffuse" if diffuse else "ShaderNodeBsdfGlossy",
                            Color=(0.8, 0.4, 0.2, 1.0))
    if not diffuse:
        node_of(material.node_tree, "ShaderNodeBsdfGlossy").inputs["Roughness"].default_value = 0.3
    material.verglas.kind, material.verglas.outer_roughness = 'COATED', 0.2
    add_pane(material)
    picture = render(small).rgb.mean((0, 1))
    small.verglas.method, small.verglas.reference_samples = 'REFERENCE', 256
    truth = render(small).rgb.mean((0, 1))
    assert picture == pytest.approx(truth, rel=0.05)


@pytest.mark.parametrize("kind, node, inputs", [
    ('COATED', "ShaderNodeBsdfGlass", {}),
    ('PANE', "ShaderNodeBsdfPrincipled", {name: 1.0 for name in compat.COAT}),
])
def test_kind_that_the_shader_cannot_be_is_named(small, kind, node, inputs):
    """A material would be something else than it is set to, without a word."""
    material = new_material("Odd", node)
    for name in inputs:
        if name in node_of(material.node_tree, node).inputs:
            node_of(material.node_tree, node).inputs[name].default_value = 1.0
    material.verglas.kind = kind
    add_pane(material)
    render(small)
    assert any("'Odd' can't be" in text for text in faults.warnings())


def test_lamp_that_is_no_number_is_named(small):
    """A broken driver on a lamp would end the render."""
    set_background(small)
    add_lamp('POINT').data.energy = float("inf")
    add_pane(pane_material(0.2, 0.2))
    assert render(small).rgb.min() > 0.0
    assert any("'Lamp'" in text for text in faults.warnings())
