# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong with the user's scene, and how the user hears of it."""

import re
import weakref
from collections.abc import Callable

import bpy

Warn = Callable[[str], None]
"""Takes one whole sentence that begins with what it is about: an object, material, node or file, by name."""

_SUBJECT = re.compile(r"(?:The )?(\w[\w ]*?) '(.+?)'(?=[\s:,.]|$)")
"""What a sentence begins with, as "Material 'Glass'"; names can hold apostrophes."""


class Fault(Exception):
    """Nothing can be rendered; the message is one sentence for the user."""


class Collector:
    """What one maker of pictures has to say: the render jobs, or a viewport. The render panel lists it as
    long as it is kept by whoever made it."""

    def __init__(self):
        self.fault = ""
        """the sentence of what keeps it from making pictures; "" if nothing does"""
        self._warnings: dict[str, None] = {}
        _collectors[self] = None

    @property
    def warnings(self) -> tuple[str, ...]:
        """Each once, in order."""
        return tuple(self._warnings)

    def warn(self, sentence: str) -> None:
        self._warnings[sentence] = None

    def clear(self) -> None:
        """Before the scene is read again."""
        self.fault = ""
        self._warnings.clear()


_collectors: weakref.WeakKeyDictionary[Collector, None] = weakref.WeakKeyDictionary()
"""In the order in which they were made."""

_job = Collector()
"""Of the latest render job."""


def warnings() -> tuple[str, ...]:
    """Those of the latest render job, each once, in order."""
    return _job.warnings


def subject(sentence: str) -> str:
    """What it is about, as "Material 'Glass'"; "" where it doesn't begin with that."""
    found = _SUBJECT.match(sentence)
    return f"{found[1]} '{found[2]}'" if found else ""


def listed() -> tuple[tuple[str, ...], dict[str, tuple[str, ...]]]:
    """The faults, and the warnings by their subject, of the render job and all viewports; each sentence once,
    subjects in the order of their names, those without one first."""
    collectors = list(_collectors)
    faults = dict.fromkeys(collector.fault for collector in collectors if collector.fault)
    groups: dict[str, dict[str, None]] = {}
    for collector in collectors:
        for sentence in collector.warnings:
            groups.setdefault(subject(sentence), {})[sentence] = None
    return tuple(faults), {name: tuple(groups[name]) for name in sorted(groups)}


def warner(engine: bpy.types.RenderEngine) -> Warn:
    """A function that reports a sentence through the engine, unless this render job, which may
    be a whole animation, has reported it before."""
    def warn(sentence: str) -> None:
        if sentence not in _job.warnings:
            _job.warn(sentence)
            engine.report({'WARNING'}, sentence)
    return warn


def report(engine: bpy.types.RenderEngine, fault: Exception) -> None:
    """Ends the render job with what keeps it from making a picture."""
    _job.fault = str(fault)
    engine.report({'ERROR'}, _job.fault)


@bpy.app.handlers.persistent
def _start_of_job(*_) -> None:
    _job.clear()


def register():
    bpy.app.handlers.render_init.append(_start_of_job)


def unregister():
    bpy.app.handlers.render_init.remove(_start_of_job)
    _job.clear()
