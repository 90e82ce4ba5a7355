# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's materials as the core gets them."""

import bpy
import numpy as np
import pytest
from scenes import (
    add_absorption, add_monkey, add_node, new_group, new_material, node_of, render, set_background,
)
from verglas import compat, faults
from verglas.sync import materials

pytestmark = pytest.mark.usefixtures("scene")

RED = (0.8, 0.2, 0.1, 1.0)
PRINCIPLED = "ShaderNodeBsdfPrincipled"


def principled(**inputs) -> bpy.types.Material:
    """Principled BSDF that transmits all, with the transmission input's name of this version."""
    material = new_material("Ice", PRINCIPLED)
    node = node_of(material.node_tree, PRINCIPLED)
    transmission = next(name for name in compat.TRANSMISSION if name in node.inputs)
    node.inputs[transmission].default_value = 1.0
    for name, value in inputs.items():
        node.inputs[name.replace("_", " ")].default_value = value
    return material


def test_glass_bsdf(warned):
    """Roughness, IOR, colour or distribution of a Glass BSDF would be ignored."""
    material = new_material(distribution='GGX', Roughness=0.4, IOR=1.33, Color=RED)
    glass = materials.from_blender(material, warned.append)
    assert glass.ndf == 'GGX' and glass.fresnel
    assert glass.roughness == pytest.approx(0.4) and glass.ior == pytest.approx(1.33)
    assert np.allclose(glass.color, RED[:3]) and np.allclose(glass.reflection_color, RED[:3])
    assert np.allclose(glass.absorption, 0.0)
    assert warned == []


def test_refraction_bsdf(warned):
    """A Refraction BSDF would get a Fresnel factor that Cycles doesn't give it."""
    material = new_material("Ice", "ShaderNodeBsdfRefraction", distribution='BECKMANN',
                            Roughness=0.55, Color=RED)
    glass = materials.from_blender(material, warned.append)
    assert glass.ndf == 'BECKMANN' and not glass.fresnel
    assert glass.roughness == pytest.approx(0.55)
    assert np.allclose(glass.color, RED[:3])
    assert warned == []


def test_principled_bsdf_tints_as_cycles_does(warned):
    """Coloured Principled glass would be too dark or too pale, or its reflection tinted."""
    glass = materials.from_blender(principled(Base_Color=RED, Roughness=0.3, IOR=1.4), warned.append)
    refracted = RED[:3] if bpy.app.version < (4, 0, 0) else np.sqrt(RED[:3])
    assert glass.ndf == 'GGX' and glass.fresnel
    assert glass.roughness == pytest.approx(0.3) and glass.ior == pytest.approx(1.4)
    assert np.allclose(glass.color, refracted, atol=1e-6)
    assert np.allclose(glass.reflection_color, 1.0)
    assert warned == []


@pytest.mark.skipif(bpy.app.version >= (4, 0, 0), reason="4.0 has no Transmission Roughness")
def test_principled_transmission_roughness(warned):
    """Principled glass with Transmission Roughness would look clearer than in Cycles."""
    material = principled(Roughness=0.2, Transmission_Roughness=0.5)
    node_of(material.node_tree, PRINCIPLED).distribution = 'GGX'
    assert materials.from_blender(material, warned.append).roughness == pytest.approx(0.6)


def test_partly_transmissive_principled_is_named(warned):
    """A half-transparent material would look wrong with no word of why."""
    material = principled(Metallic=0.25, Alpha=0.5)
    assert materials.from_blender(material, warned.append) is not None
    assert len(warned) == 2
    assert all("Material 'Ice'" in text and "Principled BSDF" in text for text in warned)
    assert "75%" in warned[0] and "Alpha" in warned[1]


@pytest.mark.parametrize("node", ["ShaderNodeBsdfDiffuse", PRINCIPLED, "ShaderNodeEmission", None])
def test_material_without_glass(node, warned):
    """An opaque object would be drawn as glass."""
    assert materials.from_blender(new_material(node=node), warned.append) is None


def test_multiscatter_is_ggx(warned):
    """Glass with Blender's default distribution of older files couldn't be rendered."""
    glass = materials.from_blender(new_material(distribution='MULTI_GGX', Roughness=0.4), warned.append)
    assert glass.ndf == 'GGX' and glass.roughness == pytest.approx(0.4)


@pytest.mark.skipif(bpy.app.version >= (4, 0, 0), reason="4.0 has no Sharp")
def test_sharp_has_no_roughness(warned):
    """Clear glass would come out frosted."""
    glass = materials.from_blender(new_material(distribution='SHARP', Roughness=0.4), warned.append)
    assert glass.roughness == 0.0


