# SPDX-License-Identifier: GPL-3.0-or-later
"""What the figures of one run share: the scenes' pictures and truths."""

from dataclasses import dataclass

import numpy as np
from verglas import renderer
from verglas.compare import methods, metrics
from verglas.compare.progress import Progress
from verglas.compare.truth import Truth

from .figure import Row
from .models import Model, new_scene


@dataclass(frozen=True)
class Case:
    """What a picture shows."""
    model: Model
    exponent: float
    """of Blinn-Phong"""
    tir: bool
    """whether the truth follows totally reflected light inside the glass"""
    paths: str = 'two_interface'
    """as methods.Conditions.paths; tir doesn't matter to 'full'"""
    rough_exponent: float | None = None
    """of parts of the surface, as models.new_scene has them; None where it is the same all over"""

    @property
    def numbers(self) -> Row:
        """What a row of numbers about it begins with."""
        rough = {} if self.rough_exponent is None else {"rough_exponent": self.rough_exponent}
        return {"model": self.model.title, "environment": self.model.world.name, "exponent": self.exponent,
                **rough, "paths": self.paths, "truth_with_tir": self.tir}


class Studio:
    """Renders each case once for all figures that show it. size: of the square pictures in pixels; quick
    makes few samples, only to see that all works."""

    def __init__(self, size: int, quick: bool, progress: Progress):
        self.size = size
        self.quick = quick
        self.progress = progress
        self.truth_samples = 4 if quick else 1024
        self.samples = 1 if quick else 16
        """of the real-time methods' pictures"""
        self._subjects: dict[Case, methods.Subject] = {}
        self._truths: dict[Case, Truth] = {}
        self._warnings: set[str] = set()

    def of_size(self, size: int) -> "Studio":
        """Another one, for pictures of another size."""
        return Studio(size, self.quick, self.progress)

    @property
    def device(self) -> str:
        """What renders by OpenGL, by its driver's name."""
        return renderer.opengl_name() or "no OpenGL"

    def subject(self, case: Case) -> methods.Subject:
        if case not in self._subjects:
            conditions = methods.Conditions(self.size, self.size, self.samples, case.paths, case.tir)
            scene = new_scene(case.model, case.exponent, case.rough_exponent)
            self._subjects[case] = methods.Subject(scene, conditions, self.warn)
        return self._subjects[case]

    def truth(self, case: Case) -> Truth:
        if case not in self._truths:
            light = ("all light" if case.paths == 'full' else
                     f"{'with' if case.tir else 'without'} total internal reflection")
            self.progress.step(f"path tracing the {case.model.title}, {light}")
            self._truths[case] = Truth("reference", self.subject(case))
            self._truths[case].add(self.truth_samples, self.progress.part)
        return self._truths[case]

    def picture(self, case: Case, method: str, **overrides) -> np.ndarray:
        """(H, W, 3) by a real-time method; overrides as in methods.Subject.real_time."""
        return self.subject(case).real_time(method, repeats=1, **overrides).pixels

    def errors(self, case: Case, method: str, pixels: np.ndarray) -> Row:
        """How far a method's picture is from the case's truth, and how noisy that is."""
        truth, mask = self.truth(case), self.subject(case).mask
        return {**case.numbers, "method": method, **metrics.measure(pixels, truth.pixels, mask),
                "relmse_net": metrics.relmse_net(pixels, truth.halves, mask),
                "truth_noise": truth.noise, "truth_samples": truth.samples}

    def warn(self, sentence: str) -> None:
        """Says it once."""
        if sentence not in self._warnings:
            self._warnings.add(sentence)
            self.progress.say(sentence)
