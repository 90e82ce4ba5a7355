# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks through shader nodes: what feeds an input, and which constant it comes to."""

from collections.abc import Iterator
from typing import NamedTuple

import bpy
import numpy as np

from ..faults import Warn

Groups = tuple[bpy.types.Node, ...]
"""The group nodes that a node lies in, outermost first."""

LUMINANCE = np.array((0.2126, 0.7152, 0.0722), np.float32)


class Input(NamedTuple):
    """A node's input, seen through the groups around it."""
    socket: bpy.types.NodeSocket
    groups: Groups = ()

    def source(self) -> "Source":
        """Follows links back through reroutes, muted nodes and group borders."""
        socket, groups = self
        while True:
            link = next((link for link in socket.links if link.is_valid and not link.is_muted), None)
            if link is None:
                return Source(None, Input(socket, groups))
            node, output = link.from_node, link.from_socket
            if node.mute:
                socket = next((bypass.from_socket for bypass in node.internal_links
                               if bypass.to_socket == output), None)
                if socket is None:
                    return Source(None, self)
            elif node.type == 'REROUTE':
                socket = node.inputs[0]
            elif node.type == 'GROUP' and _group_output(node) is not None:
                socket = _same_socket(_group_output(node).inputs, output)
                groups += (node,)
            elif node.type == 'GROUP_INPUT' and groups:
                socket = _same_socket(groups[-1].inputs, output)
                groups = groups[:-1]
            else:
                return Source(output, Input(socket, groups))


class Source(NamedTuple):
    """Where an input's value comes from: a node's output or, where that is None, the input's own value."""
    output: bpy.types.NodeSocket | None
    end: Input
    """The input at which the search ended."""

    @property
    def node(self) -> bpy.types.Node | None:
        return None if self.output is None else self.output.node


class Node:
    """A shader node with its constant inputs; what isn't constant is warned of and read as the
    input's own value."""

    def __init__(self, node: bpy.types.Node, groups: Groups, owner: str, warn: Warn):
        """owner: what the node belongs to, as it begins a warning: "Material 'Ice'"."""
        self.node = node
        self.groups = groups
        self._owner = owner
        self._warn = warn

    def other(self, node: bpy.types.Node, groups: Groups) -> "Node":
        """Another node of the same owner."""
        return Node(node, groups, self._owner, self._warn)

    def warn(self, fault: str) -> None:
        """fault: the rest of a sentence whose subject is this node."""
        self._warn(f"{self._owner}: '{title(self.node)}' {fault}.")

    def input(self, *names: str) -> Input | None:
        """The first input that has one of these names."""
        socket = next((self.node.inputs[name] for name in names if name in self.node.inputs), None)
        return None if socket is None else Input(socket, self.groups)

    def scalar(self, *names: str, default: float = 0.0) -> float:
        """The value of the first input with one of these names; default where there is none."""
        found = self.input(*names)
        if found is None:
            return default
        value = np.atleast_1d(self._constant(found))
        return float(value[0]) if len(value) == 1 else float(LUMINANCE @ value[:3])

    def color(self, *names: str) -> np.ndarray:
        """(3,) float32: the colour or vector of the first input with one of these names."""
        value = np.atleast_1d(self._constant(self.input(*names)))
        return np.broadcast_to(value[:3], 3).astype(np.float32)

    def _constant(self, found: Input) -> float | tuple[float, ...]:
        value = constant(found)
        if value is not None:
            return value
        self.warn(f"takes its {found.socket.name} from '{title(found.source().node)}', which isn't supported "
                  "yet; the input's own value is used")
        return own_value(found.socket)


def constant(found: Input) -> float | tuple[float, ...] | None:
    """A number or the components of a colour or vector; None where a link leads to something that
    isn't a Value, RGB or Combine XYZ node."""
    output, end = found.source()
    if output is None:
        return own_value(end.socket)
    if output.node.type in {'VALUE', 'RGB'}:
        return own_value(output)
    if output.node.type == 'COMBXYZ':
        parts = [constant(Input(socket, end.groups)) for socket in output.node.inputs]
        return None if any(not isinstance(part, float) for part in parts) else tuple(parts)
    return None


def shader_nodes(found: Input) -> Iterator[tuple[bpy.types.Node, Groups]]:
    """The shader nodes that feed an input, the nearest first and each branch to its end, with the
    groups that each lies in."""
    output, end = found.source()
    if output is None:
        return
    yield output.node, end.groups
    for socket in output.node.inputs:
        if socket.type == 'SHADER':
            yield from shader_nodes(Input(socket, end.groups))


def title(node: bpy.types.Node) -> str:
    """The name under which the user sees the node."""
    return node.label or node.name


def output_node(tree: bpy.types.ShaderNodeTree) -> bpy.types.Node | None:
    """The output node that counts: Cycles' or one for all engines; failing those, EEVEE's."""
    return tree.get_output_node('CYCLES') or tree.get_output_node('EEVEE')


def own_value(socket: bpy.types.NodeSocket) -> float | tuple[float, ...]:
    """What an input or output says itself."""
    value = socket.default_value
    return tuple(value) if hasattr(value, '__len__') else float(value)


def _group_output(group: bpy.types.Node) -> bpy.types.Node | None:
    nodes = group.node_tree.nodes if group.node_tree else ()
    return next((node for node in nodes if node.type == 'GROUP_OUTPUT' and node.is_active_output), None)


def _same_socket(sockets, like: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    return next(socket for socket in sockets if socket.identifier == like.identifier)
