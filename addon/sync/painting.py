# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures, with coordinates, for expressions that vary over a mesh."""

import zlib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .. import verglas_core as core
from . import atlas
from .cache import Shared
from .expressions import NUMBERS, Expression, Leaf, Points, Texels
from .meshes import Surface

TABLE_ENTRIES = 1024
"""Of an expression of one quantity."""

FINE_TEXELS = 1 << 20
"""Up to this many, a texture is made finer than its image, where what lies between image and value bends."""

CHUNK = 1 << 18
"""Points that are evaluated at a time."""


@dataclass(frozen=True, eq=False)
class Painting:
    """An expression on the triangles of a surface."""
    texture: core.Texture | core.VectorTexture
    uvs: np.ndarray
    """(T, 3, 2) float32 of the triangles' corners"""


_textures = Shared()
_paintings = Shared()


def paint(expression: Expression, surface: Surface, resolution: int, has_slopes: bool = False) -> Painting:
    """resolution: texels along the side of a texture that has to be baked. has_slopes: whether differences of
    neighbouring texels count, too."""
    if expression.is_constant:
        return _constant(expression, surface)
    if not expression.leaves and len(expression.placements) == 1 \
            and len({image.extension for image in expression.placed}) == 1:
        return _of_images(expression, surface)
    if not expression.placed and len(expression.leaves) == 1:
        leaf, = expression.leaves
        if leaf[0] in NUMBERS:
            return _of_one_quantity(expression, surface, leaf)
    return _baked(expression, surface, resolution, margin=1 if has_slopes else 0)


def paint_both(first: Expression | None, second: Expression | None, surface: Surface,
               resolution: int) -> tuple[Painting | None, Painting | None]:
    """Two that have the same coordinates; None for None."""
    painted = tuple(each and paint(each, surface, resolution) for each in (first, second))
    if None in painted or np.array_equal(painted[0].uvs, painted[1].uvs):
        return painted
    # With margins both have the same atlas, whatever they are
    return tuple(_baked(each, surface, resolution, margin=1) for each in (first, second))


def _constant(expression: Expression, surface: Surface) -> Painting:
    texture = _texture(("constant", expression.key), surface.name,
                       lambda: expression.at(Points({}), 1)[None], 'EXTEND')
    return Painting(texture, np.zeros((surface.triangle_count, 3, 2), np.float32))


def _texture(key, name: str, make: Callable[[], np.ndarray], extension: str,
             interpolation: str = 'LINEAR') -> core.Texture | core.VectorTexture:
    def made() -> core.Texture | core.VectorTexture:
        return _of_values(name, make(), extension, interpolation)
    return _textures.get((key, extension, interpolation), made)


def _of_values(name: str, values: np.ndarray, extension: str,
               interpolation: str = 'LINEAR', is_atlas: bool = False) -> core.Texture | core.VectorTexture:
    """values: (H, W) or (H, W, 3)."""
    kind = core.Texture if values.ndim == 2 else core.VectorTexture
    return kind(name, values, extension, interpolation, is_atlas)


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
        lambda: _at_texels(expression, lower, upper, (width * fine, height * fine)),
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


