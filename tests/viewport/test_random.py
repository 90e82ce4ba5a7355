# SPDX-License-Identifier: GPL-3.0-or-later
"""Hours of a user's work in short."""

import random
import time
from pathlib import Path

import pytest
from blender_window import Window
from checks import final_picture, settle
from interaction import orbit

GROWTH = 50e6
"""Bytes by which Blender may grow after the first hundred operations."""


class Work:
    """Random operations. Each method with a name is one; they leave Blender in a state in which every other
    one can follow."""

    def __init__(self, window: Window, seed: int, folder: Path):
        self._window = window
        self._random = random.Random(seed)
        self._path, self._library = str(folder / "work.blend"), str(folder / "library.blend")
        window.call("edits.save_library", self._library)
        window.call("edits.save", self._path)
        window.call("edits.load", self._path)  # nothing is undone beyond this
        self._operations = [getattr(self, name) for name in dir(self) if not name.startswith("_")]

    def __call__(self) -> None:
        operation = self._random.choice(self._operations)
        print(operation.__name__, flush=True)  # shown where the test fails
        operation()
        time.sleep(self._random.choice((0.0, 0.0, 0.02, 0.1)))

    def _number(self, low: float, high: float) -> float:
        return self._random.uniform(low, high)

    def _name(self) -> str:
        return self._random.choice(("Monkey", "Sphere"))

    def _viewport(self) -> int:
        return self._random.randrange(self._window.call("viewports.count"))

    def orbit(self):
        orbit(self._window, self._viewport(), self._number(-0.5, 0.5), self._number(-0.3, 0.3), moves=4)

    def zoom(self):
        self._window.call("viewports.zoom", self._viewport(), self._random.choice((-1, 1)))

    def roughness(self):
        self._window.call("edits.set_roughness", self._name(), self._number(0.05, 0.9))

    def world(self):
        self._window.call("edits.set_world_strength", self._number(0.5, 1.5))

    def move(self):
        self._window.call("edits.move", self._name(), *(self._number(-1.0, 1.0) for _ in range(3)))
        self._window.call("edits.push_undo", "Move")

    def undo(self):
        self._window.call("edits.undo")

    def redo(self):
        self._window.call("edits.redo")

    def add(self):
        self._window.call("edits.add_copy", self._name(), *(self._number(-1.0, 1.0) for _ in range(3)))
        self._window.call("edits.push_undo", "Add")

    def add_linked(self):
        self._window.call("edits.add_linked", self._library, *(self._number(-1.0, 1.0) for _ in range(3)))
        self._window.call("edits.push_undo", "Link")

    def delete(self):
        self._window.call("edits.delete_copies")
        self._window.call("edits.push_undo", "Delete")

    def edit_mode(self):
        self._window.call("edits.select", self._name())
        self._window.call("edits.set_mode", 'EDIT')
        self._window.call("edits.stretch_mesh", self._number(0.8, 1.25))
        self._window.call("edits.set_mode", 'OBJECT')

    def sculpt_mode(self):
        self._window.call("edits.select", self._name())
        for mode in ('SCULPT', 'OBJECT'):
            self._window.call("edits.set_mode", mode)

    def particles(self):
        self._window.call("edits.toggle_particles")
        self._window.call("edits.push_undo", "Particles")

    def second_window(self):
        self._window.call("viewports.open_window")
        self._window.call("edits.set_roughness", self._name(), self._number(0.05, 0.9))
        self._window.call("viewports.close_windows")

    def split(self):
        if self._window.call("viewports.count") == 1:
            self._window.call("viewports.split", self._random.choice(('HORIZONTAL', 'VERTICAL')),
                              self._number(0.3, 0.7))
        else:
            self._window.call("viewports.leave_one")

    def quad_view(self):
        self._window.call("viewports.toggle_quad_view", 0)

    def engine(self):
        engine = self._random.choice(('BLENDER_WORKBENCH', 'EEVEE'))
        self._window.call("edits.set_engine", engine)
        self._window.call("edits.set_engine", 'VERGLAS')

    def solid(self):
        index = self._viewport()
        for shading in ('SOLID', 'RENDERED'):
            self._window.call("viewports.set_shading", index, shading)

    def load(self):
        self._window.call("edits.load", self._path)

    def local_view(self):
        self._window.call("edits.select", self._name())
        self._window.call("edits.toggle_local_view")

    def orthographic(self):
        self._window.call("viewports.toggle_orthographic", self._viewport())

    def camera(self):
        self._window.call("viewports.toggle_camera_view", self._viewport())

    def final_frame(self):
        self._window.call("truth.camera_frame")


def test_random_work(window, tmp_path):
    """Some sequence of operations would end Blender, or leave an old picture."""
    work = Work(window, 6, tmp_path)
    for _ in range(30):
        work()
    settle(window)
    final_picture(window)


@pytest.mark.slow
def test_long_work(window, tmp_path):
    """Blender would fail after an hour of work, or fill the memory."""
    work = Work(window, 1, tmp_path)
    for done in range(500):
        work()
        if done % 20 == 0:
            settle(window)
        if done == 100:
            memory = window.memory()
    final_picture(window)
    growth = window.memory() - memory
    print(f"{growth / 1e6:.1f} MB more")
    assert growth < GROWTH
