# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixels of Blender's images as Cycles' Image Texture sees them, and numpy look-ups in them."""

import itertools
import os
import zlib
from collections.abc import Hashable
from typing import NamedTuple

import bpy
import numpy as np

from .. import compat
from .. import verglas_core as core
from .cache import Cache, Client


class Unreadable(Exception):
    """An image without pixels; the message completes "which …"."""


class Picture(NamedTuple):
    """An image's pixels, as Cycles interpolates between them: bytes that are sRGB stay so until they have
    been looked up. Data and channel-packed images have their colours apart from alpha; others are
    premultiplied."""
    key: Hashable
    """equal for equal pixels"""
    rgba: np.ndarray
    """(H, W, 4) float32, row 0 at the bottom"""
    is_srgb: bool
    """else scene-linear"""
    is_associated: bool
    """premultiplied by alpha"""
    origin: tuple[int, int] = (0, 0)
    """coordinates of its lower left corner, in tiles"""
    span: tuple[int, int] = (1, 1)
    """tiles across and up"""


SCENE_LINEAR_MATRICES = {
    'XYZ': "from_xyz_d65_to_scene_linear",
    'Linear CIE-XYZ D65': "from_xyz_d65_to_scene_linear",
    'Linear ACES': "from_aces_to_scene_linear",
    'ACES2065-1': "from_aces_to_scene_linear",
}
"""mathutils.Color's conversion for other linear colour spaces."""

MOST_TEXELS = 1 << 25
"""Of all tiles of an image together; larger ones are made smaller."""

MISSING = (1.0, 0.0, 1.0, 1.0)
"""Where an image has no tile, as in Cycles."""

_pictures = Cache()
_generations: dict[str, int] = {}
_counter = itertools.count(1)
_all_changed = 0
"""The generation of all others."""


def name_of(image: bpy.types.Image) -> str:
    """What stays the same when undo replaces the image."""
    return image.name_full


def note_change(image: bpy.types.Image) -> None:
    """Its pixels are read again when they are needed next."""
    _generations[name_of(image)] = next(_counter)


def note_all_changes() -> None:
    global _all_changed
    _all_changed = next(_counter)
    _generations.clear()
    _pictures.clear()


def sweep(client: Client) -> None:
    """As Cache.sweep."""
    _pictures.sweep(client)


def picture(image: bpy.types.Image, check: bool) -> Picture:
    """check: reads unsaved pixels even if Blender hasn't told of a change; scripts can write them without
    its knowing. Raises Unreadable."""
    if image.source == 'TILED':
        return _tiled(image)
    if check and image.is_dirty:
        pixels = _pixels(image)
        key = (*_state(image), zlib.crc32(pixels))
        return _pictures.get(key, lambda: _picture_of(key, pixels, image))
    key = version(image)
    return _pictures.get(key, lambda: _picture_of(key, _pixels(image), image))


def version(image: bpy.types.Image) -> tuple[Hashable, ...]:
    """Differs once Blender has told of a change of its pixels."""
    return (*_state(image), _generations.get(name_of(image), _all_changed))


def _state(image: bpy.types.Image) -> tuple[Hashable, ...]:
    """What else the pixels depend on."""
    path = absolute_path(image)
    modified = os.stat(path).st_mtime_ns if image.source == 'FILE' and os.path.isfile(path) else 0
    frame = bpy.context.scene.frame_current if image.source in {'SEQUENCE', 'MOVIE'} else 0
    return (name_of(image), image.source, path, modified, frame, image.colorspace_settings.name,
            image.alpha_mode, tuple(image.size))


def absolute_path(image: bpy.types.Image) -> str:
    """Of its file, in whichever folder its .blend is; of tiled ones with <UDIM> in the name."""
    folder = os.path.dirname(image.filepath_from_user())
    return os.path.normpath(os.path.join(folder, bpy.path.basename(image.filepath)))


# Tiles

