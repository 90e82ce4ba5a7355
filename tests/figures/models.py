# SPDX-License-Identifier: GPL-3.0-or-later
"""The figures' models and environment maps, and scenes of them."""

import os
from dataclasses import dataclass
from pathlib import Path

import addon_utils
import bpy
import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
SCENES = REPOSITORY / "blend_files"
ASSETS = Path(os.environ.get("VERGLAS_ASSETS", REPOSITORY.parent / "shared" / "assets"))
"""Folder of models and maps that may not be part of the project, where there is one."""


@dataclass(frozen=True)
class World:
    """An environment map: ours, or one of those that come with Blender (Greg Zaal, Poly Haven, CC0)."""
    name: str
    file: str
    degrees: float
    """turn about the vertical axis"""

    @property
    def path(self) -> Path:
        ours = SCENES / "environments" / self.file
        blenders = Path(bpy.utils.system_resource('DATAFILES', path="studiolights/world")) / self.file
        return ours if ours.is_file() else blenders


@dataclass(frozen=True)
class Model:
    name: str
    world: World
    lens: float
    """focal length in mm, with which the model covers about as many pixels as in the paper's Fig. 14"""
    stand_in: str | None = None
    """for a model of the assets: the sample scene that takes its place where there are none"""

    @property
    def mesh(self) -> Path | None:
        """The file in the assets; None for models of the sample scenes, and where it isn't there."""
        path = ASSETS / f"{self.name}.ply"
        return path if self.stand_in and path.is_file() else None

    @property
    def scene(self) -> str:
        """Name of the sample scene that is shown, with another mesh where there is one."""
        return self.stand_in or self.name

    @property
    def title(self) -> str:
        return self.name if self.mesh else self.scene


_PARK = World("park", "rooitou_park_1k.exr", 160.0)
FOREST = World("forest", "forest.exr", 0.0)

MODELS = {model.name: model for model in (
    Model("sphere", _PARK, lens=58.0),
    Model("bunny", World("city", "city.exr", 180.0), lens=69.0, stand_in="bottle"),
    Model("monkey", _PARK, lens=63.0),
    Model("buddha", World("sunrise", "sunrise.exr", 180.0), lens=88.0, stand_in="lens"),
    Model("dragon", World("sunset", "sunset.exr", 180.0), lens=86.0, stand_in="slab"),
)}
"""Those of the paper's Fig. 14, each under its own environment map."""

GLOBE = Model("globe", _PARK, lens=58.0)
"""That of Fig. 13; its roughness is that of water, and rougher where land is."""

SPOTS_SCALE = 2.5
"""Cells of noise in a length of 1, of what is rougher on other models."""


def roughness_of(exponent: float) -> float:
    """Blender's roughness for a Blinn-Phong exponent: 2 / roughness^4 - 2."""
    return (2.0 / (exponent + 2.0)) ** 0.25


def exponent_of(roughness: float) -> float:
    """Its inverse."""
    return 2.0 / roughness ** 4 - 2.0


def about(*models: Model) -> str:
    """What a caption has to say of its models: whose they are, and which stand in for others."""
    theirs = [model.name for model in models if model.mesh]
    stand_ins = [f" The {model.title} stands in for the paper's {model.name}." for model in models
                 if model.title != model.name]
    credit = f" Models: Stanford Computer Graphics Laboratory ({', '.join(theirs)})." if theirs else ""
    return credit + "".join(stand_ins)


def new_scene(model: Model, exponent: float, rough_exponent: float | None = None) -> bpy.types.Scene:
    """The model, of glass with this Blinn-Phong exponent, in place of a sample scene's object. With
    rough_exponent, the globe's land or spots on other models have that."""
    scene = _append_scene(model.scene)
    if model.title == model.name:
        scene.camera.data.lens = model.lens
    obj = next(obj for obj in scene.objects if obj.type == 'MESH')
    material = obj.data.materials[0]
    if model.mesh:
        obj.data = import_mesh(model.mesh)
        obj.data.materials.append(material)
        obj.rotation_euler = (0.0, 0.0, 0.0)
    material.verglas.ndf = 'BLINN_PHONG'
    roughness = _node(material.node_tree, 'BSDF_GLASS').inputs["Roughness"]
    roughness.default_value = roughness_of(exponent)
    if rough_exponent is not None:
        between = roughness.links[0].from_node if roughness.is_linked else _add_spots(roughness)
        between.inputs["To Min"].default_value = roughness_of(exponent)
        between.inputs["To Max"].default_value = roughness_of(rough_exponent)
    tree = scene.world.node_tree
    _node(tree, 'TEX_ENVIRONMENT').image = bpy.data.images.load(str(model.world.path), check_existing=True)
    _node(tree, 'MAPPING').inputs["Rotation"].default_value[2] = np.radians(model.world.degrees)
    return scene


def _add_spots(roughness: bpy.types.NodeSocket) -> bpy.types.Node:
    """Links the socket to noise, cut off to two values; returns the Map Range node between."""
    tree = roughness.id_data
    coordinates, noise, between = (tree.nodes.new(f"ShaderNode{kind}") for kind in
                                   ("TexCoord", "TexNoise", "MapRange"))
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = SPOTS_SCALE, 0.0
    between.inputs["From Min"].default_value, between.inputs["From Max"].default_value = 0.5, 0.53
    tree.links.new(coordinates.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(noise.outputs["Fac"], between.inputs["Value"])
    tree.links.new(between.outputs["Result"], roughness)
    return between


def _append_scene(name: str) -> bpy.types.Scene:
    """A copy of the sample scene; those that were appended before stay."""
    with bpy.data.libraries.load(str(SCENES / f"{name}.blend")) as (source, target):
        target.scenes = source.scenes[:1]
    return target.scenes[0]


def import_mesh(path: Path) -> bpy.types.Mesh:
    """A smooth mesh without materials."""
    if bpy.app.version >= (4, 0, 0):
        bpy.ops.wm.ply_import(filepath=str(path))
    else:
        addon_utils.enable("io_mesh_ply")
        bpy.ops.import_mesh.ply(filepath=str(path))
    obj = bpy.context.object
    mesh = obj.data
    bpy.data.objects.remove(obj)
    mesh.polygons.foreach_set("use_smooth", np.full(len(mesh.polygons), True))
    mesh.update()
    return mesh


def _node(tree: bpy.types.NodeTree, kind: str) -> bpy.types.Node:
    return next(node for node in tree.nodes if node.type == kind)
