# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lamps to the core's lights, as bright as Cycles has them."""

import math

import bpy
import numpy as np

from .. import verglas_core as core
from ..faults import Warn
from . import nodes

AREA_SIDE = 4
"""An area lamp becomes as many disks along each of its sides."""


def add(scene: core.Scene, obj: bpy.types.Object, matrix: np.ndarray, warn: Warn) -> None:
    """obj: an evaluated lamp. matrix: (4, 4) object -> world, of its instance."""
    title = f"Light '{obj.name}'"
    if not np.isfinite(matrix).all():
        warn(f"{title} has a transform that is no number; it is left out.")
        return
    try:
        _add(scene, obj, matrix, title, warn)
    except core.Error as fault:
        warn(f"{fault} It is left out.")


def _add(scene: core.Scene, obj: bpy.types.Object, matrix: np.ndarray, title: str, warn: Warn) -> None:
    lamp = obj.data
    power = lamp.energy * _color(lamp, title, warn)
    if not power.any():
        return
    place, axis = matrix[:3, 3], -_unit(matrix[:3, 2])
    if lamp.type == 'SUN':
        scene.add_light(obj.name, 'SUN', -axis, power, radius=0.5 * lamp.angle)
    elif lamp.type == 'AREA':
        _add_area(scene, obj, matrix, axis, power)
    else:
        if lamp.type == 'SPOT':
            warn(f"{title} has a cone, which isn't supported yet; it shines to all sides.")
        # Watts to all 4 pi steradians
        scene.add_light(obj.name, 'SPHERE', place, power / (4.0 * math.pi), radius=lamp.shadow_soft_size)


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / max(float(np.linalg.norm(vector)), 1e-30)


def _color(lamp: bpy.types.Light, title: str, warn: Warn) -> np.ndarray:
    """(3,) factor on the lamp's power."""
    color = np.array(lamp.color)
    if getattr(lamp, "use_temperature", False):
        color = color * np.array(lamp.temperature_color)
    color = color * 2.0 ** getattr(lamp, "exposure", 0.0)
    output = nodes.output_node(lamp.node_tree) if lamp.use_nodes and lamp.node_tree else None
    if output is None:
        return color
    emission = nodes.Input(output.inputs["Surface"]).source()
    if emission.node is None:
        return np.zeros(3)
    if emission.node.type != 'EMISSION':
        warn(f"{title} has a '{nodes.title(emission.node)}' in its nodes, which isn't supported yet; "
             "its own color is used.")
        return color
    node = nodes.Node(emission.node, emission.end.groups, title, warn)
    return color * node.color("Color") * node.scalar("Strength")


def _add_area(scene: core.Scene, obj: bpy.types.Object, matrix: np.ndarray, axis: np.ndarray,
              power: np.ndarray) -> None:
    """Disks of the lamp's area together. Blender's area lamps of P watts have an intensity of P / 4 along
    their axis."""
    lamp = obj.data
    side = np.array([lamp.size, lamp.size_y if lamp.shape in {'RECTANGLE', 'ELLIPSE'} else lamp.size])
    x, y = matrix[:3, 0] * side[0], matrix[:3, 1] * side[1]
    is_round = lamp.shape in {'DISK', 'ELLIPSE'}
    area = float(np.linalg.norm(np.cross(x, y))) * (0.25 * math.pi if is_round else 1.0)
    cells = (np.arange(AREA_SIDE) + 0.5) / AREA_SIDE - 0.5
    grid = np.stack(np.meshgrid(cells, cells), -1).reshape(-1, 2)
    if is_round:
        grid = _round(grid)
    radius = math.sqrt(area / (math.pi * len(grid)))
    for u, v in grid:
        place = matrix[:3, 3] + u * x + v * y
        scene.add_light(obj.name, 'DISK', place, power / (4.0 * len(grid)), radius=radius, axis=axis)


def _round(grid: np.ndarray) -> np.ndarray:
    """(N, 2) of a square of side 1 to a disk of diameter 1, areas in proportion (Shirley and Chiu 1997)."""
    x, y = grid.T
    is_x = np.abs(x) > np.abs(y)
    r = np.where(is_x, x, y)
    with np.errstate(divide='ignore', invalid='ignore'):
        angle = np.where(is_x, 0.25 * math.pi * y / x, 0.5 * math.pi - 0.25 * math.pi * x / y)
    angle = np.nan_to_num(angle)
    return np.stack([r * np.cos(angle), r * np.sin(angle)], -1)
