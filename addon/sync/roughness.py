# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures of single values, with coordinates, for expressions that vary over a mesh."""

import zlib
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .. import verglas_core as core
from . import atlas
from .cache import Cache
from .expressions import NUMBERS, Expression, Leaf, Points
from .meshes import Surface

TABLE_ENTRIES = 1024
"""Of an expression of one quantity."""

FINE_TEXELS = 1 << 20
"""Up to this many, a texture is made finer than its image, where what lies between image and value bends."""

CHUNK = 1 << 18
"""Points that are evaluated at a time."""


class Painting(NamedTuple):
    """An expression on the triangles of a surface."""
    texture: core.Texture
    uvs: np.ndarray
    """(T, 3, 2) float32 of the triangles' corners"""


_textures = Cache()


def sweep() -> None:
    """Forgets textures that weren't asked for since the last sweep."""
    _textures.sweep()


def clear() -> None:
    _textures.clear()


def paint(expression: Expression, surface: Surface, resolution: int) -> Painting:
    """resolution: texels along the side of a texture that has to be baked."""
    if not expression.leaves and len(expression.placements) == 1 \
            and len({image.extension for image in expression.placed}) == 1:
        return _of_images(expression, surface)
    if not expression.placed and len(expression.leaves) == 1:
        leaf, = expression.leaves
        if leaf[0] in NUMBERS:
            return _of_one_quantity(expression, surface, leaf)
    return _baked(expression, surface, resolution)


def _texture(key, name: str, make: Callable[[], np.ndarray], extension: str,
             interpolation: str = 'LINEAR') -> core.Texture:
    def made() -> core.Texture:
        values = np.nan_to_num(make(), posinf=1.0, neginf=0.0)
        return core.Texture(name, values, extension, interpolation)
    return _textures.get((key, extension, interpolation), made)


# Images on one UV map

def _of_images(expression: Expression, surface: Surface) -> Painting:
    """Exact where the value is the image's own; else as fine as the image, or finer."""
    placement, = expression.placements
    extension = expression.placed[0].extension
    width, height = np.max([image.size for image in expression.placed], axis=0).tolist()
    uvs = placement.apply(surface.corner_values(('UV', placement.uv_map)))
    is_closest = all(image.interpolation == 'Closest' for image in expression.placed)
    is_texels = is_closest or (expression.is_plain and expression.placed[0].interpolation == 'Linear')
    fine = 1 if is_texels else _odd(float(np.clip((FINE_TEXELS / (width * height)) ** 0.5, 1.0, 15.0)))
    is_cubic = any(image.interpolation in {'Cubic', 'Smart'} for image in expression.placed)
    lower, upper = _range_of(extension, is_cubic, width, height)
    uvs = (uvs - lower) / (upper - lower)
    texture = _texture(
        ("images", expression.key, fine), surface.name,
        lambda: _at_texels(expression, lower, upper, (width * fine, height * fine), fine == 1),
        'REPEAT' if extension in {'REPEAT', 'MIRROR'} else 'EXTEND', 'CLOSEST' if is_closest else 'LINEAR')
    return Painting(texture, uvs.astype(np.float32))


