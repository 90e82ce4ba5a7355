# SPDX-License-Identifier: GPL-3.0-or-later
"""One scene by every method, each measured against one truth."""

from collections.abc import Callable
from dataclasses import dataclass, field

import bpy

from .. import verglas_core as core
from ..faults import Fault
from . import metrics
from .methods import METHODS, PATH_TRACED, REAL_TIME, Conditions, Picture, Subject
from .notes import explain
from .progress import Progress
from .truth import FIRST_SAMPLES, MAX_SAMPLES, NOISE_TO_ERROR, Truth

METHOD_SEEDS = (1_000_000, 1_000_001)
"""Of path-traced methods and of the pictures that show their noise: none of a truth's own."""


@dataclass(frozen=True)
class Options:
    """What is compared, and how."""
    methods: tuple[str, ...] = REAL_TIME
    truth: str = "reference"
    paths: str = 'full'
    tir: bool = False
    """see Conditions"""
    spp: int | None = None
    """samples a pixel of the truth; None: as many as it takes, see NOISE_TO_ERROR"""
    samples: int | None = None
    """a pixel, of real-time methods; None: the file's"""
    method_spp: int = 64
    """samples a pixel of path-traced methods"""
    size: tuple[int, int] | None = None
    """width and height in pixels; None: the file's"""

    def conditions(self, scene: bpy.types.Scene) -> Conditions:
        percentage = scene.render.resolution_percentage / 100.0
        width, height = self.size or (max(1, int(scene.render.resolution_x * percentage)),
                                      max(1, int(scene.render.resolution_y * percentage)))
        return Conditions(width, height, self.samples or scene.verglas.samples, self.paths, self.tir)


@dataclass
class Measured:
    """A method's picture and what was found out about it."""
    picture: Picture
    metrics: dict[str, float | None]
    """those of metrics.ALL, and relmse_net"""
    noise: float | None = None
    """of path-traced methods: relmse to another such picture"""
    convergence: list[dict[str, float]] = field(default_factory=list)
    """of path-traced methods: samples, seconds and relmse on the way to the picture"""


@dataclass
class Comparison:
    """Methods by name, in the order of METHODS, and their truth."""
    subject: Subject
    options: Options
    truth: Truth
    methods: dict[str, Measured]
    notes: list[str]
    """whole sentences for the reader of the report"""


def compare(scene: bpy.types.Scene, options: Options, progress: Progress) -> Comparison:
    """Renders and measures. A method that can't be had is left out, with a note. Raises Fault or core.Error
    where the scene or the truth can't be rendered."""
    notes = [f"There is no method '{name}'; there are {', '.join(METHODS)}."
             for name in options.methods if name not in METHODS]
    progress.step("exporting the scene")
    subject = Subject(scene, options.conditions(scene), notes.append)
    truth = Truth(options.truth, subject)

    stages: dict[str, list[Picture]] = {}
    noises: dict[str, float] = {}
    for method in (known for known in METHODS if known in options.methods):
        try:
            stages[method] = _render(subject, method, options, progress)
            if method in PATH_TRACED:
                noises[method] = _noise(subject, method, stages[method][-1], progress)
        except (Fault, core.Error) as fault:
            stages.pop(method, None)
            notes.append(f"{method} isn't in this report: {fault}")
    pictures = {method: pictures[-1] for method, pictures in stages.items()}
    _sample(truth, options, pictures, notes.append, progress)

    progress.step("measuring")
    methods = {method: _measure(pictures, truth, subject, noises.get(method))
               for method, pictures in stages.items()}
    for key in _MISSING:
        if methods and all(measured.metrics[key] is None for measured in methods.values()):
            notes.append(_MISSING[key])
    if options.paths != 'full':
        for method in (method for method in ("cycles", "eevee") if method in methods):
            notes.append(f"{method} can't leave paths out: its error holds all the light that the truth, of "
                         f"{options.paths} paths, doesn't have.")
    notes += explain(subject, truth, pictures)
    return Comparison(subject, options, truth, methods, list(dict.fromkeys(notes)))


