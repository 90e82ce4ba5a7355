# SPDX-License-Identifier: GPL-3.0-or-later
"""One scene by every method, each measured against one truth."""

from collections.abc import Callable
from dataclasses import dataclass

import bpy

from .. import verglas_core as core
from ..faults import Fault
from . import blur, metrics
from .measured import Measured, Rendered
from .methods import DEFAULT, METHODS, PATH_TRACED, REAL_TIME, TRACED, Conditions, Picture, Subject
from .notes import explain, explain_cost
from .progress import Progress
from .truth import FIRST_SAMPLES, MAX_SAMPLES, NOISE_TO_ERROR, Truth

METHOD_SEEDS = (1_000_000, 1_000_001)
"""Of path-traced methods and of the pictures that show their noise: none of a truth's own."""


@dataclass(frozen=True)
class Options:
    """What is compared, and how."""
    methods: tuple[str, ...] = DEFAULT
    truth: str = "reference"
    paths: str = 'full'
    tir: bool = False
    """see Conditions"""
    spp: int | None = None
    """samples a pixel of the truth; None: as many as it takes, see NOISE_TO_ERROR"""
    samples: int | None = None
    """a pixel, of real-time methods; None: the file's"""
    method_spp: int = 64
    """samples a pixel of path-traced methods, and the most with which traced is followed to the truth"""
    size: tuple[int, int] | None = None
    """width and height in pixels; None: the file's"""

    def conditions(self, scene: bpy.types.Scene) -> Conditions:
        percentage = scene.render.resolution_percentage / 100.0
        width, height = self.size or (max(1, int(scene.render.resolution_x * percentage)),
                                      max(1, int(scene.render.resolution_y * percentage)))
        return Conditions(width, height, self.samples or scene.verglas.samples, self.paths, self.tir)


@dataclass
class Comparison:
    """Methods by name, in the order of METHODS, and their truth."""
    subject: Subject
    options: Options
    truth: Truth
    methods: dict[str, Measured]
    kappas: dict[str, float]
    """as of blur.kappas(), by method and of the "truth"; empty where the world isn't a point sun"""
    notes: list[str]
    """whole sentences for the reader of the report"""


def compare(scene: bpy.types.Scene, options: Options, progress: Progress) -> Comparison:
    """Renders and measures. A method that can't be had is left out, with a note. Raises Fault or core.Error
    where the scene or the truth can't be rendered."""
    notes: list[str] = []
    progress.step("exporting the scene")
    subject = Subject(scene, options.conditions(scene), notes.append)
    truth = Truth(options.truth, subject)
    rendered = _render_all(subject, options, notes.append, progress)
    _sample(truth, options, rendered, notes.append, progress)

    progress.step("measuring")
    methods = {method: Measured.against(truth, made) for method, made in rendered.items()}
    notes += _notes_on_what_is_missing(methods, options)
    notes += explain(subject, truth, {method: made.picture for method, made in rendered.items()})
    notes += explain_cost(methods)
    kappas = blur.kappas(subject.core_scene, {"truth": truth.pixels, **{
        method: made.picture.pixels for method, made in rendered.items()}}, subject.mask)
    return Comparison(subject, options, truth, methods, kappas, list(dict.fromkeys(notes)))


def _render_all(subject: Subject, options: Options, note: Callable[[str], None],
                progress: Progress) -> dict[str, Rendered]:
    """By method."""
    rendered: dict[str, Rendered] = {}
    for method in (known for known in METHODS if known in options.methods):
        try:
            rendered[method] = _render(subject, method, options, progress)
        except (Fault, core.Error) as fault:
            note(f"{method} isn't in this report: {fault}")
    return rendered


def _notes_on_what_is_missing(methods: dict[str, Measured], options: Options) -> list[str]:
    notes = [f"There is no method '{name}'; there are {', '.join(METHODS)}."
             for name in options.methods if name not in METHODS]
    for metric, sentence in _MISSING.items():
        if methods and all(measured.metrics[metric] is None for measured in methods.values()):
            notes.append(sentence)
    if TRACED in methods and options.paths != 'full' and options.tir:
        notes.append("traced can't follow totally reflected light where it counts two interfaces: its error "
                     "holds what the truth has of it.")
    if "tir_bounce" in methods and options.paths != 'full':
        notes.append("tir_bounce follows light that is reflected inside in part, too: its error holds what "
                     "the truth doesn't have of it.")
    if options.paths != 'full':
        notes += [f"{method} can't leave paths out: its error holds all the light that the truth, of "
                  f"{options.paths} paths, doesn't have."
                  for method in ("cycles", "cycles_denoised", "eevee") if method in methods]
    return notes


