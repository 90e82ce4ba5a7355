# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated Blender meshes to core meshes."""

import itertools
import zlib
from typing import NamedTuple

import bpy
import numpy as np

from .. import compat
from .. import verglas_core as core
from ..faults import Warn
from . import nodes
from .cache import Shared


class MeshArrays(NamedTuple):
    """Triangles in object space, as core.Mesh takes them."""
    positions: np.ndarray
    """(V, 3) float32"""
    normals: np.ndarray
    """(V, 3) float32"""
    triangles: np.ndarray
    """(T, 3) int32"""
    corners: np.ndarray
    """(T, 3) int32 face corners of the triangles"""
    slots: np.ndarray
    """(T,) int32 material slot"""
    used_slots: tuple[int, ...]
    """the distinct ones of slots"""
    number: int
    """of its own, as what it is known by"""


def are_equal(a: MeshArrays, b: MeshArrays) -> bool:
    """Whether they hold the same mesh."""
    return all(np.array_equal(x, y) for x, y in zip(a[:5], b[:5]))


_numbers = itertools.count()
_meshes = Shared()


def read(evaluated: bpy.types.Object) -> MeshArrays:
    """The object's mesh with all modifiers. Vertices with one normal are shared between triangles,
    otherwise every face corner is a vertex of its own."""
    mesh = evaluated.to_mesh()
    try:
        mesh.calc_loop_triangles()
        slots = _slots(mesh)
        used_slots = tuple(np.flatnonzero(np.bincount(slots)).tolist())
        positions = _get(mesh.vertices, "co", 3, np.float32)
        corners = _get(mesh.loop_triangles, "loops", 3, np.intc)
        if compat.has_vertex_normals(mesh):
            normals = _get(mesh.vertex_normals, "vector", 3, np.float32)
            triangles = _vertices(mesh)[corners]
            return MeshArrays(positions, normals, triangles, corners, slots, used_slots, next(_numbers))
        positions, normals = positions[_vertices(mesh)], compat.corner_normals(mesh)
        return MeshArrays(positions, normals, corners, corners, slots, used_slots, next(_numbers))
    finally:
        evaluated.to_mesh_clear()


def _slots(mesh: bpy.types.Mesh) -> np.ndarray:
    """(T,) material slot of each triangle. A mesh without the attribute uses the first alone."""
    if "material_index" not in mesh.attributes:
        return np.zeros(len(mesh.loop_triangles), np.intc)
    return _get(mesh.loop_triangles, "material_index", 1, np.intc).reshape(-1)


TEXTURE_COORDINATES = {"uvs": 2, "normal_uvs": 2, "tangents": 4, "height_uvs": 2}
"""Arguments of core.Mesh that depend on textures, and how many numbers a vertex has of them."""


def to_core(name: str, arrays: MeshArrays, slots: frozenset[int],
            coordinates: dict[str, dict[int, np.ndarray]]) -> core.Mesh:
    """Only the triangles of these material slots. coordinates: by their names in TEXTURE_COORDINATES,
    (T, 3, 2 or 4) of a slot's triangles' corners where it needs them. The same mesh as before, while that is
    in use and nothing has changed."""
    positions, normals, triangles = arrays.positions, arrays.normals, arrays.triangles
    slot_of_triangle = arrays.slots
    if not slots.issuperset(arrays.used_slots):
        kept = np.isin(slot_of_triangle, list(slots))
        triangles, slot_of_triangle = triangles[kept], slot_of_triangle[kept]
    of_vertices = {}
    if coordinates:
        of_corners = np.concatenate([_of_all(slot_of_triangle, by_slot, TEXTURE_COORDINATES[key])
                                     for key, by_slot in coordinates.items()], axis=-1)
        source, triangles, values = _split_at_seams(triangles, of_corners, len(positions))
        positions, normals = positions[source], normals[source]
        ends = np.cumsum([TEXTURE_COORDINATES[key] for key in coordinates])
        of_vertices = dict(zip(coordinates, np.split(values, ends[:-1], axis=1)))
    sums = tuple((kind, zlib.crc32(np.ascontiguousarray(values))) for kind, values in of_vertices.items())
    key = (name, arrays.number, slots, sums)
    return _meshes.get(key, lambda: core.Mesh(name, positions, normals, triangles, slot_of_triangle,
                                              **of_vertices))