_MISSING = {
    "ssim": "SSIM isn't measured: it needs scikit-image (on Debian: python3-skimage) and 11 x 11 pixels.",
    "flip": "FLIP isn't measured: it needs the Python module flip_evaluator (from PyPI: flip-evaluator).",
}
"""Notes on metrics that no method has."""


def _render(subject: Subject, method: str, options: Options, progress: Progress) -> list[Picture]:
    """The method's picture, last; before it those with fewer samples where it is path traced."""
    if method == "reference":
        return _render_reference(subject, options.method_spp, progress)
    if method == "cycles":
        return _render_cycles(subject, options.method_spp, progress)
    progress.step(f"rendering {method}")
    return [subject.eevee() if method == "eevee" else subject.real_time(method)]


def _render_reference(subject: Subject, samples: int, progress: Progress) -> list[Picture]:
    """With 1, 2, 4, … samples."""
    progress.step(f"rendering reference, {samples} samples")
    tracer = subject.path_tracer(METHOD_SEEDS[0])
    pictures = []
    for reached in _doubling(samples, 2):
        before = tracer.samples
        tracer.render(reached - before, lambda done, _: progress.part(before + done, samples))
        pictures.append(Picture.of(tracer))
    return pictures


def _render_cycles(subject: Subject, samples: int, progress: Progress) -> list[Picture]:
    """With 1, 4, 16, … samples, each begun anew."""
    pictures = []
    for reached in _doubling(samples, 4):
        progress.step(f"rendering cycles, {reached} samples")
        pictures.append(subject.cycles(reached, METHOD_SEEDS[0]))
    return pictures


def _doubling(last: int, factor: int) -> list[int]:
    """1, factor, factor^2, … and at the end last."""
    numbers = []
    number = 1
    while number < last:
        numbers.append(number)
        number *= factor
    return [*numbers, last]


def _noise(subject: Subject, method: str, picture: Picture, progress: Progress) -> float:
    """relmse between the picture and another of another seed."""
    progress.step(f"rendering {method} once more, for its noise")
    if method == "reference":
        other = subject.reference(picture.samples, METHOD_SEEDS[1], progress.part)
    else:
        other = subject.cycles(picture.samples, METHOD_SEEDS[1])
    return metrics.relmse(picture.pixels, other.pixels, subject.mask)


def _sample(truth: Truth, options: Options, pictures: dict[str, Picture], note: Callable[[str], None],
            progress: Progress) -> None:
    """Gives the truth its samples, and a note where they leave too much noise."""
    def add(samples: int) -> None:
        progress.step(f"rendering the truth by {truth.method}, {truth.samples + samples} samples")
        truth.add(samples, progress.part)

    judged = {m: p for m, p in pictures.items() if m in REAL_TIME} or pictures

    def allowed() -> float:
        errors = [metrics.relmse(p.pixels, truth.pixels, truth.mask) for p in judged.values()]
        return NOISE_TO_ERROR * min(errors, default=0.0)

    add(options.spp + options.spp % 2 if options.spp else FIRST_SAMPLES)
    while options.spp is None and truth.noise >= allowed() and truth.samples < MAX_SAMPLES and judged:
        add(truth.samples)
    if judged and truth.noise >= allowed():
        note(f"The truth is noisy: with {truth.samples} samples its noise is {truth.noise:.2g} (relative "
             f"MSE), not below {allowed():.2g}, a tenth of the smallest error measured against it.")


def _measure(pictures: list[Picture], truth: Truth, subject: Subject, noise: float | None) -> Measured:
    pixels, mask = truth.pixels, subject.mask
    found = metrics.measure(pictures[-1].pixels, pixels, mask)
    found["relmse_net"] = metrics.relmse_net(pictures[-1].pixels, truth.halves, mask)
    convergence = [
        {"samples": p.samples, "seconds": p.seconds, "relmse": metrics.relmse(p.pixels, pixels, mask)}
        for p in pictures] if noise is not None else []
    return Measured(pictures[-1], found, noise, convergence)
