# SPDX-License-Identifier: GPL-3.0-or-later
"""Roughness that varies over the surface: each node and source against what Cycles makes of it."""

import os

import bpy
import numpy as np
import pytest
from scenes import add, add_node, add_sphere, new_group, new_material, node_of, render, set_map
from textures import (
    add_image, add_plane, link, new_image, of_cycles, of_verglas, set_uvs, texture_of, textured,
)
from verglas import faults, sync
from verglas import verglas_core as core
from verglas.sync import images, materials, meshes

pytestmark = pytest.mark.usefixtures("scene")


def noise_image(size: int = 6, **options) -> bpy.types.Image:
    pixels = np.random.default_rng(1).uniform(0.1, 0.9, (size, size + 2, 3)).astype(np.float32)
    return new_image(pixels, **options)


def assert_as_cycles(scene, plane, warned, tolerance: float, share: float = 1.0) -> None:
    """share: of the pixels that are within the tolerance; edges that Cycles has sharper aren't."""
    ours = of_verglas(plane, warned.append)
    truth = of_cycles(scene, plane)
    assert warned == []
    assert truth.std() > 0.01
    error = np.abs(ours - truth)
    assert np.mean(error <= tolerance) >= share, f"error up to {error.max():.3g}, mean {error.mean():.3g}"


@pytest.mark.parametrize("extension", ['REPEAT', 'EXTEND', 'CLIP', 'MIRROR'])
@pytest.mark.parametrize("interpolation", ['Linear', 'Closest', 'Cubic'])
def test_image(scene, warned, extension, interpolation):
    """An artist's painted frost would be shifted, cut or smeared beyond the borders of its image."""
    if extension == 'MIRROR' and bpy.app.version < (3, 5, 0):
        pytest.skip("3.5 brought Mirror")
    material = textured(lambda tree: add_image(tree, noise_image(), extension=extension,
                                               interpolation=interpolation).outputs[0])
    assert_as_cycles(scene, add_plane(material, uv_range=(-0.7, 1.45)), warned, 0.004)


def mapped(tree, kind: str, **values) -> bpy.types.NodeSocket:
    uv = add_node(tree, "ShaderNodeUVMap", uv_map="UVMap").outputs[0]
    return link(tree, "ShaderNodeMapping", {0: uv}, vector_type=kind, **values)


@pytest.mark.parametrize("kind", ['POINT', 'TEXTURE', 'VECTOR'])
def test_mapping_of_an_image(scene, warned, kind):
    """An image that is moved, turned or scaled by a Mapping node would lie elsewhere than in Cycles."""
    values = {"Location": (0.3, -0.2, 0.4)} if kind != 'VECTOR' else {}
    material = textured(lambda tree: add_image(
        tree, noise_image(), mapped(tree, kind, Rotation=(0.4, 0.2, 0.7), Scale=(1.5, 0.6, 1.0), **values)
    ).outputs[0])
    assert_as_cycles(scene, add_plane(material), warned, 0.002)


@pytest.mark.parametrize("space, is_float", [
    ('sRGB', False), ('Non-Color', False), ('Non-Color', True), ('Linear', True), ('XYZ', False),
    ('Linear ACES', False)])
def test_color_space(scene, warned, space, is_float):
    """Roughness would be too low or too high all over for images that aren't data."""
    if space not in {item.name for item in bpy.types.ColorManagedInputColorspaceSettings.bl_rna
                     .properties["name"].enum_items}:
        pytest.skip("this version names it differently")
    material = textured(lambda tree: add_image(tree, noise_image(space=space, is_float=is_float)).outputs[0])
    assert_as_cycles(scene, add_plane(material), warned, 0.004)


@pytest.mark.parametrize("mode", ['STRAIGHT', 'PREMUL', 'CHANNEL_PACKED', 'NONE'])
@pytest.mark.parametrize("output", ["Color", "Alpha", "both"])
@pytest.mark.parametrize("space", ['sRGB', 'Non-Color'])
def test_alpha(scene, warned, mode, output, space):
    """Images with alpha would have another roughness where they are transparent."""
    pixels = np.random.default_rng(2).uniform(0.2, 0.9, (4, 4, 4)).astype(np.float32)
    image = new_image(pixels, space=space, is_float=False, alpha=True)
    image.alpha_mode = mode

    def build(tree):
        node = add_image(tree, image)
        if output != "both":
            return node.outputs[output]
        return link(tree, "ShaderNodeMath", {0: node.outputs["Color"], 1: node.outputs["Alpha"]},
                    operation='MULTIPLY')
    if (mode, output) == ('NONE', "Alpha"):
        pytest.skip("all 1")
    if mode == 'PREMUL' and space == 'sRGB' and output != "Alpha" and bpy.app.version >= (5, 0, 0):
        pytest.skip("Cycles takes bytes in memory, which are straight, for premultiplied ones")
    assert_as_cycles(scene, add_plane(textured(build)), warned, 0.006)


