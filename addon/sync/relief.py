# SPDX-License-Identifier: GPL-3.0-or-later
"""What bends the normals of a shader node: a Bump node, a Normal Map node, or the one upon the other."""

from typing import NamedTuple

import numpy as np

from .. import compat
from . import nodes
from .evaluation import expression_of
from .expressions import Expression, Unsupported


class NormalColors(NamedTuple):
    """Of a Normal Map node."""
    colors: Expression
    space: str
    """as core.NormalMap's"""
    steepness: float
    strength: float
    """both as core.NormalMap's"""
    uv_map: str
    """along which the tangents go; '' for the mesh's own choice"""


class Heights(NamedTuple):
    """Of a Bump node."""
    heights: Expression
    strength: float
    distance: float
    """as core.BumpMap's"""


class Relief(NamedTuple):
    normals: NormalColors | None = None
    heights: Heights | None = None


SPACES = {'TANGENT': 'TANGENT', 'OBJECT': 'OBJECT', 'WORLD': 'WORLD', 'BLENDER_OBJECT': 'OBJECT',
          'BLENDER_WORLD': 'WORLD'}
"""The core's space for a Normal Map node's."""


def relief_of(shader: nodes.Node, check_images: bool) -> Relief:
    """What a shader node takes its Normal from; what can't be rendered is warned of. check_images: as
    images.picture's."""
    heights, node = None, _feeding_normal(shader)
    if node is not None and node.node.type == 'BUMP':
        heights, node = _heights(node, check_images), _feeding_normal(node)
    if node is None:
        return Relief(None, heights)
    if node.node.type == 'NORMAL_MAP':
        return Relief(_normal_colors(node, check_images), heights)
    node.warn("goes into a Normal, which isn't supported yet from a node of its kind; it is left out")
    return Relief(None, heights)


def _feeding_normal(node: nodes.Node) -> nodes.Node | None:
    found = node.input("Normal").source()
    return None if found.node is None else node.other(found.node, found.end.groups)


def _expression(node: nodes.Node, name: str, check_images: bool, kind: str = 'VALUE') -> Expression | None:
    """Of an input; None, and a warning, where it can't be read."""
    try:
        return expression_of(node.input(name), check_images, kind)
    except Unsupported as fault:
        node.warn(f"takes its {name} from {fault}; the mesh's own normals are used")
        return None


def _heights(node: nodes.Node, check_images: bool) -> Heights | None:
    strength = max(node.scalar("Strength"), 0.0)
    distance = node.scalar("Distance") * (-1.0 if node.node.invert else 1.0)
    if strength == 0.0 or distance == 0.0:
        return None
    heights = _expression(node, "Height", check_images)
    return None if heights is None or heights.is_constant else Heights(heights, strength, distance)


def _normal_colors(node: nodes.Node, check_images: bool) -> NormalColors | None:
    strength = max(node.scalar("Strength"), 0.0)
    colors = _expression(node, "Color", check_images, 'RGBA') if strength > 0.0 else None
    if colors is None:
        return None
    space = node.node.space
    if space.startswith('BLENDER_'):
        colors = _reversed(colors, (0.0, 1.0, 1.0))
    if compat.is_directx(node.node):
        colors = _reversed(colors, (0.0, 1.0, 0.0))
    steepness = 1.0
    if space == 'TANGENT' and compat.STRENGTH_STEEPENS_NORMAL_MAPS:
        steepness, strength = strength, 1.0
    return NormalColors(colors, SPACES[space], steepness, strength, node.node.uv_map)


def _reversed(colors: Expression, axes: tuple[float, float, float]) -> Expression:
    """Colours of normals that go the other way along those axes that are 1."""
    return colors.then(lambda values: np.abs(values - axes).astype(np.float32), ("reversed", axes))
