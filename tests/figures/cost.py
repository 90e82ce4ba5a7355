# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure 14: what a frame costs, by pass."""

import matplotlib.pyplot as plt
import numpy as np
from verglas import verglas_core as core
from verglas.compare.methods import Picture

from . import layout
from .figure import Figure, Row
from .models import MODELS, about
from .studio import Case, Studio

EXPONENT = 24.0
REPEATS = 9

TRUTH_SAMPLES = 512
"""of the ground truth's time, as in the paper"""
TIMED_SAMPLES = 128
"""of which it is found: each takes the same time"""

METHODS = {"specular": "Specular", "bundle": "Ours (bundle)", "traced": "Ours (traced)", "paper": "Paper"}

PASSES = ("back_faces", "inner_layers", "coverage", "pyramid", "front_faces", "refraction", "background",
          "data", "readback", "tracing")
"""In the order of the frame; the last is all of traced's. The rest of its time is drawn as 'other'."""

COLUMNS = ("Model", "Triangles", "Pixels", *METHODS.values(), "Ground truth")


def figure_14(studio: Studio) -> Figure:
    rows: list[Row] = []
    table = []
    for model in MODELS.values():
        case = Case(model, EXPONENT, tir=False)
        subject = studio.subject(case)
        truth = subject.reference(4 if studio.quick else TIMED_SAMPLES)
        truth_seconds = truth.seconds * TRUTH_SAMPLES / truth.samples
        frames = [subject.real_time(method, 1 if studio.quick else REPEATS, samples=1) for method in METHODS]
        common = {**case.numbers, "triangles": subject.triangles, "object_pixels": int(subject.mask.sum())}
        rows += [{**common, "method": name, **_milliseconds(frame)} for name, frame in zip(METHODS, frames)]
        rows.append({**common, "method": "truth", "samples": TRUTH_SAMPLES, "frame_ms": 1e3 * truth_seconds})
        table.append((model.title, f"{subject.triangles:,}", f"{common['object_pixels']:,}",
                      *(f"{1e3 * frame.seconds:.1f} ms" for frame in frames), f"{truth_seconds:.1f} s"))
    caption = (
        f"Time of one frame of {studio.size} x {studio.size} pixels with one sample each, Blinn-Phong "
        f"exponent {EXPONENT:g}, the median of several, on {studio.device}; traced on all cores of the CPU. "
        "Specular: sharp refraction at two interfaces; ours and the paper's method: rough refraction. Ground "
        f"truth: the path tracer with {TRUTH_SAMPLES} samples on all cores, by the time of its first "
        f"{TIMED_SAMPLES}. The bars are the passes of the frame; 'other' is its time outside of them.")
    return Figure("14", "What a frame costs", caption + about(*MODELS.values()), _draw(table, rows), rows)


def passes_of(frame: Picture | core.Frame) -> dict[str, float]:
    """Seconds by pass. A traced frame has but one."""
    return dict(frame.pass_seconds) or {"tracing": frame.seconds}


def _milliseconds(frame: Picture) -> Row:
    passes = {name: 1e3 * passes_of(frame).get(name, 0.0) for name in PASSES}
    whole = 1e3 * frame.seconds
    return {"frame_ms": whole, **{f"{name}_ms": time for name, time in passes.items()},
            "other_ms": max(whole - sum(passes.values()), 0.0)}


def _draw(table: list[tuple[str, ...]], rows: list[Row]) -> plt.Figure:
    """The table, and below it a stacked bar for each model and method."""
    picture, (top, ax) = layout.plots(2, 1, height_ratios=(1.0, 2.6), figsize=(7.2, 7.2))
    layout.table(top.inset_axes((-0.22, 0.0, 1.22, 1.0)), table, COLUMNS)
    top.axis('off')

    frames = [row for row in rows if row["method"] in METHODS]
    places = [i + 0.6 * (i // len(METHODS)) for i in range(len(frames))]
    done = np.zeros(len(frames))
    for name, color in zip((*PASSES, "other"), plt.get_cmap("Set3").colors):
        times = np.array([row[f"{name}_ms"] for row in frames])
        ax.barh(places, times, left=done, color=color, label=name.replace("_", " "), height=0.8)
        done += times
    ax.set_yticks(places, [f"{row['model']}, {METHODS[row['method']].lower()}" for row in frames])
    ax.margins(y=0.01)
    ax.invert_yaxis()
    ax.spines[['top', 'right']].set_visible(False)
    ax.set_xlabel("milliseconds")
    ax.legend(frameon=False, ncols=(len(PASSES) + 2) // 2, loc='upper center', bbox_to_anchor=(0.39, -0.09),
              columnspacing=1.2, handlelength=1.2)
    return picture
