# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds scenes for the tests and reads what Blender renders of them."""

import functools
import math
import os
import tempfile
from dataclasses import dataclass

import bmesh
import bpy
import numpy as np
import OpenImageIO as oiio

BACKGROUND_DEPTH = 1e9
"""Depths beyond this are background."""


def world_map(name: str) -> str:
    """Path of one of Blender's own studio maps: 'forest', 'city', …"""
    return os.path.join(bpy.utils.system_resource('DATAFILES', path="studiolights/world"), f"{name}.exr")


@functools.cache
def _folder() -> tempfile.TemporaryDirectory:
    return tempfile.TemporaryDirectory()


@functools.cache
def sample_map() -> str:
    """Path of a small bright map without faults in it, different in every direction."""
    v, u = np.mgrid[0.0:1.0:32j, 0.0:1.0:64j]
    pixels = np.stack([1.0 + np.sin(2 * np.pi * u), 0.2 + v, 1.0 + np.cos(4 * np.pi * u) * v], axis=-1)
    path = os.path.join(_folder().name, "sample.exr")
    file = oiio.ImageOutput.create(path)
    file.open(path, oiio.ImageSpec(64, 32, 3, "float"))
    file.write_image(pixels.astype(np.float32))
    file.close()
    return path


def empty_scene() -> bpy.types.Scene:
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, load_ui=False)
    scene = bpy.context.scene
    scene.render.engine = 'VERGLAS'
    scene.render.resolution_x, scene.render.resolution_y = 64, 48
    scene.verglas.samples = 1
    scene.verglas.device = 'OPENGL'  # not what this machine has
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.0, 0.0, 0.0)
    return scene


def add(data: bpy.types.ID | None, name: str = "Object", **properties) -> bpy.types.Object:
    """A new object in the scene with properties set."""
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    for key, value in properties.items():
        setattr(obj, key, value)
    return obj


def add_camera(scene: bpy.types.Scene, location=(0.0, -5.2, 0.3), tilt=87.0) -> bpy.types.Object:
    """A 50 mm camera, turned by tilt degrees about X."""
    scene.camera = add(bpy.data.cameras.new("Camera"), "Camera", location=location,
                       rotation_euler=(math.radians(tilt), 0.0, 0.0))
    return scene.camera


def add_monkey(material: bpy.types.Material | None, subdivisions: int = 0) -> bpy.types.Object:
    """Smooth, size 2, at the origin."""
    bpy.ops.mesh.primitive_monkey_add(size=2)
    return _finish(material, subdivisions)