def image_chain(*kinds: tuple[str, dict]):
    """Builds an image whose colour goes through nodes, by their first colour or number input."""
    def build(tree):
        output = add_image(tree, noise_image(12)).outputs[0]
        for kind, values in kinds:
            number = values.pop("number", 0)
            output = link(tree, kind, {number: output}, values.pop("output", 0), **values)
        return output
    return build


MATHS = ['ADD', 'SUBTRACT', 'MULTIPLY', 'DIVIDE', 'MULTIPLY_ADD', 'POWER', 'LOGARITHM', 'SQRT',
         'INVERSE_SQRT', 'ABSOLUTE', 'EXPONENT', 'MINIMUM', 'MAXIMUM', 'LESS_THAN', 'GREATER_THAN',
         'SIGN', 'COMPARE', 'SMOOTH_MIN', 'SMOOTH_MAX', 'ROUND', 'FLOOR', 'CEIL', 'TRUNC', 'FRACT',
         'MODULO', 'WRAP', 'SNAP', 'PINGPONG', 'SINE', 'COSINE', 'TANGENT', 'ARCSINE', 'ARCCOSINE',
         'ARCTANGENT', 'ARCTAN2', 'SINH', 'COSH', 'TANH', 'RADIANS', 'DEGREES']


def assert_node_as_cycles(scene, warned, build, tolerance=0.002):
    """On a plane across which an attribute rises."""
    plane = add_plane(textured(build), cells=1)
    attribute = plane.data.attributes.new("Slope", 'FLOAT', 'POINT')
    attribute.data.foreach_set("value", (0.0, 1.0, 0.0, 1.0))
    assert_as_cycles(scene, plane, warned, tolerance, share=0.97)


def slope(tree, lower: float = -1.5, upper: float = 1.5) -> bpy.types.NodeSocket:
    """A number that rises over the plane."""
    x = add_node(tree, "ShaderNodeAttribute", attribute_name="Slope").outputs["Fac"]
    node = add_node(tree, "ShaderNodeMapRange", clamp=False)
    tree.links.new(x, node.inputs[0])
    node.inputs[3].default_value, node.inputs[4].default_value = lower, upper
    return node.outputs[0]


@pytest.mark.parametrize("operation", MATHS)
def test_math(scene, warned, operation):
    """A Math node between texture and roughness would calculate something else."""
    def build(tree):
        node = add_node(tree, "ShaderNodeMath", operation=operation)
        tree.links.new(slope(tree), node.inputs[0])
        node.inputs[1].default_value, node.inputs[2].default_value = 0.75, 0.4
        return node.outputs[0]
    assert_node_as_cycles(scene, warned, build, 0.01)


@pytest.mark.skipif(bpy.app.version < (4, 1, 0), reason="4.1 brought it")
def test_floored_modulo(scene, warned):
    """As test_math."""
    test_math(scene, warned, 'FLOORED_MODULO')


@pytest.mark.parametrize("operation", [
    'ADD', 'MULTIPLY', 'DIVIDE', 'DOT_PRODUCT', 'CROSS_PRODUCT', 'DISTANCE', 'LENGTH', 'SCALE',
    'NORMALIZE', 'FRACTION', 'MODULO', 'WRAP', 'SNAP', 'SINE'])
def test_vector_math(scene, warned, operation):
    """Coordinates that a Vector Math node bends would lie elsewhere."""
    def build(tree):
        x = slope(tree)
        vector = link(tree, "ShaderNodeCombineXYZ", {0: x, 2: x}, Y=0.4)
        node = add_node(tree, "ShaderNodeVectorMath", operation=operation)
        tree.links.new(vector, node.inputs[0])
        for number, value in ((1, (0.7, 0.3, 0.9)), (2, (0.1, 0.0, 0.2))):
            node.inputs[number].default_value = value
        if operation == 'SCALE':
            node.inputs["Scale"].default_value = 1.3
        return next(output for output in node.outputs if output.enabled)
    assert_node_as_cycles(scene, warned, build, 0.01)


@pytest.mark.parametrize("clamp", [False, True])
@pytest.mark.parametrize("kind", ['LINEAR', 'STEPPED', 'SMOOTHSTEP', 'SMOOTHERSTEP'])
def test_map_range(scene, warned, kind, clamp):
    """Frost between two values, the way most artists set it, would have others."""
    def build(tree):
        node = add_node(tree, "ShaderNodeMapRange", clamp=clamp, interpolation_type=kind)
        tree.links.new(slope(tree), node.inputs[0])
        for number, value in enumerate((-0.5, 0.8, 0.9, 0.2, 3.0), 1):
            node.inputs[number].default_value = value
        return node.outputs[0]
    assert_node_as_cycles(scene, warned, build)


