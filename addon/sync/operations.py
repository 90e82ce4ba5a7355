# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's converter nodes calculate, on numpy arrays.

Numbers are () or (N,); colours and vectors (3,) or (N, 3). Where a function isn't defined, as in a division
by 0, the results are Cycles'.
"""

from collections.abc import Callable

import numpy as np

Array = np.ndarray

EPSILON = np.finfo(np.float32).eps


def mix(a: Array, b: Array, t: Array) -> Array:
    """a where t is 0, b where it is 1."""
    return a + (b - a) * t


def divided(a: Array, b: Array) -> Array:
    """0 where b is."""
    return np.where(b != 0.0, a / np.where(b != 0.0, b, 1.0), 0.0)


def fraction(a: Array) -> Array:
    return a - np.floor(a)


# Math

def _power(a: Array, b: Array) -> Array:
    is_defined = (a >= 0.0) | (b == np.floor(b))
    return np.where(is_defined & ((a != 0.0) | (b > 0.0)), np.power(np.where(a == 0.0, 1.0, np.abs(a)), b)
                    * np.where((a < 0.0) & (np.mod(b, 2.0) == 1.0), -1.0, 1.0) * (a != 0.0),
                    np.where((a == 0.0) & (b == 0.0), 1.0, 0.0))


def _logarithm(a: Array, b: Array) -> Array:
    is_defined = (a > 0.0) & (b > 0.0)
    return np.where(is_defined, divided(np.log(np.where(a > 0.0, a, 1.0)), np.log(np.where(b > 0.0, b, 2.0))),
                    0.0)


def _smooth_minimum(a: Array, b: Array, c: Array) -> Array:
    h = divided(np.maximum(c - np.abs(a - b), 0.0), c)
    return np.where(c != 0.0, np.minimum(a, b) - h * h * h * c / 6.0, np.minimum(a, b))


def _wrap(a: Array, b: Array, c: Array) -> Array:
    return np.where(b != c, a - (b - c) * np.floor(divided(a - c, b - c)), c)


_ARITHMETIC: dict[str, Callable[..., Array]] = {
    'ADD': lambda a, b: a + b,
    'SUBTRACT': lambda a, b: a - b,
    'MULTIPLY': lambda a, b: a * b,
    'DIVIDE': lambda a, b: divided(a, b),
    'MULTIPLY_ADD': lambda a, b, c: a * b + c,
}
"""What numbers and vectors have in common."""

MATH: dict[str, Callable[..., Array]] = {
    **_ARITHMETIC,
    'POWER': _power,
    'LOGARITHM': _logarithm,
    'SQRT': lambda a: np.sqrt(np.maximum(a, 0.0)),
    'INVERSE_SQRT': lambda a: np.where(a > 0.0, 1.0 / np.sqrt(np.where(a > 0.0, a, 1.0)), 0.0),
    'ABSOLUTE': lambda a: np.abs(a),
    'EXPONENT': lambda a: np.exp(a),
    'MINIMUM': lambda a, b: np.minimum(a, b),
    'MAXIMUM': lambda a, b: np.maximum(a, b),
    'LESS_THAN': lambda a, b: (a < b).astype(np.float32),
    'GREATER_THAN': lambda a, b: (a > b).astype(np.float32),
    'SIGN': lambda a: np.sign(a),
    'COMPARE': lambda a, b, c: (np.abs(a - b) <= np.maximum(c, EPSILON)).astype(np.float32),
    'SMOOTH_MIN': _smooth_minimum,
    'SMOOTH_MAX': lambda a, b, c: -_smooth_minimum(-a, -b, c),
    'ROUND': lambda a: np.floor(a + 0.5),
    'FLOOR': lambda a: np.floor(a),
    'CEIL': lambda a: np.ceil(a),
    'TRUNC': lambda a: np.trunc(a),
    'FRACT': lambda a: fraction(a),
    'MODULO': lambda a, b: np.where(b != 0.0, np.fmod(a, np.where(b != 0.0, b, 1.0)), 0.0),
    'FLOORED_MODULO': lambda a, b: np.where(b != 0.0, a - np.floor(divided(a, b)) * b, 0.0),
    'WRAP': _wrap,
    'SNAP': lambda a, b: np.floor(divided(a, b)) * b,
    'PINGPONG': lambda a, b: np.where(b != 0.0, np.abs(fraction(divided(a - b, 2.0 * b)) * 2.0 * b - b), 0.0),
    'SINE': lambda a: np.sin(a),
    'COSINE': lambda a: np.cos(a),
    'TANGENT': lambda a: np.tan(a),
    'ARCSINE': lambda a: np.arcsin(np.clip(a, -1.0, 1.0)),
    'ARCCOSINE': lambda a: np.arccos(np.clip(a, -1.0, 1.0)),
    'ARCTANGENT': lambda a: np.arctan(a),
    'ARCTAN2': lambda a, b: np.arctan2(a, b),
    'SINH': lambda a: np.sinh(a),
    'COSH': lambda a: np.cosh(a),
    'TANH': lambda a: np.tanh(a),
    'RADIANS': lambda a: np.radians(a),
    'DEGREES': lambda a: np.degrees(a),
}
"""By the Math node's operation; a function takes as many of its inputs as it has arguments."""


