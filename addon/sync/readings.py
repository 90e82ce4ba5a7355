# SPDX-License-Identifier: GPL-3.0-or-later
"""What has been read of Blender's meshes, and which of it still holds.

Meshes go by name: undo replaces all of Blender's data, and addresses are used again. Each change that Blender
tells of is numbered; what was read holds until its mesh has a new number.
"""

import itertools
from collections.abc import Callable, Hashable
from typing import Any, NamedTuple

import bpy

from . import meshes
from .cache import Cache, Client

ALL = "all"
METABALLS = "metaballs"
_counter = itertools.count(1)
_changes: dict[Hashable, int] = {}
"""Numbers of the last changes, by kind and name of what has changed, or for ALL or METABALLS."""


def note_object(obj: bpy.types.Object) -> None:
    """Its geometry has changed."""
    original = obj.original
    _note(_key_of(original))
    # Modes other than Object Mode change the data beneath the modifiers
    if original.data is not None and (not original.modifiers or original.mode != 'OBJECT'):
        note_data(original.data)


def note_data(data: bpy.types.ID) -> None:
    """A mesh, a curve, … has changed."""
    _note(_key_of(data))


def note_metaballs() -> None:
    """One has changed or moved; another may have the mesh of both."""
    _note(METABALLS)


def note_all() -> None:
    _note(ALL)


def _note(key: Hashable) -> None:
    _changes[key] = next(_counter)


def _key_of(data: bpy.types.ID) -> tuple[str, str]:
    return type(data).__name__, data.name_full


class _State(NamedTuple):
    """Of a mesh, differs after a change."""
    changes: tuple[int, ...]
    address: int
    """of the original data, in case that two have exchanged their names"""
    counts: tuple[int, int]
    """vertices, face corners"""


class Reading:
    """Arrays of one mesh, and what has been made of them."""

    def __init__(self, state: _State, arrays: meshes.MeshArrays, previous: "Reading | None"):
        self.state = state
        self.arrays = arrays
        self._previous = previous
        """Keeps alive what can be shared until all of this one has been made."""
        self._made: dict[Hashable, Any] = {}
        self._used: set[Hashable] = set()

    def get(self, key: Hashable, make: Callable[[], Any]) -> Any:
        if key not in self._made:
            self._made[key] = make()
        self._used.add(key)
        return self._made[key]

    def sweep(self) -> None:
        """Forgets what has not been asked for since the last sweep."""
        self._made = {key: self._made[key] for key in self._used}
        self._used = set()
        self._previous = None


_readings = Cache()


def sweep(client: Client) -> None:
    """As Cache.sweep."""
    _readings.sweep(client)


def clear() -> None:
    _readings.clear()
    _changes.clear()


class Readings:
    """Those of one synchronisation, by the evaluated mesh's address, which holds meanwhile."""

    def __init__(self, depsgraph: bpy.types.Depsgraph):
        self._owner = Client.of(depsgraph, None)
        self._keys: dict[int, Hashable] = {}
        self._count: dict[Hashable, int] = {}
        self._readings: dict[int, Reading] = {}

    def touch(self, obj: bpy.types.Object) -> None:
        """Keeps the mesh of an evaluated object that isn't shown. To be called of all objects in their order,
        as it tells apart the meshes that the nodes of one object make."""
        address = obj.data.as_pointer()
        if address not in self._keys:
            source = _source(obj.original)
            number = self._count[source] = self._count.get(source, 0) + 1
            self._keys[address] = (self._owner, source, number)
            _readings.peek(self._keys[address])

    def of(self, obj: bpy.types.Object) -> Reading:
        """The mesh of an evaluated object, read if it has changed, or for final frames: scripts can change
        meshes without Blender's knowing."""
        address = obj.data.as_pointer()
        if address not in self._readings:
            self.touch(obj)
            self._readings[address] = self._read(obj, self._keys[address])
        return self._readings[address]

    def _read(self, obj: bpy.types.Object, key: Hashable) -> Reading:
        previous, state = _readings.peek(key), _state(obj)
        if previous is not None and previous.state == state and self._owner.mode == 'VIEWPORT':
            return previous
        arrays = meshes.read(obj)
        if previous is not None and meshes.are_equal(previous.arrays, arrays):
            arrays = previous.arrays
        reading = Reading(state, arrays, previous)
        _readings.put(key, reading)
        return reading

    def finish(self) -> None:
        for reading in self._readings.values():
            reading.sweep()


def _is_shared(original: bpy.types.Object) -> bool:
    """Whether the evaluated mesh is that of all objects with the same data."""
    return (isinstance(original.data, bpy.types.Mesh) and not original.modifiers and original.mode != 'EDIT'
            and original.data.shape_keys is None)


def _source(original: bpy.types.Object) -> tuple[str, str]:
    return _key_of(original.data if _is_shared(original) else original)


def _state(obj: bpy.types.Object) -> _State:
    original = obj.original
    keys = [ALL, _key_of(original.data)] if original.data is not None else [ALL]
    if not _is_shared(original):
        keys.append(_key_of(original))
    if original.type == 'META':
        keys.append(METABALLS)
    address = 0 if original.data is None else original.data.as_pointer()
    return _State(tuple(_changes.get(key, 0) for key in keys), address,
                  (len(obj.data.vertices), len(obj.data.loops)))
