# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated Blender meshes to core meshes."""

from typing import NamedTuple

import bpy
import numpy as np

from .. import compat
from .. import verglas_core as core


class MeshArrays(NamedTuple):
    """Triangles in object space, as core.Mesh takes them."""
    positions: np.ndarray
    """(V, 3) float32"""
    normals: np.ndarray
    """(V, 3) float32"""
    triangles: np.ndarray
    """(T, 3) int32"""
    slots: np.ndarray
    """(T,) int32 material slot"""
    used_slots: tuple[int, ...]
    """the distinct ones of slots"""


def read(evaluated: bpy.types.Object) -> MeshArrays:
    """The object's mesh with all modifiers. Vertices with one normal are shared between triangles,
    otherwise every face corner is a vertex of its own."""
    mesh = evaluated.to_mesh()
    try:
        mesh.calc_loop_triangles()
        slots = _get(mesh.loop_triangles, "material_index", 1, np.intc).reshape(-1)
        used_slots = tuple(np.unique(slots).tolist())
        positions = _get(mesh.vertices, "co", 3, np.float32)
        if compat.has_vertex_normals(mesh):
            normals = _get(mesh.vertex_normals, "vector", 3, np.float32)
            triangles = _get(mesh.loop_triangles, "vertices", 3, np.intc)
            return MeshArrays(positions, normals, triangles, slots, used_slots)
        vertex_of_corner = _get(mesh.loops, "vertex_index", 1, np.intc).reshape(-1)
        corners = _get(mesh.loop_triangles, "loops", 3, np.intc)
        positions, normals = positions[vertex_of_corner], compat.corner_normals(mesh)
        return MeshArrays(positions, normals, corners, slots, used_slots)
    finally:
        evaluated.to_mesh_clear()


def to_core(name: str, arrays: MeshArrays, slots: frozenset[int]) -> core.Mesh:
    """Only the triangles of these material slots."""
    kept = np.isin(arrays.slots, list(slots))
    return core.Mesh(name, arrays.positions, arrays.normals, arrays.triangles[kept], arrays.slots[kept])


def _get(collection, attribute: str, width: int, dtype: type) -> np.ndarray:
    """(len(collection), width) values of one attribute."""
    values = np.empty(len(collection) * width, dtype)
    collection.foreach_get(attribute, values)
    return values.reshape(-1, width)
