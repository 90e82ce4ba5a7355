# SPDX-License-Identifier: GPL-3.0-or-later
"""Tells on a stream what long work is at."""

import os
import time
from pathlib import Path
from typing import TextIO

SECONDS_BETWEEN_LINES = 10.0
"""Where the stream isn't a terminal, whose one line is written anew each time."""

SECONDS_BEFORE_ESTIMATE = 1.0


def silence_blender(log: Path) -> TextIO:
    """From now on what Blender writes to the standard output goes to this file; returns a stream to write to
    the standard output still."""
    stream = os.fdopen(os.dup(1), "w", encoding="utf-8")
    with open(log, "w", encoding="utf-8") as file:
        os.dup2(file.fileno(), 1)
    return stream


class Progress:
    """One step of work after the other, each a line that begins with 'verglas: '. Without a stream it is
    silent."""

    def __init__(self, stream: TextIO | None = None):
        self._stream = stream
        self._is_terminal = stream is not None and stream.isatty()
        self._subject = ""
        self._step = ""
        self._start = self._last = 0.0
        self._open_line = False

    def subject(self, name: str) -> None:
        """What the next steps are about."""
        self._subject = f"{name}: " if name else ""

    def step(self, text: str) -> None:
        """The next step begins."""
        self._step = text
        self._start = self._last = time.monotonic()
        self._write(f"{self._subject}{text}")

    def part(self, done: int, total: int) -> bool:
        """How much of the step is done; always True, as the core takes it for a wish to go on."""
        now = time.monotonic()
        elapsed = now - self._start
        if now - self._last >= (0.2 if self._is_terminal else SECONDS_BETWEEN_LINES) and done < total:
            self._last = now
            left = f", {_duration(elapsed * (total - done) / done)} left" if (
                done and elapsed > SECONDS_BEFORE_ESTIMATE) else ""
            self._write(f"{self._subject}{self._step}, {done / total:.0%}{left}", replace=True)
        return True

    def say(self, sentence: str) -> None:
        """Something worth a line of its own."""
        self._write(f"{self._subject}{sentence}")

    def close(self) -> None:
        if self._stream and self._open_line:
            self._stream.write("\n")
            self._stream.flush()
        self._open_line = False

    def _write(self, text: str, replace: bool = False) -> None:
        if self._stream is None:
            return
        if self._is_terminal:
            start = "\r\x1b[K" if replace or not self._open_line else "\n"
            self._stream.write(f"{start}verglas: {text}")
            self._open_line = True
        else:
            self._stream.write(f"verglas: {text}\n")
        self._stream.flush()


def _duration(seconds: float) -> str:
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes:02} min"
    return f"{minutes} min {seconds:02} s" if minutes else f"{seconds} s"
