# SPDX-License-Identifier: GPL-3.0-or-later
"""A real Blender window on an X server of its own, which the caller's Python drives call by call.

The window needs no display and no graphics card: Xvfb keeps the screen in memory, and Mesa draws in software.
Blender's own event loop runs between the calls: it handles events, redraws and runs timers as for a user.
"""

import os
import re
import shutil
import signal
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
from channel import Channel

TESTS = Path(__file__).resolve().parents[1]

PATH = [str(TESTS / "viewport"), str(TESTS / "blender")]
"""Where Blender finds the modules whose functions are called."""

SIMULATE_EVENTS = "--enable-event-simulate"
"""The option with which Blender takes simulated events. It never sleeps then."""

OVERWRITE_FREED_MEMORY = {"MALLOC_CONF": "junk:true", "MALLOC_PERTURB_": "165"}
"""Environment variables by which jemalloc, which Debian's and the official Blender have, and glibc fill
memory as it is freed: who uses it later crashes then and there, not in one of some runs. Only for the CPU
device: Mesa 22.3's software renderer reads freed memory where two threads draw."""

PATIENCE = 60.0
"""Seconds that one call may take before Blender counts as hung."""


def why_not() -> str | None:
    """Why no window can be opened here; None where it can."""
    return None if shutil.which("Xvfb") else "There is no Xvfb here (Debian package xvfb)."


def is_error(line: str) -> bool:
    """Whether a line of what Blender prints tells of a fault in Python or, with --debug-gpu, in OpenGL."""
    return bool(re.search(r"Traceback|^\w*Error\b|^ERROR \(", line))


class Dead(Exception):
    """Blender has crashed or hung; the message ends with the last lines of what it printed."""


class Failed(Exception):
    """A function raised inside Blender; the message is its traceback."""


class Screen:
    """An X server. Its picture is a file that the server writes as it draws."""

    def __init__(self, folder: Path, width: int, height: int):
        read, write = os.pipe()
        command = ["Xvfb", "-displayfd", str(write), "-screen", "0", f"{width}x{height}x24",
                   "-fbdir", str(folder), "-nolisten", "tcp", "-noreset", "-nocursor"]
        self._file = folder / "Xvfb_screen0"
        with (folder / "xvfb.log").open("wb") as log:
            self._process = subprocess.Popen(command, pass_fds=(write,), stdout=log, stderr=log)
        os.close(write)
        with os.fdopen(read) as pipe:
            number = pipe.readline().strip()
        if not number:
            raise Dead(f"Xvfb ended: {(folder / 'xvfb.log').read_text(errors='replace')}")
        self.display = f":{number}"

    def picture(self) -> np.ndarray:
        """(H, W, 3) uint8, RGB, row 0 at the bottom as of Blender's regions."""
        # The format of xwd, X11/XWDFile.h: a header of big-endian numbers, a colour map, 32 bits a pixel
        header = np.fromfile(self._file, ">u4", 25)
        size, width, height, bytes_per_line, colors = header[[0, 4, 5, 12, 19]].tolist()
        data = np.fromfile(self._file, np.uint8, height * bytes_per_line, offset=size + 12 * colors)
        pixels = data.reshape(height, bytes_per_line)[:, :4 * width].reshape(height, width, 4)
        return pixels[::-1, :, 2::-1].copy()

    def close(self) -> None:
        self._process.terminate()
        self._process.wait()


