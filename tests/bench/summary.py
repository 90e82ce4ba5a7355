# SPDX-License-Identifier: GPL-3.0-or-later
"""The measurements in short: ratios, which compare from machine to machine, and a table to print."""

import math
from collections.abc import Iterator

from .frames import METHODS, Row

TRUTH_SAMPLES = 512
"""of a path-traced picture, as in the paper"""


def ratios(results: dict[str, list[Row]]) -> dict[str, float]:
    """By a name that reads 'this / that'. Of frames: the geometric mean over the models. Cycles' time is that
    of its samples alone, found with fewer of them: each takes the same."""
    models, engines, threads = (results[kind] for kind in ("models", "engines", "threads"))
    result = {}
    for size in _sizes(models):
        for method in METHODS:
            if method != "bundle":
                name = f"{method} / bundle, frames of {size[0]} x {size[1]}"
                result[name] = _geometric_mean(
                    _frame_ms(models, model, size, method) / _frame_ms(models, model, size, "bundle")
                    for model in _titles(models))
    sample_ms = {row["engine"]: row["sample_ms"] for row in engines}
    picture_ms = {row["engine"]: row["picture_ms"] for row in engines if "picture_ms" in row}
    result["reference / bundle, one sample"] = sample_ms["reference"] / sample_ms["bundle"]
    if "cycles" in sample_ms:
        result["reference / cycles, one sample"] = sample_ms["reference"] / sample_ms["cycles"]
        for method in ("bundle", "traced"):
            result[f"cycles with {TRUTH_SAMPLES} samples / {method} with one"] = (
                TRUTH_SAMPLES * sample_ms["cycles"] / sample_ms[method])
    refraction_ms = {row["engine"]: row["sample_ms"] for row in results["refraction"]}
    if "cycles" in refraction_ms:
        result[f"cycles with {TRUTH_SAMPLES} samples / traced with one, refraction only"] = (
            TRUTH_SAMPLES * refraction_ms["cycles"] / refraction_ms["traced"])
    if "eevee" in picture_ms:
        result["eevee's picture / bundle with one sample"] = picture_ms["eevee"] / sample_ms["bundle"]
    for row in threads[1:]:
        name = f"traced, 1 thread / {row['threads']} threads"
        result[name] = threads[0]["frame_ms"] / row["frame_ms"]
    uniform, *varying = results["roughness"]
    for row in varying:
        result[f"{row['roughness']} / uniform roughness"] = row["frame_ms"] / uniform["frame_ms"]
    coated = results["coatings"]
    glossy = {(row["base"], row["method"]): row["frame_ms"] for row in coated if row["bounces"] == 0}
    for row in coated:
        if row["bounces"] > 0:
            name = f"coating, {row['base']}, {row['bounces']} bounces / glossy layer, {row['method']}"
            result[name] = row["frame_ms"] / glossy[row["base"], row["method"]]
    for row in results["bounces"]:
        for kind in ("samples", "noise"):
            light = "the last bounce of" if row["light"] == "one" else "all of"
            name = f"recursive / ENDF at equal {kind}, {light} {row['bounces']}"
            result[name] = row[f"speedup_at_equal_{kind}"]
    for method in dict.fromkeys(row["method"] for row in results["lobes"]):
        table, analytic = (row["frame_ms"] for row in results["lobes"] if row["method"] == method)
        result[f"analytic / table lobes, {method}"] = analytic / table
    return result


def text(results: dict) -> str:
    """Lines for a terminal."""
    return "\n".join([*_machine(results["machine"]), "", *_models(results["models"]), "",
                      *_column("milliseconds before the first frame",
                               {row["step"]: row["ms"] for row in results["preparation"]}), "",
                      *_column("milliseconds of one sample of the monkey",
                               {row["engine"]: row["sample_ms"] for row in results["engines"]}), "",
                      *_updates(results["updates"]), "",
                      *_navigation(results["navigation"]), *_column("ratios", results["ratios"]),
                      *results["notes"]])


def _machine(machine: dict) -> Iterator[str]:
    yield f"{machine['cpu']}, {machine['cores']} cores; OpenGL: {machine['opengl']}"
    yield f"Blender {machine['blender']}; Verglas {machine['verglas']}, commit {machine['commit']}"


def _models(rows: list[Row]) -> Iterator[str]:
    yield f"{'milliseconds of a frame':32}" + "".join(f"{method:>10}" for method in METHODS)
    for size in _sizes(rows):
        for model in _titles(rows):
            times = (_frame_ms(rows, model, size, method) for method in METHODS)
            yield f"{f'{model}, {size[0]} x {size[1]}':32}" + "".join(f"{time:10.1f}" for time in times)


def _updates(rows: list[Row]) -> Iterator[str]:
    yield from _column(f"milliseconds until a device has {rows[0]['triangles']:,} triangles",
                       {f"{row['update']}, {row['method']}": row["ms"] for row in rows})


def _navigation(rows: list[Row]) -> Iterator[str]:
    """Nothing where it couldn't be measured."""
    if not rows:
        return
    size = "{width} x {height}".format(**rows[0])
    yield from _column(f"a viewport of {size}: new pictures a second while the view turns",
                       {row["method"]: row["pictures_per_s"] for row in rows})
    yield from _column("  milliseconds from a changed roughness to its picture",
                       {row["method"]: row["change_ms"] for row in rows})
    yield from _column("  milliseconds from drawing to drawing while the view turns",
                       {row["method"]: row["redraw_ms"] for row in rows})
    yield ""


def _column(title: str, values: dict[str, float]) -> Iterator[str]:
    yield title
    for name, value in values.items():
        yield f"  {name:52}{value:10.4g}"


def _sizes(rows: list[Row]) -> list[tuple[int, int]]:
    return list(dict.fromkeys((row["width"], row["height"]) for row in rows))


def _titles(models: list[Row]) -> list[str]:
    return list(dict.fromkeys(row["model"] for row in models))


def _frame_ms(models: list[Row], model: str, size: tuple[int, int], method: str) -> float:
    wanted = (model, *size, method)
    return next(row["frame_ms"] for row in models
                if (row["model"], row["width"], row["height"], row["method"]) == wanted)


def _geometric_mean(values: Iterator[float]) -> float:
    logarithms = [math.log(value) for value in values]
    return math.exp(sum(logarithms) / len(logarithms))
