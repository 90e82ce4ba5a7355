# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong with the user's scene, and how the user hears of it."""

from collections.abc import Callable

import bpy

Warn = Callable[[str], None]
"""Takes one whole sentence that names the object, material, node or file it is about."""


class Fault(Exception):
    """Nothing can be rendered; the message is one sentence for the user."""


_warnings: dict[str, None] = {}


def warnings() -> tuple[str, ...]:
    """The warnings of the latest render job, each once, in order; the render panel lists them."""
    return tuple(_warnings)


def warner(engine: bpy.types.RenderEngine) -> Warn:
    """A function that reports a sentence through the engine, unless this render job, which may
    be a whole animation, has reported it before."""
    def warn(sentence: str) -> None:
        if sentence not in _warnings:
            _warnings[sentence] = None
            engine.report({'WARNING'}, sentence)
    return warn


@bpy.app.handlers.persistent
def _start_of_job(*_) -> None:
    _warnings.clear()


def register():
    bpy.app.handlers.render_init.append(_start_of_job)


def unregister():
    bpy.app.handlers.render_init.remove(_start_of_job)
    _warnings.clear()