@pytest.mark.parametrize("interpolation", ['LINEAR', 'CONSTANT', 'EASE', 'B_SPLINE', 'CARDINAL'])
def test_color_ramp(scene, warned, interpolation):
    """A ramp between texture and roughness would be flat, or of other colours between its stops."""
    def build(tree):
        node = add_node(tree, "ShaderNodeValToRGB")
        node.color_ramp.interpolation = interpolation
        node.color_ramp.elements.new(0.6).color = (0.9, 0.3, 0.1, 0.5)
        node.color_ramp.elements[0].position = 0.2
        tree.links.new(slope(tree, -0.2, 1.2), node.inputs[0])
        return node.outputs["Color"]
    assert_node_as_cycles(scene, warned, build)


@pytest.mark.parametrize("kind", ["ShaderNodeRGBCurve", "ShaderNodeFloatCurve"])
def test_curves(scene, warned, kind):
    """Roughness through curves would be another."""
    def build(tree):
        node = add_node(tree, kind)
        node.mapping.curves[0].points.new(0.4, 0.8)
        node.mapping.curves[-1].points.new(0.6, 0.3)
        node.inputs[0].default_value = 0.8
        tree.links.new(slope(tree, -0.3, 1.3), node.inputs[1])
        return node.outputs[0]
    assert_node_as_cycles(scene, warned, build, 0.004)


BLENDS = ['MIX', 'DARKEN', 'MULTIPLY', 'BURN', 'LIGHTEN', 'SCREEN', 'DODGE', 'ADD', 'OVERLAY', 'SOFT_LIGHT',
          'LINEAR_LIGHT', 'DIFFERENCE', 'SUBTRACT', 'DIVIDE', 'HUE', 'SATURATION', 'COLOR', 'VALUE']


@pytest.mark.parametrize("kind", ["ShaderNodeMixRGB", "ShaderNodeMix"])
@pytest.mark.parametrize("blend", BLENDS)
def test_mix_of_colors(scene, warned, kind, blend):
    """Textures that are mixed would give another roughness."""
    def build(tree):
        node = add_node(tree, kind, blend_type=blend)
        if kind == "ShaderNodeMix":
            node.data_type, node.clamp_result = 'RGBA', blend == 'ADD'
        inputs = [socket for socket in node.inputs if socket.enabled]
        inputs[0].default_value = 0.7
        inputs[2].default_value = (0.6, 0.2, 0.8, 1.0)
        tree.links.new(slope(tree, 0.05, 1.0), inputs[1])
        return next(output for output in node.outputs if output.enabled)
    assert_node_as_cycles(scene, warned, build)


@pytest.mark.parametrize("data_type, mode", [('FLOAT', 'UNIFORM'), ('VECTOR', 'UNIFORM'),
                                             ('VECTOR', 'NON_UNIFORM')])
def test_mix_of_values(scene, warned, data_type, mode):
    """As test_mix_of_colors, of numbers and vectors."""
    def build(tree):
        node = add_node(tree, "ShaderNodeMix", data_type=data_type, factor_mode=mode)
        inputs = [socket for socket in node.inputs if socket.enabled]
        tree.links.new(slope(tree, -0.2, 1.2), inputs[0])
        inputs[2].default_value = 0.8 if data_type == 'FLOAT' else (0.2, 0.9, 0.6)
        return next(output for output in node.outputs if output.enabled)
    assert_node_as_cycles(scene, warned, build)


@pytest.mark.parametrize("kind, values", [
    ("ShaderNodeInvert", {"Fac": 0.8}),
    ("ShaderNodeGamma", {"Gamma": 2.2}),
    ("ShaderNodeBrightContrast", {"Bright": 0.2, "Contrast": 0.4}),
    ("ShaderNodeRGBToBW", {}),
    ("ShaderNodeClamp", {"Min": 0.3, "Max": 0.5}),
    ("ShaderNodeClamp", {"Min": 0.6, "Max": 0.2, "clamp_type": 'RANGE'}),
    ("ShaderNodeSeparateColor", {"output": 1}),
    ("ShaderNodeSeparateXYZ", {"output": 2}),
    *(("ShaderNodeSeparateColor", {"mode": mode, "output": output}) for mode in ('HSV', 'HSL')
      for output in range(3)),
])
def test_converters(scene, warned, kind, values):
    """A converter between texture and roughness would do something else."""
    def build(tree):
        node = add_node(tree, kind, **{key: value for key, value in values.items() if key != "output"})
        color = link(tree, "ShaderNodeCombineColor", {0: slope(tree, 0.0, 1.0)}, Green=0.4, Blue=0.7)
        color = link(tree, "ShaderNodeMixRGB", {0: slope(tree, 0.0, 1.0), 1: color})
        tree.links.new(color, next(s for s in node.inputs if s.name in {"Color", "Value", "Vector"}))
        return node.outputs[values.get("output", 0)]
    assert_node_as_cycles(scene, warned, build, 0.004)


