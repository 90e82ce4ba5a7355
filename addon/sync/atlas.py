# SPDX-License-Identifier: GPL-3.0-or-later
"""Lays the triangles of a mesh out on a square texture, each for itself: two share a square cell, one in its
lower left, one in its upper right half, apart enough that bilinear look-ups don't mix them.

margin: how far beyond the triangles look-ups may reach, in texels."""

from typing import NamedTuple

import numpy as np


class Texels(NamedTuple):
    """Texels that triangles cover or border on."""
    index: np.ndarray
    """(N,) of the texture, row by row"""
    triangle: np.ndarray
    """(N,)"""
    weights: np.ndarray
    """(N, 3) barycentric; outside the triangle, at its border, some are negative"""


class Atlas(NamedTuple):
    uvs: np.ndarray
    """(T, 3, 2) float32 of the triangles' corners"""
    texels: list[Texels]


def _border(margin: int) -> int:
    """Texels of a cell's side that a triangle's legs leave free."""
    return 3 + 3 * margin


def _smallest_cell(margin: int) -> int:
    """Texels along its side, a power of two."""
    return 1 << _border(margin).bit_length()


def fits(triangle_count: int, resolution: int, margin: int = 0) -> bool:
    return triangle_count * _smallest_cell(margin) ** 2 <= 2 * resolution ** 2


def lay_out(corners: np.ndarray, resolution: int, margin: int = 0) -> Atlas:
    """corners: (T, 3, 3) positions; longer edges get more texels. resolution: texels along a side, a power of
    two; the triangles must fit."""
    smallest, border = _smallest_cell(margin), _border(margin)
    sides = _cell_sides(corners, resolution, margin)
    uvs = np.empty((len(corners), 3, 2), np.float32)
    texels = []
    first = 0  # the smallest cells are numbered along a Morton curve: squares of powers of two stay whole
    for side in sorted(set(sides.tolist()), reverse=True):
        members = np.flatnonzero(sides == side)
        cell, is_upper = np.arange(len(members)) // 2, np.arange(len(members)) % 2 == 1
        number = first + cell * (side // smallest) ** 2
        place = [_every_second_bit(number), _every_second_bit(number >> 1)]
        origin = smallest * np.stack(place, axis=-1)
        leg = side - border
        legs = np.array([(0, 0), (leg, 0), (0, leg)]) + 0.5 + margin
        places = np.where(is_upper[:, None, None], side - legs, legs)
        uvs[members] = (origin[:, None] + places) / resolution
        texels += [_texels(members[is_upper == half], origin[is_upper == half], side, half, resolution,
                           margin) for half in (False, True)]
        first = number[-1] + (side // smallest) ** 2
    return Atlas(uvs, texels)


def _cell_sides(corners: np.ndarray, resolution: int, margin: int) -> np.ndarray:
    """(T,) powers of two, as large as the texture allows."""
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    legs = edges.max(axis=1) / np.sqrt(2.0)
    lower, upper = 0.0, resolution / max(float(legs.max(initial=0.0)), 1e-12)
    smallest = _smallest_cell(margin)
    sides = np.full(len(legs), smallest)
    for _ in range(24):
        density = 0.5 * (lower + upper)
        exponents = np.ceil(np.log2(np.maximum(density * legs + _border(margin), smallest)))
        tried = 2 ** exponents.astype(np.int64)
        if _area(tried) <= resolution ** 2:
            lower, sides = density, tried
        else:
            upper = density
    return sides


def _area(sides: np.ndarray) -> int:
    kinds, counts = np.unique(sides, return_counts=True)
    return int(((counts + 1) // 2 * kinds ** 2).sum())


def _texels(members: np.ndarray, origin: np.ndarray, side: int, is_upper: bool, resolution: int,
            margin: int) -> Texels:
    """Those of one half of each member's cell."""
    j, i = np.mgrid[0:side, 0:side]
    is_ours = i + j <= side - 2
    i, j = i[is_ours], j[is_ours]
    x, y = (i - margin) / (side - _border(margin)), (j - margin) / (side - _border(margin))
    weights = np.stack([1.0 - x - y, x, y], axis=-1).astype(np.float32)
    if is_upper:
        i, j = side - 1 - i, side - 1 - j
    index = (origin[:, 1:] + j) * resolution + origin[:, :1] + i
    return Texels(index.ravel(), np.repeat(members, len(i)), np.tile(weights, (len(members), 1)))


def _every_second_bit(number: np.ndarray) -> np.ndarray:
    """Bits 0, 2, 4, … together."""
    n = number.astype(np.uint64) & np.uint64(0x5555555555555555)
    for shift, mask in ((1, 0x3333333333333333), (2, 0x0F0F0F0F0F0F0F0F), (4, 0x00FF00FF00FF00FF),
                        (8, 0x0000FFFF0000FFFF), (16, 0x00000000FFFFFFFF)):
        n = (n | (n >> np.uint64(shift))) & np.uint64(mask)
    return n.astype(np.int64)
