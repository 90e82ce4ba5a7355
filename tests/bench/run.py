# SPDX-License-Identifier: GPL-3.0-or-later
r"""Measures what Verglas costs, inside Blender, with the installed add-on enabled:

    blender --background --factory-startup --python-exit-code 1 --python tests/bench/run.py -- \
        [--out DIR] [--quick]

DIR/bench.json holds all numbers, DIR/*.png are plots of them; a summary is printed. --quick: small pictures
and few frames, to see that all works.
"""

import argparse
import json
import sys
from pathlib import Path

import addon_utils

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS), str(TESTS / "viewport")]


def parse_arguments(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="verglas bench")
    parser.add_argument("--out", type=Path, default=Path("verglas_bench"))
    parser.add_argument("--quick", action="store_true")
    return parser.parse_args(arguments)


def measure(quick: bool, progress) -> dict:
    """What bench.json holds."""
    from bench import engines, layers, machine, navigation, preparation, scaling, summary, updates
    from bench.plan import FULL, QUICK

    plan = QUICK if quick else FULL
    notes: list[str] = []
    results = {
        "machine": machine.describe(),
        "models": scaling.by_model(plan, progress),
        "triangles": scaling.by_triangles(plan, progress),
        "pixels": scaling.by_pixels(plan, progress),
        "threads": scaling.by_threads(plan, progress),
        "roughness": scaling.by_roughness(plan, progress),
        "lobes": scaling.by_lobes(plan, progress),
        "updates": updates.steps(plan, progress),
        "preparation": preparation.steps(plan, progress),
        "engines": engines.engines(plan, progress, notes),
        "refraction": engines.refraction(plan, progress, notes),
        "coatings": layers.frames(plan, progress),
        "bounces": layers.bounces(plan, progress),
        "navigation": navigation.rows(plan, progress, notes),
        "notes": notes,
    }
    return results | {"ratios": summary.ratios(results)}


def draw(results: dict, folder: Path) -> None:
    import matplotlib
    from bench import plots
    from figures import layout

    with matplotlib.rc_context(layout.STYLE):
        for draw_plot in (plots.models, plots.triangles, plots.pixels, plots.preparation, plots.engines,
                          plots.navigation):
            name = draw_plot.__name__
            if results[name]:
                picture = draw_plot(results[name])
                picture.savefig(folder / f"{name}.png")
                matplotlib.pyplot.close(picture)


def main(arguments: list[str], silence: bool = False) -> int:
    """Returns the process's exit status. silence: what Blender itself says goes to DIR/blender.log."""
    if addon_utils.enable("verglas") is None:
        sys.exit("verglas: the add-on isn't installed in this Blender, or can't be enabled.")
    from bench import summary
    from verglas.compare.progress import Progress, silence_blender
    from verglas.faults import Fault
    from verglas.verglas_core import Error

    chosen = parse_arguments(arguments)
    try:
        chosen.out.mkdir(parents=True, exist_ok=True)
        stream = silence_blender(chosen.out / "blender.log") if silence else sys.stdout
    except OSError as error:
        sys.exit(f"verglas: '{chosen.out}' can't be written: {error.strerror}.")
    progress = Progress(stream)
    try:
        results = measure(chosen.quick, progress)
        text = json.dumps(results, indent=2, allow_nan=False)
        (chosen.out / "bench.json").write_text(f"{text}\n", encoding="utf-8")
        draw(results, chosen.out)
    except (Fault, Error) as fault:
        progress.say(str(fault))
        progress.close()
        return 1
    progress.say(f"wrote {chosen.out / 'bench.json'}")
    progress.close()
    print(summary.text(results), file=stream, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[sys.argv.index("--") + 1:], silence=True))