def _dot(a: Array, b: Array) -> Array:
    return (a * b).sum(axis=-1)


def _length(a: Array) -> Array:
    return np.sqrt(_dot(a, a))


VECTOR_MATH: dict[str, Callable[..., Array]] = {
    **_ARITHMETIC,
    'DOT_PRODUCT': _dot,
    'CROSS_PRODUCT': lambda a, b: np.cross(a, b),
    'DISTANCE': lambda a, b: _length(a - b),
    'LENGTH': _length,
    'SCALE': lambda a, s: a * s,
    'NORMALIZE': lambda a: divided(a, _length(a)[..., None]),
    'ABSOLUTE': lambda a: np.abs(a),
    'MINIMUM': lambda a, b: np.minimum(a, b),
    'MAXIMUM': lambda a, b: np.maximum(a, b),
    'FLOOR': lambda a: np.floor(a),
    'CEIL': lambda a: np.ceil(a),
    'FRACTION': lambda a: fraction(a),
    'MODULO': lambda a, b: np.where(b != 0.0, np.fmod(a, np.where(b != 0.0, b, 1.0)), 0.0),
    'WRAP': _wrap,
    'SNAP': lambda a, b: np.floor(divided(a, b)) * b,
    'SINE': lambda a: np.sin(a),
    'COSINE': lambda a: np.cos(a),
    'TANGENT': lambda a: np.tan(a),
}
"""By the Vector Math node's operation."""


# Color models: (…, 3) to (…, 3), hue in turns

def _hue(rgb: Array) -> Array:
    """0 … 1; 0 where there is none."""
    r, g, b = np.moveaxis(rgb, -1, 0)
    most, least = rgb.max(axis=-1), rgb.min(axis=-1)
    from_red, from_green, from_blue = (divided(x - y, most - least) for x, y in ((g, b), (b, r), (r, g)))
    sixths = np.where(r == most, from_red, np.where(g == most, 2.0 + from_green, 4.0 + from_blue))
    return fraction(np.where(most > least, sixths, 0.0) / 6.0)


def hsv_from_rgb(rgb: Array) -> Array:
    most, least = rgb.max(axis=-1), rgb.min(axis=-1)
    return np.stack([_hue(rgb), divided(most - least, most), most], axis=-1)


def rgb_from_hsv(hsv: Array) -> Array:
    hue, saturation, value = (hsv[..., i, None] for i in range(3))
    hue = np.where(hue == 1.0, 0.0, hue)
    # Beyond its ends hue goes through its last sixth again and again
    last_sixth = (5.0 + fraction(6.0 * hue)) / 6.0
    hue = np.where((hue >= 0.0) & (hue < 1.0), hue, last_sixth)
    return value * mix(np.float32(1.0), _pure(hue), saturation)


