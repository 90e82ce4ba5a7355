# SPDX-License-Identifier: GPL-3.0-or-later
"""Input that can't be rendered as it is: a picture or one clear message, never a crash.

Missing and corrupt map files are tested with the world, panoramas with the camera.
"""

import bpy
import numpy as np
import pytest
from scenes import (
    add, add_monkey, add_sphere, frosted, new_material, node_of, render, set_background, set_map,
)
from verglas import faults


by_each_device = pytest.mark.usefixtures("device")


@pytest.fixture
def lit(scene, device) -> bpy.types.Scene:
    """By each device."""
    set_background(scene)
    return scene


def mesh_of(name: str, vertices, faces) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(frosted())
    return add(mesh, name)


def test_no_camera(lit):
    """A scene without a camera would crash, or fail without saying why."""
    lit.camera = None
    with pytest.raises(RuntimeError, match="(?i)no camera"):
        bpy.ops.render.render()


def test_empty_scene(lit):
    """A scene without objects would give no picture at all."""
    assert np.allclose(render(lit).rgb, 1.0)
    assert faults.warnings() == ()


def test_empty_mesh(lit):
    """An empty mesh, as generators leave them, would crash or spoil the picture."""
    mesh_of("Empty", [], [])
    mesh_of("Loose Vertices", [(0, 0, 0), (1, 0, 0)], [])
    picture = render(lit)
    assert not picture.mask.any() and np.allclose(picture.rgb, 1.0)
    assert faults.warnings() == ()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_vertices_that_are_no_numbers(lit, bad):
    """One broken vertex would blacken the picture, or crash, with no word of the object."""
    sphere = add_sphere(frosted())
    sphere.name = "Ball"
    positions = np.empty(3 * len(sphere.data.vertices), np.float32)
    sphere.data.vertices.foreach_get("co", positions)
    positions[30] = bad
    sphere.data.vertices.foreach_set("co", positions)
    picture = render(lit)
    assert np.isfinite(picture.combined).all() and np.isfinite(picture.normal).all()
    assert picture.mask.sum() > 200
    assert len(faults.warnings()) == 1 and "Object 'Ball' (mesh 'Sphere'): " in faults.warnings()[0]


def test_faces_without_area(lit):
    """Degenerate faces would leave black or missing pixels without a word."""
    add_sphere(frosted())
    mesh_of("Degenerate", [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, -1.5, 0)], [(0, 1, 2), (0, 1, 3)])
    picture = render(lit)
    assert np.isfinite(picture.combined).all()
    assert len(faults.warnings()) == 1 and "Object 'Degenerate': " in faults.warnings()[0]


def test_no_material(lit):
    """An object without material would be missing, or replaced silently."""
    add_sphere(None)
    picture = render(lit)
    assert picture.mask.any()
    assert len(faults.warnings()) == 1
    assert "'Sphere'" in faults.warnings()[0] and "no material" in faults.warnings()[0]


def test_empty_material_slot(lit):
    """An empty slot would crash, or be replaced silently."""
    sphere = add_sphere(None)
    sphere.data.materials.append(None)
    assert render(lit).mask.any()
    assert len(faults.warnings()) == 1 and "'Sphere'" in faults.warnings()[0]


def test_opaque_object_is_left_out(lit):
    """An opaque object would be missing without a word."""
    add_sphere(new_material("Clay", "ShaderNodeBsdfDiffuse"))
    assert not render(lit).mask.any()
    assert len(faults.warnings()) == 1
    assert "'Sphere'" in faults.warnings()[0] and "'Clay'" in faults.warnings()[0]


@pytest.mark.parametrize("scale", [(0, 0, 0), (1, 1, 0)])
def test_scaled_to_nothing(lit, scale):
    """An object scaled to nothing, as animations hide things, would crash or leave specks."""
    add_sphere(frosted()).scale = scale
    assert np.isfinite(render(lit).combined).all()
    assert len(faults.warnings()) == 1 and "'Sphere'" in faults.warnings()[0]


@by_each_device
@pytest.mark.parametrize("node", ["ShaderNodeBsdfGlass", "ShaderNodeBsdfRefraction"])
@pytest.mark.parametrize("roughness", [0.0, 1.0])
@pytest.mark.parametrize("ior", [1.0, 1.5])
def test_extreme_materials(scene, node, roughness, ior):
    """Clear glass, the roughest glass, or glass that doesn't refract would come out black or broken."""
    set_map(scene)
    add_monkey(new_material("Extreme", node, distribution='BECKMANN', Roughness=roughness, IOR=ior))
    picture = render(scene)
    assert picture.mask.any() and np.isfinite(picture.combined).all()
    inside, outside = picture.rgb[picture.mask], picture.rgb[~picture.mask]
    assert inside.min() >= 0.0 and inside.mean() > 0.2 * outside.mean()
    assert faults.warnings() == ()


@by_each_device
def test_clear_glass_without_refraction_is_invisible(scene):
    """Glass of IOR 1 and roughness 0 must show exactly what is behind it."""
    set_map(scene)
    background = render(scene).rgb
    add_sphere(frosted(roughness=0.0, ior=1.0))
    picture = render(scene)
    error = np.abs(picture.rgb - background)[picture.mask]
    assert error.mean() < 0.03 * background.mean()


def test_smallest_picture(lit):
    """A 1 x 1 picture, as thumbnails and tests make them, would crash."""
    add_sphere(frosted())
    lit.render.resolution_x = lit.render.resolution_y = 4
    lit.render.resolution_percentage = 25
    picture = render(lit)
    assert picture.combined.shape == (1, 1, 4) and picture.mask.all()


@pytest.mark.parametrize("size", [4096, pytest.param(8192, marks=pytest.mark.slow)])
def test_large_picture(scene, size):
    """A picture for print would crash for lack of memory in the driver."""
    set_background(scene)
    add_sphere(frosted())
    scene.render.resolution_x = scene.render.resolution_y = size
    result = bpy.ops.render.render()
    assert result == {'FINISHED'}
    assert faults.warnings() == ()


def test_shader_loop(lit):
    """A shader that feeds itself, which Blender allows to build, would hang the render."""
    material = new_material("Loop")
    tree = material.node_tree
    first, second = tree.nodes.new("ShaderNodeAddShader"), tree.nodes.new("ShaderNodeAddShader")
    tree.links.new(first.outputs[0], second.inputs[0])
    tree.links.new(second.outputs[0], first.inputs[0])
    tree.links.new(node_of(tree, "ShaderNodeBsdfGlass").outputs[0], first.inputs[1])
    tree.links.new(second.outputs[0], node_of(tree, "ShaderNodeOutputMaterial").inputs["Surface"])
    add_sphere(material)
    render(lit)
    assert all("'Loop'" in text for text in faults.warnings())
