# SPDX-License-Identifier: GPL-3.0-or-later
"""What is compared: .blend files, each as it is or with other roughness and light."""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy

from .. import compat
from ..faults import Fault
from ..sync import materials


@dataclass(frozen=True)
class Case:
    """One scene to compare methods on. Paths are as the user gave them."""
    file: str
    roughness: float | None = None
    """of all glass; None: as the file has it"""
    map: str | None = None
    """the world's environment picture; None: as the file has it"""
    name: str = ""
    """of the report, and of its folder where there are several"""


def combinations(files: Sequence[str], roughnesses: Sequence[float] = (),
                 maps: Sequence[str] = ()) -> list[Case]:
    """Every file with every roughness under every map, each with a name of its own."""
    cases: dict[str, Case] = {}
    for file, roughness, environment in itertools.product(files, roughnesses or [None], maps or [None]):
        parts = [Path(file).stem]
        parts += [f"r{roughness:g}"] if roughness is not None else []
        parts += [Path(environment).stem] if environment is not None else []
        stem = name = "_".join(parts)
        for i in itertools.count(2):
            if name not in cases:
                break
            name = f"{stem}_{i}"
        cases[name] = Case(file, roughness, environment, name)
    return list(cases.values())


def open_case(case: Case) -> bpy.types.Scene:
    """Opens the file, which stays as it is on disk, and changes what the case asks for. Raises Fault."""
    if not Path(case.file).is_file():
        raise Fault(f"There is no file '{case.file}'.")
    try:
        bpy.ops.wm.open_mainfile(filepath=str(Path(case.file).resolve()), load_ui=False)
    except RuntimeError as error:
        raise Fault(f"'{case.file}' can't be opened by Blender {bpy.app.version_string}.") from error
    scene = bpy.context.scene
    if case.roughness is not None:
        set_roughness(case.file, case.roughness)
    if case.map is not None:
        set_map(scene, case.map)
    return scene


def set_roughness(file: str, roughness: float) -> None:
    """Of every glass node of the open file, in node groups too. Raises Fault where there is none."""
    trees = [material.node_tree for material in bpy.data.materials if compat.uses_nodes(material)]
    nodes = [node for tree in trees + list(bpy.data.node_groups) for node in tree.nodes if _is_glass(node)]
    if not nodes:
        raise Fault(f"'{file}' has no glass node whose Roughness could be set.")
    for node in nodes:
        if node.distribution == 'SHARP':
            node.distribution = 'BECKMANN'
        _set_unlinked(node, "Roughness", roughness)
        if "Transmission Roughness" in node.inputs:
            _set_unlinked(node, "Transmission Roughness", 0.0)


def _is_glass(node: bpy.types.Node) -> bool:
    if node.type == 'BSDF_PRINCIPLED':
        transmission = next(node.inputs[name] for name in compat.TRANSMISSION if name in node.inputs)
        return transmission.is_linked or transmission.default_value > 0.0
    return node.type in materials.GLASS_NODES


def _set_unlinked(node: bpy.types.Node, name: str, value: float) -> None:
    socket = node.inputs[name]
    for link in socket.links:
        node.id_data.links.remove(link)
    socket.default_value = value


def set_map(scene: bpy.types.Scene, path: str) -> None:
    """Makes an image the world's environment picture: in its Environment Texture nodes, or in a new world
    where it has none. Raises Fault where the image can't be read."""
    image = _load(path)
    world = scene.world
    textures = list(_environment_textures(world.node_tree)) if world and compat.uses_nodes(world) else []
    for texture in textures:
        texture.image = image
    if not textures:
        scene.world = _new_world(image)


def _load(path: str) -> bpy.types.Image:
    try:
        image = bpy.data.images.load(str(Path(path).resolve()))
    except RuntimeError as error:
        raise Fault(f"There is no readable map '{path}'.") from error
    if 0 in image.size:
        raise Fault(f"Map '{path}' can't be read as a picture.")
    return image


def _environment_textures(tree: bpy.types.NodeTree) -> Iterator[bpy.types.Node]:
    for node in tree.nodes:
        if node.type == 'TEX_ENVIRONMENT':
            yield node
        elif node.type == 'GROUP' and node.node_tree is not None:
            yield from _environment_textures(node.node_tree)


def _new_world(image: bpy.types.Image) -> bpy.types.World:
    world = bpy.data.worlds.new("World")
    compat.use_nodes(world)
    tree = world.node_tree
    tree.nodes.clear()
    texture, background, output = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexEnvironment", "Background", "OutputWorld"))
    texture.image = image
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    tree.links.new(background.outputs["Background"], output.inputs["Surface"])
    return world
