# SPDX-License-Identifier: GPL-3.0-or-later
"""What is rendered: the models of the figures, the sample scenes, and balls of any number of triangles."""

import dataclasses

import numpy as np
from figures.models import MODELS, Model, new_scene
from verglas import verglas_core as core
from verglas.compare.methods import Conditions, Subject
from verglas.compare.progress import Progress

from .plan import Size

EXPONENT = 24.0
"""of Blinn-Phong, for all models alike"""

WORLD = MODELS["monkey"].world
"""the environment map of all of them"""

SAMPLE_LENS = 50.0
"""of the sample scenes' cameras, in mm"""


def models() -> list[Model]:
    """The sample scenes, and the models of the paper's Fig. 14 that are there."""
    names = (model.stand_in for model in MODELS.values() if model.stand_in)
    stand_ins = (Model(name, WORLD, SAMPLE_LENS) for name in names)
    theirs = (model for model in MODELS.values() if model.title == model.name)
    return [dataclasses.replace(model, world=WORLD) for model in (*theirs, *stand_ins)]


def subject(model: Model, size: Size, progress: Progress) -> Subject:
    """The model in glass, for one sample of all light."""
    return Subject(new_scene(model, EXPONENT), Conditions(*size, samples=1), progress.say)


def refracting(model: Model, size: Size, progress: Progress) -> Subject:
    """The same with a Refraction BSDF, which reflects nothing."""
    scene = new_scene(model, EXPONENT)
    tree = next(obj for obj in scene.objects if obj.type == 'MESH').data.materials[0].node_tree
    glass = next(node for node in tree.nodes if node.type == 'BSDF_GLASS')
    refraction = tree.nodes.new("ShaderNodeBsdfRefraction")
    for name in ("Roughness", "IOR"):
        refraction.inputs[name].default_value = glass.inputs[name].default_value
    tree.links.new(refraction.outputs["BSDF"], glass.outputs["BSDF"].links[0].to_socket)
    return Subject(scene, Conditions(*size, samples=1), progress.say)


def ball_mesh(squares: int) -> tuple[np.ndarray, np.ndarray]:
    """A unit sphere of 12 squares^2 triangles of about equal size: a cube whose faces are grids, spread to
    equal angles and drawn to the sphere. Its points, which are their own normals, and triangles."""
    angles = np.linspace(-np.pi / 4, np.pi / 4, squares + 1)
    u, v = np.meshgrid(np.tan(angles), np.tan(angles))
    points = []
    for axis in range(3):
        for side in (1.0, -1.0):
            face = np.empty((*u.shape, 3))
            # Turned so that u, v and the outward axis are right-handed
            face[..., axis], face[..., (axis + 1) % 3], face[..., (axis + 2) % 3] = side, side * u, v
            points.append(face.reshape(-1, 3))
    points = np.concatenate(points)
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    first = np.arange(6 * u.size).reshape(6, *u.shape)[:, :-1, :-1].ravel()
    up, across = squares + 1, 1
    triangles = np.concatenate([np.stack([first, first + across, first + across + up], 1),
                                np.stack([first, first + across + up, first + up], 1)])
    return points, triangles


def ball(squares: int) -> core.Mesh:
    """Its UVs are X and Z, 0 … 1 across it."""
    points, triangles = ball_mesh(squares)
    return core.Mesh(f"Ball of {len(triangles)} triangles", points, points, triangles,
                     uvs=0.5 + 0.5 * points[:, [0, 2]])


def scene_of(mesh: core.Mesh, matrix: np.ndarray, material: core.Material | None = None) -> core.Scene:
    """The mesh in glass before a black world. matrix: object -> world. material: default all alike."""
    scene = core.Scene()
    index = scene.add_material(material or core.Material("Glass"))
    scene.add_object("Ball", mesh, matrix, [index])
    return scene


def frosted() -> core.Material:
    """Glass with waves of all roughnesses from 0.05 to 0.9, of which there is as much of each."""
    v, u = np.indices((256, 256)) / 256.0
    waves = np.sin(2.0 * np.pi * (3.0 * u + v)) + np.sin(2.0 * np.pi * (u - 2.0 * v))
    ranks = waves.ravel().argsort().argsort().reshape(waves.shape)
    material = core.Material("Frosted")
    material.roughness_texture = core.Texture("Waves", 0.05 + 0.85 * ranks / ranks.max())
    return material


def ball_scene(squares: int, view: core.Scene, is_textured: bool = False) -> core.Scene:
    """The ball in place of another scene's objects, with its camera and world. is_textured: its roughness
    varies."""
    scene = scene_of(ball(squares), np.eye(4), frosted() if is_textured else None)
    scene.camera = view.camera
    scene.environment_map = view.environment_map
    scene.environment_color = view.environment_color
    scene.environment_rotation = view.environment_rotation
    return scene
