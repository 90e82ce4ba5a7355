# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the error of the OpenGL device's default method, bundle, comes from: its pixels are told apart by
what rays meet in them, and each kind stands for one assumption of the method that doesn't hold there. And
what path tracers need to be as exact as it, or as the CPU device."""

from collections.abc import Sequence

import numpy as np

from .. import verglas_core as core
from .measured import Measured
from .methods import SCREEN_SPACE, TRACED, Picture, Subject
from .metrics import RELATIVE_FLOOR, relmse
from .truth import Truth

JUDGED = "bundle"

GRAZING_COSINE = 0.35
"""Of the angle between surface and view, 70 degrees from the normal."""

WORTH_TELLING = 0.1
"""Kinds with a smaller share of the error aren't listed."""

KINDS = {
    "outline": "on the outline, where pixels mix the glass with the world beside it",
    "open": "where the refracted ray meets a front before any back, or nothing, as the mesh intersects "
            "itself or isn't closed (the method takes all between front and back for glass)",
    "hidden": "where the refracted ray leaves through a back between others on the line of sight, or outside "
              "of the picture (the method knows the nearest and the farthest back of a pixel)",
    "again": "where the refracted ray meets glass again after leaving (the method ends there)",
    "total": "where the refracted ray meets the back beyond the critical angle (the method follows "
             "inner reflections in mode bounce alone, and three of them)",
    "divided": "where some of the four rays around the refracted one have no exit that lets light out or "
               "that the camera sees (the method has four rays for the whole lobe)",
    "grazing": "seen at more than 70 degrees from the normal, where the horizon cuts the refracted lobe off "
               "(the method's are whole)",
    "plain": "where the rays meet nothing that breaks an assumption",
}
"""Kinds of pixels, each without those before it, as the end of a phrase 'the pixels …'."""


def explain(subject: Subject, truth: Truth, pictures: dict[str, Picture]) -> list[str]:
    """Sentences on where bundle's error lies, and where it loses against the best other method in screen
    space if it does; none without bundle, or where it has no error."""
    if JUDGED not in pictures:
        return []
    errors = {name: _squared_errors(pictures[name].pixels, truth.pixels, subject.mask)
              for name in SCREEN_SPACE if name in pictures}
    total = errors[JUDGED].mean()
    if total == 0.0:
        return []
    kinds = kinds_of_pixels(subject)
    sentences = [f"Of bundle's relative MSE of {total:.3g}, "
                 f"{_shares(errors[JUDGED], kinds, lambda part: f'{part / total:.0%} lies in')}."]
    others = {name: values.mean() for name, values in errors.items() if name != JUDGED}
    best = min(others, key=others.get, default=None)
    if best is not None and others[best] < total:
        excess = errors[JUDGED] - errors[best]
        sentences.append(f"bundle's relative MSE is {excess.mean():.2g} above that of {best}: "
                         f"{_shares(excess, kinds, lambda part: f'{part:+.2g} comes from')}. Half of what it "
                         f"loses, it loses in {_pixels_of_half(excess):,} of {len(excess):,} pixels.")
        sentences += _explain_search(subject, truth, total)
    return sentences


def _pixels_of_half(values: np.ndarray) -> int:
    """The least number of values that add up to half of the sum of all positive ones."""
    largest_first = np.sort(np.maximum(values, 0.0))[::-1].cumsum()
    return int(np.searchsorted(largest_first, 0.5 * largest_first[-1])) + 1


def _explain_search(subject: Subject, truth: Truth, total: float) -> list[str]:
    """What is due to the search for the exits, where it isn't the slow march through the depth map."""
    if subject.scene.verglas.intersection == 'MARCH':
        return []
    marched = subject.real_time(JUDGED, repeats=1, intersection='MARCH')
    error = relmse(marched.pixels, truth.pixels, subject.mask)
    return [f"bundle's relative MSE is {error:.3g} with the march in place of Newton's steps to the exits: "
            f"{max(total - error, 0.0) / total:.0%} of its error comes from exits that these miss."]


Way = Sequence[dict[str, float]]
"""As Measured.convergence."""


def explain_cost(methods: dict[str, Measured]) -> list[str]:
    """When path tracers are as exact as bundle, and as traced with one sample; and how exact they are when
    traced has taken as long as they."""
    ways = {name: measured.convergence for name, measured in methods.items()
            if measured.convergence and name != TRACED}
    sentences = []
    if JUDGED in methods:
        picture, error = methods[JUDGED].picture, methods[JUDGED].metrics["relmse"]
        sentences += [f"bundle takes {picture.seconds:.2g} s; {name} {_when(way, error, picture.seconds)}"
                      for name, way in ways.items()]
    if TRACED in methods:
        traced = methods[TRACED].convergence
        seconds, error = traced[0]["seconds"], traced[0]["relmse"]
        sentences += [f"traced takes {seconds:.2g} s with one sample; {name} {_when(way, error, seconds)}"
                      for name, way in ways.items()]
        sentences += [sentence for name, way in ways.items()
                      for sentence in _at_equal_times(traced, name, way)]
    return sentences


