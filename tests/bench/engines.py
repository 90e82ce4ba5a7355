# SPDX-License-Identifier: GPL-3.0-or-later
"""Verglas beside its own path tracer, Cycles and EEVEE, on the monkey."""

from collections.abc import Callable

from figures.models import MODELS
from verglas.compare.methods import TRACED, Subject
from verglas.compare.progress import Progress
from verglas.faults import Fault

from . import subjects
from .frames import METHODS, Row, cost
from .plan import Plan


def engines(plan: Plan, progress: Progress, notes: list[str]) -> list[Row]:
    """sample_ms: the time of one sample of every pixel, without what is done once for a picture; EEVEE's is a
    share of picture_ms, which holds all. notes: takes what can't run here."""
    subject = subjects.subject(MODELS["monkey"], plan.engine_size, progress)
    rows = [_real_time(subject, method, plan) for method in METHODS]
    progress.step("path tracing by Verglas")
    rows.append(_reference(subject, plan.reference_samples))
    others = {"Cycles": _cycles, "EEVEE": _eevee} if plan.with_eevee else {"Cycles": _cycles}
    for engine, measure in others.items():
        progress.step(f"rendering by {engine}")
        rows += _attempt(lambda measure=measure: measure(subject, plan), progress, notes)
    return rows


def refraction(plan: Plan, progress: Progress, notes: list[str]) -> list[Row]:
    """As engines(), of glass that reflects nothing, by the CPU device and Cycles."""
    subject = subjects.refracting(MODELS["monkey"], plan.engine_size, progress)
    progress.step("rendering refraction by Cycles")
    return [_real_time(subject, TRACED, plan),
            *_attempt(lambda: _cycles(subject, plan), progress, notes)]


def _attempt(measure: Callable[[], Row], progress: Progress, notes: list[str]) -> list[Row]:
    """None where it can't run."""
    try:
        return [measure()]
    except Fault as fault:
        notes.append(str(fault))
        progress.say(str(fault))
        return []


def _real_time(subject: Subject, method: str, plan: Plan) -> Row:
    return {"engine": method, "samples": 1,
            "sample_ms": cost(subject.core_scene, method, plan.engine_size, plan)["frame_ms"]}


def _reference(subject: Subject, samples: int) -> Row:
    tracer = subject.path_tracer()
    tracer.render(1)
    first = tracer.frame().seconds
    tracer.render(samples)
    seconds = tracer.frame().seconds - first
    return {"engine": "reference", "samples": samples, "sample_ms": 1e3 * seconds / samples}


def _cycles(subject: Subject, plan: Plan) -> Row:
    subject.cycles(1)  # warms up
    few, many = (subject.cycles(samples) for samples in plan.cycles_samples)
    samples = many.samples - few.samples
    return {"engine": "cycles", "samples": samples, "sample_ms": 1e3 * (many.seconds - few.seconds) / samples}


def _eevee(subject: Subject, plan: Plan) -> Row:
    picture = subject.eevee()
    milliseconds = 1e3 * picture.seconds
    return {"engine": "eevee", "samples": picture.samples, "picture_ms": milliseconds,
            "sample_ms": milliseconds / picture.samples}
