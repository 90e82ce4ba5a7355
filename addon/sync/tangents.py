# SPDX-License-Identifier: GPL-3.0-or-later
"""Tangents of a mesh along a UV map, as normal maps are made for: MikkTSpace's (Mikkelsen: Simulation of
Wrinkled Surfaces Revisited, 2008), on triangles, as Cycles' are. mesh.calc_tangents() knows no faces of five
and more corners."""

import zlib

import numpy as np

from .cache import Shared
from .meshes import Surface

_tangents = Shared()


def of_surface(surface: Surface, uv_map: str) -> np.ndarray:
    """(T, 3, 4) float32 of the triangles' corners, as core.Mesh takes them."""
    positions, normals = surface.corner_values(('OBJECT', '')), surface.corner_values(('NORMAL', ''))
    uvs = surface.corner_values(('UV', uv_map))[..., :2]
    key = tuple(zlib.crc32(np.ascontiguousarray(each)) for each in (positions, normals, uvs))
    return _tangents.get((len(positions), *key), lambda: along_u(positions, normals, uvs))


def along_u(positions: np.ndarray, normals: np.ndarray, uvs: np.ndarray) -> np.ndarray:
    """(T, 3, 4) unit tangents, and the bitangents' sign. positions, normals: (T, 3, 3); uvs: (T, 3, 2)."""
    edges, uv_edges = ((each[:, 1:] - each[:, :1]).astype(float) for each in (positions, uvs))
    determinant = np.linalg.det(uv_edges)
    sign = np.where(determinant > 0.0, 1.0, -1.0)
    along = sign[:, None] * (uv_edges[:, 1, 1:] * edges[:, 0] - uv_edges[:, 0, 1:] * edges[:, 1])
    along[determinant == 0.0] = 0.0
    weighted = _angles(positions, normals)[..., None] * _unit(_in_plane(along[:, None], normals))
    tangents = np.empty((len(positions), 3, 4), np.float32)
    tangents[..., :3] = _unit(_sum_over_equal(weighted, positions, normals, uvs, sign))
    tangents[..., 3] = sign[:, None]
    return tangents


def _sum_over_equal(values: np.ndarray, positions: np.ndarray, normals: np.ndarray, uvs: np.ndarray,
                    sign: np.ndarray) -> np.ndarray:
    """(T, 3, 3): at each corner the sum of values (T, 3, 3) over all corners that are equal in position,
    normal, UV and sign."""
    signs = np.broadcast_to(sign[:, None, None], (len(sign), 3, 1))
    corners = np.concatenate([positions, normals, uvs, signs], axis=-1, dtype=np.float32).reshape(-1, 9)
    corners += np.float32(0.0)  # -0 and 0 are the same
    rows = np.ascontiguousarray(corners).view(np.dtype((np.void, corners.dtype.itemsize * 9))).ravel()
    _, group = np.unique(rows, return_inverse=True)
    flat = values.reshape(-1, 3)
    sums = np.stack([np.bincount(group, flat[:, axis]) for axis in range(3)], axis=-1)
    return sums[group].reshape(values.shape)


def _angles(positions: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(T, 3) between the edges at each corner, as they lie in the plane of its normal."""
    to_next, to_last = (_unit(_in_plane(np.roll(positions, shift, axis=1) - positions, normals))
                        for shift in (-1, 1))
    return np.arccos(np.clip(np.einsum('tkc,tkc->tk', to_next, to_last), -1.0, 1.0))


def _in_plane(vectors: np.ndarray, normals: np.ndarray) -> np.ndarray:
    return vectors - (vectors * normals).sum(axis=-1, keepdims=True) * normals


def _unit(vectors: np.ndarray) -> np.ndarray:
    """0 stays 0."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-30)