def test_value_and_color_nodes(warned):
    """Values that come from Value and RGB nodes would be ignored."""
    material = new_material()
    tree = material.node_tree
    glass = node_of(tree, "ShaderNodeBsdfGlass")
    value, color, reroute = (tree.nodes.new(n) for n in ("ShaderNodeValue", "ShaderNodeRGB", "NodeReroute"))
    value.outputs[0].default_value = 0.7
    color.outputs[0].default_value = RED
    tree.links.new(value.outputs[0], reroute.inputs[0])
    tree.links.new(reroute.outputs[0], glass.inputs["Roughness"])
    tree.links.new(color.outputs[0], glass.inputs["Color"])
    read = materials.from_blender(material, warned.append)
    assert read.roughness == pytest.approx(0.7) and np.allclose(read.color, RED[:3])
    assert warned == []


def test_group_with_inputs(warned):
    """Glass inside a node group, with the group's inputs, would be lost."""
    group = new_group('ShaderNodeTree', {"Rough": 'NodeSocketFloat'}, {"Shader": 'NodeSocketShader'})
    shader = add_node(group, "ShaderNodeBsdfRefraction", IOR=1.2)
    group.links.new(node_of(group, "NodeGroupInput").outputs["Rough"], shader.inputs["Roughness"])
    group.links.new(shader.outputs[0], node_of(group, "NodeGroupOutput").inputs["Shader"])

    material = new_material(node=None)
    tree = material.node_tree
    outer = tree.nodes.new("ShaderNodeGroup")
    outer.node_tree = group
    outer.inputs["Rough"].default_value = 0.35
    tree.links.new(outer.outputs[0], node_of(tree, "ShaderNodeOutputMaterial").inputs["Surface"])
    glass = materials.from_blender(material, warned.append)
    assert glass.roughness == pytest.approx(0.35) and glass.ior == pytest.approx(1.2)
    value = tree.nodes.new("ShaderNodeValue")
    value.outputs[0].default_value = 0.9
    tree.links.new(value.outputs[0], outer.inputs["Rough"])
    assert materials.from_blender(material, warned.append).roughness == pytest.approx(0.9)
    assert warned == []


def test_node_that_cannot_be_read_is_named(warned):
    """A roughness that comes from such a node would be ignored silently."""
    material = new_material("Ice", Roughness=0.45)
    tree = material.node_tree
    weight = tree.nodes.new("ShaderNodeLayerWeight")
    tree.links.new(weight.outputs[0], node_of(tree, "ShaderNodeBsdfGlass").inputs["Roughness"])
    assert materials.from_blender(material, warned.append).roughness == pytest.approx(0.45)
    assert len(warned) == 1
    assert all(name in warned[0] for name in ("Material 'Ice'", "Glass BSDF", "Roughness", "Layer Weight"))


def test_mixed_shaders_are_named(warned):
    """Glass mixed with another shader would vanish, or its mixing be ignored silently."""
    material = new_material("Ice", Roughness=0.45)
    tree = material.node_tree
    mix, diffuse = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(diffuse.outputs[0], mix.inputs[1])
    tree.links.new(node_of(tree, "ShaderNodeBsdfGlass").outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], node_of(tree, "ShaderNodeOutputMaterial").inputs["Surface"])
    assert materials.from_blender(material, warned.append).roughness == pytest.approx(0.45)
    assert len(warned) == 1
    assert all(name in warned[0] for name in ("Material 'Ice'", "Mix Shader", "Diffuse BSDF"))


def test_muted_mix_passes_glass_through(warned):
    """Muting a node would take effect in Cycles and not here."""
    material = new_material(Roughness=0.45)
    tree = material.node_tree
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(node_of(tree, "ShaderNodeBsdfGlass").outputs[0], mix.inputs[1])
    tree.links.new(mix.outputs[0], node_of(tree, "ShaderNodeOutputMaterial").inputs["Surface"])
    mix.mute = True
    assert materials.from_blender(material, warned.append).roughness == pytest.approx(0.45)
    assert warned == []


def test_output_of_cycles_wins(warned):
    """A file with outputs for several engines would render the wrong one."""
    material = new_material(Roughness=0.1)
    tree = material.node_tree
    node_of(tree, "ShaderNodeOutputMaterial").target = 'EEVEE'
    assert materials.from_blender(material, warned.append).roughness == pytest.approx(0.1)
    output = add_node(tree, "ShaderNodeOutputMaterial", target='CYCLES')
    shader = add_node(tree, "ShaderNodeBsdfGlass", Roughness=0.6)
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    assert materials.from_blender(material, warned.append).roughness == pytest.approx(0.6)


