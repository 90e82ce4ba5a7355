# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's noises, on numpy arrays: random numbers by hashing, Perlin noise, and what is made of it. p:
(…, D) float32 coordinates in 1 to 4 dimensions, scaled already."""

import numpy as np

from . import operations

Array = np.ndarray


# Bob Jenkins' lookup3

def _hash(*keys: Array) -> Array:
    """uint32 of one to four arrays of uint32."""
    start = np.uint32((0xDEADBEEF + (len(keys) << 2) + 13) & 0xFFFFFFFF)
    with np.errstate(over='ignore'):
        a, b, c = (key + start for key in (*keys[:3], *(np.zeros_like(keys[0]),) * (3 - len(keys))))
        if len(keys) == 4:
            a, b, c = _mixed(a, b, c)
            a = a + keys[3]
        c = (c ^ b) - _turned(b, 14)
        a = (a ^ c) - _turned(c, 11)
        b = (b ^ a) - _turned(a, 25)
        c = (c ^ b) - _turned(b, 16)
        a = (a ^ c) - _turned(c, 4)
        b = (b ^ a) - _turned(a, 14)
        return (c ^ b) - _turned(b, 24)


def _mixed(a: Array, b: Array, c: Array) -> tuple[Array, Array, Array]:
    for first, second, third in ((4, 6, 8), (16, 19, 4)):
        a = (a - c) ^ _turned(c, first)
        c = c + b
        b = (b - a) ^ _turned(a, second)
        a = a + c
        c = (c - b) ^ _turned(b, third)
        b = b + a
    return a, b, c


def _turned(x: Array, bits: int) -> Array:
    return (x << np.uint32(bits)) | (x >> np.uint32(32 - bits))


def random_number(p: Array) -> Array:
    """(…), 0 … 1; the same for the same p only."""
    bits = np.ascontiguousarray(p, np.float32).view(np.uint32)
    return (_hash(*np.moveaxis(bits, -1, 0)) / np.float32(0xFFFFFFFF)).astype(np.float32)


_ORDERS = ((0, 1, 2, 3), (2, 0, 3, 1), (3, 2, 1, 0))
"""Of four coordinates, for the three numbers of a colour."""


def random_color(p: Array) -> Array:
    """(…, 3), 0 … 1"""
    if p.shape[-1] == 4:
        return np.stack([random_number(p[..., order]) for order in _ORDERS], axis=-1)
    return np.stack([random_number(p), *(random_number(_with(p, i)) for i in (1, 2))], axis=-1)


def _with(p: Array, number: float) -> Array:
    """One dimension more."""
    return np.concatenate([p, np.full((*p.shape[:-1], 1), number, np.float32)], axis=-1)


# Perlin noise: K. Perlin, Improving Noise, 2002

_AMPLITUDES = {1: 0.25, 2: 0.6616, 3: 0.9820, 4: 0.8344}


def perlin(p: Array) -> Array:
    """-1 … 1, about."""
    dimensions = p.shape[-1]
    cell = np.floor(p)
    t = p - cell
    fade = t * t * t * (t * (6.0 * t - 15.0) + 10.0)
    corner = cell.astype(np.int64)
    slope = (_slope_1d, _slope_2d, _slope_3d, _slope_4d)[dimensions - 1]
    result = np.float32(0.0)
    for number in range(2 ** dimensions):
        step = np.array([(number >> axis) & 1 for axis in range(dimensions)])
        weights = np.where(step == 1, fade, 1.0 - fade).prod(axis=-1)
        hashed = _hash(*np.moveaxis((corner + step).astype(np.uint32), -1, 0))
        result = result + weights * slope(hashed, t - step.astype(np.float32))
    return np.float32(_AMPLITUDES[dimensions]) * result


def _slope_1d(hashed: Array, t: Array) -> Array:
    slope = (1 + (hashed & np.uint32(7))).astype(np.float32)
    return np.where(hashed & np.uint32(8), -slope, slope) * t[..., 0]


def _slope_2d(hashed: Array, t: Array) -> Array:
    h = hashed & np.uint32(7)
    x, y = t[..., 0], t[..., 1]
    u, v = np.where(h < 4, x, y), 2.0 * np.where(h < 4, y, x)
    return np.where(h & 1, -u, u) + np.where(h & 2, -v, v)


def _slope_3d(hashed: Array, t: Array) -> Array:
    h = hashed & np.uint32(15)
    x, y, z = t[..., 0], t[..., 1], t[..., 2]
    u = np.where(h < 8, x, y)
    v = np.where(h < 4, y, np.where((h == 12) | (h == 14), x, z))
    return np.where(h & 1, -u, u) + np.where(h & 2, -v, v)


def _slope_4d(hashed: Array, t: Array) -> Array:
    h = hashed & np.uint32(31)
    x, y, z, w = (t[..., axis] for axis in range(4))
    u, v, s = np.where(h < 24, x, y), np.where(h < 16, y, z), np.where(h < 8, z, w)
    return np.where(h & 1, -u, u) + np.where(h & 2, -v, v) + np.where(h & 4, -s, s)


def _octave(p: Array, scale: Array) -> Array:
    return perlin(p * np.asarray(scale, np.float32)[..., None])


def fractal(p: Array, detail: Array, roughness: Array, lacunarity: Array, normalize: bool) -> Array:
    """Octaves, each finer and weaker than the one before; the last one in part. detail: one number for all
    points."""
    p = np.asarray(p, np.float32)
    detail = float(np.clip(np.max(detail), 0.0, 15.0))
    roughness = np.clip(roughness, 0.0, 1.0) if normalize else np.maximum(roughness, 0.0)
    scale, amplitude, total, weight = np.float32(1.0), np.float32(1.0), np.float32(0.0), np.float32(0.0)
    for _ in range(int(detail) + 1):
        total = total + amplitude * _octave(p, scale)
        weight = weight + amplitude
        amplitude = amplitude * roughness
        scale = scale * lacunarity
    rest = detail - int(detail)
    if rest == 0.0:
        return 0.5 * total / weight + 0.5 if normalize else total
    more = total + amplitude * _octave(p, scale)
    if not normalize:
        return operations.mix(total, more, rest)
    return 0.5 * operations.mix(total / weight, more / (weight + amplitude), rest) + 0.5


# The Noise Texture

def noise(p: Array, is_color: bool, normalize: bool, detail: Array, roughness: Array, distortion: Array,
          lacunarity: Array = np.float32(2.0)) -> Array:
    """(…), or (…, 3) where is_color."""
    p = np.asarray(p, np.float32)
    dimensions = p.shape[-1]
    if np.any(distortion != 0.0):
        p = p + np.stack([perlin(p + _offset(seed, dimensions)) * distortion for seed in range(dimensions)],
                         axis=-1)

    def octaves(at: Array) -> Array:
        return fractal(at, detail, roughness, lacunarity, normalize)

    if not is_color:
        return octaves(p)
    others = (octaves(p + _offset(dimensions + i, dimensions)) for i in range(2))
    return np.stack([octaves(p), *others], axis=-1)


def _offset(seed: int, dimensions: int) -> Array:
    """100 … 200 in each dimension."""
    seeds = [(seed,)] if dimensions == 1 else [(seed, axis) for axis in range(dimensions)]
    return np.float32(100.0) + np.float32(100.0) * random_number(np.array(seeds, np.float32))


# The Musgrave Texture: F. K. Musgrave in Texturing and Modeling, 1994

def musgrave(kind: str, p: Array, detail: Array, dimension: Array, lacunarity: Array, offset: Array,
             gain: Array) -> Array:
    """(…). kind: the node's type. detail: one number for all points."""
    p = np.asarray(p, np.float32)
    detail = float(np.clip(np.max(detail), 0.0, 15.0))
    lacunarity = np.maximum(lacunarity, 1e-5)
    fading = lacunarity ** -np.maximum(dimension, 1e-5)
    weights = [np.float32(1.0)] * int(detail) + [np.float32(detail - int(detail))] * (detail > int(detail))

    def signal(octave: int) -> Array:
        return _octave(p, lacunarity ** np.float32(octave))

    if kind == 'FBM':
        return sum((weight * signal(i) * fading ** i for i, weight in enumerate(weights)), np.float32(0.0))
    if kind == 'MULTIFRACTAL':
        value = np.float32(1.0)
        for i, weight in enumerate(weights):
            value = value * (weight * fading ** i * signal(i) + 1.0)
        return value
    if kind == 'HETERO_TERRAIN':
        value = offset + signal(0)
        for i, weight in enumerate(weights[1:], 1):
            value = value + weight * (signal(i) + offset) * fading ** i * value
        return value
    if kind == 'HYBRID_MULTIFRACTAL':
        value, share = np.float32(0.0), np.float32(1.0)
        for i, weight in enumerate(weights):
            share = np.where(share > 0.001, np.minimum(share, 1.0), 0.0)
            part = (signal(i) + offset) * fading ** i
            value = value + weight * share * part
            share = share * gain * part
        return value
    ridge = (offset - np.abs(signal(0))) ** 2
    value = ridge
    for i in range(1, int(detail)):
        ridge = (offset - np.abs(signal(i))) ** 2 * np.clip(ridge * gain, 0.0, 1.0)
        value = value + ridge * fading ** i
    return value