def hsl_from_rgb(rgb: Array) -> Array:
    most, least = rgb.max(axis=-1), rgb.min(axis=-1)
    lightness = np.minimum(0.5 * (most + least), 1.0)
    saturation = divided(most - least, np.where(lightness > 0.5, 2.0 - most - least, most + least))
    return np.stack([_hue(rgb), saturation, lightness], axis=-1)


def rgb_from_hsl(hsl: Array) -> Array:
    hue, saturation, lightness = (hsl[..., i, None] for i in range(3))
    return lightness + (_pure(hue) - 0.5) * (1.0 - np.abs(2.0 * lightness - 1.0)) * saturation


def _pure(hue: Array) -> Array:
    """(…, 3) of full saturation and value; hue: (…, 1), red beyond 0 … 1."""
    from_cyan, from_green, from_blue = (np.abs(6.0 * hue - sixths) for sixths in (3.0, 2.0, 4.0))
    return np.clip(np.concatenate([from_cyan - 1.0, 2.0 - from_green, 2.0 - from_blue], axis=-1), 0.0, 1.0)


# Mix

def _soft_light(a: Array, b: Array) -> Array:
    screen = 1.0 - (1.0 - b) * (1.0 - a)
    return (1.0 - a) * b * a + a * screen


def _dodge(a: Array, b: Array, t: Array) -> Array:
    rest = 1.0 - t * b
    dodged = np.where(rest <= 0.0, 1.0, np.minimum(divided(a, rest), 1.0))
    return np.where(a != 0.0, dodged, a)


def _burn(a: Array, b: Array, t: Array) -> Array:
    under = 1.0 - t + t * b
    return np.where(under <= 0.0, 0.0, np.clip(1.0 - divided(1.0 - a, under), 0.0, 1.0))


def _overlaid(a: Array, b: Array, t: Array) -> Array:
    under = 1.0 - t
    return np.where(a < 0.5, a * (under + 2.0 * t * b),
                    1.0 - (under + 2.0 * t * (1.0 - b)) * (1.0 - a))


def _with_hue(a: Array, b: Array, t: Array) -> Array:
    hsv, other = hsv_from_rgb(a), hsv_from_rgb(b)
    hued = rgb_from_hsv(np.stack(np.broadcast_arrays(other[..., 0], hsv[..., 1], hsv[..., 2]), axis=-1))
    return np.where(other[..., 1:2] != 0.0, mix(a, hued, t), a)


def _with_saturation(a: Array, b: Array, t: Array) -> Array:
    hsv = hsv_from_rgb(a)
    saturation = mix(hsv[..., 1], hsv_from_rgb(b)[..., 1], t[..., 0])
    mixed = rgb_from_hsv(np.stack(np.broadcast_arrays(hsv[..., 0], saturation, hsv[..., 2]), axis=-1))
    return np.where(hsv[..., 1:2] != 0.0, mixed, a)


def _with_value(a: Array, b: Array, t: Array) -> Array:
    hsv = hsv_from_rgb(a)
    value = mix(hsv[..., 2], hsv_from_rgb(b)[..., 2], t[..., 0])
    return rgb_from_hsv(np.stack(np.broadcast_arrays(hsv[..., 0], hsv[..., 1], value), axis=-1))


def _with_color(a: Array, b: Array, t: Array) -> Array:
    hsv, other = hsv_from_rgb(a), hsv_from_rgb(b)
    colored = rgb_from_hsv(np.stack(np.broadcast_arrays(other[..., 0], other[..., 1], hsv[..., 2]), axis=-1))
    return np.where(other[..., 1:2] != 0.0, mix(a, colored, t), a)