@pytest.mark.parametrize("mode", ['HSV', 'HSL'])
def test_combined_color(scene, warned, mode):
    """Colors that are combined of hue, saturation and value would give another roughness."""
    def build(tree):
        return link(tree, "ShaderNodeCombineColor", {0: slope(tree, -0.3, 1.25), 1: slope(tree, 0.2, 0.9)},
                    Blue=0.6, mode=mode)
    assert_node_as_cycles(scene, warned, build, 0.004)


def paint_colors(plane, name="Frost", domain='CORNER', data_type='FLOAT_COLOR') -> None:
    attribute = plane.data.attributes.new(name, data_type, domain)
    width = {'FLOAT': 1, 'FLOAT_VECTOR': 3}.get(data_type, 4)
    values = np.random.default_rng(3).uniform(0.1, 0.9, len(attribute.data) * width)
    attribute.data.foreach_set({1: "value", 3: "vector", 4: "color"}[width], values)


@pytest.mark.parametrize("domain", ['CORNER', 'POINT', 'FACE'])
@pytest.mark.parametrize("data_type", ['FLOAT_COLOR', 'BYTE_COLOR', 'FLOAT', 'FLOAT_VECTOR'])
@pytest.mark.parametrize("output", ["Color", "Fac", "Vector"])
def test_attribute(scene, warned, domain, data_type, output):
    """Roughness painted on vertices, or made by geometry nodes, would be missing or another."""
    if domain == 'FACE' and data_type == 'BYTE_COLOR':
        pytest.skip("Blender has none")
    plane = add_plane(textured(lambda tree: add_node(
        tree, "ShaderNodeAttribute", attribute_name="Frost").outputs[output]), cells=3)
    paint_colors(plane, "Frost", domain, data_type)
    assert_as_cycles(scene, plane, warned, 0.003)


@pytest.mark.parametrize("layer", ["", "Frost"])
def test_color_attribute_through_a_ramp(scene, warned, layer):
    """Steps that a ramp makes of painted colours would be smeared over whole faces."""
    def build(tree):
        node = add_node(tree, "ShaderNodeVertexColor", layer_name=layer)
        ramp = link(tree, "ShaderNodeValToRGB", {0: node.outputs["Color"]})
        ramp.node.color_ramp.elements[0].position, ramp.node.color_ramp.elements[1].position = 0.45, 0.5
        return ramp
    plane = add_plane(textured(build), cells=2)
    paint_colors(plane)
    assert_as_cycles(scene, plane, warned, 0.02, share=0.99)


def procedural(kind: str, coordinates: str | None = None, output: str | int = 0, **values):
    """Builds a texture that is calculated."""
    def build(tree):
        node = add_node(tree, kind, **values)
        if coordinates is not None:
            tree.links.new(add_node(tree, "ShaderNodeTexCoord").outputs[coordinates], node.inputs["Vector"])
        return node.outputs[output]
    return build


def noise_along_w(output: str = "Fac", **values):
    """As procedural(), of a noise in one dimension."""
    def build(tree):
        node = add_node(tree, "ShaderNodeTexNoise", noise_dimensions='1D', Scale=6.0, **values)
        x = link(tree, "ShaderNodeSeparateXYZ", {0: add_node(tree, "ShaderNodeTexCoord").outputs["UV"]})
        tree.links.new(x, node.inputs["W"])
        return node.outputs[output]
    return build


WAVES = [{"wave_type": 'BANDS', "bands_direction": direction, "wave_profile": profile}
         for direction, profile in (('X', 'SIN'), ('Y', 'SAW'), ('DIAGONAL', 'TRI'))]
WAVES += [{"wave_type": 'RINGS', "rings_direction": direction, "Distortion": 2.0}
          for direction in ('Y', 'SPHERICAL')]