def _tiled(image: bpy.types.Image) -> Picture:
    """All tiles beside each other. They come from their files: Blender gives the pixels of the first only."""
    if image.is_dirty or image.packed_files:
        raise Unreadable("has a tiled image that isn't saved as files, which isn't supported yet")
    paths = {tile.number: absolute_path(image).replace("<UDIM>", str(tile.number)) for tile in image.tiles}
    lost = next((path for path in paths.values() if not os.path.isfile(path)), None)
    if lost is not None:
        raise Unreadable(f"has a tile that can't be read ('{lost}')")
    times = tuple(os.stat(path).st_mtime_ns for path in paths.values())
    key = (*version(image), tuple(paths), times)
    return _pictures.get(key, lambda: _beside_each_other(key, image, paths))


def _beside_each_other(key: Hashable, image: bpy.types.Image, paths: dict[int, str]) -> Picture:
    """paths: by the tiles' numbers, 1001 + u + 10 v."""
    space = image.colorspace_settings.name
    if space != 'sRGB' and space not in compat.LINEAR_COLOR_SPACES:
        raise Unreadable(f"has tiles in the color space '{space}', which isn't supported yet")
    try:
        tiles = {divmod(number - 1001, 10)[::-1]: core.EnvironmentMap.load(path).pixels
                 for number, path in paths.items()}
    except core.Error as fault:
        raise Unreadable(f"has a tile that can't be read. {fault}") from fault
    origin = tuple(min(place[axis] for place in tiles) for axis in (0, 1))
    span = tuple(max(place[axis] for place in tiles) - origin[axis] + 1 for axis in (0, 1))
    side = max(max(pixels.shape[:2]) for pixels in tiles.values())
    side = min(side, int((MOST_TEXELS / (span[0] * span[1])) ** 0.5))
    rgba = np.empty((span[1] * side, span[0] * side, 4), np.float32)
    rgba[:] = MISSING
    for (u, v), pixels in tiles.items():
        rows, columns = ((np.arange(side) * size) // side for size in pixels.shape[:2])
        y, x = (v - origin[1]) * side, (u - origin[0]) * side
        rgba[y:y + side, x:x + side, :3] = pixels[rows[:, None], columns]
    is_srgb = space == 'sRGB' and not paths[min(paths)].lower().endswith((".exr", ".hdr"))
    return Picture(key, rgba, is_srgb, False, origin, span)


# Pixels

def _pixels(image: bpy.types.Image) -> np.ndarray:
    """(H, W, C) float32 as Blender holds them: floats scene-linear, bytes in their own colour space."""
    width, height = image.size
    if width == 0 or height == 0:
        raise Unreadable(f"has an image that can't be read ({_whereabouts(image)})")
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(height, width, -1)


def _whereabouts(image: bpy.types.Image) -> str:
    """Its name and path and, where that is relative, the file that it stands for."""
    path = os.path.abspath(absolute_path(image))
    is_relative = image.filepath not in {"", path}
    return f"'{image.name}', '{image.filepath}'" + (f", looked for at '{path}'" if is_relative else "")


def _picture_of(key: Hashable, pixels: np.ndarray, image: bpy.types.Image) -> Picture:
    rgba = _with_four_channels(pixels)
    if image.alpha_mode == 'NONE':
        rgba[..., 3] = 1.0
    space = image.colorspace_settings.name
    is_srgb = space == 'sRGB' and not image.is_float
    if not (image.is_float or is_srgb or space in compat.LINEAR_COLOR_SPACES):
        if space not in SCENE_LINEAR_MATRICES:
            raise Unreadable(f"has an image in the color space '{space}', which isn't supported yet")
        rgba[..., :3] = rgba[..., :3] @ _matrix_of(space).T
    is_associated = not (image.colorspace_settings.is_data or image.alpha_mode in {'NONE', 'CHANNEL_PACKED'})
    if is_associated and not image.is_float and rgba[..., 3].min() < 1.0:
        rgba[..., :3] *= rgba[..., 3:]
    return Picture(key, rgba, is_srgb, is_associated)


def _with_four_channels(pixels: np.ndarray) -> np.ndarray:
    channels = pixels.shape[2]
    if channels == 4:
        return pixels
    rgba = np.ones((*pixels.shape[:2], 4), np.float32)
    rgba[..., :3] = pixels[..., :3] if channels == 3 else pixels[..., :1]
    if channels == 2:
        rgba[..., 3] = pixels[..., 1]
    return rgba


def _matrix_of(space: str) -> np.ndarray:
    """(3, 3): to scene-linear."""
    from mathutils import Color
    return np.array([getattr(Color(unit), SCENE_LINEAR_MATRICES[space])() for unit in np.eye(3)],
                    np.float32).T


def linear_from_srgb(values: np.ndarray) -> np.ndarray:
    return np.where(values <= 0.04045, values / 12.92, ((np.maximum(values, 0.0) + 0.055) / 1.055) ** 2.4)


def linear_from_srgb_bytes(values: np.ndarray) -> np.ndarray:
    """values: multiples of 1/255 within 0 … 1, or their products with such, to the nearest."""
    return _SRGB_TABLE[(values * np.float32(255.0) + np.float32(0.5)).astype(np.uint8)]


_SRGB_TABLE = linear_from_srgb(np.arange(256, dtype=np.float32) / np.float32(255.0)).astype(np.float32)


# Look-ups

def wrapped(x: np.ndarray, size: int, extension: str) -> np.ndarray:
    """Indices of texels within 0 … size - 1; those that Clip leaves empty are -1."""
    if extension == 'REPEAT':
        return x % size
    if extension == 'MIRROR':
        x = x % (2 * size)
        return np.where(x < size, x, 2 * size - 1 - x)
    if extension == 'CLIP':
        return np.where((x >= 0) & (x < size), x, -1)
    return np.clip(x, 0, size - 1)


def sample(rgba: np.ndarray, uv: np.ndarray, extension: str, interpolation: str) -> np.ndarray:
    """(N, 4) values of rgba (H, W, 4) at uv (N, 2); centres of texels lie at halves. interpolation:
    'Closest', 'Linear', and 'Cubic' or 'Smart', which is cubic, too."""
    height, width = rgba.shape[:2]
    uv = np.nan_to_num(np.clip(uv, -1e6, 1e6), posinf=0.0, neginf=0.0)
    place = uv.astype(np.float64) * (width, height)
    if interpolation == 'Closest':
        corner = np.floor(place).astype(np.int64)
        return _fetch(rgba, corner[:, 0], corner[:, 1], extension)
    place -= 0.5
    corner = np.floor(place).astype(np.int64)
    t = (place - corner).astype(np.float32)
    weigh, first = (_linear_weights, 0) if interpolation == 'Linear' else (_cubic_weights, -1)
    across, up = weigh(t[:, 0]), weigh(t[:, 1])
    result = np.zeros((len(uv), 4), np.float32)
    for j, wy in enumerate(up):
        for i, wx in enumerate(across):
            texels = _fetch(rgba, corner[:, 0] + first + i, corner[:, 1] + first + j, extension)
            result += (wx * wy)[:, None] * texels
    return result


def _fetch(rgba: np.ndarray, x: np.ndarray, y: np.ndarray, extension: str) -> np.ndarray:
    height, width = rgba.shape[:2]
    x, y = wrapped(x, width, extension), wrapped(y, height, extension)
    texels = rgba[y, x]
    if extension == 'CLIP':
        texels[(x < 0) | (y < 0)] = 0.0
    return texels


def _linear_weights(t: np.ndarray) -> tuple[np.ndarray, ...]:
    return 1.0 - t, t


def _cubic_weights(t: np.ndarray) -> tuple[np.ndarray, ...]:
    """Of the uniform cubic B-spline."""
    return ((1.0 - t) ** 3 / 6.0, (3.0 * t ** 3 - 6.0 * t ** 2 + 4.0) / 6.0,
            (-3.0 * t ** 3 + 3.0 * t ** 2 + 3.0 * t + 1.0) / 6.0, t ** 3 / 6.0)
