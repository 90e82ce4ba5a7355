# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure 19: roughnesses under several environment maps."""

from . import layout
from .figure import Figure
from .models import MODELS, about, roughness_of
from .studio import Case, Studio

EXPONENTS = (20000.0, 90.0, 24.0, 6.4)


def figure_19(studio: Studio) -> Figure:
    models = [MODELS[name] for name in ("bunny", "dragon", "monkey", "buddha")]
    picture, axes = layout.sheet(len(models), len(EXPONENTS))
    rows = []
    for line, model in zip(axes, models):
        for ax, exponent in zip(line, EXPONENTS):
            case = Case(model, exponent, tir=True)
            subject = studio.subject(case)
            made = subject.real_time("bundle", repeats=1, tir='CLAMP')
            rows.append({**case.numbers, "roughness": roughness_of(exponent), "samples": made.samples,
                         "object_pixels": int(subject.mask.sum()), "frame_ms": 1e3 * made.seconds,
                         "mean_radiance": float(made.pixels[subject.mask].mean())})
            layout.show(ax, made.pixels, f"Exponent {exponent:g}")
        line[0].set_ylabel(f"{model.title}, {model.world.name}")
    caption = (
        "From nearly clear to misted: bundle at four Blinn-Phong exponents, each model under its own "
        "environment map; refraction alone, with total internal reflection clamped.")
    return Figure("19", "Roughnesses and environments", caption + about(*models), picture, rows)
