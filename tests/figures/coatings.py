# SPDX-License-Identifier: GPL-3.0-or-later
"""Coated objects for the ENDF paper's figures: by the core's materials, as Blender's sliders end before the
paper's roughnesses do."""

import functools
from dataclasses import dataclass, replace

import numpy as np
from verglas import conductors, renderer
from verglas import verglas_core as core
from verglas.compare import export, metrics
from verglas.compare.methods import BACKGROUND_DEPTH, Picture
from verglas.compare.truth import Truth
from verglas.sync import meshes

from .figure import Row
from .models import Model, new_scene
from .studio import Studio

DEVICES = {"opengl": 'OPENGL', "cpu": 'CPU'}
"""Methods in real time, and what renderer.render() calls their devices."""

LAYERS = {"truth": 'RECURSIVE', "endf": 'ENDF', "weidlich_wilkie": 'WEIDLICH_WILKIE'}
"""Methods by path tracing: core.PathSettings.layers."""

TITLES = {"truth": "Ground truth", "opengl": "OpenGL", "cpu": "CPU", "endf": "ENDF, path traced",
          "weidlich_wilkie": "Weidlich, Wilkie"}


@dataclass(frozen=True)
class Coating:
    """A clear layer on a mirror or a metal."""
    kappa: float
    """concentration of the outer side's normals"""
    base_kappa: float
    bounces: int = 2
    """how often light meets the base, at most"""
    ior: float = 1.5
    absorption: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """sigma_a by 1 / length"""
    thickness: float = 0.5
    metal: str | None = None
    """of the base, as conductors.INDICES has it; None reflects all"""
    surface: bool = True
    """whether the outer side reflects to the viewer"""

    @property
    def material(self) -> core.Material:
        material = core.Material("Coating")
        material.kind = 'COATED'
        material.ior = self.ior
        material.absorption = self.absorption
        if not self.surface:
            material.reflection_color = (0.0, 0.0, 0.0)
        layer = material.layer
        material.roughness, layer.roughness = roughness_of(self.kappa), roughness_of(self.base_kappa)
        layer.bounces, layer.thickness = self.bounces, self.thickness
        layer.base_color = (1.0, 1.0, 1.0)
        if self.metal:
            layer.base_color, layer.edge_tint = conductors.reflectance(self.metal, self.ior)
        return material

    @property
    def title(self) -> str:
        return f"κ₁ = {power(self.kappa)}, κ₂ = {power(self.base_kappa)}"

    @property
    def numbers(self) -> Row:
        """What a row of numbers about it begins with."""
        return {"kappa_1": self.kappa, "kappa_2": self.base_kappa, "bounces": self.bounces, "ior": self.ior}


def roughness_of(kappa: float) -> float:
    """Of normals of a von Mises-Fisher distribution: kappa = 2 / roughness^4."""
    return (2.0 / kappa) ** 0.25


def power(kappa: float) -> str:
    """As a power of ten where it is one from 100 on."""
    exponent = int(np.log10(kappa))
    return "10" + "⁰¹²³⁴⁵⁶⁷⁸⁹"[exponent] if exponent > 1 and 10 ** exponent == kappa else f"{kappa:g}"


@dataclass(frozen=True)
class Setting:
    """A mesh where it stands, and all of its picture but its material."""
    name: str
    mesh: core.Mesh
    matrix: np.ndarray
    """object -> world"""
    view: core.Scene
    """with the camera and the environment"""
    studio: Studio


def model_setting(studio: Studio, model: Model) -> Setting:
    scene = new_scene(model, exponent=24.0)
    view = export.core_scene(scene, studio.size, studio.size, studio.warn)
    view_layer = scene.view_layers[0]
    view_layer.update()
    obj = next(obj for obj in scene.objects if obj.type == 'MESH').evaluated_get(view_layer.depsgraph)
    arrays = meshes.read(obj)
    mesh = meshes.to_core(model.title, arrays, frozenset(arrays.used_slots), {})
    return Setting(model.title, mesh, np.array(obj.matrix_world), view, studio)


class Coated:
    """A setting with a coating, for Truth and all methods."""

    def __init__(self, setting: Setting, coating: Coating):
        self.setting = setting
        self.coating = coating
        scene, view = core.Scene(), setting.view
        scene.camera, scene.environment_map = view.camera, view.environment_map
        scene.environment_color = view.environment_color
        scene.environment_rotation = view.environment_rotation
        index = scene.add_material(coating.material)
        scene.add_object(setting.name, setting.mesh, setting.matrix, [index])
        self.core_scene = scene

    def changed(self, **attributes) -> "Coated":
        """With other attributes of the coating."""
        return Coated(self.setting, replace(self.coating, **attributes))

    @functools.cached_property
    def mask(self) -> np.ndarray:
        """(H, W) bool: where the pixel's centre meets the object."""
        tracer = self.path_tracer()
        tracer.render(1)
        return tracer.frame().depth < BACKGROUND_DEPTH

    def path_tracer(self, seed: int = 0, method: str = "truth", max_interfaces: int = 64,
                    bounce: int | None = None) -> core.PathTracer:
        """bounce: as core.PathSettings.bounce."""
        settings = core.PathSettings()
        settings.bounce = bounce
        settings.max_interfaces = max_interfaces
        settings.width = settings.height = self.setting.studio.size
        settings.layers = LAYERS[method]
        settings.seed = seed
        return core.PathTracer(self.core_scene, settings)

    def path_traced(self, method: str) -> Picture:
        """With fewer samples than the truth: they are less noisy in closed form, and one bounce less so."""
        studio = self.setting.studio
        tracer = self.path_tracer(method=method)
        tracer.render(max(studio.truth_samples // 8, 1), studio.progress.part)
        return Picture.of(tracer)

    def real_time(self, method: str) -> Picture:
        """By the CPU with one sample: its edges are smooth, and further ones take the model's error away."""
        settings = core.Settings()
        settings.width = settings.height = self.setting.studio.size
        settings.samples = self.setting.studio.samples if method == "opengl" else 1
        frame = renderer.render(DEVICES[method], self.core_scene, settings)
        return Picture(frame.combined[..., :3].copy(), frame.seconds, samples=settings.samples)

    def picture(self, method: str) -> Picture:
        return self.real_time(method) if method in DEVICES else self.path_traced(method)

    def truth(self) -> Truth:
        """With half the samples of solid glass, which is noisier."""
        studio = self.setting.studio
        studio.progress.step(f"path tracing the {self.setting.name}")
        truth = Truth("reference", self)
        truth.add(studio.truth_samples // 2, studio.progress.part)
        return truth


def errors(pixels: np.ndarray, halves: tuple[np.ndarray, np.ndarray], mask: np.ndarray) -> Row:
    """How far pixels are from the mean of two independent truths: the mean error as a share of the mean
    light, beside what the truth's own noise would make; bias and relmse_net as metrics has them."""
    first, second = halves
    truth = 0.5 * (first + second)
    light = float(np.mean(truth[mask], dtype=np.float64))
    return {"mean_relative_error": float(np.mean(np.abs(pixels - truth)[mask], dtype=np.float64)) / light,
            "mean_relative_noise": float(np.mean(0.5 * np.abs(first - second)[mask])) / light,
            "bias": metrics.bias(pixels, truth, mask),
            "relmse_net": metrics.relmse_net(pixels, halves, mask)}


def in_percent(row: Row) -> str:
    return f"{100.0 * row['mean_relative_error']:.1f} %"
