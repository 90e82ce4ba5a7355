# SPDX-License-Identifier: GPL-3.0-or-later
"""What one synchronisation has made, for the next ones to use again."""

from collections.abc import Callable, Hashable
from typing import Any


class Cache:
    """Values by key. Those that weren't asked for between two sweeps are forgotten."""

    def __init__(self):
        self._values: dict[Hashable, Any] = {}
        self._used: set[Hashable] = set()

    def get(self, key: Hashable, make: Callable[[], Any]) -> Any:
        if key not in self._values:
            self._values[key] = make()
        self._used.add(key)
        return self._values[key]

    def sweep(self) -> None:
        self._values = {key: value for key, value in self._values.items() if key in self._used}
        self._used.clear()

    def clear(self) -> None:
        self._values.clear()
        self._used.clear()