def test_volume_absorption(warned):
    """Tinted glass would be clear, or of another depth of colour than in Cycles."""
    material = add_absorption(new_material(), (0.5, 1.0, 0.0), density=2.0)
    material.verglas.absorption_density = 9.0
    assert np.allclose(materials.from_blender(material, warned.append).absorption, (1.0, 0.0, 2.0))
    assert warned == []


def test_other_volumes_are_named(warned):
    """Scattering inside would be left out silently."""
    material = new_material("Milk")
    tree = material.node_tree
    scatter = tree.nodes.new("ShaderNodeVolumeScatter")
    tree.links.new(scatter.outputs[0], node_of(tree, "ShaderNodeOutputMaterial").inputs["Volume"])
    assert np.allclose(materials.from_blender(material, warned.append).absorption, 0.0)
    assert len(warned) == 1 and "Material 'Milk'" in warned[0] and "Volume Scatter" in warned[0]


def test_panel(warned):
    """The settings of the Verglas material panel would have no effect."""
    material = new_material()
    material.verglas.ndf = 'BLINN_PHONG'
    material.verglas.absorption_color = (0.25, 0.5, 1.0)
    material.verglas.absorption_density = 4.0
    material.verglas.priority = 3
    glass = materials.from_blender(material, warned.append)
    assert glass.ndf == 'BLINN_PHONG'
    assert np.allclose(glass.absorption, (3.0, 2.0, 0.0))
    assert glass.priority == 3


@pytest.mark.parametrize("ior, expected", [(10.0, 3.0), (0.1, 1.0 / 3.0)])
def test_ior_beyond_the_tables_is_named(ior, expected, warned):
    """An extreme index would render as another with no word of it."""
    glass = materials.from_blender(new_material("Ice", IOR=ior), warned.append)
    assert glass.ior == pytest.approx(expected, rel=1e-5)
    assert len(warned) == 1 and "Material 'Ice'" in warned[0] and "IOR" in warned[0]


def test_other_normals_and_displacement_are_named(warned):
    """Bumps would be missing from the picture silently."""
    material = new_material("Ice")
    tree = material.node_tree
    bevel, displacement = tree.nodes.new("ShaderNodeBevel"), tree.nodes.new("ShaderNodeDisplacement")
    tree.links.new(bevel.outputs[0], node_of(tree, "ShaderNodeBsdfGlass").inputs["Normal"])
    tree.links.new(displacement.outputs[0], node_of(tree, "ShaderNodeOutputMaterial").inputs["Displacement"])
    assert materials.from_blender(material, warned.append) is not None
    assert len(warned) == 2
    assert "'Bevel'" in warned[0] and "Normal" in warned[0] and "Displacement" in warned[1]


@pytest.mark.skipif(bpy.app.version >= (5, 0, 0), reason="from 5.0 all materials use nodes")
def test_material_without_nodes_is_named(warned):
    """A material without nodes would leave a hole, or be replaced silently."""
    material = bpy.data.materials.new("Plain")
    glass = materials.from_blender(material, warned.append)
    assert glass.roughness == 0.25 and glass.ior == 1.5
    assert len(warned) == 1 and "Material 'Plain'" in warned[0]


def test_material_override(scene):
    """The view layer's material override would be ignored."""
    set_background(scene)
    add_monkey(new_material("Opaque", "ShaderNodeBsdfDiffuse"))
    scene.view_layers[0].material_override = new_material("Override")
    assert render(scene).mask.any()
    assert faults.warnings() == ()


def test_each_slot_has_its_material(scene):
    """A mesh with several materials would render with one of them, or not at all."""
    set_background(scene)
    monkey = add_monkey(new_material("Red", "ShaderNodeBsdfRefraction", Color=(1, 0, 0, 1)))
    monkey.data.materials.append(new_material("Opaque", "ShaderNodeBsdfDiffuse"))
    monkey.data.materials.append(new_material("Green", "ShaderNodeBsdfRefraction", Color=(0, 1, 0, 1)))
    centers = np.empty(3 * len(monkey.data.polygons), np.float32)
    monkey.data.polygons.foreach_get("center", centers)
    slots = np.digitize(centers.reshape(-1, 3)[:, 0], (-0.4, 0.4))
    monkey.data.polygons.foreach_set("material_index", slots)
    picture = render(scene)
    left, right = picture.rgb[:, :24], picture.rgb[:, 40:]
    left_mask, right_mask = picture.mask[:, :24], picture.mask[:, 40:]
    assert left[left_mask][:, 1].max() < 0.05 < left[left_mask][:, 0].mean()
    assert right[right_mask][:, 0].max() < 0.05 < right[right_mask][:, 1].mean()
    assert len(faults.warnings()) == 1
    assert "'Suzanne'" in faults.warnings()[0] and "'Opaque'" in faults.warnings()[0]