def _when(way: Way, error: float, seconds: float) -> str:
    """The end of a sentence: when a path tracer is as close to the truth as a picture that takes these
    seconds."""
    last = way[-1]
    if last["relmse"] > error:
        return (f"isn't as close to the truth with {last['samples']:,} samples, after "
                f"{last['seconds']:.2g} s, {last['seconds'] / seconds:,.3g} times the time.")
    samples, reached = (_interpolated(way, "relmse", error, wanted) for wanted in ("samples", "seconds"))
    return (f"is as close to the truth with {samples:,.0f} samples, after {reached:.2g} s, "
            f"{reached / seconds:,.3g} times the time.")


def _at_equal_times(traced: Way, name: str, way: Way) -> list[str]:
    """A sentence on the errors of a path tracer and traced wherever both have a picture."""
    times = [point["seconds"] for point in (*traced, *way)]
    first = max(traced[0]["seconds"], way[0]["seconds"])
    last = min(traced[-1]["seconds"], way[-1]["seconds"])
    shared = sorted({first, last, *(time for time in times if first <= time <= last)})
    if first >= last:
        return []
    theirs, ours = ([_interpolated(points, "seconds", time, "relmse") for time in shared]
                    for points in (way, traced))
    ratios = [a / b for a, b in zip(theirs, ours)]
    return [f"In equal times from {first:.2g} to {last:.2g} s the relative MSE of {name} is "
            f"{min(ratios):.2g} to {max(ratios):.2g} times that of traced."]


def _interpolated(way: Way, key: str, value: float, wanted: str) -> float:
    """What a way has of one key where another, which rises or falls along it, has this value: a power law
    from point to point, as the noise of Monte Carlo has; its ends outside."""
    points = sorted((point[key], point[wanted]) for point in way)
    x, y = np.log(np.maximum(np.array(points), 1e-30)).T
    return float(np.exp(np.interp(np.log(max(value, 1e-30)), x, y)))


def _shares(values: np.ndarray, kinds: np.ndarray, phrase) -> str:
    """A phrase for every kind with much of the values' mean, largest first. values: (N,); kinds: (N,) index
    into KINDS; phrase: makes the beginning from the kind's part of the mean."""
    parts = {i: values[kinds == i].sum() / len(values) for i in range(len(KINDS))}
    told = [i for i in sorted(parts, key=lambda i: -abs(parts[i]))
            if abs(parts[i]) >= WORTH_TELLING * abs(values.mean())]
    texts = list(KINDS.values())
    return "; ".join(f"{phrase(parts[i])} the {np.mean(kinds == i):.1%} of pixels {texts[i]}" for i in told)