_MISSING = {
    "ssim": "SSIM isn't measured: it needs scikit-image (on Debian: python3-skimage) and 11 x 11 pixels.",
    "flip": "FLIP isn't measured: it needs the Python module flip_evaluator (from PyPI: flip-evaluator).",
}
"""Notes on metrics that can't be had."""


def _render(subject: Subject, method: str, options: Options, progress: Progress) -> Rendered:
    if method in PATH_TRACED:
        way = (_render_reference(subject, options.method_spp, progress) if method == "reference" else
               _render_cycles(subject, method, options.method_spp, progress))
        return Rendered(way[-1], way, _noise(subject, method, way[-1], progress))
    if method == TRACED:
        way = _render_traced(subject, options.method_spp, progress)
        return Rendered(next(made for made in way if made.samples == subject.conditions.samples), way)
    progress.step(f"rendering {method}")
    return Rendered(subject.eevee() if method == "eevee" else subject.real_time(method), [])


def _render_traced(subject: Subject, most: int, progress: Progress) -> list[Picture]:
    """With 1, 2, 4, … samples and those of the conditions, each begun anew; the times of the first and of the
    latter are told, so they are medians."""
    pictures = []
    for samples in sorted({*_doubling(most, 2), subject.conditions.samples}):
        progress.step(f"rendering traced, {samples} samples")
        repeats = 5 if samples in (1, subject.conditions.samples) else 1
        pictures.append(subject.real_time(TRACED, repeats, samples=samples))
    return pictures


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


def _render_cycles(subject: Subject, method: str, samples: int, progress: Progress) -> list[Picture]:
    """With 1, 4, 16, … samples, each begun anew, after one that warms Cycles up."""
    denoised = method == "cycles_denoised"
    progress.step(f"rendering {method}, to warm up")
    subject.cycles(1, METHOD_SEEDS[0], denoised)
    pictures = []
    for reached in _doubling(samples, 4):
        progress.step(f"rendering {method}, {reached} samples")
        pictures.append(subject.cycles(reached, METHOD_SEEDS[0], denoised))
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
        other = subject.cycles(picture.samples, METHOD_SEEDS[1], denoised=method == "cycles_denoised")
    return metrics.relmse(picture.pixels, other.pixels, subject.mask)


def _sample(truth: Truth, options: Options, rendered: dict[str, Rendered], note: Callable[[str], None],
            progress: Progress) -> None:
    """Gives the truth its samples, and a note where they leave too much noise for real-time methods: of
    traced, whose further samples come as close to the truth as one likes, for the first."""
    def add(samples: int) -> None:
        progress.step(f"rendering the truth by {truth.method}, {truth.samples + samples} samples")
        truth.add(samples, progress.part)

    judged = [made.way[0] if method == TRACED else made.picture for method, made in rendered.items()
              if method in REAL_TIME] or [made.picture for made in rendered.values()]

    def allowed() -> float:
        errors = [metrics.relmse(p.pixels, truth.pixels, truth.mask) for p in judged]
        return NOISE_TO_ERROR * min(errors, default=0.0)

    add(options.spp + options.spp % 2 if options.spp else FIRST_SAMPLES)
    while options.spp is None and judged and truth.noise >= allowed() and truth.samples < MAX_SAMPLES:
        needed = truth.samples * truth.noise / max(allowed(), 1e-12)  # noise falls as 1 / samples
        progress.say(f"the truth's noise is {truth.noise:.2g}, {allowed():.2g} is wanted: "
                     f"about {min(needed, MAX_SAMPLES):,.0f} samples")
        add(truth.samples)
    if judged and truth.noise >= allowed():
        note(f"The truth is noisy: with {truth.samples} samples its noise is {truth.noise:.2g} (relative "
             f"MSE), not below {allowed():.2g}, a tenth of the smallest error measured against it.")