@pytest.mark.parametrize("build, share", [
    *((procedural("ShaderNodeTexGradient", coordinates, gradient_type=kind), 0.99)
      for kind, coordinates in (('LINEAR', "Generated"), ('QUADRATIC', "Object"), ('EASING', "UV"),
                                ('DIAGONAL', None), ('RADIAL', "Object"), ('QUADRATIC_SPHERE', "Object"),
                                ('SPHERICAL', "Object"))),
    *((procedural("ShaderNodeTexWave", "UV", Scale=0.5, **values), 0.95) for values in WAVES),
    (procedural("ShaderNodeTexChecker", Scale=3.3), 0.9),
    (procedural("ShaderNodeTexChecker", "UV", "Fac", Scale=3.3), 0.9),
    (procedural("ShaderNodeTexMagic", "Object", turbulence_depth=0), 0.95),
    *((procedural("ShaderNodeTexMagic", "UV", "Fac", turbulence_depth=depth, Distortion=1.2, Scale=1.5), 0.95)
      for depth in (2, 10)),
    (procedural("ShaderNodeTexNoise", "Object", Scale=2.0, Detail=0.0), 0.99),
    (procedural("ShaderNodeTexNoise", "Object", "Color", Scale=1.5, Detail=2.5, Roughness=0.6), 0.99),
    (procedural("ShaderNodeTexNoise", "UV", Scale=3.0, Detail=1.0, Distortion=0.7), 0.97),
    (procedural("ShaderNodeTexNoise", "UV", "Color", noise_dimensions='2D', Scale=3.0, Distortion=0.3), 0.97),
    (noise_along_w(), 0.97),
    (noise_along_w("Color", Detail=1.5, Distortion=0.4), 0.97),
    (procedural("ShaderNodeTexNoise", "UV", "Color", noise_dimensions='4D', W=0.3, Scale=3.0,
                Distortion=0.3, Detail=0.5), 0.97),
    (procedural("ShaderNodeTexBrick", "UV", Scale=1.7, offset=0.3, squash=0.8, Mortar_Smooth=0.4), 0.9),
    (procedural("ShaderNodeTexBrick", None, "Fac", Scale=1.7, offset_frequency=3, squash_frequency=3), 0.9),
])
def test_procedural(scene, warned, build, share):
    """Textures that Blender calculates would be missing, or other ones than in Cycles. Edges are blurred by a
    texel of the baked texture."""
    assert_as_cycles(scene, add_plane(textured(build), cells=2), warned, 0.02, share)


@pytest.mark.parametrize("dimensions, output", [('1D', "Color"), ('2D', "Color"), ('3D', "Value"),
                                                ('3D', "Color"), ('4D', "Color")])
def test_white_noise(scene, warned, dimensions, output):
    """A random roughness for each tile or pane would be another one than in Cycles."""
    def build(tree):
        uv = add_node(tree, "ShaderNodeTexCoord").outputs["UV"]
        many = link(tree, "ShaderNodeVectorMath", {0: uv}, operation='SCALE', Scale=6.0)
        tiles = link(tree, "ShaderNodeVectorMath", {0: many}, operation='FLOOR')
        node = add_node(tree, "ShaderNodeTexWhiteNoise", noise_dimensions=dimensions)
        if dimensions == '4D':
            node.inputs["W"].default_value = 2.0
        if dimensions == '1D':
            tree.links.new(link(tree, "ShaderNodeSeparateXYZ", {0: tiles}), node.inputs["W"])
        else:
            tree.links.new(tiles, node.inputs["Vector"])
        return node.outputs[output]
    assert_as_cycles(scene, add_plane(textured(build)), warned, 0.02, 0.9)


@pytest.mark.skipif(bpy.app.version >= (4, 1, 0), reason="4.1 took the node away")
@pytest.mark.parametrize("kind, dimensions", [
    ('FBM', '2D'), ('MULTIFRACTAL', '3D'), ('HYBRID_MULTIFRACTAL', '3D'), ('RIDGED_MULTIFRACTAL', '3D'),
    ('HETERO_TERRAIN', '4D')])
def test_musgrave(scene, warned, kind, dimensions):
    """As test_procedural."""
    build = procedural("ShaderNodeTexMusgrave", "UV", musgrave_type=kind, musgrave_dimensions=dimensions,
                       Scale=3.0, Detail=2.5, Dimension=0.9, Lacunarity=1.8, Offset=0.6, Gain=1.3, W=0.2)
    assert_as_cycles(scene, add_plane(textured(build)), warned, 0.02, 0.97)


VORONOI = [('F1', "Distance", {}), ('F1', "Color", {"Randomness": 0.7}), ('F2', "Distance", {}),
           ('F2', "Position", {}), ('SMOOTH_F1', "Distance", {"Smoothness": 0.8}),
           ('SMOOTH_F1', "Color", {"Smoothness": 0.4}), ('DISTANCE_TO_EDGE', "Distance", {}),
           ('N_SPHERE_RADIUS', "Radius", {"Randomness": 0.9})]
METRICS = [('F1', "Distance", {"distance": metric, "Exponent": 0.8})
           for metric in ('MANHATTAN', 'CHEBYCHEV', 'MINKOWSKI')]


@pytest.mark.skipif(bpy.app.version >= (4, 0, 0), reason="4.0 brought octaves, which aren't supported yet")
@pytest.mark.parametrize("dimensions, feature, output, values", [
    *(('3D', *case) for case in VORONOI + METRICS), *(('2D', *case) for case in VORONOI[::2]),
    *(('4D', *case) for case in VORONOI[1::2])])
def test_voronoi(scene, warned, dimensions, feature, output, values):
    """As test_procedural."""
    build = procedural("ShaderNodeTexVoronoi", "UV", output, feature=feature, voronoi_dimensions=dimensions,
                       Scale=3.0, W=0.3, **values)
    assert_as_cycles(scene, add_plane(textured(build)), warned, 0.02, 0.9)


