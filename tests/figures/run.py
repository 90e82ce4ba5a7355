# SPDX-License-Identifier: GPL-3.0-or-later
r"""Makes the papers' figures inside Blender, with the installed add-on enabled:

    blender --background --factory-startup --python-exit-code 1 --python tests/figures/run.py -- \
        [--out DIR] [--only 3,endf2,...] [--size N] [--quick]

Each is a picture with its numbers beside it, DIR/figure_03.png and .json; DIR/index.html shows all that are
in the folder. --only: these figures, 3 of the rough refraction paper, endf2 of the ENDF paper and so on.
--size: of the square pictures in pixels. --quick: few samples, to see that all works.
"""

import argparse
import shlex
import sys
from pathlib import Path

import addon_utils

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))


def parse_arguments(arguments: list[str], known: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="verglas figures")
    parser.add_argument("--out", type=Path, default=Path("verglas_figures"))
    parser.add_argument("--only", type=lambda text: text.split(","), default=known)
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--quick", action="store_true")
    chosen = parser.parse_args(arguments)
    unknown = [figure_id for figure_id in chosen.only if figure_id not in known]
    if unknown:
        parser.error(f"there is no figure {unknown[0]}; there are {', '.join(known)}")
    if chosen.size < 16:
        parser.error("--size must be at least 16")
    return chosen


def main(arguments: list[str], silence: bool = False) -> int:
    """Returns how many of the figures could not be made. silence: what Blender itself says goes to
    DIR/blender.log."""
    if addon_utils.enable("verglas") is None:
        sys.exit("verglas: the add-on isn't installed in this Blender, or can't be enabled.")
    import matplotlib
    from figures import (against_truth, cost, gallery, layer_cost, layers, layout, lobes, masking, page,
                         patterns, transports, warping)
    from figures.studio import Studio
    from verglas.compare.progress import Progress, silence_blender
    from verglas.faults import Fault
    from verglas.verglas_core import Error

    makers = {
        "3": lobes.figure_3, "10": against_truth.figure_10, "11": against_truth.figure_11,
        "12": against_truth.figure_12, "13": patterns.figure_13, "14": cost.figure_14,
        "15": patterns.figure_15, "17": transports.figure_17, "18": transports.figure_18,
        "19": gallery.figure_19,
        "endf2": masking.figure_2, "endf5": warping.figure_5, "endf6": warping.figure_6,
        "endf7": warping.figure_7, "endf14": layers.figure_14, "endf15": layers.figure_15,
        "endf16": layers.figure_16, "endf17": layers.figure_17, "endf18": layers.figure_18,
        "endf_table2": layer_cost.table_2,
    }
    chosen = parse_arguments(arguments, list(makers))
    try:
        chosen.out.mkdir(parents=True, exist_ok=True)
        progress = Progress(silence_blender(chosen.out / "blender.log") if silence else sys.stdout)
    except OSError as error:
        sys.exit(f"verglas: '{chosen.out}' can't be written: {error.strerror}.")
    studio = Studio(chosen.size, chosen.quick, progress)
    failed = 0
    for figure_id in chosen.only:
        progress.subject(f"figure {figure_id}")
        progress.step("rendering")
        command = ["./verglas", "figures", "--out", str(chosen.out), "--only", figure_id,
                   "--size", str(chosen.size)] + ["--quick"] * chosen.quick
        try:
            with matplotlib.rc_context(layout.STYLE):
                record = makers[figure_id](studio).save(chosen.out, shlex.join(command))
            progress.say(f"wrote {record.with_suffix('.png')}")
        except (Fault, Error) as fault:
            progress.say(f"it could not be made. {fault}")
            failed += 1
    progress.subject("")
    progress.say(f"wrote {page.write(chosen.out)}")
    progress.close()
    return failed


if __name__ == "__main__":
    sys.exit(1 if main(sys.argv[sys.argv.index("--") + 1:], silence=True) else 0)
