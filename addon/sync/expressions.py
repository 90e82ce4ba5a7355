# SPDX-License-Identifier: GPL-3.0-or-later
"""What feeds an input of a shader node, as a function of points of the surface.

Values are numpy arrays, float32: () or (N,) for numbers, (3,) or (N, 3) for colours and vectors.
"""

from collections.abc import Callable, Hashable
from typing import NamedTuple

import bpy
import numpy as np

from . import images, nodes

Leaf = tuple[str, str]
"""A quantity of the surface and the name of its layer, '' where there is none or for the default one:
('UV', name), ('GENERATED', ''), ('OBJECT', ''), ('NORMAL', ''): (N, 3);
('COLOR', name): (N, 3), ('GRAY', name), ('ALPHA', name), ('FACTOR', name): (N,) of an attribute."""

NUMBERS = frozenset({'GRAY', 'ALPHA', 'FACTOR'})
"""Kinds of leaves that are numbers."""


class Unsupported(Exception):
    """A node that can't be read; the message completes "'Node' …"."""

    def __init__(self, node: bpy.types.Node, fault: str = "isn't supported yet"):
        super().__init__(f"'{nodes.title(node)}', which {fault}")


class Placement(NamedTuple):
    """An affine map from a UV map to the coordinates of an image."""
    uv_map: str
    rows: tuple[tuple[float, float, float], tuple[float, float, float]]
    """u, v and 1 to the image's u and v"""

    def apply(self, uv: np.ndarray) -> np.ndarray:
        """uv: (…, 2 or more)"""
        rows = np.array(self.rows)
        return uv[..., :2] @ rows[:, :2].T + rows[:, 2]

    def within(self, picture: images.Picture) -> "Placement":
        """To 0 … 1 over all tiles of the picture."""
        rows = np.array(self.rows)
        rows[:, 2] -= picture.origin
        return self._replace(rows=_as_tuples(rows / np.array(picture.span)[:, None]))

    @staticmethod
    def of_matrix(uv_map: str, matrix: np.ndarray) -> "Placement":
        """matrix: (4, 4) of coordinates whose third is 0."""
        return Placement(uv_map, _as_tuples(matrix[:2][:, [0, 1, 3]]))


def _as_tuples(rows: np.ndarray) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(float(x) for x in row) for row in rows)


class Image(NamedTuple):
    """How an Image Texture node reads its image."""
    picture: images.Picture
    extension: str
    """'REPEAT', 'EXTEND', 'CLIP' or 'MIRROR'"""
    interpolation: str
    """'Linear', 'Closest', 'Cubic' or 'Smart'"""

    @property
    def size(self) -> tuple[int, int]:
        """width, height"""
        height, width = self.picture.rgba.shape[:2]
        return width, height

    def is_at_texels(self, points: "Points") -> bool:
        return points.texels is not None and points.texels.size == self.size


class Texels(NamedTuple):
    size: tuple[int, int]
    """width, height"""
    rows: slice


class Points:
    """Where an expression is evaluated."""

    def __init__(self, leaves: dict[Leaf, np.ndarray] | Callable[[Leaf], np.ndarray],
                 image_uv: Callable[[], np.ndarray] | None = None, texels: Texels | None = None):
        """leaves: their values, or a function that gives them. image_uv: gives (N, 2), what all placed images
        are looked up at, in place of their placement of a UV map. texels: of images of this size, these are
        the centres of these rows."""
        self._leaf = leaves.__getitem__ if isinstance(leaves, dict) else leaves
        self.image_uv = image_uv
        self.texels = texels
        self.known: dict[Hashable, np.ndarray] = {}
        """values of outputs that have been evaluated"""

    def leaf(self, leaf: Leaf) -> np.ndarray:
        key = ("leaf", leaf)
        if key not in self.known:
            self.known[key] = self._leaf(leaf)
        return self.known[key]


Function = Callable[[Points], np.ndarray]

NodeFunction = Callable[["Reader", bpy.types.NodeSocket, str], Function]
"""Makes a node's output a function; the last argument is the type of socket as whose it is wanted."""


class Expression(NamedTuple):
    """A number or a colour that depends on where it is."""
    evaluate: Function
    key: Hashable
    """equal for equal expressions of equal images"""
    leaves: frozenset[Leaf]
    """what of the surface it depends on, beside placed images"""
    placements: frozenset[Placement]
    placed: tuple[Image, ...]
    """images that lie on UV maps by the placements"""
    is_plain: bool
    """whether it is an image's own value, with nothing in between but what is linear"""
    shape: tuple[int, ...] = ()
    """of a value: (3,) of a colour"""

    @property
    def is_constant(self) -> bool:
        return not (self.leaves or self.placed)

    def at(self, points: Points, count: int) -> np.ndarray:
        """(count, *shape) finite values."""
        values = np.nan_to_num(self.evaluate(points), posinf=1.0, neginf=0.0)
        return np.broadcast_to(values, (count, *self.shape))

    def then(self, function: Callable[[np.ndarray], np.ndarray], key: Hashable) -> "Expression":
        """A function, which the key tells apart from others, of this expression."""
        evaluate = self.evaluate
        return self._replace(evaluate=lambda points: function(evaluate(points)), key=(self.key, key),
                             is_plain=False)