def _of_all(slot_of_triangle: np.ndarray, by_slot: dict[int, np.ndarray], width: int) -> np.ndarray:
    """(T, 3, width) of all triangles; 0 where a slot has none."""
    values = np.zeros((len(slot_of_triangle), 3, width), np.float32)
    for slot, of_slot in by_slot.items():
        values[slot_of_triangle == slot] = of_slot
    return values


def _split_at_seams(triangles: np.ndarray, of_corners: np.ndarray,
                    vertex_count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """One value (K,) for each vertex: corners that differ from the others of theirs get a new one.
    of_corners: (T, 3, K). Returns the vertex that each is a copy of (V,), triangles (T, 3) and values
    (V, K)."""
    width = of_corners.shape[2]
    values = np.zeros((vertex_count, width), np.float32)
    values[triangles.reshape(-1)] = of_corners.reshape(-1, width)
    differs = (values[triangles] != of_corners).any(axis=2)
    source = np.concatenate([np.arange(vertex_count), triangles[differs]])
    split = triangles.copy()
    split[differs] = vertex_count + np.arange(np.count_nonzero(differs))
    return source, split, np.concatenate([values, of_corners[differs]])


def name_of(evaluated: bpy.types.Object) -> str:
    """Of the object's data, as the user knows it: an evaluated mesh has another name in Edit Mode."""
    return (evaluated.original.data or evaluated.data).name


def title(evaluated: bpy.types.Object) -> str:
    """What warnings of an object's mesh begin with. Of objects that share one, the first is named."""
    mesh = name_of(evaluated)
    return f"Object '{evaluated.name}'" + (f" (mesh '{mesh}')" if mesh != evaluated.name else "")


class Surface:
    """The triangles of one material slot, and what nodes can ask about them."""

    def __init__(self, evaluated: bpy.types.Object, arrays: MeshArrays, slot: int, warn: Warn):
        self.name = name_of(evaluated)
        self.title = title(evaluated)
        self._evaluated = evaluated
        self._arrays = arrays
        self._kept = arrays.slots == slot
        self._warn = warn
        self._known: dict[tuple[str, str], np.ndarray] = {}

    @property
    def triangle_count(self) -> int:
        return int(np.count_nonzero(self._kept))

    def has_uv_map(self, name: str) -> bool:
        """name: '' for the mesh's own choice."""
        mesh = self._evaluated.to_mesh()
        try:
            return _uv_layer(mesh, name) is not None
        finally:
            self._evaluated.to_mesh_clear()

    def corner_values(self, leaf: tuple[str, str]) -> np.ndarray:
        """(T, 3, 3) or (T, 3) float32 of the triangles' corners, of an expression's leaf. 0, and a warning,
        where the mesh has none such."""
        if leaf not in self._known:
            # Not its data: with subdivision on the GPU those aren't subdivided
            mesh = self._evaluated.to_mesh()
            try:
                self._known[leaf] = self._read(mesh, *leaf)
            finally:
                self._evaluated.to_mesh_clear()
        return self._known[leaf]

    def at(self, leaf: tuple[str, str], triangle: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """(N, 3) or (N,) at points of triangles (N,), by barycentric weights (N, 3)."""
        corners = self.corner_values(leaf)[triangle]
        values = np.einsum('nk,nk...->n...', weights, corners)
        if leaf[0] == 'NORMAL':
            values /= np.maximum(np.linalg.norm(values, axis=1, keepdims=True), 1e-12)
        return values

    def _read(self, mesh: bpy.types.Mesh, kind: str, name: str) -> np.ndarray:
        arrays, kept = self._arrays, self._kept
        if kind == 'OBJECT':
            return arrays.positions[arrays.triangles[kept]]
        if kind == 'NORMAL':
            return arrays.normals[arrays.triangles[kept]]
        if kind == 'GENERATED':
            return self._of_corners(_generated(mesh)[_vertices(mesh)])
        if kind == 'UV':
            return self._of_corners(self._uvs(mesh, name))
        rgba, factor = self._attribute(mesh, name)
        if kind == 'FACTOR':
            return self._of_corners(factor)
        if kind == 'ALPHA':
            return self._of_corners(rgba[:, 3])
        if kind == 'GRAY':
            return self._of_corners(rgba[:, :3] @ nodes.LUMINANCE)
        return self._of_corners(rgba[:, :3])

    def _of_corners(self, values: np.ndarray) -> np.ndarray:
        return values[self._arrays.corners[self._kept]]

    def _uvs(self, mesh: bpy.types.Mesh, name: str) -> np.ndarray:
        """(C, 3), the third 0"""
        layer = _uv_layer(mesh, name)
        uvs = np.zeros((len(mesh.loops), 3), np.float32)
        if layer is None or len(mesh.loops) == 0:
            self._warn(f"{self.title} has no UV map{f' {name!r}' if name else ''}; its textures have "
                       "coordinates of 0, as in Cycles.")
            return uvs
        uvs[:, :2] = compat.uvs_of(layer)
        return uvs

    def _attribute(self, mesh: bpy.types.Mesh, name: str) -> tuple[np.ndarray, np.ndarray]:
        """(C, 4) as a colour and (C,) as a number."""
        count = len(mesh.loops)
        attribute = _attribute_named(mesh, name)
        field = None if attribute is None else ATTRIBUTE_FIELDS.get(attribute.data_type)
        if field is None and name in mesh.uv_layers:
            rgba = np.column_stack([self._uvs(mesh, name), np.ones(count, np.float32)])
            return rgba, rgba[:, 0]
        index = None if field is None else _index_of_domain(mesh, attribute.domain)
        if index is None:
            self._warn(f"{self.title} has no attribute {name!r} that can be read; it is 0, as in Cycles.")
            return np.zeros((count, 4), np.float32), np.zeros(count, np.float32)
        key, width, dtype = field
        values = _get(attribute.data, key, width, dtype).astype(np.float32)[index]
        rgba = np.ones((count, 4), np.float32)
        rgba[:, :3] = values[:, :3] if width != 2 else np.column_stack([values, np.zeros(count)])
        if width == 4:
            rgba[:, 3] = values[:, 3]
        return rgba, values[:, 0] if width == 2 else rgba[:, :3].mean(axis=1)


ATTRIBUTE_FIELDS = {
    'FLOAT': ("value", 1, np.float32),
    'INT': ("value", 1, np.intc),
    'INT8': ("value", 1, np.intc),
    'BOOLEAN': ("value", 1, bool),
    'FLOAT2': ("vector", 2, np.float32),
    'FLOAT_VECTOR': ("vector", 3, np.float32),
    'FLOAT_COLOR': ("color", 4, np.float32),
    'BYTE_COLOR': ("color", 4, np.float32),
}
"""Property of an element, its width and type, by an attribute's data type; colours come scene-linear."""


def _uv_layer(mesh: bpy.types.Mesh, name: str) -> bpy.types.MeshUVLoopLayer | None:
    """name: '' for the one that the mesh renders with."""
    layers = mesh.uv_layers
    return layers.get(name) if name else next((each for each in layers if each.active_render), None)


def _vertices(mesh: bpy.types.Mesh) -> np.ndarray:
    """(C,) vertex of each face corner."""
    return _get(mesh.loops, "vertex_index", 1, np.intc).reshape(-1)


def _index_of_domain(mesh: bpy.types.Mesh, domain: str) -> np.ndarray | None:
    """(C,) where each face corner finds its value; None where Cycles reads none."""
    if domain == 'CORNER':
        return np.arange(len(mesh.loops))
    if domain == 'POINT':
        return _vertices(mesh)
    if domain == 'FACE':
        return np.repeat(np.arange(len(mesh.polygons)),
                         _get(mesh.polygons, "loop_total", 1, np.intc).reshape(-1))
    return None


def _attribute_named(mesh: bpy.types.Mesh, name: str) -> bpy.types.Attribute | None:
    """'*': the colours that the mesh renders with."""
    if name != "*":
        return mesh.attributes.get(name)
    colors = mesh.color_attributes
    index = colors.render_color_index
    return colors[index] if 0 <= index < len(colors) else None


def _generated(mesh: bpy.types.Mesh) -> np.ndarray:
    """(V, 3): 0 … 1 over the mesh's texture space, before modifiers that deform."""
    positions = _get(mesh.vertices, "undeformed_co", 3, np.float32)
    location = np.array(mesh.texspace_location, np.float32)
    size = np.array(mesh.texspace_size, np.float32)
    return (positions - location) / np.where(size != 0.0, 2.0 * size, 1.0) + 0.5


def _get(collection, attribute: str, width: int, dtype: type) -> np.ndarray:
    """(len(collection), width) values of one attribute."""
    values = np.empty(len(collection) * width, dtype)
    collection.foreach_get(attribute, values)
    return values.reshape(-1, width)