def _squared_errors(a: np.ndarray, b: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """(N,) of the mask's pixels; their mean is metrics.relmse."""
    a, b = a[mask].astype(np.float64), b[mask].astype(np.float64)
    return np.mean((a - b) ** 2 / (b ** 2 + RELATIVE_FLOOR), axis=-1)


def kinds_of_pixels(subject: Subject) -> np.ndarray:
    """(N,) index into KINDS of each of the mask's pixels, in the order of mask.nonzero()."""
    rays = _Rays(subject)
    direction, cosine, spread = rays.front_lobe()
    axis = rays.exits(direction)
    around = [rays.exits(ray) for ray in _four_rays(direction, spread)]
    found = {
        "outline": _outline(subject.mask)[subject.mask],
        "open": ~axis["found"],
        "hidden": axis["hidden"],
        "again": axis["again"] & (subject.conditions.paths == 'full'),
        "total": axis["total"],
        "divided": np.any([~ray["found"] | ray["hidden"] | ray["total"] for ray in around], axis=0),
        "grazing": cosine < GRAZING_COSINE,
        "plain": np.ones(len(cosine), bool),
    }
    return np.argmax([found[name] for name in KINDS], axis=0)


def _outline(mask: np.ndarray) -> np.ndarray:
    """(H, W) bool: pixels with a neighbour outside the mask."""
    inside = np.pad(mask, 1)
    neighbours = [inside[1 + y:1 + y + mask.shape[0], 1 + x:1 + x + mask.shape[1]]
                  for y in (-1, 0, 1) for x in (-1, 0, 1)]
    return mask & ~np.all(neighbours, axis=0)


class _Rays:
    """The rays through the centres of the mask's N pixels, and what becomes of them. Vectors are (N, 3)."""

    def __init__(self, subject: Subject):
        scene = subject.core_scene
        self._surfaces = core.RayScene(scene)
        self._clip_from_world = np.float64(scene.camera.projection) @ np.float64(scene.camera.view)
        rows, columns = subject.mask.nonzero()
        height, width = subject.mask.shape
        ndc = np.stack([2.0 * (columns + 0.5) / width - 1.0, 2.0 * (rows + 0.5) / height - 1.0], axis=-1)
        near, far = self._world(ndc, -1.0), self._world(ndc, 1.0)
        self._view = _unit(far - near)
        front = self._surfaces.intersect(near, self._view)
        self._point = near + np.nan_to_num(front["t"], posinf=0.0)[:, None] * self._view
        self._object = front["object"]
        self._normal = _facing(front["normal"], self._view)
        materials = scene.materials
        self._ior = np.array([materials[i].ior for i in front["material"]])
        self._alpha = np.array([materials[i].roughness ** 2 for i in front["material"]])
        self._step = 1e-4 * max(float(np.ptp(self._point, axis=0).max()), 1e-6)

    def _world(self, ndc: np.ndarray, depth: float) -> np.ndarray:
        clip = np.concatenate([ndc, np.full((len(ndc), 1), depth), np.ones((len(ndc), 1))], axis=-1)
        world = clip @ np.linalg.inv(self._clip_from_world).T
        return world[:, :3] / world[:, 3:]

    def front_lobe(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction of the view refracted by Snell's law, (N,) cosine of view and normal, and (N,) cosine of
        the root-mean angle of the rough lobe around it: R = A3(kappa), kappa = J kappa_m with the Jacobian
        of refraction (method.md 1 and 9) at the mean normal."""
        cosine = -_dot(self._view, self._normal)
        direction, _ = _refract(self._view, self._normal, self._ior)
        inside = -_dot(direction, self._normal)
        jacobian = self._ior ** 2 * inside / np.maximum((cosine - self._ior * inside) ** 2, 1e-6)
        kappa = np.clip(jacobian * 2.0 / np.maximum(self._alpha, 1e-4) ** 2, 1e-3, 1e12)
        return direction, cosine, 1.0 / np.tanh(kappa) - 1.0 / kappa

    def exits(self, direction: np.ndarray) -> dict[str, np.ndarray]:
        """What becomes of rays inside, each (N,) bool: 'found' a back; 'hidden' to the camera; 'total'ly
        reflected; meets the scene 'again' after leaving. The last three are False where none is found."""
        inside = self._surfaces.intersect(self._point + self._step * direction, direction)
        found = np.isfinite(inside["t"]) & (_dot(direction, inside["geometric_normal"]) > 0.0)
        point = self._point + (self._step + np.where(found, inside["t"], 0.0))[:, None] * direction
        refracted, total = _refract(direction, _facing(inside["normal"], direction), 1.0 / self._ior)
        outside = self._surfaces.intersect(point + self._step * refracted, refracted)
        return {"found": found, "hidden": found & self._is_hidden(point), "total": found & total,
                "again": found & ~total & np.isfinite(outside["t"])}

    def _is_hidden(self, point: np.ndarray) -> np.ndarray:
        """(N,) bool: whether the object has farther and nearer backs on the same line of sight, or the point
        lies outside of the picture."""
        clip = np.concatenate([point, np.ones((len(point), 1))], axis=-1) @ self._clip_from_world.T
        ndc = clip[:, :2] / clip[:, 3:]
        line = _unit(self._world(ndc, 1.0) - self._world(ndc, -1.0))
        behind = self._surfaces.intersect(point + 10.0 * self._step * line, line)
        # Toward the camera: the front of the glass that ends here, and beyond it another back if there is one
        front = self._surfaces.intersect(point - 10.0 * self._step * line, -line)
        way = 20.0 * self._step + np.where(np.isfinite(front["t"]), front["t"], 0.0)
        before = self._surfaces.intersect(point - way[:, None] * line, -line)
        is_between = (behind["object"] == self._object) & (before["object"] == self._object)
        return is_between | (np.abs(ndc) > 1.0).any(axis=-1)


def _four_rays(axis: np.ndarray, cosine: np.ndarray) -> list[np.ndarray]:
    """Directions at an angle, whose cosine is given, around the axis."""
    helper = np.where(np.abs(axis[:, 2:]) < 0.9, (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
    side = _unit(np.cross(axis, helper))
    up = np.cross(side, axis)
    sine = np.sqrt(np.maximum(1.0 - cosine ** 2, 0.0))[:, None]
    return [cosine[:, None] * axis + sine * turn * vector for vector in (side, up) for turn in (-1.0, 1.0)]


def _refract(d: np.ndarray, n: np.ndarray, eta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions behind an interface with its normal toward where d comes from, eta = n_behind / n_before,
    and whether they are totally reflected; those go on along the interface."""
    cosine = -_dot(d, n)
    sine_squared = (1.0 - cosine ** 2) / eta ** 2
    cosine_behind = np.sqrt(np.maximum(1.0 - sine_squared, 0.0))
    return _unit(d / eta[:, None] + (cosine / eta - cosine_behind)[:, None] * n), sine_squared > 1.0


def _facing(n: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Normals turned against d; of unit length even where there is none."""
    length = np.linalg.norm(n, axis=-1, keepdims=True)
    return np.where(length > 0.0, np.where(_dot(n, d)[:, None] > 0.0, -n, n), -d)


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.einsum("ij,ij->i", a, b)


def _unit(a: np.ndarray) -> np.ndarray:
    return a / np.maximum(np.linalg.norm(a, axis=-1, keepdims=True), 1e-12)