BLEND: dict[str, Callable[[Array, Array, Array], Array]] = {
    'MIX': mix,
    'ADD': lambda a, b, t: a + b * t,
    'SUBTRACT': lambda a, b, t: a - b * t,
    'MULTIPLY': lambda a, b, t: mix(a, a * b, t),
    'SCREEN': lambda a, b, t: 1.0 - (1.0 - t + t * (1.0 - b)) * (1.0 - a),
    'DIVIDE': lambda a, b, t: np.where(b != 0.0, (1.0 - t) * a + t * divided(a, b), a),
    'DIFFERENCE': lambda a, b, t: mix(a, np.abs(a - b), t),
    'EXCLUSION': lambda a, b, t: np.maximum(mix(a, a + b - 2.0 * a * b, t), 0.0),
    'DARKEN': lambda a, b, t: mix(a, np.minimum(a, b), t),
    'LIGHTEN': lambda a, b, t: mix(a, np.maximum(a, b), t),
    'OVERLAY': _overlaid,
    'DODGE': _dodge,
    'BURN': _burn,
    'SOFT_LIGHT': lambda a, b, t: mix(a, _soft_light(a, b), t),
    'LINEAR_LIGHT': lambda a, b, t: a + t * (2.0 * b - 1.0),
    'HUE': _with_hue,
    'SATURATION': _with_saturation,
    'VALUE': _with_value,
    'COLOR': _with_color,
}
"""By a mix node's blend type: of two colours and a factor with a last axis of 1."""


# Map Range

def _smoothstep(t: Array) -> Array:
    return t * t * (3.0 - 2.0 * t)


def _smootherstep(t: Array) -> Array:
    return t * t * t * (t * (6.0 * t - 15.0) + 10.0)


def map_range(kind: str, clamps: bool, value: Array, from_min: Array, from_max: Array, to_min: Array,
              to_max: Array, steps: Array) -> Array:
    """kind: 'LINEAR', 'STEPPED', 'SMOOTHSTEP' or 'SMOOTHERSTEP'; the last two are clamped always."""
    factor = divided(value - from_min, from_max - from_min)
    if kind == 'STEPPED':
        factor = divided(np.floor(factor * (steps + 1.0)), np.maximum(steps, 0.0))
    elif kind != 'LINEAR':
        smooth = _smoothstep if kind == 'SMOOTHSTEP' else _smootherstep
        factor = smooth(np.clip(factor, 0.0, 1.0))
    result = np.where(from_max != from_min, to_min + factor * (to_max - to_min), 0.0)
    if clamps and kind in {'LINEAR', 'STEPPED'}:
        result = np.clip(result, np.minimum(to_min, to_max), np.maximum(to_min, to_max))
    return result


# Tables

def table_value(table: Array, place: Array, is_smooth: bool = True) -> Array:
    """(…, C) of table (T, C) at place 0 … 1, between entries where it is smooth."""
    last = len(table) - 1
    x = np.nan_to_num(np.clip(place, 0.0, 1.0)) * last
    i = np.minimum(x.astype(np.int64), last)
    if not is_smooth:
        return table[i]
    return mix(table[i], table[np.minimum(i + 1, last)], (x - i)[..., None])


def curved(table: Array, place: Array, extrapolates: bool) -> Array:
    """Each channel of place (…, C), or (…) for a table of one, by its column of the table (T, C); beyond its
    ends the same value or, extrapolated, on along the end's slope."""
    columns = place[..., None] if table.shape[1] == 1 else place
    parts = []
    for channel in range(table.shape[1]):
        entries, x = table[:, channel:channel + 1], columns[..., channel]
        y = table_value(entries, x)[..., 0]
        if extrapolates:
            last = len(entries) - 1
            y = y + np.minimum(x, 0.0) * (entries[1, 0] - entries[0, 0]) * last
            y = y + np.maximum(x - 1.0, 0.0) * (entries[last, 0] - entries[last - 1, 0]) * last
        parts.append(y)
    result = np.stack(parts, axis=-1)
    return result[..., 0] if table.shape[1] == 1 else result


# Coordinates

def mapped(kind: str, vector: Array, location: Array, rotation: Array, scale: Array) -> Array:
    """The Mapping node; rotation: XYZ Euler angles."""
    if kind == 'POINT':
        return _rotated(vector * scale, rotation) + location
    if kind == 'TEXTURE':
        return divided(_rotated(vector - location, rotation, inverse=True), scale)
    if kind == 'VECTOR':
        return _rotated(vector * scale, rotation)
    return VECTOR_MATH['NORMALIZE'](_rotated(divided(vector, scale), rotation))


