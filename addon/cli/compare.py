# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares methods of rendering on .blend files, and writes a report.

    blender --background --python addon/cli/compare.py -- FILE.blend ... [OPTION ...]

See --help for the options. Progress goes to the standard output; what Blender itself says goes to blender.log
in the report's folder.
"""

import argparse
import shlex
import sys
from pathlib import Path

import addon_utils
import bpy

if addon_utils.enable("verglas") is None:
    sys.exit("verglas: the add-on isn't installed in this Blender, or can't be enabled.")

from verglas.compare import cases, runner  # noqa: E402
from verglas.compare.comparison import Options  # noqa: E402
from verglas.compare.methods import METHODS  # noqa: E402
from verglas.compare.progress import Progress, silence_blender  # noqa: E402


def names(text):
    return tuple(dict.fromkeys(name.strip() for name in text.split(",") if name.strip()))


def numbers(text):
    return [roughness(part) for part in text.split(",")]


def roughness(text):
    value = float(text)
    if not 0.0 <= value <= 1.0:
        raise argparse.ArgumentTypeError(f"{text} isn't a roughness from 0 to 1")
    return value


def count(text):
    value = int(text)
    if not 1 <= value <= 1 << 24:
        raise argparse.ArgumentTypeError(f"{text} isn't a number of samples")
    return value


def count_or_auto(text):
    return None if text == "auto" else count(text)


def size(text):
    width, _, height = text.partition("x")
    if not all(side.isdecimal() and 1 <= int(side) <= 16384 for side in (width, height)):
        raise argparse.ArgumentTypeError(f"{text} isn't a size such as 512x512")
    return int(width), int(height)


def argument_parser():
    defaults = Options()
    result = argparse.ArgumentParser(prog="verglas compare", allow_abbrev=False)
    result.add_argument("files", metavar="FILE.blend", nargs="+")
    result.add_argument("--methods", type=names, default=defaults.methods, metavar="LIST",
                        help=f"of {','.join(METHODS)}; default: {','.join(defaults.methods)}")
    result.add_argument("--truth", choices=("reference", "cycles"), default=defaults.truth)
    result.add_argument("--paths", choices=("full", "two_interface"), default=defaults.paths)
    result.add_argument("--tir", action="store_true")
    result.add_argument("--spp", type=count_or_auto, default=defaults.spp, metavar="N|auto")
    result.add_argument("--samples", type=count, metavar="N")
    result.add_argument("--method-spp", type=count, default=defaults.method_spp, metavar="N")
    result.add_argument("--size", type=size, metavar="WxH")
    result.add_argument("--roughness", type=numbers, default=[], metavar="R,R,...")
    result.add_argument("--maps", type=names, default=(), metavar="FILE,...")
    result.add_argument("--out", metavar="DIR")
    result.add_argument("--launcher", default="", help="what started this, for the report")
    return result


TEXTS = {
    "methods": ",".join, "truth": str, "paths": str, "tir": None, "spp": str, "samples": str,
    "method_spp": str, "size": lambda value: "x".join(map(str, value)),
    "roughness": lambda values: ",".join(f"{value:g}" for value in values), "maps": ",".join,
}
"""How an option's value is written on the command line; None for options without one."""


def command_line(arguments, case, folder):
    """The line that makes the case's report again in the folder, or for None all reports."""
    values = vars(arguments)
    if case is not None:
        values = values | {"files": [case.file],
                           "roughness": [] if case.roughness is None else [case.roughness],
                           "maps": () if case.map is None else (case.map,)}
    default = vars(argument_parser().parse_args(["FILE"]))
    started = [bpy.app.binary_path, "--background", "--python", __file__, "--"]
    if arguments.launcher:
        started = [arguments.launcher, "compare"]
    words = [*started, *values["files"]]
    for name, text in TEXTS.items():
        if values[name] != default[name]:
            words += [f"--{name.replace('_', '-')}", *([text(values[name])] if text else [])]
    return shlex.join([*words, "--out", str(folder)])


def main():
    arguments = argument_parser().parse_args(sys.argv[sys.argv.index("--") + 1:])
    compared = cases.combinations(arguments.files, arguments.roughness, arguments.maps)
    name = Path(arguments.files[0]).stem if len(arguments.files) == 1 else "verglas"
    folder = Path(arguments.out or f"{name}_compare")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        progress = Progress(silence_blender(folder / "blender.log"))
    except OSError as error:
        sys.exit(f"verglas: '{folder}' can't be written: {error.strerror}.")
    options = Options(
        methods=arguments.methods, truth=arguments.truth, paths=arguments.paths, tir=arguments.tir,
        spp=arguments.spp, samples=arguments.samples, method_spp=arguments.method_spp, size=arguments.size)
    try:
        done = runner.run(compared, options, folder, lambda *of: command_line(arguments, *of), progress)
    finally:
        progress.close()
    sys.exit(0 if done else 1)


if __name__ == "__main__":
    main()
