# SPDX-License-Identifier: GPL-3.0-or-later
"""Python values between two processes. (After an import of multiprocessing, whose __mp_main__ outlives the
script's module, Blender 3.4 crashes at its end.)"""

import pickle
import select
import socket


class Channel:
    """One end. Each side waits for an answer before it sends again."""

    def __init__(self, end: socket.socket):
        self._socket = end
        self._file = end.makefile("rwb")

    def send(self, value: object) -> None:
        """Raises OSError where the other side is gone."""
        pickle.dump(value, self._file)
        self._file.flush()

    def poll(self, seconds: float) -> bool:
        """Whether something comes within this time, or the other side goes."""
        return bool(select.select([self._socket], [], [], seconds)[0])

    def receive(self) -> object:
        """Waits for it. Raises EOFError or OSError where the other side is gone."""
        return pickle.load(self._file)