def add_sphere(material: bpy.types.Material | None, segments: int = 32, rings: int = 16, radius: float = 1.0,
               location=(0.0, 0.0, 0.0)) -> bpy.types.Object:
    """Smooth."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=rings, radius=radius,
                                         location=location)
    return _finish(material, 0)


def add_hollow_sphere(material: bpy.types.Material | None, segments: int = 32, rings: int = 16,
                      hollow: float = 0.8) -> bpy.types.Object:
    """Smooth, radius 1, at the origin, with a hollow of this radius in it. One mesh of two closed walls; the
    inner one faces its centre, as the air is there."""
    obj = add_sphere(material, segments, rings)
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    wall = bmesh.ops.create_uvsphere(bm, u_segments=segments, v_segments=rings, radius=hollow)["verts"]
    bmesh.ops.reverse_faces(bm, faces=list({face for vertex in wall for face in vertex.link_faces}))
    bm.to_mesh(obj.data)
    bm.free()
    set_smooth(obj.data, True)
    return obj


Pair = tuple[bpy.types.Object, bpy.types.Object]


def add_nested_spheres(outer: bpy.types.Material, inner: bpy.types.Material, segments: int = 32,
                       rings: int = 16) -> Pair:
    """Radius 0.5 within radius 1, off its centre, not touching it: light goes from glass into glass. Without
    priorities, as in Cycles, each IOR is that of one crossing: for an IOR of 1.3 within one of 1.5 the inner
    material has to have 1.3 / 1.5 there."""
    return (add_sphere(outer, segments, rings),
            add_sphere(inner, segments, rings, radius=0.5, location=(0.25, 0.0, 0.15)))


def add_spheres_in_a_row(front: bpy.types.Material, back: bpy.types.Material, segments: int = 32,
                         rings: int = 16) -> Pair:
    """Two that are seen one through the other, in part, by the camera of add_camera()."""
    return (add_sphere(front, segments, rings, radius=0.7, location=(-0.3, -0.9, 0.0)),
            add_sphere(back, segments, rings, radius=0.9, location=(0.4, 0.9, 0.0)))


def add_overlapping_spheres(left: bpy.types.Material, right: bpy.types.Material, segments: int = 32,
                            rings: int = 16) -> Pair:
    """Two that share a part of their space, a lens upright between them, seen from the side by the camera of
    add_camera()."""
    return (add_sphere(left, segments, rings, radius=0.8, location=(-0.45, 0.0, 0.0)),
            add_sphere(right, segments, rings, radius=0.8, location=(0.45, 0.0, 0.0)))


def _finish(material: bpy.types.Material | None, subdivisions: int) -> bpy.types.Object:
    obj = bpy.context.object
    set_smooth(obj.data, True)
    if material is not None:
        obj.data.materials.append(material)
    if subdivisions:
        modifier = obj.modifiers.new("Subdivision", 'SUBSURF')
        modifier.levels = modifier.render_levels = subdivisions
    return obj


def set_smooth(mesh: bpy.types.Mesh, smooth: bool) -> None:
    mesh.polygons.foreach_set("use_smooth", np.full(len(mesh.polygons), smooth))
    mesh.update()


def use_nodes(owner: bpy.types.Material | bpy.types.World) -> None:
    if bpy.app.version < (5, 0, 0):  # from 5.0 they always do
        owner.use_nodes = True


def new_material(name: str = "Glass", node: str | None = "ShaderNodeBsdfGlass",
                 **inputs) -> bpy.types.Material:
    """A material with one shader node; keywords name its inputs ('Base_Color' is "Base Color") or,
    in lower case, its properties."""
    material = bpy.data.materials.new(name)
    use_nodes(material)
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    if node is not None:
        shader = tree.nodes.new(node)
        set_values(shader, **inputs)
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def add_absorption(material: bpy.types.Material, color=(0.5, 0.8, 1.0),
                   density: float = 1.0) -> bpy.types.Material:
    """Links a Volume Absorption; returns the material."""
    tree = material.node_tree
    volume = add_node(tree, "ShaderNodeVolumeAbsorption", Color=(*color, 1.0), Density=density)
    tree.links.new(volume.outputs[0], node_of(tree, "ShaderNodeOutputMaterial").inputs["Volume"])
    return material


def set_values(node: bpy.types.Node, **values) -> None:
    for key, value in values.items():
        if key[0].islower():
            setattr(node, key, value)
        else:
            node.inputs[key.replace("_", " ")].default_value = value


def frosted(roughness: float = 0.3, ior: float = 1.5) -> bpy.types.Material:
    """Refraction BSDF, Beckmann, white."""
    return new_material("Frosted", "ShaderNodeBsdfRefraction", distribution='BECKMANN', Roughness=roughness,
                        IOR=ior, Color=(1, 1, 1, 1))


def add_node(tree: bpy.types.NodeTree, kind: str, **values) -> bpy.types.Node:
    node = tree.nodes.new(kind)
    set_values(node, **values)
    return node


def node_of(tree: bpy.types.NodeTree, kind: str) -> bpy.types.Node:
    return next(node for node in tree.nodes if node.bl_idname == kind)


def new_group(kind: str, inputs: dict[str, str], outputs: dict[str, str]) -> bpy.types.NodeTree:
    """An empty node group with sockets by name and type, a Group Input and a Group Output."""
    group = bpy.data.node_groups.new("Group", kind)
    for in_out, sockets in (('INPUT', inputs), ('OUTPUT', outputs)):
        for name, socket_type in sockets.items():
            if hasattr(group, "interface"):
                group.interface.new_socket(name, in_out=in_out, socket_type=socket_type)
            else:
                (group.inputs if in_out == 'INPUT' else group.outputs).new(socket_type, name)
    group.nodes.new("NodeGroupInput")
    group.nodes.new("NodeGroupOutput")
    return group


def set_background(scene: bpy.types.Scene, color=(1.0, 1.0, 1.0), strength: float = 1.0) -> bpy.types.Node:
    """Makes the world one Background node and returns it."""
    use_nodes(scene.world)
    tree = scene.world.node_tree
    tree.nodes.clear()
    background = add_node(tree, "ShaderNodeBackground", Color=(*color, 1), Strength=strength)
    tree.links.new(background.outputs[0], add_node(tree, "ShaderNodeOutputWorld").inputs["Surface"])
    return background


def set_map(scene: bpy.types.Scene, image: bpy.types.Image | str | None = None,
            strength: float = 1.0) -> bpy.types.Node:
    """Makes the world an Environment Texture and returns its node. image: or its path; default the
    sample map."""
    background = set_background(scene, strength=strength)
    tree = scene.world.node_tree
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    image = image or sample_map()
    texture.image = bpy.data.images.load(image) if isinstance(image, str) else image
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    return texture


def add_mapping(scene: bpy.types.Scene, texture: bpy.types.Node, rotation=(0.0, 0.0, 0.0),
                kind: str = 'POINT') -> bpy.types.Node:
    """Puts Texture Coordinate (Generated) and Mapping before the texture; returns the Mapping."""
    tree = scene.world.node_tree
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    mapping = add_node(tree, "ShaderNodeMapping", vector_type=kind, Rotation=rotation)
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    return mapping


@dataclass
class Picture:
    """Passes of one view layer, float32, row 0 at the bottom."""
    combined: np.ndarray
    """(H, W, 4)"""
    depth: np.ndarray | None = None
    """(H, W)"""
    normal: np.ndarray | None = None
    """(H, W, 3)"""

    @property
    def rgb(self) -> np.ndarray:
        return self.combined[..., :3]

    @property
    def mask(self) -> np.ndarray:
        """(H, W) bool: where an object is."""
        return self.depth < BACKGROUND_DEPTH


def render(scene: bpy.types.Scene) -> Picture:
    """Renders with all passes; the first view layer's."""
    for layer in scene.view_layers:
        layer.use_pass_z = layer.use_pass_normal = True
    return next(iter(render_layers(scene).values()))


