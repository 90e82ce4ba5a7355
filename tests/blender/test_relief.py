# SPDX-License-Identifier: GPL-3.0-or-later
"""Normal maps and bump maps: the normals that Cycles has, and what the user sees of them."""

import math

import bpy
import numpy as np
import pytest
from scenes import (
    add_camera, add_node, add_sphere, empty_scene, frosted, new_material, node_of, render, set_map, world_map,
)
from test_against_cycles import relative_mse, render_cycles
from textures import add_image, add_plane, link, new_image, set_uvs
from verglas import sync
from verglas import verglas_core as core
from verglas.sync import meshes, tangents

pytestmark = pytest.mark.usefixtures("scene")

OF_SMOOTH = 0.004 if bpy.app.version < (5, 1, 0) else 0.008
"""Error of normals that a map bends on a smooth mesh. From 5.1 on Cycles normalizes the interpolated normal
before it makes axes of it, which MikkTSpace, that maps are baked for, doesn't."""


def relief_glass(build) -> bpy.types.Material:
    """Glass with the output of nodes in its Normal."""
    material = new_material("Ice", Roughness=0.2)
    tree = material.node_tree
    tree.links.new(build(tree), node_of(tree, "ShaderNodeBsdfGlass").inputs["Normal"])
    return material


def normal_image(size: int = 16, **options) -> bpy.types.Image:
    """Smooth normals of up to 30 degrees."""
    x, y = np.meshgrid((np.arange(size) + 0.5) / size * 2 * np.pi, (np.arange(size) + 0.5) / size * 2 * np.pi)
    normals = np.stack([0.5 * np.sin(x + 0.3), 0.5 * np.sin(y + 2.0 * np.cos(x)), np.ones_like(x)], -1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return new_image((0.5 + 0.5 * normals).astype(np.float32), "Normals", **options)


def normal_map(tree, image: bpy.types.Image | None = None, strength: float = 1.0, **values):
    """values: of the Normal Map node."""
    node = add_node(tree, "ShaderNodeNormalMap", Strength=strength, **values)
    tree.links.new(add_image(tree, image or normal_image()).outputs[0], node.inputs["Color"])
    return node.outputs[0]


def bump(tree, height: bpy.types.NodeSocket, normal: bpy.types.NodeSocket | None = None, **values):
    node = add_node(tree, "ShaderNodeBump", **values)
    tree.links.new(height, node.inputs["Height"])
    if normal is not None:
        tree.links.new(normal, node.inputs["Normal"])
    return node.outputs[0]


def hills(tree, size: int = 256, **values) -> bpy.types.NodeSocket:
    """Smooth heights of an image on the UV map."""
    x, y = np.meshgrid((np.arange(size) + 0.5) / size * 2 * np.pi, (np.arange(size) + 0.5) / size * 2 * np.pi)
    heights = 0.5 + 0.2 * np.sin(2.0 * x) * np.cos(y) + 0.1 * np.sin(3.0 * y)
    image = new_image(np.repeat(heights[..., None], 3, -1).astype(np.float32), "Heights", **values)
    return add_image(tree, image).outputs[0]


def waves(tree, scale: float = 0.5) -> bpy.types.NodeSocket:
    """Heights that are no image."""
    return add_node(tree, "ShaderNodeTexWave", Scale=scale, Distortion=1.0, Detail=0.0).outputs["Fac"]


def normals_of_cycles(scene: bpy.types.Scene) -> np.ndarray:
    """(H, W, 3) of the shaders at the pixels' centres, by Cycles."""
    scene.render.engine = 'CYCLES'
    cycles = scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = 1, False, False
    cycles.pixel_filter_type, cycles.filter_width = 'BOX', 0.01
    normals = render(scene).normal
    scene.render.engine = 'VERGLAS'
    return normals


def assert_normals_as_cycles(scene, obj, tolerance: float, scale: int = 1) -> None:
    """By both devices, but at outlines. scale: of the picture; Cycles takes slopes from differences over a
    pixel. A few pixels may be beyond the tolerance: at borders of triangles and where the view is flat."""
    scene.render.resolution_percentage = 100 * scale
    truth = normals_of_cycles(scene)
    for device in ('OPENGL', 'CPU'):
        scene.verglas.device = device
        picture = render(scene)
        inside = picture.mask.copy()
        for axis, shift in ((0, 1), (0, -1), (1, 1), (1, -1)):
            inside &= np.roll(picture.mask, shift, axis)
        error = np.linalg.norm(picture.normal - truth, axis=-1)[inside]
        print(f"{device}: error up to {error.max():.4f}, mean {error.mean():.5f}; "
              f"{np.mean(error <= tolerance):.3f} within {tolerance}")
        assert inside.sum() > 300
        assert np.mean(error <= tolerance) >= 0.99
    socket = node_of(obj.data.materials[0].node_tree, "ShaderNodeBsdfGlass").inputs["Normal"]
    socket.id_data.links.remove(socket.links[0])
    assert np.linalg.norm(render(scene).normal - truth, axis=-1)[inside].max() > 0.05


def turned_plane(material, **options) -> bpy.types.Object:
    """Toward the camera, askew and stretched."""
    plane = add_plane(material, cells=3, **options)
    plane.rotation_euler = (math.radians(70), math.radians(10), math.radians(25))
    plane.scale = (1.3, 0.8, 1.0)
    return plane


@pytest.mark.parametrize("strength", [0.4, 1.0, 2.0])
@pytest.mark.parametrize("space", ['TANGENT', 'OBJECT', 'WORLD', 'BLENDER_OBJECT', 'BLENDER_WORLD'])
def test_normal_map(scene, space, strength):
    """A normal map would bend light otherwise than in Cycles: turned, too weak or too strong."""
    plane = turned_plane(relief_glass(lambda tree: normal_map(tree, strength=strength, space=space)))
    assert_normals_as_cycles(scene, plane, 0.004)


@pytest.mark.skipif(bpy.app.version < (5, 1, 0), reason="5.1 brought it")
def test_directx_convention(scene):
    """Normal maps of games would have dents for bumps."""
    plane = turned_plane(relief_glass(lambda tree: normal_map(tree, convention='DIRECTX')))
    assert_normals_as_cycles(scene, plane, 0.004)


@pytest.mark.parametrize("shape", ["sphere", "flat sphere", "mirrored sphere", "mirrored coordinates"])
def test_normal_map_on_shapes(scene, shape):
    """Normal maps would turn at seams, on flat faces, or on mirrored halves of a model."""
    sphere = add_sphere(relief_glass(lambda tree: normal_map(tree, uv_map="UVMap")), 24, 12)
    sphere.rotation_euler = (0.5, 0.3, 1.0)
    if shape == "flat sphere":
        sphere.data.polygons.foreach_set("use_smooth", np.zeros(len(sphere.data.polygons), bool))
    elif shape == "mirrored sphere":
        sphere.scale = (-1.0, 0.9, 1.1)
    elif shape == "mirrored coordinates":
        for loop in sphere.data.uv_layers[0].data:
            loop.uv.x = abs(2.0 * loop.uv.x - 1.0)
    assert_normals_as_cycles(scene, sphere, OF_SMOOTH)


@pytest.mark.parametrize("options", [
    {"interpolation": 'Closest'}, {"extension": 'CLIP'}, {"extension": 'EXTEND'}, {"space": 'sRGB'}], ids=str)
def test_image_of_a_normal_map(scene, options):
    """A normal map's image would be read otherwise than Cycles reads it."""
    space = options.pop("space", 'Non-Color')

    def build(tree):
        output = normal_map(tree, normal_image(space=space, is_float=space != 'sRGB'))
        for name, value in options.items():
            setattr(node_of(tree, "ShaderNodeTexImage"), name, value)
        return output
    assert_normals_as_cycles(scene, turned_plane(relief_glass(build), uv_range=(-0.3, 1.4)), 0.004)


def test_tangents_of_another_uv_map(scene):
    """Normal maps on a second UV map would be turned."""
    def build(tree):
        output = normal_map(tree, uv_map="Second")
        uv = add_node(tree, "ShaderNodeUVMap", uv_map="Second").outputs[0]
        tree.links.new(uv, node_of(tree, "ShaderNodeTexImage").inputs["Vector"])
        return output
    plane = turned_plane(relief_glass(build))
    set_uvs(plane.data, "Second", (0.0, 1.0))
    for loop in plane.data.uv_layers["Second"].data:
        loop.uv = (0.8 * loop.uv.y, 0.3 - loop.uv.x)
    assert_normals_as_cycles(scene, plane, 0.004)


@pytest.mark.parametrize("values", [
    {"Strength": 1.0, "Distance": 0.2}, {"Strength": 0.5, "Distance": 0.4},
    {"Strength": 1.0, "Distance": 0.2, "invert": True}], ids=str)
@pytest.mark.parametrize("shape", ["plane", "sphere"])
def test_bump_map_of_an_image(scene, shape, values):
    """Bumps would be shallower or deeper than in Cycles, or dents."""
    material = relief_glass(lambda tree: bump(tree, hills(tree), **values))
    obj = turned_plane(material) if shape == "plane" else add_sphere(material, 64, 32)
    assert_normals_as_cycles(scene, obj, 0.02, scale=6)


@pytest.mark.parametrize("source", ["waves", "noise", "ramp of waves", "attribute", "ramp of an image"])
@pytest.mark.parametrize("shape", ["plane", "sphere"])
def test_bump_map_of_nodes(scene, shape, source):
    """Bumps of procedural textures would be missing, or show the triangles that they are baked for."""
    def heights(tree):
        if source == "noise":
            return add_node(tree, "ShaderNodeTexNoise", Scale=3.0, Detail=0.0).outputs["Fac"]
        if source == "attribute":
            return add_node(tree, "ShaderNodeAttribute", attribute_name="Slope").outputs["Fac"]
        if source == "waves":
            return waves(tree)
        ramped = waves(tree) if source == "ramp of waves" else hills(tree)
        return link(tree, "ShaderNodeValToRGB", {0: ramped})
    material = relief_glass(lambda tree: bump(tree, heights(tree), Strength=1.0, Distance=0.1))
    obj = turned_plane(material) if shape == "plane" else add_sphere(material, 64, 32)
    attribute = obj.data.attributes.new("Slope", 'FLOAT', 'POINT')
    attribute.data.foreach_set("value", np.random.default_rng(1).uniform(0, 0.4, len(obj.data.vertices)))
    assert_normals_as_cycles(scene, obj, 0.02, scale=6)


def test_bumps_on_a_normal_map(scene):
    """Fine bumps on a coarse relief would replace it, or be left out."""
    material = relief_glass(
        lambda tree: bump(tree, hills(tree), normal_map(tree), Strength=1.0, Distance=0.2))
    assert_normals_as_cycles(scene, turned_plane(material), 0.02, scale=6)


def synchronised(warn=None) -> core.Scene:
    """As the viewport has it."""
    bpy.context.view_layer.update()
    return sync.scene_from(bpy.context.evaluated_depsgraph_get(), warn)


@pytest.fixture
def exported(monkeypatch) -> list[core.Mesh]:
    """Meshes that the core has got."""
    log = []
    real = core.Mesh
    monkeypatch.setattr(core, "Mesh", lambda *arguments, **coordinates:
                        log.append(real(*arguments, **coordinates)) or log[-1])
    return log


def test_tangents_are_blenders(scene):
    """Normal maps that were baked in Blender or elsewhere would show seams."""
    sphere = add_sphere(new_material(), 24, 12)
    mesh = sphere.data
    loops = np.random.default_rng(3).uniform(-0.02, 0.02, (len(mesh.loops), 2)).astype(np.float32)
    for loop, shift in zip(mesh.uv_layers[0].data, loops):  # UVs of their own at every corner
        loop.uv = (loop.uv.x + shift[0], loop.uv.y + shift[1])
    modifier = sphere.modifiers.new("Triangles", 'TRIANGULATE')
    modifier.quad_method = 'FIXED'
    evaluated = sphere.evaluated_get(bpy.context.evaluated_depsgraph_get())
    surface = meshes.Surface(evaluated, meshes.read(evaluated), 0, pytest.fail)
    ours = tangents.of_surface(surface, "")
    whole = evaluated.to_mesh()
    whole.calc_tangents()
    truth = np.array([(*loop.tangent, loop.bitangent_sign) for loop in whole.loops]).reshape(-1, 3, 4)
    evaluated.to_mesh_clear()
    assert (ours[..., 3] == truth[..., 3]).all()
    assert ours[..., :3] == pytest.approx(truth[..., :3], abs=1e-3)


def test_a_mesh_without_normal_map_has_no_tangents(exported):
    """All meshes would take twice the memory and time to export."""
    add_sphere(new_material())
    add_sphere(relief_glass(lambda tree: bump(tree, waves(tree))))
    add_sphere(relief_glass(lambda tree: normal_map(tree, space='OBJECT')))
    synchronised(pytest.fail)
    assert len(exported) == 3 and not any(mesh.has_tangents for mesh in exported)
    add_sphere(relief_glass(normal_map), 16, 8)
    synchronised(pytest.fail)
    assert exported[-1].has_tangents


@pytest.mark.parametrize("uv_map", ["", "Lost"])
def test_missing_uv_map_is_named(scene, device, warned, uv_map):
    """A normal map on a mesh without its UV map would be left out with no word of it, or end the render."""
    sphere = add_sphere(relief_glass(lambda tree: normal_map(tree, uv_map=uv_map)))
    sphere.data.uv_layers.remove(sphere.data.uv_layers[0])
    material, = synchronised(warned.append).materials
    assert material.normal_map.texture is None
    assert len(warned) == 1 and f"Object '{sphere.name}'" in warned[0] and "material 'Ice'" in warned[0]
    assert render(scene).mask.any()


def test_painting_a_normal_map_reaches_the_next_frame_without_the_mesh(scene, device, exported):
    """Each stroke would export the mesh again, or not be seen."""
    image = new_image(np.broadcast_to(np.float32([0.5, 0.5, 1.0]), (8, 8, 3)))
    add_sphere(relief_glass(lambda tree: normal_map(tree, image)))
    first = synchronised().materials[0].normal_map.texture
    pixels = np.ones((8, 8, 4), np.float32)
    pixels[..., :3] = (0.8, 0.4, 0.9)
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.update_tag()
    assert synchronised().materials[0].normal_map.texture is not first
    assert len(exported) == 1
    before = render(scene).normal
    pixels[..., 0] = 0.2
    image.pixels.foreach_set(pixels.ravel())
    assert np.abs(render(scene).normal - before).max() > 0.1


def test_tangents_follow_a_deformed_mesh(scene, exported):
    """Normal maps of characters and cloth would stay behind."""
    sphere = add_sphere(relief_glass(normal_map), 24, 12)
    synchronised()
    twist = sphere.modifiers.new("Twist", 'SIMPLE_DEFORM')
    twist.deform_method, twist.angle, twist.deform_axis = 'TWIST', 1.5, 'Z'
    assert_normals_as_cycles(scene, sphere, OF_SMOOTH)
    assert len(exported) == 3  # before, for the viewport and for the frames


def relief_scene(kind: str, shape: str) -> bpy.types.Scene:
    """Refraction BSDF with a relief that shows, in a forest."""
    scene = empty_scene()
    add_camera(scene)
    set_map(scene, world_map("forest"))
    material = frosted(0.2)
    tree = material.node_tree
    source = (normal_map(tree, normal_image(64), strength=0.5) if kind == "normal map" else
              bump(tree, waves(tree, 0.4), Strength=1.0, Distance=0.1))
    tree.links.new(source, node_of(tree, "ShaderNodeBsdfRefraction").inputs["Normal"])
    if shape == "sphere":
        add_sphere(material, 64, 32)
    else:
        bpy.ops.mesh.primitive_cube_add(size=2, scale=(1.2, 0.3, 1.0), rotation=(0.2, 0.0, 0.4))
        bpy.context.object.data.materials.append(material)
    scene.render.resolution_x = scene.render.resolution_y = 64
    scene.verglas.tir = 'NONE'
    scene.verglas.samples = 16
    return scene


@pytest.mark.parametrize("shape", ["sphere", "slab"])
@pytest.mark.parametrize("kind", ["normal map", "bump map"])
def test_picture_as_cycles(kind, shape):
    """Glass with relief would not look as in Cycles."""
    scene = relief_scene(kind, shape)
    truth, _ = render_cycles(scene, 128)
    for device, bound in (('CPU', 0.02), ('OPENGL', 0.03)):
        scene.verglas.device = device
        picture = render(scene)
        error = relative_mse(picture.rgb, truth.rgb, picture.mask)
        brightness = picture.rgb[picture.mask].mean() / truth.rgb[picture.mask].mean()
        print(f"{kind}, {shape}, {device}: relative MSE {error:.4f}, brightness {brightness:.3f}")
        assert error <= bound
        assert brightness == pytest.approx(1.0, abs=0.03)
