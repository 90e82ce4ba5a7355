# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's textures that are calculated, on numpy arrays. p: (…, 3) coordinates, scaled already."""

import numpy as np

from . import noise, operations

Array = np.ndarray


def _nudged(p: Array) -> Array:
    """So that faces at whole numbers don't flicker."""
    p = np.asarray(p, np.float32)
    return (p + np.float32(0.000001)) * np.float32(0.999999)


def checker(p: Array) -> Array:
    """(…): 1 for the first colour, 0 for the second."""
    parity = np.abs(np.floor(_nudged(p))) % 2.0
    return ((parity[..., 0] == parity[..., 1]) == (parity[..., 2] == 1.0)).astype(np.float32)


def gradient(kind: str, p: Array) -> Array:
    x, y = p[..., 0], p[..., 1]
    if kind == 'LINEAR':
        value = x
    elif kind == 'QUADRATIC':
        value = np.maximum(x, 0.0) ** 2
    elif kind == 'EASING':
        t = np.clip(x, 0.0, 1.0)
        value = t * t * (3.0 - 2.0 * t)
    elif kind == 'DIAGONAL':
        value = 0.5 * (x + y)
    elif kind == 'RADIAL':
        value = np.arctan2(y, x) / (2.0 * np.pi) + 0.5
    else:
        value = np.maximum(0.999999 - np.sqrt((p * p).sum(axis=-1)), 0.0)
        value = value ** 2 if kind == 'QUADRATIC_SPHERE' else value
    return np.clip(value, 0.0, 1.0)


def magic(p: Array, distortion: Array, depth: int) -> Array:
    """(…, 3)"""
    px, py, pz = np.moveaxis(np.fmod(p, 2.0 * np.pi), -1, 0)
    x = np.sin(5.0 * (px + py + pz))
    y = np.cos(5.0 * (-px + py - pz))
    z = -np.cos(5.0 * (-px - py + pz))
    if depth > 0:
        x, y, z = x * distortion, y * distortion, z * distortion
        y = -np.cos(x - y + z) * distortion
    if depth > 1:
        x = np.cos(x - y - z) * distortion
    if depth > 2:
        z = np.sin(-x - y - z) * distortion
    if depth > 3:
        x = -np.cos(-x + y - z) * distortion
    if depth > 4:
        y = -np.sin(-x + y + z) * distortion
    if depth > 5:
        y = -np.cos(-x + y + z) * distortion
    if depth > 6:
        x = np.cos(x + y + z) * distortion
    if depth > 7:
        z = np.sin(x + y - z) * distortion
    if depth > 8:
        x = -np.cos(-x - y + z) * distortion
    if depth > 9:
        y = -np.sin(x - y + z) * distortion
    divisor = np.where(distortion != 0.0, 2.0 * distortion, 1.0)
    return 0.5 - np.stack([x / divisor, y / divisor, z / divisor], axis=-1)


def wave(kind: str, direction: str, profile: str, p: Array, distortion: Array, detail: Array,
         detail_scale: Array, detail_roughness: Array, phase: Array) -> Array:
    """kind: 'BANDS' or 'RINGS'; direction: an axis, 'DIAGONAL' or 'SPHERICAL'; profile: 'SIN', 'SAW' or
    'TRI'."""
    p = _nudged(p)
    axis = "XYZ".find(direction)
    if kind == 'BANDS':
        n = 20.0 * p[..., axis] if axis >= 0 else 10.0 * p.sum(axis=-1)
    else:
        across = np.array([i != axis for i in range(3)], np.float32)
        n = 20.0 * np.sqrt(((across * p) ** 2).sum(axis=-1))
    n = n + phase
    if np.any(distortion != 0.0):
        bend = noise.fractal(p * detail_scale[..., None], detail, detail_roughness, np.float32(2.0), True)
        n = n + distortion * (2.0 * bend - 1.0)
    if profile == 'SIN':
        return 0.5 + 0.5 * np.sin(n - 0.5 * np.pi)
    n = n / (2.0 * np.pi)
    return n - np.floor(n) if profile == 'SAW' else 2.0 * np.abs(n - np.floor(n + 0.5))


def brick(p: Array, mortar_size: Array, mortar_smooth: Array, bias: Array, width: Array, height: Array,
          offset: float, offset_frequency: int, squash: float, squash_frequency: int) -> tuple[Array, Array]:
    """The share of the second colour in the brick, and that of mortar: (…) each."""
    row = np.floor(operations.divided(p[..., 1], height))
    shift = np.zeros_like(row)
    if offset_frequency and squash_frequency:
        width = np.where(row % squash_frequency == 0.0, width * squash, width)
        shift = np.where(row % offset_frequency == 0.0, width * offset, 0.0)
    column = np.floor(operations.divided(p[..., 0] + shift, width))
    x = p[..., 0] + shift - width * column
    y = p[..., 1] - height * row
    number = (row.astype(np.int64) << 16) + (column.astype(np.int64) & 0xFFFF)
    tint = np.clip(_brick_noise(number) + bias, 0.0, 1.0)
    edge = np.minimum(np.minimum(x, y), np.minimum(width - x, height - y))
    depth = 1.0 - operations.divided(edge, mortar_size)
    soft = np.clip(operations.divided(depth, mortar_smooth), 0.0, 1.0)
    is_inner = (mortar_smooth == 0.0) | (depth >= mortar_smooth)
    mortar = np.where(is_inner, 1.0, soft * soft * (3.0 - 2.0 * soft))
    return tint, np.where(edge >= mortar_size, 0.0, mortar)


def _brick_noise(number: Array) -> Array:
    n = (number + 1013) & 0x7FFFFFFF
    n = ((n >> 13) ^ n).astype(np.uint32)
    with np.errstate(over='ignore'):
        n = n * (n * n * np.uint32(60493) + np.uint32(19990303)) + np.uint32(1376312589)
    return 0.5 * (n & np.uint32(0x7FFFFFFF)).astype(np.float32) / 1073741824.0
