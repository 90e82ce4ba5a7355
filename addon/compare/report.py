# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the report of one comparison: pictures, plots, report.json and index.html in one folder."""

import json
import platform
from html import escape
from pathlib import Path

import bpy
import numpy as np

from .. import bl_info, renderer
from ..faults import Fault
from . import images, metrics, pages, plots
from .cases import Case
from .comparison import Comparison
from .measured import Measured
from .methods import PATH_TRACED, REAL_TIME

COLUMNS = {
    "relmse": "Relative MSE", "relmse_net": "Net", "rmse": "RMSE", "psnr": "PSNR (dB)", "ssim": "SSIM",
    "flip": "FLIP", "bias": "Bias",
}
"""Metrics in the order and by the name of the report's table."""

HIGHER_IS_BETTER = {"psnr", "ssim"}


def write(comparison: Comparison, case: Case, command: str, folder: Path, overview: str = "") -> dict:
    """Returns what report.json holds. command: the line that makes this report again. overview: path of the
    page, relative to this one, that the report belongs to. Raises Fault where the folder can't be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        notes = [*comparison.notes, *_write_pictures(comparison, folder)]
        report = _report(comparison, case, command, notes)
        (folder / "report.json").write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
        (folder / "index.html").write_text(_page(report, comparison, folder, overview), encoding="utf-8")
    except OSError as error:
        raise Fault(f"The report in '{folder}' can't be written: {error.strerror}.") from error
    return report


def _write_pictures(comparison: Comparison, folder: Path) -> list[str]:
    """Returns notes on what could not be drawn."""
    truth, mask = comparison.truth.pixels, comparison.subject.mask
    pictures = {method: measured.picture.pixels for method, measured in comparison.methods.items()}
    for name, pixels in {"truth": truth, **pictures}.items():
        images.write_exr(folder / f"{name}.exr", pixels)
        images.write_png(folder / f"{name}.png", metrics.display(pixels))
    try:
        differences = {name: plots.relative_difference(pixels, truth) for name, pixels in pictures.items()}
        errors = {name: plots.relative_error(pixels, truth) for name, pixels in pictures.items()}
        difference_scale, error_scale = _scale(differences, mask), _scale(errors, mask)
        for name in pictures:
            plots.draw_differences(
                folder / f"{name}_difference.png", differences[name], mask, difference_scale)
            plots.draw_errors(folder / f"{name}_error.png", errors[name], mask, error_scale)
        plots.draw_scan_line(folder / "scan_line.svg", comparison)
        plots.draw_error_over_cost(folder / "error_over_cost.svg", comparison)
    except Fault as fault:
        return [str(fault)]
    return []


def _scale(values: dict[str, np.ndarray], mask: np.ndarray) -> float:
    """For all methods alike: that of the real-time ones, as noise and missing light would drown them."""
    return plots.scale([v for name, v in values.items() if name in REAL_TIME] or list(values.values()), mask)


def _report(comparison: Comparison, case: Case, command: str, notes: list[str]) -> dict:
    subject, truth, options = comparison.subject, comparison.truth, comparison.options
    conditions = subject.conditions
    return {
        "scene": case.name,
        "file": case.file,
        "roughness": case.roughness,
        "map": case.map,
        "size": [conditions.width, conditions.height],
        "object_pixels": int(subject.mask.sum()),
        "triangles": subject.triangles,
        "truth": {
            "method": truth.method, "spp": truth.samples, "seconds": truth.seconds, "noise": truth.noise,
            "paths": options.paths, "tir": options.tir if options.paths == 'two_interface' else None,
            **_kappa(comparison, "truth"),
        },
        "methods": {name: _entry(measured) | _kappa(comparison, name)
                    for name, measured in comparison.methods.items()},
        "notes": notes,
        "command": command,
        "version": ".".join(map(str, bl_info["version"])),
        "blender": bpy.app.version_string,
        "device": {"opengl": renderer.opengl_name(), "cpu": _cpu(), "threads": subject.scene.render.threads},
    }


def _entry(measured: Measured) -> dict:
    picture = measured.picture
    entry = {"seconds": picture.seconds, **measured.metrics, "samples": picture.samples}
    if picture.pass_seconds:
        entry["pass_seconds"] = picture.pass_seconds
    if measured.noise is not None:
        entry["noise"] = measured.noise
    if measured.convergence:
        entry["convergence"] = measured.convergence
    return entry


def _kappa(comparison: Comparison, name: str) -> dict[str, float]:
    """Of the blur, where it is measured."""
    return {"kappa": comparison.kappas[name]} if name in comparison.kappas else {}


def _cpu() -> str:
    """The processor's name."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())


def _page(report: dict, comparison: Comparison, folder: Path, overview: str) -> str:
    methods = report["methods"]
    width = report["size"][0]
    shown = {f"{name}.png": name for name in ("truth", *methods)}
    first = next(iter(methods), "truth")
    back = f' · <a href="{escape(overview)}">all cases</a>' if overview else ""
    device = report["device"]
    return pages.page("report.html", {
        "title": escape(report["scene"]),
        "back": back,
        "facts": pages.facts(_facts(report)),
        "left_choices": pages.options(shown, f"{first}.png"),
        "right_choices": pages.options(shown, "truth.png"),
        "zooms": pages.options({str(zoom): f"{zoom} x" for zoom in (1, 2, 3, 4, 6, 8)}, _zoom(width)),
        "width": str(width),
        "numbers": _numbers(methods),
        "blur": _blur(report["truth"], methods),
        "plots": "".join(
            pages.section(title, f'<img class="plot" src="{file}" alt="{escape(title)}">')
            for file, title in (("error_over_cost.svg", "Error over cost"),
                                ("scan_line.svg", "Scan line through the object's middle"))
            if (folder / file).is_file()),
        "pictures": "".join(_row_of_pictures(name, methods, folder) for name in ("truth", *methods)),
        "passes": _passes(methods),
        "notes": pages.items(report["notes"], "Nothing to note."),
        "command": escape(report["command"]),
        "versions": escape(f"Verglas {report['version']}, Blender {report['blender']}; OpenGL: "
                           f"{device['opengl'] or 'none'}; CPU: {device['cpu']}, "
                           f"{device['threads']} threads."),
    })


