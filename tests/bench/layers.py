# SPDX-License-Identifier: GPL-3.0-or-later
"""Coated surfaces: what light that meets the base under the layer costs."""

from figures import coatings, layer_cost
from figures.coatings import Coated, Coating
from figures.models import MODELS
from figures.studio import Studio
from verglas.compare.methods import TRACED
from verglas.compare.progress import Progress

from .frames import Row, costs
from .plan import Plan

SHARP = Coating(kappa=1e4, base_kappa=1e3)


ROUGH = Coating(kappa=1e4, base_kappa=10.0)

METHODS = ("bundle", TRACED)
"""One for each device."""


def frames(plan: Plan, progress: Progress) -> list[Row]:
    """Of the monkey on both devices: as one glossy layer, which is the coating's outer side alone, and under
    the coating, with light that meets the base once and twice."""
    rows = []
    for name, coating in (("sharp", SHARP), ("rough", ROUGH)):
        progress.step(f"frames of a coating, {name}")
        coated = Coated(_monkey(plan, progress).setting, coating)
        scenes = [coated.changed(bounces=count) for count in range(3)]
        for method in METHODS:
            found = costs([(scene.core_scene, {}) for scene in scenes], method, plan.engine_size, plan)
            rows += [{"base": name} | scene.coating.numbers | row for scene, row in zip(scenes, found)]
    return rows


def bounces(plan: Plan, progress: Progress) -> list[Row]:
    """Of the path tracer on the monkey: recursive sampling beside ENDF, by layer_cost.measure_both()."""
    monkey = _monkey(plan, progress)
    rows = []
    for count in plan.bounces:
        progress.step(f"path tracing {count} bounces in a layer")
        coated = monkey.changed(bounces=count)
        rows += [coated.coating.numbers | costs
                 for costs in layer_cost.measure_both(coated, plan.bounce_samples, plan.bounce_seeds)]
    return rows


def _monkey(plan: Plan, progress: Progress) -> Coated:
    studio = Studio(plan.engine_size[0], quick=False, progress=progress)
    return Coated(coatings.model_setting(studio, MODELS["monkey"]), SHARP)
