# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's world to the core's environment."""

import hashlib
import os

import bpy
import numpy as np
from mathutils import Euler

from .. import compat
from .. import verglas_core as core
from ..faults import Warn
from . import images, nodes
from .cache import Cache, Client

MISSING_COLOR = np.array((1.0, 0.0, 1.0), np.float32)
"""What Blender shows for an image that can't be read."""

_maps = Cache()
"""Environment maps by content: one is costly to prepare."""


def set_environment(scene: core.Scene, world: bpy.types.World | None, warn: Warn,
                    check_images: bool = True) -> None:
    """Fills scene's environment from the world. check_images: reads pixels that are in no file even if
    Blender hasn't told of a change; scripts can write them without its knowing."""
    if world is None:
        warn("The scene has no world: nothing lights the glass.")
        return
    if not compat.uses_nodes(world):
        scene.environment_color = tuple(world.color)
        return
    owner = f"World '{world.name}'"
    output = nodes.output_node(world.node_tree)
    background = _background(output, owner, warn) if output else None
    if background is None:
        warn(f"{owner} has no Background: nothing lights the glass.")
        return
    strength = max(background.scalar("Strength"), 0.0)
    texture = background.input("Color").source()
    if texture.node is None or texture.node.type != 'TEX_ENVIRONMENT':
        scene.environment_color = strength * background.color("Color")
        return
    node = background.other(texture.node, texture.end.groups)
    if node.node.projection != 'EQUIRECTANGULAR':
        node.warn("isn't equirectangular, which isn't supported yet; the Background's own color is used")
        scene.environment_color = strength * np.array(background.node.inputs["Color"].default_value[:3])
        return
    scene.environment_map = _map_of(node, owner, warn, check_images)
    scene.environment_color = strength * (MISSING_COLOR if scene.environment_map is None else np.ones(3))
    scene.environment_rotation = _rotation(node)


def sweep(client: Client) -> None:
    """As Cache.sweep."""
    _maps.sweep(client)


def clear() -> None:
    _maps.clear()


def _background(output: bpy.types.Node, owner: str, warn: Warn) -> nodes.Node | None:
    """The first Background or Emission that feeds the output's Surface."""
    if nodes.Input(output.inputs["Volume"]).source().node is not None:
        warn(f"{owner} has a volume, which isn't supported yet; it is left out.")
    shaders = list(nodes.shader_nodes(nodes.Input(output.inputs["Surface"])))
    background = next((shader for shader in shaders if shader[0].type in {'BACKGROUND', 'EMISSION'}), None)
    ignored = dict.fromkeys(nodes.title(node) for node, groups in shaders if (node, groups) != background)
    if background is not None and ignored:
        warn(f"{owner}: only its first Background is rendered; not supported yet beside it: "
             f"{', '.join(ignored)}.")
    return None if background is None else nodes.Node(*background, owner, warn)


def _rotation(texture: nodes.Node) -> np.ndarray:
    """(3, 3): map direction = rotation @ world direction, through all Mapping nodes before the texture."""
    rotation = np.eye(3)
    vector = texture.input("Vector")
    while True:
        output, end = vector.source()
        if output is None or output.node.type != 'MAPPING':
            break
        mapping = texture.other(output.node, end.groups)
        rotation = rotation @ _mapping_rotation(mapping)
        vector = mapping.input("Vector")
    if output is not None and not _is_world_direction(output):
        texture.warn(f"takes its Vector from '{nodes.title(output.node)}' ({output.name}), which isn't "
                     "supported yet; Generated coordinates are used")
    return rotation


def _is_world_direction(output: bpy.types.NodeSocket) -> bool:
    if output.node.type != 'TEX_COORD':
        return False
    return output.name == "Generated" or (output.name == "Object" and output.node.object is None)


def _mapping_rotation(mapping: nodes.Node) -> np.ndarray:
    """(3, 3) of one Mapping node: Point, Vector and Normal turn the vector, Texture turns the texture."""
    matrix = np.array(Euler(mapping.color("Rotation"), 'XYZ').to_matrix())
    kind = mapping.node.vector_type
    scale = mapping.color("Scale")
    moves = kind in {'POINT', 'TEXTURE'} and mapping.color("Location").any()
    if moves or scale.min() <= 0.0 or not np.allclose(scale, scale[0]):
        mapping.warn("moves or scales the map, which isn't supported yet; only its rotation is rendered")
    return matrix.T if kind == 'TEXTURE' else matrix


def _map_of(texture: nodes.Node, owner: str, warn: Warn, check_images: bool) -> core.EnvironmentMap | None:
    """None, and one warning, where there is no readable image."""
    image = texture.node.image
    if image is None:
        texture.warn("has no image; it is rendered in magenta")
        return None
    try:
        environment = _load(image, texture, check_images)
    except core.Error as fault:
        warn(f"{owner}: image '{image.name}' is rendered in magenta. {fault}")
        return None
    for sentence in environment.warnings:
        warn(sentence)
    return environment


def load_file(path: str, is_srgb: bool) -> core.EnvironmentMap:
    """Raises core.Error with the path."""
    return _maps.get((path, _mtime(path), is_srgb), lambda: core.EnvironmentMap.load(path, srgb=is_srgb))


def _load(image: bpy.types.Image, texture: nodes.Node, check_images: bool) -> core.EnvironmentMap:
    """From the file where the core can read it itself, else from Blender's pixels."""
    color_space = image.colorspace_settings.name
    is_srgb = color_space == 'sRGB'
    is_known = is_srgb or color_space in compat.LINEAR_COLOR_SPACES
    if image.source == 'FILE' and is_known and not (image.packed_file or image.is_dirty):
        return load_file(images.absolute_path(image), is_srgb)
    if image.source not in {'FILE', 'GENERATED'}:
        texture.warn(f"has an image of type {image.source.title()}, of which one picture is rendered")
    if not (image.is_float or is_known):
        texture.warn(f"has an image in the color space '{color_space}', which isn't supported yet; "
                     "it is read as linear")
    if check_images:
        pixels = _pixels(image)
        key = (image.name_full, is_srgb, hashlib.blake2b(pixels, digest_size=16).digest())
        return _maps.get(key, lambda: _of_pixels(image, pixels, is_srgb))
    return _maps.get(images.version(image), lambda: _of_pixels(image, _pixels(image), is_srgb))


def _of_pixels(image: bpy.types.Image, pixels: np.ndarray, is_srgb: bool) -> core.EnvironmentMap:
    if is_srgb and not image.is_float:
        pixels[..., :3] = images.linear_from_srgb(pixels[..., :3])
    return core.EnvironmentMap(image.name, pixels)


def _mtime(path: str) -> int:
    try:
        return os.stat(path).st_mtime_ns
    except OSError as error:
        raise core.Error(f"'{path}' can't be read: {error.strerror}.") from error


def _pixels(image: bpy.types.Image) -> np.ndarray:
    """(H, W, C) float32 as Blender holds them: floats scene-linear, bytes in their own color space."""
    width, height = image.size
    if width == 0 or height == 0:
        raise core.Error(f"Blender can't read '{image.filepath}'.")
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, -1)
    return pixels if pixels.shape[2] >= 3 else np.repeat(pixels[..., :1], 3, axis=2)
