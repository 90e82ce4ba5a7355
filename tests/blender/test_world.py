# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's world as the core gets it."""

import math
import shutil

import bpy
import numpy as np
import pytest
from scenes import (
    add, add_mapping, add_monkey, add_node, frosted, node_of, render, sample_map, set_background, set_map,
    world_map,
)
from verglas import faults, sync
from verglas.sync import world

MAGENTA = (1.0, 0.0, 1.0)


@pytest.fixture
def read(scene, warned):
    """A function that reads the scene's world into a core scene."""
    def read_world():
        core_scene = sync.core.Scene()
        world.set_environment(core_scene, scene.world, warned.append)
        return core_scene
    return read_world


def test_background(scene, read, warned):
    """A plain world would be black or of another brightness."""
    set_background(scene, (0.5, 0.25, 1.0), 3.0)
    environment = read()
    assert environment.environment_map is None
    assert np.allclose(environment.environment_color, (1.5, 0.75, 3.0))
    assert warned == []


def test_linked_strength(scene, read, warned):
    """A strength or colour that comes from a node would be ignored."""
    background = set_background(scene, (0, 0, 0))
    tree = scene.world.node_tree
    value, color = tree.nodes.new("ShaderNodeValue"), tree.nodes.new("ShaderNodeRGB")
    value.outputs[0].default_value = 2.0
    color.outputs[0].default_value = (0.5, 1.0, 0.25, 1.0)
    tree.links.new(value.outputs[0], background.inputs["Strength"])
    tree.links.new(color.outputs[0], background.inputs["Color"])
    assert np.allclose(read().environment_color, (1.0, 2.0, 0.5))
    assert warned == []


@pytest.mark.skipif(bpy.app.version >= (5, 0, 0), reason="from 5.0 all worlds use nodes")
def test_world_without_nodes(scene, read, warned):
    """A world without nodes would be black."""
    scene.world.color = (0.1, 0.2, 0.3)
    assert np.allclose(read().environment_color, (0.1, 0.2, 0.3))


def test_no_world_is_said(scene, read, warned):
    """A black picture would come without a reason."""
    scene.world = None
    assert np.allclose(read().environment_color, 0.0)
    assert len(warned) == 1 and "no world" in warned[0]


def test_environment_texture(scene, read, warned):
    """The HDR map would be missing, or its strength ignored."""
    set_map(scene, strength=2.5)
    environment = read()
    assert (environment.environment_map.width, environment.environment_map.height) == (64, 32)
    assert np.allclose(environment.environment_color, 2.5)
    assert np.allclose(environment.environment_rotation, np.eye(3))
    assert warned == []


def test_map_is_read_once(scene, read):
    """Every frame of an animation would read and filter the map anew."""
    texture = set_map(scene)
    first = read().environment_map
    assert read().environment_map is first
    texture.image.pack()
    packed = read().environment_map
    assert read().environment_map is packed


def test_changed_map_is_read_again(scene, read, tmp_path):
    """A map that was painted over would stay the old one."""
    path = tmp_path / "map.exr"
    shutil.copy(sample_map(), path)
    set_map(scene, str(path))
    first = read().environment_map
    shutil.copy(world_map("city"), path)
    assert read().environment_map is not first


@pytest.mark.parametrize("kind, inverse", [
    ('POINT', False), ('VECTOR', False), ('NORMAL', False), ('TEXTURE', True),
])
def test_rotation(scene, read, warned, kind, inverse):
    """A turned map would stand still, or turn the other way."""
    add_mapping(scene, set_map(scene), rotation=(0.0, 0.0, math.radians(90)), kind=kind)
    turned = read().environment_rotation @ (1.0, 0.0, 0.0)
    assert np.allclose(turned, (0.0, -1.0 if inverse else 1.0, 0.0), atol=1e-6)
    assert warned == []


def test_chained_rotations(scene, read):
    """Of two Mapping nodes one would be ignored, or their order swapped."""
    texture = set_map(scene)
    first = add_mapping(scene, texture, rotation=(0.0, 0.0, math.radians(90)))
    tree = scene.world.node_tree
    second = add_node(tree, "ShaderNodeMapping", Rotation=(math.radians(90), 0.0, 0.0))
    tree.links.new(first.outputs[0], second.inputs[0])
    tree.links.new(second.outputs[0], texture.inputs[0])
    assert np.allclose(read().environment_rotation @ (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), atol=1e-6)


@pytest.mark.parametrize("values", [{"Location": (0, 0, 1)}, {"Scale": (1, 2, 1)}, {"Scale": (1, 1, -1)}])
def test_moved_or_scaled_map_is_named(scene, read, warned, values):
    """A map moved or scaled by its Mapping node would be wrong silently."""
    mapping = add_mapping(scene, set_map(scene))
    for name, value in values.items():
        mapping.inputs[name].default_value = value
    read()
    assert len(warned) == 1 and "World 'World'" in warned[0] and "Mapping" in warned[0]


def test_other_coordinates_are_named(scene, read, warned):
    """A map on other coordinates would be wrong silently."""
    texture = set_map(scene)
    add_mapping(scene, texture)
    tree = scene.world.node_tree
    coordinates = node_of(tree, "ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Window"], node_of(tree, "ShaderNodeMapping").inputs["Vector"])
    read()
    assert len(warned) == 1 and "Texture Coordinate" in warned[0] and "Window" in warned[0]


def test_mirror_ball_is_named(scene, read, warned):
    """A mirror ball would be read as if it were equirectangular."""
    set_map(scene).projection = 'MIRROR_BALL'
    assert read().environment_map is None
    assert len(warned) == 1 and "Environment Texture" in warned[0]