def _facts(report: dict) -> dict[str, str]:
    truth = report["truth"]
    paths = {'full': "all paths", 'two_interface': "two interfaces"}[truth["paths"]]
    if truth["tir"] is not None:
        paths += ", with total internal reflection" if truth["tir"] else ", totally reflected light is lost"
    return {
        "File": report["file"],
        **({"Roughness": f"{report['roughness']:g}"} if report["roughness"] is not None else {}),
        **({"Map": report["map"]} if report["map"] is not None else {}),
        "Size": "{} x {} pixels".format(*report["size"]),
        "Glass": f"{report['object_pixels']:,} pixels, {report['triangles']:,} triangles",
        "Truth": f"{truth['method']}, {truth['spp']:,} samples, {pages.seconds(truth['seconds'])}",
        "Paths": paths,
        "Its noise": f"{pages.number(truth['noise'])} (relative MSE)",
    }


def _zoom(width: int) -> str:
    """That makes the slider's pictures about 600 pixels wide."""
    return str(max(zoom for zoom in (1, 2, 3, 4, 6, 8) if zoom == 1 or zoom * width <= 720))


def _numbers(methods: dict[str, dict]) -> str:
    """The table of metrics."""
    real_time = {name: methods[name] for name in methods if name in REAL_TIME}
    largest = max((entry["relmse"] for entry in methods.values()), default=0.0)
    best = {key: best_of(key, real_time) for key in ("seconds", *COLUMNS)}

    def row(name: str, entry: dict) -> list[str]:
        cells = [pages.head(name), pages.cell(pages.seconds(entry["seconds"]), best["seconds"] == name)]
        for key in COLUMNS:
            part = entry["relmse"] / largest if key == "relmse" and largest > 0.0 else None
            cells.append(pages.cell(_text(key, entry[key]), best[key] == name, part))
        noise = pages.number(entry["noise"]) if name in PATH_TRACED else ""
        return [*cells, pages.cell(str(entry["samples"])), pages.cell(noise)]

    heads = ["", "Seconds", *COLUMNS.values(), "Samples", "Own noise"]
    return pages.table(heads, (row(name, entry) for name, entry in methods.items()))


def _blur(truth: dict, methods: dict[str, dict]) -> str:
    """A table of the blur, where it is measured."""
    if "kappa" not in truth:
        return ""
    found = {"truth": truth["kappa"],
             **{name: entry["kappa"] for name, entry in methods.items() if "kappa" in entry}}
    rows = ([pages.head(name), pages.cell(pages.number(kappa, 4)),
             pages.cell("" if name == "truth" else f"{kappa / truth['kappa'] - 1.0:+.1%}")]
            for name, kappa in found.items())
    hint = ("Concentration (kappa) of the lobe through which glass shows the sun, the world's only light: "
            "the lower, the wider. It is exact for glass with parallel sides.")
    return pages.section("Blur", pages.table(["", "Kappa", "To the truth's"], rows)
                         + f'\n<p class="hint">{hint}</p>')


def _text(key: str, value: float | None) -> str:
    return f"{value:+.1%}" if key == "bias" and value is not None else pages.number(value)


def best_of(key: str, methods: dict[str, dict]) -> str | None:
    """The name of the method that is best by a key of its entry; None where fewer than two have it."""
    values = {name: entry[key] for name, entry in methods.items() if entry[key] is not None}
    if len(values) < 2:
        return None
    if key in HIGHER_IS_BETTER:
        return max(values, key=values.get)
    return min(values, key=lambda name: abs(values[name]) if key == "bias" else values[name])


def _row_of_pictures(name: str, methods: dict[str, dict], folder: Path) -> str:
    about = ""
    if name in methods:
        entry = methods[name]
        about = f"relative MSE {pages.number(entry['relmse'])}, {pages.seconds(entry['seconds'])}"
    files = {f"{name}.png": "Picture", f"{name}_difference.png": "Signed difference",
             f"{name}_error.png": "Absolute difference"}
    pictures = "".join(pages.figure(file, kind) for file, kind in files.items() if (folder / file).is_file())
    return f'<h3>{name}<small>{about} <a href="{name}.exr">EXR</a></small></h3>{pictures}\n'


def _passes(methods: dict[str, dict]) -> str:
    """A table of milliseconds by pass, where there are real-time methods."""
    timed = {name: entry["pass_seconds"] for name, entry in methods.items() if "pass_seconds" in entry}
    if not timed:
        return ""
    names = dict.fromkeys(name for passes in timed.values() for name in passes)

    def row(method: str, passes: dict[str, float]) -> list[str]:
        return [pages.head(method),
                *(pages.cell(pages.number(1000.0 * passes.get(name, 0.0))) for name in names)]

    return pages.section("Milliseconds by pass", pages.table(
        ["", *(name.replace("_", " ") for name in names)], (row(*item) for item in timed.items())))