def _odd(number: float) -> int:
    """The next lower one: the image's own texels are then among the finer ones, and values bend there."""
    return 2 * (int(number + 1.0) // 2) - 1


def _range_of(extension: str, is_cubic: bool, width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
    """The image's coordinates over which a texture holds all of it, with the border in which it fades out."""
    if extension in {'REPEAT', 'MIRROR'}:
        return np.zeros(2), np.full(2, 2.0 if extension == 'MIRROR' else 1.0)
    texels = 2 if is_cubic else 1 if extension == 'CLIP' else 0
    border = texels / np.array([width, height])
    return -border, 1.0 + border


def _at_texels(expression: Expression, lower: np.ndarray, upper: np.ndarray, texels: tuple[int, int],
               is_image: bool) -> np.ndarray:
    """(H, W): the expression at the texels' centres. texels: for coordinates 0 … 1."""
    size = np.rint((upper - lower) * texels).astype(int)
    x, y = (lower[i] + (np.arange(size[i]) + 0.5) / size[i] * (upper[i] - lower[i]) for i in range(2))
    rows = max(1, CHUNK // size[0])
    if is_image and tuple(size) == texels:
        rows = size[1]
    parts = []
    for first in range(0, size[1], rows):
        v, u = np.meshgrid(y[first:first + rows], x, indexing='ij')
        uv = np.stack([u.ravel(), v.ravel()], axis=-1)
        points = Points({}, uv, texels if len(uv) == texels[0] * texels[1] else None)
        parts.append(np.broadcast_to(expression.evaluate(points), len(uv)))
    return np.concatenate(parts).reshape(size[1], size[0])


# One quantity of the mesh

def _of_one_quantity(expression: Expression, surface: Surface, leaf: Leaf) -> Painting:
    """A table over the quantity: exact wherever it lies between the corners' values."""
    values = surface.corner_values(leaf)
    lower, upper = float(values.min(initial=np.inf)), float(values.max(initial=-np.inf))
    return _by_table(("quantity", expression.key), surface, values, lower, upper, TABLE_ENTRIES,
                     lambda entries: expression.evaluate(Points({leaf: entries})))


def _by_table(key, surface: Surface, values: np.ndarray, lower: float, upper: float, count: int,
              evaluate: Callable[[np.ndarray], np.ndarray]) -> Painting:
    """values: (T, 3) of the corners, lower … upper."""
    span = max(upper - lower, 1e-12)
    place = (values - lower) / span * (count - 1) + 0.5
    uvs = np.stack([place / count, np.full_like(place, 0.5)], axis=-1)

    def entries() -> np.ndarray:
        inputs = (lower + np.linspace(0.0, span, count)).astype(np.float32)
        return np.broadcast_to(evaluate(inputs), count)[None]
    return Painting(_texture((key, lower, upper), surface.name, entries, 'EXTEND'), uvs.astype(np.float32))


# Anything else

def _baked(expression: Expression, surface: Surface, resolution: int) -> Painting:
    """Evaluated at the texels of an atlas of the triangles; at the corners of meshes that are finer than
    that."""
    needed = set(expression.leaves) | {('UV', placement.uv_map) for placement in expression.placements}
    sums = tuple(zlib.crc32(np.ascontiguousarray(surface.corner_values(leaf))) for leaf in sorted(needed))
    corners = surface.corner_values(('OBJECT', ''))
    key = ("baked", expression.key, resolution, sums, zlib.crc32(np.ascontiguousarray(corners)))
    triangle_count = len(corners)
    if not atlas.fits(triangle_count, resolution):
        every_corner = np.tile(np.eye(3, dtype=np.float32), (triangle_count, 1))
        values = _evaluated(expression, surface, np.repeat(np.arange(triangle_count), 3), every_corner)
        lower, upper = float(values.min()), float(values.max())
        return _by_table(key, surface, values.reshape(-1, 3), lower, upper, 2, lambda entries: entries)
    laid_out = atlas.lay_out(corners, resolution)

    def bake() -> np.ndarray:
        values = np.full(resolution * resolution, np.nan, np.float32)
        for texels in laid_out.texels:
            values[texels.index] = _evaluated(expression, surface, texels.triangle, texels.weights)
        mean = np.nanmean(values)  # for the texels between, so that the texture's own mean is the surface's
        return np.nan_to_num(values, nan=mean).reshape(resolution, resolution)
    return Painting(_texture(key, surface.name, bake, 'EXTEND'), laid_out.uvs)


def _evaluated(expression: Expression, surface: Surface, triangle: np.ndarray,
               weights: np.ndarray) -> np.ndarray:
    """(N,) at points of triangles, by barycentric weights (N, 3)."""
    parts = []
    for first in range(0, len(triangle), CHUNK):
        part = slice(first, first + CHUNK)
        points = Points(lambda leaf, part=part: surface.at(leaf, triangle[part], weights[part]))
        parts.append(np.broadcast_to(expression.evaluate(points), len(triangle[part])))
    return np.concatenate(parts) if parts else np.zeros(0, np.float32)
