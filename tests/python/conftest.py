# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures for tests of the core's Python module, outside of Blender."""

import numpy as np
import pytest
import verglas_core as verglas


@pytest.fixture(scope="session")
def renderer():
    return verglas.Renderer()


def sphere(name="Sphere", segments=64, **coordinates):
    """A unit sphere around the origin; u goes around Z from +X, v from pole to pole."""
    rows = segments // 2
    around, down = np.meshgrid(np.linspace(0, 2 * np.pi, segments + 1), np.linspace(0, np.pi, rows + 1))
    points = np.stack([np.sin(down) * np.cos(around), np.sin(down) * np.sin(around), np.cos(down)], -1)
    points = points.reshape(-1, 3)
    i = np.arange(rows * (segments + 1)).reshape(rows, segments + 1)[:, :-1].ravel()
    below = i + segments + 1
    upper = np.stack([i, below, below + 1], -1)[:-segments]
    lower = np.stack([i, below + 1, i + 1], -1)[segments:]
    uvs = np.stack([around / (2 * np.pi), 1 - down / np.pi], -1).reshape(-1, 2)
    return verglas.Mesh(name, points, points, np.concatenate([upper, lower]), uvs=uvs, **coordinates)


def flat_faces(name, corners, uvs=None, slots=None):
    """Quads with normals of their own. corners: (F, 4, 3), counter-clockwise from outside. slots: of each
    triangle, two a quad."""
    corners = np.asarray(corners, float)
    normals = np.repeat(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), 4, axis=0)
    quads = 4 * np.arange(len(corners))[:, None, None] + [[0, 1, 2], [0, 2, 3]]
    return verglas.Mesh(name, corners.reshape(-1, 3), normals, quads.reshape(-1, 3), slots, uvs)


def cube_faces():
    """Of a cube from -1 to 1, as flat_faces takes them: (6, 4, 3)."""
    faces = []
    for axis in range(3):
        for sign in (-1, 1):
            side, up = np.roll(np.eye(3), axis, axis=1)[1:] * [[sign], [1]]
            out = np.cross(side, up)
            faces.append([out - side - up, out + side - up, out + side + up, out - side + up])
    return faces


def cube(name="Cube", uvs=None):
    """From -1 to 1."""
    return flat_faces(name, cube_faces(), uvs)


def camera(distance=4.0, focal=2.5):
    """At (0, -distance, 0), looking along +Y, Z up."""
    near, far = 0.1, 100.0
    return verglas.Camera(
        view=[[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, -distance], [0, 0, 0, 1]],
        projection=[[focal, 0, 0, 0], [0, focal, 0, 0],
                    [0, 0, (far + near) / (near - far), 2 * far * near / (near - far)], [0, 0, -1, 0]])


def gradient_map():
    """Red to the right of the camera (+X), green up, blue behind it (-Y)."""
    height, width = 32, 64
    v, u = np.meshgrid((np.arange(height) + 0.5) / height, (np.arange(width) + 0.5) / width, indexing="ij")
    azimuth, theta = (0.5 - u) * 2 * np.pi, (1 - v) * np.pi
    sine = np.sin(theta)
    direction = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), np.cos(theta)], -1)
    return verglas.EnvironmentMap("gradient", 0.5 + 0.5 * direction * [1, -1, 1])


def scene_of(*objects, material=None):
    """A scene of (name, mesh, matrix) with one material, under a gradient."""
    scene = verglas.Scene()
    scene.camera = camera()
    scene.environment_map = gradient_map()
    scene.environment_color = (1, 1, 1)
    index = scene.add_material(material or verglas.Material("Glass"))
    for name, mesh, matrix in objects:
        scene.add_object(name, mesh, matrix, [index])
    return scene


def settings_of(**values):
    settings = verglas.Settings()
    settings.width = settings.height = 96
    settings.samples = 1
    for name, value in values.items():
        setattr(settings, name, value)
    return settings


@pytest.fixture
def glass_sphere():
    return scene_of(("Sphere", sphere(), np.eye(4)))