class Compiler:
    """Turns nodes to functions, and collects what these depend on."""

    def __init__(self, functions: dict[str, NodeFunction], check_images: bool):
        """functions: by a node's type."""
        self.functions = functions
        self.check_images = check_images
        self.keys: list[Hashable] = []
        self.leaves: set[Leaf] = set()
        self.placements: set[Placement] = set()
        self.placed: list[Image] = []
        self._open: list[Hashable] = []

    def value(self, found: nodes.Input, kind: str) -> Function:
        """kind: type of socket, as whose the value is wanted."""
        output, end = found.source()
        if output is None:
            own = own_array(end.socket)
            self.keys.append(own.tobytes())
            return converted(lambda points: own, end.socket.type, kind)
        compile_node = self.functions.get(output.node.type)
        if compile_node is None:
            raise Unsupported(output.node)
        key = (output.node.as_pointer(), tuple(group.as_pointer() for group in end.groups), output.identifier)
        if key in self._open:
            raise Unsupported(output.node, "feeds itself")
        self._open.append(key)
        self.keys.append((output.node.bl_idname, output.identifier, _fingerprint(output.node)))
        reader = Reader(self, output.node, end.groups)
        function = compile_node(reader, output, kind)
        self._open.pop()
        return converted(once((key, kind), function), reader.kind or output.type, kind)

    def leaf(self, leaf: Leaf) -> Function:
        self.leaves.add(leaf)
        self.keys.append(leaf)
        return lambda points: points.leaf(leaf)


class Reader:
    """A node's inputs as functions."""

    def __init__(self, compiler: Compiler, node: bpy.types.Node, groups: nodes.Groups):
        self.compiler = compiler
        self.node = node
        self.kind: str | None = None
        """type of what the node's function returns, where that isn't the output's"""
        self._groups = groups

    def input(self, name: str | int) -> nodes.Input:
        """By identifier or number; names aren't unique in a Mix node."""
        if isinstance(name, int):
            return nodes.Input(self.node.inputs[name], self._groups)
        socket = next(socket for socket in self.node.inputs if name in (socket.identifier, socket.name))
        return nodes.Input(socket, self._groups)

    def has(self, name: str) -> bool:
        return name in self.node.inputs

    def number(self, name: str | int) -> Function:
        return self.compiler.value(self.input(name), 'VALUE')

    def color(self, name: str | int) -> Function:
        return self.compiler.value(self.input(name), 'RGBA')

    def vector(self, name: str | int) -> Function:
        return self.compiler.value(self.input(name), 'VECTOR')

    def coordinates(self, default: Leaf) -> Function:
        """The Vector of a texture; default where nothing is linked."""
        if self.input("Vector").source().output is None:
            return self.compiler.leaf(default)
        return self.vector("Vector")

    def constant(self, name: str | int, kind: str = 'VECTOR') -> np.ndarray | None:
        """None where the input isn't the same everywhere."""
        try:
            inner = Compiler(self.compiler.functions, self.compiler.check_images)
            function = inner.value(self.input(name), kind)
        except Unsupported:
            return None
        if inner.leaves or inner.placed:
            return None
        self.compiler.keys.extend(inner.keys)
        return np.broadcast_to(function(Points({})), 3 if kind == 'VECTOR' else ())


def own_array(socket: bpy.types.NodeSocket) -> np.ndarray:
    """() or (3,): its own value; alpha is left out."""
    value = np.asarray(nodes.own_value(socket), np.float32)
    return value[:3] if value.ndim else value


def once(key: Hashable, function: Function) -> Function:
    """The function, evaluated once for the same points."""
    def evaluate(points: Points) -> np.ndarray:
        if key not in points.known:
            points.known[key] = np.asarray(function(points), np.float32)
        return points.known[key]
    return evaluate


def _fingerprint(node: bpy.types.Node) -> Hashable:
    """All that the node's own settings say; ramps and curves are tables in it."""
    common = bpy.types.ShaderNode.bl_rna.properties.keys()
    settings = []
    for prop in node.bl_rna.properties:
        if prop.identifier in common or prop.type in {'COLLECTION', 'POINTER'}:
            continue
        value = getattr(node, prop.identifier)
        settings.append((prop.identifier, tuple(value) if hasattr(value, '__iter__') else value))
    return tuple(settings)


# Between types of sockets

def converted(function: Function, kind: str, wanted: str) -> Function:
    is_number, is_wanted_number = (each in {'VALUE', 'INT', 'BOOLEAN'} for each in (kind, wanted))
    if is_number and not is_wanted_number:
        return lambda points: np.repeat(function(points)[..., None], 3, axis=-1)
    if is_wanted_number and kind == 'RGBA':
        return lambda points: function(points) @ nodes.LUMINANCE
    if is_wanted_number and kind == 'VECTOR':
        return lambda points: function(points).mean(axis=-1)
    return function