@pytest.mark.skipif(bpy.app.version >= (4, 0, 0), reason="4.0 brought octaves, which aren't supported yet")
@pytest.mark.parametrize("feature, output", [('F1', "Distance"), ('F2', "W"), ('SMOOTH_F1', "Color"),
                                             ('DISTANCE_TO_EDGE', "Distance"), ('N_SPHERE_RADIUS', "Radius")])
def test_voronoi_along_w(scene, warned, feature, output):
    """As test_procedural."""
    def build(tree):
        x = link(tree, "ShaderNodeSeparateXYZ", {0: add_node(tree, "ShaderNodeTexCoord").outputs["UV"]})
        node = add_node(tree, "ShaderNodeTexVoronoi", feature=feature, voronoi_dimensions='1D', Scale=5.0)
        tree.links.new(x, node.inputs["W"])
        return node.outputs[output]
    assert_as_cycles(scene, add_plane(textured(build)), warned, 0.02, 0.95)


@pytest.mark.parametrize("projection", ['BOX', 'SPHERE', 'TUBE'])
def test_projection(scene, warned, projection):
    """Images that are projected onto the object would lie elsewhere."""
    def build(tree):
        vector = add_node(tree, "ShaderNodeTexCoord").outputs["Generated"]
        moved = link(tree, "ShaderNodeMapping", {0: vector}, Location=(0.1, 0.2, 0.3),
                     Rotation=(0.3, 0.5, 0.2))
        return add_image(tree, noise_image(), moved, projection=projection, projection_blend=0.3).outputs[0]
    plane = add_plane(textured(build), cells=2)
    plane.data.vertices[4].co.z = 0.9  # so that sides blend
    for polygon in plane.data.polygons:
        polygon.use_smooth = True
    assert_as_cycles(scene, plane, warned, 0.02, 0.95)


def test_two_images_with_mappings_of_their_own(scene, warned):
    """A mask over a pattern, each repeated in its own way, would show one of them only."""
    def build(tree):
        images = [add_image(tree, noise_image(), mapped(tree, 'POINT', Scale=(scale, scale, 1))).outputs[0]
                  for scale in (0.8, 1.7)]
        return link(tree, "ShaderNodeMixRGB", {1: images[0], 2: images[1]}, blend_type='MULTIPLY', Fac=1.0)
    assert_as_cycles(scene, add_plane(textured(build)), warned, 0.02, 0.98)


@pytest.mark.parametrize("coordinates", ["Generated", "Object", "UV"])
def test_modifiers(scene, device, warned, coordinates, monkeypatch):
    """On an object that modifiers subdivide and move, frost would lie elsewhere, or crash the render."""
    plane = add_plane(textured(procedural("ShaderNodeTexGradient", coordinates)), cells=2)
    plane.modifiers.new("Subdivision", 'SUBSURF').subdivision_type = 'SIMPLE'
    displace = plane.modifiers.new("Displace", 'DISPLACE')
    displace.direction, displace.strength, displace.mid_level = 'X', 0.25, 0.0
    real, pictures = sync.scene_from, []

    def scene_from(depsgraph, warn):  # a final frame: others have moved coordinates
        pictures.append(of_verglas(plane, warned.append, depsgraph))
        return real(depsgraph, warn)
    monkeypatch.setattr(sync, "scene_from", scene_from)
    render(scene)
    truth = of_cycles(scene, plane)
    assert warned == []
    assert np.abs(pictures[0] - truth)[:, 4:].max() < 0.01  # the plane has left the picture's left side


@pytest.mark.parametrize("space", ['sRGB', 'Non-Color'])
def test_tiled_image(scene, warned, tmp_path, space):
    """Of an image in several tiles (UDIM) one would be seen everywhere, or none."""
    for number, seed in ((1012, 1), (1013, 2), (1022, 3), (1023, 4)):
        pixels = np.random.default_rng(seed).uniform(0.1, 0.9, (4, 4, 3)).astype(np.float32)
        tile = new_image(pixels, f"Tile {number}", space, is_float=False)
        tile.filepath_raw, tile.file_format = str(tmp_path / f"frost.{number}.png"), 'PNG'
        tile.save()
    image = bpy.data.images.load(str(tmp_path / "frost.1012.png"))
    image.source = 'TILED'
    image.colorspace_settings.name = space
    for label in (1013, 1022, 1023):
        if label not in {each.number for each in image.tiles}:
            image.tiles.new(label)
    material = textured(lambda tree: add_image(tree, image, interpolation='Closest').outputs[0])
    assert_as_cycles(scene, add_plane(material, uv_range=(1.05, 2.95)), warned, 0.004)