def write_layers(scene: bpy.types.Scene) -> None:
    """Makes multilayer EXRs the format of what is saved."""
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = 'MULTI_LAYER_IMAGE'
    settings.file_format = 'OPEN_EXR_MULTILAYER'
    settings.color_depth = '32'


def render_layers(scene: bpy.types.Scene) -> dict[str, Picture]:
    """Renders through Blender into a multilayer EXR and reads it back, by name of view layer."""
    write_layers(scene)
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "picture.exr")
        bpy.ops.render.render(write_still=True, scene=scene.name)
        return read_layers(scene.render.filepath)


def _read_channels(path: str) -> dict[str, np.ndarray]:
    """(H, W) of each channel by name, row 0 at the bottom; Blender 5 writes a part for each pass."""
    file = oiio.ImageInput.open(path)
    channels = {}
    part = 0
    while file.seek_subimage(part, 0):
        pixels = file.read_image(part, 0, 0, file.spec().nchannels, "float")[::-1]
        channels |= {name: pixels[..., i] for i, name in enumerate(file.spec().channelnames)}
        part += 1
    file.close()
    return channels


def read_layers(path: str) -> dict[str, Picture]:
    channels = _read_channels(path)

    def channels_of(layer: str, name: str, components: str) -> np.ndarray | None:
        names = [f"{layer}.{name}.{component}" for component in components]
        found = [channels[name] for name in names if name in channels]
        return np.stack(found, axis=-1) if found else None

    layers = dict.fromkeys(channel.split(".")[0] for channel in channels)
    pictures = {}
    for layer in layers:
        depth = channels_of(layer, "Depth", "Z")
        pictures[layer] = Picture(channels_of(layer, "Combined", "RGBA"),
                                  None if depth is None else depth[..., 0],
                                  channels_of(layer, "Normal", "XYZ"))
    return pictures
