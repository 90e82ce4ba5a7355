# SPDX-License-Identifier: GPL-3.0-or-later
"""What one synchronisation has made, for the next ones to use again."""

import threading
from collections.abc import Callable, Hashable, Set
from typing import Any, NamedTuple
from weakref import WeakValueDictionary

import bpy


class Client(NamedTuple):
    """What is synchronised for itself: the final frames of a view layer, or a 3D viewport. Names, as undo
    replaces the data; the viewport's address is no key to what it shows, but to how long that is kept."""
    scene: str
    view_layer: str
    mode: str
    """of the depsgraph: 'RENDER' or 'VIEWPORT'"""
    space: int
    """address of the 3D viewport; 0 without one"""

    @classmethod
    def of(cls, depsgraph: bpy.types.Depsgraph, space: bpy.types.SpaceView3D | None) -> "Client":
        return cls(depsgraph.scene.name_full, depsgraph.view_layer.name, depsgraph.mode,
                   0 if space is None else space.as_pointer())

    def exists(self, spaces: Set[int]) -> bool:
        """spaces: addresses of the rendered viewports."""
        if self.mode == 'RENDER' and not (bpy.app.background or bpy.app.is_job_running('RENDER')):
            return False
        return self.scene in bpy.data.scenes and (self.space == 0 or self.space in spaces)


def rendered_viewports() -> set[int]:
    """Addresses of the 3D viewports with Rendered shading, on all screens."""
    return {space.as_pointer() for screen in bpy.data.screens for area in screen.areas
            for space in area.spaces if space.type == 'VIEW_3D' and space.shading.type == 'RENDERED'}


class _Asked(threading.local):
    """Final frames are synchronised on a thread of their own."""

    def __init__(self):
        self.keys: set[Hashable] = set()


class Cache:
    """Values by key. Each is kept until no client needs it."""

    def __init__(self):
        self._values: dict[Hashable, Any] = {}
        self._asked = _Asked()
        self._needed: dict[Client, set[Hashable]] = {}

    def get(self, key: Hashable, make: Callable[[], Any]) -> Any:
        value = self._values.get(key)
        if value is None:
            value = self._values[key] = make()
        self._asked.keys.add(key)
        return value

    def peek(self, key: Hashable) -> Any:
        """None where there is none. Asks for it, too."""
        self._asked.keys.add(key)
        return self._values.get(key)

    def put(self, key: Hashable, value: Any) -> None:
        self._values[key] = value
        self._asked.keys.add(key)

    def sweep(self, client: Client) -> None:
        """Ends a synchronisation: client needs what was asked for since the last one on this thread. Forgets
        what no client that exists needs."""
        spaces = rendered_viewports()
        self._needed = {each: keys for each, keys in list(self._needed.items()) if each.exists(spaces)}
        self._needed[client] = self._asked.keys
        self._asked.keys = set()
        needed = set().union(*self._needed.values())
        for key in list(self._values):
            if key not in needed:
                self._values.pop(key, None)

    def clear(self) -> None:
        self._values.clear()
        self._needed.clear()


class Shared:
    """Values by key, as long as they are in use elsewhere."""

    def __init__(self):
        self._values = WeakValueDictionary()

    def get(self, key: Hashable, make: Callable[[], Any]) -> Any:
        value = self._values.get(key)
        if value is None:
            value = self._values[key] = make()
        return value