def test_tiled_image_that_is_not_saved_is_named(scene, warned):
    """Tiles that can't be read would be one value without a word."""
    image = bpy.data.images.new("Tiles", 8, 8, tiled=True)
    material = textured(lambda tree: add_image(tree, image).outputs[0], roughness=0.45)
    glass = materials.from_blender(material, warned.append)
    assert glass.roughness == pytest.approx(0.45) and glass.roughness_map is None
    assert len(warned) == 1 and "Image Texture" in warned[0] and "tile" in warned[0]


def test_two_uv_maps(scene, warned):
    """An image on another than the active UV map would lie elsewhere."""
    def build(tree):
        return add_image(tree, noise_image(),
                         add_node(tree, "ShaderNodeUVMap", uv_map="Other").outputs[0]).outputs[0]
    plane = add_plane(textured(build))
    set_uvs(plane.data, "Other", (0.2, 0.6))
    assert_as_cycles(scene, plane, warned, 0.002)


def test_group_with_a_texture(scene, warned):
    """Textures within node groups would be ignored."""
    group = new_group('ShaderNodeTree', {"Vector": 'NodeSocketVector', "Most": 'NodeSocketFloat'},
                      {"Value": 'NodeSocketFloat'})
    ends = node_of(group, "NodeGroupInput"), node_of(group, "NodeGroupOutput")
    image = add_image(group, noise_image(), ends[0].outputs["Vector"]).outputs[0]
    product = link(group, "ShaderNodeMath", {0: image, 1: ends[0].outputs["Most"]}, operation='MULTIPLY')
    group.links.new(product, ends[1].inputs["Value"])

    def build(tree):
        node = tree.nodes.new("ShaderNodeGroup")
        node.node_tree = group
        node.inputs["Most"].default_value = 0.6
        tree.links.new(mapped(tree, 'POINT', Scale=(2, 1, 1)), node.inputs["Vector"])
        return node.outputs[0]
    assert_as_cycles(scene, add_plane(textured(build)), warned, 0.002)


# Changes

@pytest.fixture
def painted(scene, monkeypatch):
    """A sphere with a painted image, and what has been read and made of meshes since: names."""
    log = []
    real_read, real_mesh = meshes.read, core.Mesh
    monkeypatch.setattr(meshes, "read", lambda evaluated: log.append("read") or real_read(evaluated))
    monkeypatch.setattr(core, "Mesh", lambda *arguments, **coordinates:
                        log.append("Mesh") or real_mesh(*arguments, **coordinates))
    image = new_image(np.full((4, 4, 3), 0.25, np.float32))
    sphere = add_sphere(textured(lambda tree: add_image(tree, image).outputs[0]))
    return image, sphere, log


def synchronised(warn=None) -> core.Scene:
    """As the viewport has it."""
    bpy.context.view_layer.update()
    return sync.scene_from(bpy.context.evaluated_depsgraph_get(), warn)


def value_of(scene: core.Scene) -> float:
    """The texture's, where all texels have the same."""
    return float(texture_of(scene).sample([(0.4, 0.6)])[0])


def paint(image: bpy.types.Image, value: float) -> None:
    """As Blender's brushes do, which tell the depsgraph of it."""
    image.pixels.foreach_set(np.full(len(image.pixels), value, np.float32))
    image.update_tag()


def test_painting_reaches_the_next_frame_without_the_mesh(painted):
    """While an artist paints frost, each stroke would export the mesh again, or not be seen."""
    image, _, log = painted
    first = synchronised()
    assert value_of(first) == pytest.approx(0.25) and log == ["read", "Mesh"]
    paint(image, 0.75)
    assert value_of(synchronised()) == pytest.approx(0.75)
    assert log == ["read", "Mesh"]


def test_an_unchanged_image_is_not_read_again(painted, monkeypatch):
    """Each change of anything in the scene would read all images again, for seconds with large ones."""
    texture = texture_of(synchronised())
    monkeypatch.setattr(images, "_pixels", lambda image: pytest.fail("read again"))
    painted[1].location.x += 1.0
    assert texture_of(synchronised()) is texture


def test_a_deformed_mesh_is_read_again(painted):
    """The viewport would show an object's old shape."""
    _, sphere, log = painted
    synchronised()
    sphere.data.vertices[0].co.z += 0.5
    sphere.data.update()
    synchronised()
    assert log == ["read", "Mesh"] * 2


def test_a_changed_node_reaches_the_next_frame(painted):
    """A slider between texture and roughness would have no effect."""
    _, sphere, log = painted
    tree = sphere.data.materials[0].node_tree
    image = node_of(tree, "ShaderNodeTexImage").outputs[0]
    half = link(tree, "ShaderNodeMath", {0: image}, operation='MULTIPLY')
    tree.links.new(half, node_of(tree, "ShaderNodeBsdfGlass").inputs["Roughness"])
    for factor in (0.5, 2.0):
        half.node.inputs[1].default_value = factor
        assert value_of(synchronised()) == pytest.approx(0.25 * factor)
    assert log == ["read", "Mesh"]