def _rotated(vector: Array, angles: Array, inverse: bool = False) -> Array:
    """About X, then Y, then Z; or back."""
    for axis in ((2, 1, 0) if inverse else (0, 1, 2)):
        angle = -angles[..., axis] if inverse else angles[..., axis]
        c, s = np.cos(angle), np.sin(angle)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        parts = [None, None, None]
        parts[axis] = vector[..., axis]
        parts[i] = c * vector[..., i] - s * vector[..., j]
        parts[j] = s * vector[..., i] + c * vector[..., j]
        vector = np.stack(np.broadcast_arrays(*parts), axis=-1)
    return vector


def sphere_uv(p: Array) -> Array:
    """(N, 2) where a sphere about the unit cube has p (N, 3), as the Image Texture's Sphere projection."""
    x, y, z = np.moveaxis(2.0 * np.atleast_2d(p) - 1.0, -1, 0)
    length = np.sqrt(x * x + y * y + z * z)
    u = np.where((x == 0.0) & (y == 0.0), 0.0, 0.5 * (1.0 - np.arctan2(x, y) / np.pi))
    v = 1.0 - np.arccos(np.clip(divided(z, length), -1.0, 1.0)) / np.pi
    return np.where((length > 0.0)[:, None], np.stack([u, v], axis=-1), 0.0)


def tube_uv(p: Array) -> Array:
    """As sphere_uv, of a tube along Z."""
    x, y, z = np.moveaxis(2.0 * np.atleast_2d(p) - 1.0, -1, 0)
    uv = np.stack([0.5 * (1.0 - np.arctan2(x, y) / np.pi), 0.5 * (z + 1.0)], axis=-1)
    return np.where(((x != 0.0) | (y != 0.0))[:, None], uv, 0.0)


def box_projected(look_up: Callable[[Array], Array], p: Array, normal: Array, blend: float) -> Array:
    """(N, 4) of an image on the six sides of a box, which pass over into each other by blend, 0 … 1. p,
    normal: (N, 3)."""
    weights = _box_weights(np.abs(normal), blend)
    x, y, z = np.moveaxis(p, -1, 0)
    sides = ((np.where(normal[:, 0] < 0.0, 1.0 - y, y), z),
             (np.where(normal[:, 1] > 0.0, 1.0 - x, x), z),
             (np.where(normal[:, 2] > 0.0, 1.0 - y, y), x))
    return sum(weights[:, i:i + 1] * look_up(np.stack(side, axis=-1)) for i, side in enumerate(sides))


def _box_weights(n: Array, blend: float) -> Array:
    """(N, 3) of the sides along X, Y and Z, for the normal's absolute values n (N, 3)."""
    n = divided(n, n.sum(axis=-1, keepdims=True))
    limit = 0.5 * (1.0 + blend)
    weights = np.zeros_like(n)
    is_open = np.ones(len(n), bool)
    for axis in range(3):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        is_alone = is_open & (n[:, axis] > limit * (n[:, axis] + n[:, i])) \
            & (n[:, axis] > limit * (n[:, axis] + n[:, j]))
        weights[is_alone, axis] = 1.0
        is_open &= ~is_alone
    if blend <= 0.0:
        weights[is_open, 0] = 1.0
        return weights
    for i, j, least in ((0, 1, 2), (1, 2, 0), (0, 2, 1)):
        is_pair = is_open & (n[:, least] < (1.0 - limit) * (n[:, i] + n[:, j]))
        share = divided(n[is_pair, i], n[is_pair, i] + n[is_pair, j])
        weights[is_pair, i] = np.clip((share - 0.5 * (1.0 - blend)) / blend, 0.0, 1.0)
        weights[is_pair, j] = 1.0 - weights[is_pair, i]
        is_open &= ~is_pair
    weights[is_open] = ((2.0 - limit) * n[is_open] + (limit - 1.0)) / (2.0 * limit - 1.0)
    return weights


def unassociated(rgba: Array) -> Array:
    """(N, 3): colours without the alpha that is multiplied into them."""
    alpha = rgba[:, 3:]
    return np.where((alpha != 0.0) & (alpha != 1.0), divided(rgba[:, :3], alpha), rgba[:, :3])