def test_sky_is_named(scene, read, warned):
    """A procedural sky would be replaced silently."""
    background = set_background(scene, (0.5, 0.5, 0.5))
    tree = scene.world.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeTexSky").outputs[0], background.inputs["Color"])
    assert np.allclose(read().environment_color, 0.5)
    assert len(warned) == 1 and "World 'World'" in warned[0] and "Sky Texture" in warned[0]


def generated_image(color, name: str = "Generated", is_float: bool = False) -> bpy.types.Image:
    image = bpy.data.images.new(name, 16, 8, float_buffer=is_float)
    image.pixels.foreach_set(np.tile(np.float32([*color, 1.0]), 16 * 8))
    return image


@pytest.mark.parametrize("is_float, linear", [(False, 0.2140), (True, 0.5)])
def test_generated_image(scene, is_float, linear):
    """An image made in Blender would be black, or of another brightness than in Cycles."""
    set_map(scene, generated_image((0.5, 0.5, 0.5), is_float=is_float))
    assert render(scene).rgb == pytest.approx(linear, abs=2e-3)


def test_srgb_file(scene, tmp_path):
    """A JPEG or PNG sky would be too bright."""
    image = generated_image((0.5, 0.5, 0.5))
    image.filepath_raw, image.file_format = str(tmp_path / "grey.png"), 'PNG'
    image.save()
    set_map(scene, image.filepath_raw)
    assert render(scene).rgb == pytest.approx(0.2140, abs=2e-3)


def test_packed_image(scene, tmp_path):
    """A map that is packed into the .blend would be missing once its file is."""
    path = tmp_path / "map.exr"
    shutil.copy(sample_map(), path)
    texture = set_map(scene, str(path))
    unpacked = render(scene).rgb
    texture.image.pack()
    path.unlink()
    assert np.allclose(render(scene).rgb, unpacked, rtol=1e-4, atol=1e-5)
    assert faults.warnings() == ()


def test_relative_path(scene, tmp_path):
    """A map with a path relative to the .blend would not be found."""
    shutil.copy(sample_map(), tmp_path / "map.exr")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    scene = bpy.context.scene
    set_map(scene, str(tmp_path / "map.exr")).image.filepath = "//map.exr"
    assert render(scene).rgb.max() > 0.0
    assert faults.warnings() == ()


@pytest.mark.usefixtures("device")
def test_rotation_turns_the_picture(scene):
    """What lies left of the camera must come in front of it when the camera or the map is turned."""
    image = generated_image((0.0, 0.0, 0.0), is_float=True)
    pixels = np.zeros((8, 16, 4), np.float32)
    pixels[:, 8] = 1.0  # the columns around +X: u = 1/2 there
    pixels[:, 7] = 1.0
    image.pixels.foreach_set(pixels.ravel())
    texture = set_map(scene, image)
    scene.camera.rotation_euler = (math.radians(90), 0.0, math.radians(-90))
    assert render(scene).rgb[24, 32].min() > 0.9
    scene.camera.rotation_euler = (math.radians(90), 0.0, 0.0)
    assert render(scene).rgb[24, 32].max() < 0.1
    add_mapping(scene, texture, rotation=(0.0, 0.0, math.radians(-90)))
    assert render(scene).rgb[24, 32].min() > 0.9


@pytest.mark.usefixtures("device")
def test_missing_file_is_named_and_magenta(scene, tmp_path):
    """A missing map would stop the render, or give a black picture with no word of the file."""
    path = tmp_path / "map.exr"
    shutil.copy(sample_map(), path)
    set_map(scene, str(path), strength=0.5)
    path.unlink()
    picture = render(scene)
    assert np.allclose(picture.rgb, 0.5 * np.array(MAGENTA), atol=1e-3)
    assert len(faults.warnings()) == 1 and str(path) in faults.warnings()[0]


@pytest.mark.parametrize("damage", [
    lambda content: b"", lambda content: b"not a picture", lambda content: content[:500],
    lambda content: content[:len(content) // 2], lambda content: bytes(len(content)),
], ids=["empty", "text", "header", "half", "zeros"])
def test_corrupt_file_is_named_and_magenta(scene, tmp_path, damage):
    """A damaged map would crash Blender."""
    path = tmp_path / "map.exr"
    shutil.copy(sample_map(), path)
    set_map(scene, str(path))  # before: Blender 3.4 itself hangs on a damaged header
    path.write_bytes(damage(path.read_bytes()))
    add_monkey(frosted())
    picture = render(scene)
    assert np.allclose(picture.rgb[0, 0], MAGENTA, atol=1e-3)
    assert len(faults.warnings()) == 1 and str(path) in faults.warnings()[0]


def test_texture_without_image_is_named(scene, read, warned):
    """An Environment Texture without image would be black with no word of it."""
    set_map(scene).image = None
    assert np.allclose(read().environment_color, MAGENTA)
    assert len(warned) == 1 and "Environment Texture" in warned[0]


def test_user_file_is_not_changed(scene):
    """Rendering would mark the user's images or file as changed."""
    texture = set_map(scene)
    add(bpy.data.meshes.new("Empty"))
    before = (texture.image.filepath, texture.image.is_dirty, len(bpy.data.meshes), len(bpy.data.images))
    render(scene)
    names = {image.name for image in bpy.data.images} - {"Render Result"}
    assert (texture.image.filepath, texture.image.is_dirty, len(bpy.data.meshes), len(names)) == before