def test_pixels_that_a_script_writes_reach_the_final_frame(scene, painted, device):
    """Images that scripts make would be rendered as they were before."""
    image, _, _ = painted
    set_map(scene)
    before = render(scene).rgb
    image.pixels.foreach_set(np.full(len(image.pixels), 0.9, np.float32))
    after = render(scene).rgb
    assert np.abs(after - before).max() > 0.01


# What can't be read

def test_missing_file_is_named(scene, warned):
    """A picture with a wrong path would give another roughness without a word of where it should be."""
    def build(tree):
        node = add_image(tree, new_image(np.ones((2, 2, 3))))
        node.image.source, node.image.filepath = 'FILE', "//gone.png"
        return node.outputs[0]
    glass = materials.from_blender(textured(build, roughness=0.45), warned.append)
    assert glass.roughness == pytest.approx(0.45) and glass.roughness_map is None
    assert len(warned) == 1
    path = os.path.abspath("gone.png")
    assert all(name in warned[0] for name in ("Material 'Ice'", "Image Texture", "Frost", "'//gone.png'",
                                              f"'{path}'"))


@pytest.mark.parametrize("build, node", [
    (procedural("ShaderNodeTexImage"), "Image Texture"),
    pytest.param(procedural("ShaderNodeTexPointDensity"), "Point Density", marks=pytest.mark.skipif(
        bpy.app.version >= (5, 0, 0), reason="5.0 took the node away")),
    (procedural("ShaderNodeTexChecker", "Window"), "Texture Coordinate"),
    (image_chain(("ShaderNodeHueSaturation", {"number": 4})), bpy.types.ShaderNodeHueSaturation.bl_rna.name),
])
def test_what_cannot_be_read_is_named(scene, warned, build, node):
    """Frost would be missing with no word of which node is at fault."""
    glass = materials.from_blender(textured(build, roughness=0.45), warned.append)
    assert glass.roughness == pytest.approx(0.45) and glass.roughness_map is None
    assert len(warned) == 1 and "Material 'Ice'" in warned[0] and f"'{node}'" in warned[0]


def test_nodes_that_feed_themselves(scene, warned):
    """A loop of nodes would hang the render."""
    def build(tree):
        first, second = (add_node(tree, "ShaderNodeMath") for _ in range(2))
        tree.links.new(first.outputs[0], second.inputs[0])
        tree.links.new(second.outputs[0], first.inputs[0])
        return second.outputs[0]
    materials.from_blender(textured(build), warned.append)
    assert len(warned) <= 1


def test_mesh_without_uv_map_is_named(scene, warned):
    """A texture would be one value all over with no word of why."""
    plane = add_plane(textured(lambda tree: add_image(tree, noise_image()).outputs[0]))
    plane.data.uv_layers.remove(plane.data.uv_layers[0])
    ours, truth = of_verglas(plane, warned.append), of_cycles(scene, plane)
    assert np.abs(ours - truth).max() < 0.003
    assert len(warned) == 1 and "'Plane'" in warned[0] and "UV map" in warned[0]


def test_missing_attribute_is_named(scene, warned):
    """As without a UV map."""
    plane = add_plane(textured(procedural("ShaderNodeVertexColor", layer_name="Gone")))
    assert of_verglas(plane, warned.append) == pytest.approx(0.0)
    assert len(warned) == 1 and "'Plane'" in warned[0] and "'Gone'" in warned[0]


def test_constants_through_nodes(scene, warned):
    """Numbers that are calculated would be ignored."""
    def build(tree):
        value = add_node(tree, "ShaderNodeValue")
        value.outputs[0].default_value = 0.7
        return link(tree, "ShaderNodeMath", {0: value.outputs[0]}, operation='COSINE')
    glass = materials.from_blender(textured(build), warned.append)
    assert glass.roughness == pytest.approx(np.cos(0.7))
    assert glass.roughness_map is None and warned == []


# Whole pictures

def test_objects_that_share_a_mesh(scene, device):
    """They would show each other's frost."""
    set_map(scene)
    clear, rough = (new_image(np.full((2, 2, 3), value, np.float32)) for value in (0.05, 0.9))
    sphere = add_sphere(textured(lambda tree: add_image(tree, clear).outputs[0]), radius=0.8,
                        location=(-1.0, 0.0, 0.0))
    other = add(sphere.data, "Other", location=(1.0, 0.0, 0.0))
    other.material_slots[0].link = 'OBJECT'
    other.material_slots[0].material = textured(lambda tree: add_image(tree, rough).outputs[0])
    mixed = render(scene).rgb
    for obj, value in ((sphere, 0.05), (other, 0.9)):
        obj.material_slots[0].link = 'OBJECT'
        obj.material_slots[0].material = new_material(Roughness=value)
    assert np.abs(mixed - render(scene).rgb).max() < 0.01
    assert faults.warnings() == ()