def _at_texels(expression: Expression, lower: np.ndarray, upper: np.ndarray,
               texels: tuple[int, int]) -> np.ndarray:
    """(H, W, *shape): the expression at the texels' centres. texels: for coordinates 0 … 1."""
    width, height = np.rint((upper - lower) * texels).astype(int).tolist()
    x, y = (lower[i] + (np.arange(size) + 0.5) / size * (upper[i] - lower[i])
            for i, size in enumerate((width, height)))
    values = np.empty((height, width, *expression.shape), np.float32)
    step = max(1, CHUNK // width)
    for first in range(0, height, step):
        rows = slice(first, min(first + step, height))
        points = Points({}, lambda rows=rows: _grid(x, y[rows]),
                        Texels(texels, rows) if (width, height) == texels else None)
        count = len(y[rows])
        values[rows] = expression.at(points, count * width).reshape(count, width, *expression.shape)
    return values


def _grid(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """(N, 2), row by row."""
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


# One quantity of the mesh

def _of_one_quantity(expression: Expression, surface: Surface, leaf: Leaf) -> Painting:
    """A table over the quantity: exact wherever it lies between the corners' values."""
    values = surface.corner_values(leaf)
    lower, upper = float(values.min()), float(values.max())

    def entries() -> np.ndarray:
        inputs = np.linspace(lower, upper, TABLE_ENTRIES, dtype=np.float32)
        return expression.at(Points({leaf: inputs}), TABLE_ENTRIES)[None]
    texture = _texture(("quantity", expression.key, lower, upper), surface.name, entries, 'EXTEND')
    return Painting(texture, _table_uvs(values, lower, upper, TABLE_ENTRIES))


def _table_uvs(values: np.ndarray, lower: float, upper: float, count: int) -> np.ndarray:
    """(T, 3, 2) where a table of count entries, lower … upper, has the corners' values (T, 3)."""
    place = (values - lower) / max(upper - lower, 1e-12) * (count - 1) + 0.5
    return np.stack([place / count, np.full_like(place, 0.5)], axis=-1).astype(np.float32)


# Anything else

def _baked(expression: Expression, surface: Surface, resolution: int, margin: int) -> Painting:
    """Evaluated at the texels of an atlas of the triangles. Of meshes that are finer than that single values,
    whose slopes don't count, are evaluated at the corners; the atlas of others grows."""
    needed = set(expression.leaves) | {('UV', placement.uv_map) for placement in expression.placements}
    sums = tuple(zlib.crc32(np.ascontiguousarray(surface.corner_values(leaf))) for leaf in sorted(needed))
    corners = surface.corner_values(('OBJECT', ''))
    key = ("baked", expression.key, resolution, margin, sums, zlib.crc32(np.ascontiguousarray(corners)))

    def bake() -> Painting:
        if not atlas.fits(len(corners), resolution) and expression.shape == () and margin == 0:
            return _at_corners(expression, surface)
        side = resolution
        while not atlas.fits(len(corners), side, margin):
            side *= 2
        return _at_atlas(expression, surface, side, margin)
    return _paintings.get(key, bake)


def _at_atlas(expression: Expression, surface: Surface, resolution: int, margin: int) -> Painting:
    laid_out = atlas.lay_out(surface.corner_values(('OBJECT', '')), resolution, margin)
    values = np.full((resolution * resolution, *expression.shape), np.nan, np.float32)
    for texels in laid_out.texels:
        values[texels.index] = _evaluated(expression, surface, texels.triangle, texels.weights)
    mean = np.nanmean(values, axis=0)  # for the texels between, so that the texture's own is the surface's
    values = np.where(np.isnan(values), mean, values).reshape(resolution, resolution, *expression.shape)
    return Painting(_of_values(surface.name, values, 'EXTEND', is_atlas=True), laid_out.uvs)


def _at_corners(expression: Expression, surface: Surface) -> Painting:
    count = surface.triangle_count
    values = _evaluated(expression, surface, np.repeat(np.arange(count), 3),
                        np.tile(np.eye(3, dtype=np.float32), (count, 1)))
    lower, upper = float(values.min()), float(values.max())
    uvs = _table_uvs(values.reshape(-1, 3), lower, upper, 2)
    return Painting(core.Texture(surface.name, np.array([[lower, upper]], np.float32), 'EXTEND'), uvs)


def _evaluated(expression: Expression, surface: Surface, triangle: np.ndarray,
               weights: np.ndarray) -> np.ndarray:
    """(N, *shape) at points of triangles, by barycentric weights (N, 3)."""
    parts = []
    for first in range(0, len(triangle), CHUNK):
        part = slice(first, first + CHUNK)
        points = Points(lambda leaf, part=part: surface.at(leaf, triangle[part], weights[part]))
        parts.append(expression.at(points, len(triangle[part])))
    return np.concatenate(parts) if parts else np.zeros((0, *expression.shape), np.float32)
