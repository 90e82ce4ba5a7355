# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Voronoi Texture, on numpy arrays: S. Worley, A Cellular Texture Basis Function, 1996. Each unit
cell of space has one point; p: (…, D) float32 coordinates in 1 to 4 dimensions, scaled already."""

import itertools
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from . import noise, operations

Array = np.ndarray

Distance = Callable[[Array], Array]
"""Length (…) of differences (…, D)."""

_ORDERS = ((0, 1, 2, 3), (3, 0, 1, 2), (2, 3, 0, 1), (1, 2, 3, 0))
"""Of a cell's four coordinates, for the four of its point."""


class Cell(NamedTuple):
    """What is found of the points about a place."""
    distance: Array
    """(…)"""
    color: Array
    """(…, 3)"""
    position: Array
    """(…, D)"""


def distance_of(metric: str, exponent: Array) -> Distance:
    """metric: 'EUCLIDEAN', 'MANHATTAN', 'CHEBYCHEV' or 'MINKOWSKI', which alone has the exponent."""
    if metric == 'MANHATTAN':
        return lambda d: np.abs(d).sum(axis=-1)
    if metric == 'CHEBYCHEV':
        return lambda d: np.abs(d).max(axis=-1)
    if metric == 'MINKOWSKI':
        return lambda d: (np.abs(d) ** exponent[..., None]).sum(axis=-1) ** (1.0 / exponent)
    return _length


def _length(d: Array) -> Array:
    return np.sqrt((d * d).sum(axis=-1))


def nearest(p: Array, randomness: Array, distance: Distance, second: bool) -> Cell:
    """The nearest point, or the second nearest."""
    cell, place = _divided(p)
    found = [(np.full(p.shape[:-1], np.float32(8.0)), np.zeros_like(p), np.zeros_like(p))] * 2
    for offset in _offsets(p, 1):
        point = _point(cell, offset, randomness)
        here = distance(point - place), point, np.broadcast_to(offset, p.shape)
        is_first, is_second = (here[0] < each[0] for each in found)
        found = [_chosen(is_first, here, found[0]),
                 _chosen(is_first, found[0], _chosen(is_second, here, found[1]))]
    length, point, offset = found[1 if second else 0]
    return Cell(length, noise.random_color(cell + offset), cell + point)


def _chosen(condition: Array, those: tuple[Array, ...], others: tuple[Array, ...]) -> tuple[Array, ...]:
    return tuple(np.where(condition if a.ndim == condition.ndim else condition[..., None], a, b)
                 for a, b in zip(those, others))


def smooth(p: Array, randomness: Array, distance: Distance, smoothness: Array) -> Cell:
    """As the nearest point, but passing over from one to the next. smoothness: 0 … 1 of the node."""
    cell, place = _divided(p)
    width = np.clip(0.5 * smoothness, 1e-6, 0.5)
    length = np.full(p.shape[:-1], np.float32(8.0))
    color, position = np.zeros((*p.shape[:-1], 3), np.float32), np.zeros_like(p)
    for offset in _offsets(p, 2):
        point = _point(cell, offset, randomness)
        here = distance(point - place)
        t = np.clip(0.5 + 0.5 * (length - here) / width, 0.0, 1.0)
        t = t * t * (3.0 - 2.0 * t)
        dip = width * t * (1.0 - t)
        length = operations.mix(length, here, t) - dip
        small_dip, t = (dip / (1.0 + 3.0 * width))[..., None], t[..., None]
        color = operations.mix(color, noise.random_color(cell + offset), t) - small_dip
        position = operations.mix(position, point, t) - small_dip
    return Cell(length, color, cell + position)


def distance_to_edge(p: Array, randomness: Array) -> Array:
    """(…): to where another point becomes the nearest."""
    cell, place = _divided(p)
    if p.shape[-1] == 1:
        points = [_point(cell, np.float32([offset]), randomness) for offset in (-1.0, 0.0, 1.0)]
        middles = (0.5 * (points[1] + points[i]) for i in (0, 2))
        return np.minimum(*(np.abs(middle - place)[..., 0] for middle in middles))
    to_nearest = nearest(p, randomness, _length, False).position - cell - place
    result = np.full(p.shape[:-1], np.float32(8.0))
    for offset in _offsets(p, 1):
        to_point = _point(cell, offset, randomness) - place
        across = to_point - to_nearest
        is_other = (across * across).sum(axis=-1) > 1e-4
        middle = 0.5 * (to_nearest + to_point)
        edge = operations.divided((middle * across).sum(axis=-1), _length(across))
        result = np.where(is_other, np.minimum(result, edge), result)
    return result


def radius(p: Array, randomness: Array) -> Array:
    """(…): of spheres about the points that touch."""
    cell, _ = _divided(p)
    own = nearest(p, randomness, _length, False).position
    home = np.floor(own)  # points lie in their cells
    result = np.full(p.shape[:-1], np.float32(8.0))
    for offset in _offsets(p, 1):
        if offset.any():
            other = home + _point(home, offset, randomness)
            result = np.minimum(result, _length(other - own))
    return 0.5 * result


def _divided(p: Array) -> tuple[Array, Array]:
    """The cell's corner, and where p lies in it."""
    cell = np.floor(p)
    return cell, p - cell


def _offsets(p: Array, reach: int) -> Iterator[Array]:
    """To the cells about one, the first coordinate changing fastest."""
    steps = range(-reach, reach + 1)
    return (np.array(offset[::-1], np.float32) for offset in itertools.product(steps, repeat=p.shape[-1]))


def _point(cell: Array, offset: Array, randomness: Array) -> Array:
    """(…, D): of the cell at an offset from another, relative to that."""
    return offset + _random_place(cell + offset) * randomness[..., None]


def _random_place(cell: Array) -> Array:
    """(…, D), 0 … 1"""
    dimensions = cell.shape[-1]
    if dimensions == 1:
        return noise.random_number(cell)[..., None]
    if dimensions == 2:
        return noise.random_color(cell)[..., :2]
    if dimensions == 3:
        return noise.random_color(cell)
    return np.stack([noise.random_number(cell[..., order]) for order in _ORDERS], axis=-1)
