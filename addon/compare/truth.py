# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture that others are measured against, made by a path tracer, with its own noise measured."""

from collections.abc import Callable

import numpy as np

from ..faults import Fault
from . import metrics
from .methods import Subject

FIRST_SAMPLES = 64
"""of the whole truth, when their number is found automatically; then they are doubled"""

MAX_SAMPLES = 65536
"""of the whole truth, when their number is found automatically"""

NOISE_TO_ERROR = 0.1
"""The noise that a truth may have, as a share of the smallest error that is measured against it."""


class _ReferenceHalf:
    """Samples of one seed of the core's path tracer."""

    def __init__(self, subject: Subject, seed: int):
        self._tracer = subject.path_tracer(seed)

    def add(self, samples: int, progress: Callable[[int, int], bool] | None) -> None:
        self._tracer.render(samples, progress)

    @property
    def pixels(self) -> np.ndarray:
        return np.ascontiguousarray(self._tracer.frame().combined[..., :3])

    @property
    def seconds(self) -> float:
        return self._tracer.frame().seconds


class _CyclesHalf:
    """A mean of Cycles' pictures, each of a seed of its own, as Cycles can't go on with a picture."""

    def __init__(self, subject: Subject, seed: int):
        self._subject = subject
        self._seed = seed
        self._sum = np.zeros((*subject.mask.shape, 3))
        self._samples = 0
        self.seconds = 0.0

    def add(self, samples: int, progress: Callable[[int, int], bool] | None) -> None:
        picture = self._subject.cycles(samples, self._seed)
        self._seed += 2  # the other half's seeds lie between
        self._sum += samples * picture.pixels.astype(np.float64)
        self._samples += samples
        self.seconds += picture.seconds

    @property
    def pixels(self) -> np.ndarray:
        return (self._sum / self._samples).astype(np.float32)


class Truth:
    """The mean of two halves of the same number of samples and different seeds: how they differ shows
    what noise their mean has."""

    def __init__(self, method: str, subject: Subject):
        """method: "reference" or "cycles". Raises Fault where it can't render the subject's conditions."""
        if method == "cycles" and subject.conditions.paths != 'full':
            raise Fault("Cycles can't be the truth of two_interface paths, as it can't leave out the others; "
                        "take the reference.")
        half = {"reference": _ReferenceHalf, "cycles": _CyclesHalf}[method]
        self.method = method
        self.samples = 0
        self.mask = subject.mask
        self._halves = half(subject, 1), half(subject, 2)
        self.halves: tuple[np.ndarray, np.ndarray] | None = None
        """(H, W, 3) float32 each, once there are samples"""

    def add(self, samples: int, progress: Callable[[int, int], bool] | None = None) -> None:
        """samples: of the whole, an even number."""
        for i, half in enumerate(self._halves):
            half.add(samples // 2, progress and (
                lambda done, total, before=i: progress(before * total + done, 2 * total)))
        self.samples += samples
        self.halves = self._halves[0].pixels, self._halves[1].pixels

    @property
    def pixels(self) -> np.ndarray:
        """(H, W, 3) float32"""
        return 0.5 * (self.halves[0] + self.halves[1])

    @property
    def seconds(self) -> float:
        return sum(half.seconds for half in self._halves)

    @property
    def noise(self) -> float:
        """The relmse to expect between this and another such truth of other seeds."""
        return metrics.noise(self.halves, self.mask)