class Window:
    """Blender with factory settings and the installed add-on, with one window of width x height pixels.
    Its settings, temporary and recent files are kept apart from the user's.

    options: further ones of Blender; SIMULATE_EVENTS where drag() is called. blender: its path; default as
    the launcher takes it. variables: of its environment. Raises Dead where it doesn't come up."""

    def __init__(self, width: int, height: int, *options: str, blender: str | None = None,
                 variables: dict[str, str] | None = None):
        self.folder = Path(tempfile.mkdtemp(prefix="verglas_window_"))
        self.width, self.height = width, height
        self.screen = Screen(self.folder, width, height)
        ours, theirs = socket.socketpair()
        self._channel = Channel(ours)
        environment = os.environ | (variables or {}) | {
            "DISPLAY": self.screen.display, "LIBGL_ALWAYS_SOFTWARE": "1", "LC_ALL": "C.UTF-8",
            "BLENDER_USER_CONFIG": str(self.folder / "config"), "TMPDIR": str(self.folder),
        }
        environment.pop("WAYLAND_DISPLAY", None)
        start = f"import sys; sys.path[:0] = {PATH}; import agent; agent.start({theirs.fileno()})"
        command = [blender or os.environ.get("BLENDER", "blender"), "--factory-startup", "-noaudio", *options,
                   "--window-geometry", "0", "0", str(width), str(height),
                   "--python-exit-code", "1", "--python-expr", start]
        self._log = self.folder / "blender.log"
        with self._log.open("wb") as log:
            self.process = subprocess.Popen(
                command, pass_fds=(theirs.fileno(),), env=environment, stdout=log, stderr=log)
        theirs.close()
        try:
            self.call("agent.ready")
        except Dead:
            self.close()
            raise

    def call(self, function: str, *arguments, patience: float = PATIENCE):
        """What MODULE.FUNCTION returns, run on Blender's main thread."""
        try:
            self._channel.send((function, arguments))
            if not self._channel.poll(patience):
                raise self._hung(f"{function} took more than {patience:g} s")
            succeeded, value = self._channel.receive()
        except (EOFError, OSError) as error:
            raise self._crashed(function) from error
        if not succeeded:
            raise Failed(value)
        return value

    def drag(self, button: str, path: Iterable[tuple[int, int]]) -> None:
        """Presses a mouse button, moves through places in the window, in pixels from its lower left corner,
        and releases it."""
        path = iter(path)
        place = next(path)
        self._mouse('MOUSEMOVE', 'NOTHING', place)
        self._mouse(button, 'PRESS', place)
        for place in path:
            self._mouse('MOUSEMOVE', 'NOTHING', place)
        self._mouse(button, 'RELEASE', place)

    def _mouse(self, event: str, value: str, place: tuple[int, int]) -> None:
        self.call("viewports.send", event, value, *place)

    def wait_until(self, condition: Callable[[], object], what: str, patience: float = PATIENCE,
                   pause: float = 0.01) -> None:
        """Asks every `pause` seconds while Blender goes on. Raises TimeoutError, which says what was waited
        for."""
        end = time.monotonic() + patience
        while not condition():
            if time.monotonic() > end:
                raise TimeoutError(f"{what} hasn't come after {patience:g} s")
            time.sleep(pause)

    def settle(self, patience: float = 20.0) -> None:
        """Waits until all viewports have drawn their last picture. Raises TimeoutError."""
        def is_settled() -> bool:
            # Between two calls Blender's event loop goes round once, and takes notice of what was changed
            seen = [self.call("viewports.states") for _ in range(3)]
            return seen[0] == seen[1] == seen[2] and all(is_done for is_done, _, _ in seen[0])
        self.wait_until(is_settled, "the viewports' last picture", patience)

    def cpu_seconds(self) -> float:
        """Time of all cores that Blender has used so far."""
        # proc(5): the process's name in parentheses is field 2, utime and stime are 14 and 15
        fields = self._proc("stat").rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def memory(self) -> int:
        """Bytes of RAM that Blender has."""
        return int(self._proc("statm").split()[1]) * os.sysconf("SC_PAGE_SIZE")

    def _proc(self, name: str) -> str:
        return Path("/proc", str(self.process.pid), name).read_text()

    def log(self) -> str:
        """All that Blender has printed."""
        return self._log.read_text(errors="replace")

    @property
    def is_alive(self) -> bool:
        return self.process.poll() is None

    def close(self) -> None:
        """Ends Blender, where it still runs, and the screen. Raises Dead where it doesn't quit well."""
        try:
            if self.is_alive:
                self._quit()
        finally:
            self.screen.close()
            shutil.rmtree(self.folder)

    def _quit(self) -> None:
        try:
            self._channel.send(("agent.quit", ()))
            self.process.wait(PATIENCE)
        except (OSError, subprocess.TimeoutExpired):
            self._kill()
        if self.process.returncode != 0:
            raise self._ended("agent.quit")

    def _hung(self, what: str) -> Dead:
        self.process.send_signal(signal.SIGUSR1)  # has the agent print the stacks of all threads
        time.sleep(0.5)
        self._kill()
        return Dead(f"Blender hangs: {what}\n{self._last_words()}")

    def _crashed(self, function: str) -> Dead:
        self._kill()
        return self._ended(function)

    def _ended(self, function: str) -> Dead:
        return Dead(f"Blender ended in {function}, with status {self.process.returncode}\n"
                    f"{self._last_words()}")

    def _kill(self) -> None:
        self.process.kill()
        self.process.wait()

    def _last_words(self) -> str:
        """The end of what it printed, and what Blender writes when it crashes."""
        crashes = [path.read_text(errors="replace") for path in self.folder.glob("*.crash.txt")]
        return "\n".join([*self.log().splitlines()[-40:], *crashes])
