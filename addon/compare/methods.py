# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders one scene by every method that is compared, under the same conditions."""

import contextlib
import json
import os
import shutil
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import bpy
import numpy as np

from .. import compat, renderer
from .. import verglas_core as core
from ..faults import Fault, Warn
from ..sync import settings
from . import export, images
from .temporary import changed, plain_picture

TRACED = "traced"
"""Verglas' CPU device."""

BASELINES = ("paper", "single", "depth_mip", "specular")

SCREEN_SPACE = ("bundle", *BASELINES)
"""Verglas' OpenGL device, by its ways to cross the object: core.Settings.transport in lower case."""

DEFAULT = ("bundle", TRACED, *BASELINES)
"""What is compared unless one chooses."""

ANALYTIC = "analytic"
"""bundle with lobes in closed form, whatever the file's are: core.Settings.lobes."""

TIR_MODES = {"tir_none": 'NONE', "tir_incident": 'INCIDENT', "tir_clamp": 'CLAMP', "tir_bounce": 'BOUNCE'}
"""bundle with another mode of total internal reflection than the file's: core.Settings.tir."""

REAL_TIME = (*DEFAULT, ANALYTIC, *TIR_MODES)

PATH_TRACED = ("reference", "cycles", "cycles_denoised")
"""Methods with noise, which falls with their samples."""

METHODS = REAL_TIME + PATH_TRACED + ("eevee",)

BACKGROUND_DEPTH = 1e9
"""Depths beyond this are background."""

EEVEE_SCRIPT = Path(__file__).parents[1] / "cli" / "render_eevee.py"

CYCLES = {
    "device": 'CPU',
    "use_adaptive_sampling": False, "use_denoising": False, "use_animated_seed": False, "time_limit": 0.0,
    "sample_clamp_direct": 0.0, "sample_clamp_indirect": 0.0, "blur_glossy": 0.0,
    "caustics_reflective": True, "caustics_refractive": True, "use_fast_gi": False,
    "max_bounces": 64, "transmission_bounces": 64, "glossy_bounces": 64,
    "pixel_filter_type": 'BLACKMAN_HARRIS', "film_exposure": 1.0,
}
"""Settings that leave nothing of the light out and make nothing up."""

DENOISED = {
    "use_denoising": True, "denoiser": 'OPENIMAGEDENOISE', "denoising_input_passes": 'RGB_ALBEDO_NORMAL',
}
"""What is changed of these where Cycles may make something up."""


@dataclass
class Picture:
    """What a method made, and its cost."""
    pixels: np.ndarray
    """(H, W, 3) float32, scene-linear, row 0 at the bottom"""
    seconds: float
    """of rendering alone"""
    pass_seconds: dict[str, float] = field(default_factory=dict)
    samples: int = 1

    @classmethod
    def of(cls, tracer: core.PathTracer) -> "Picture":
        """What a path tracer has reached."""
        frame = tracer.frame()
        return cls(_rgb(frame), frame.seconds, samples=tracer.samples)


@dataclass(frozen=True)
class Conditions:
    """What all methods have in common."""
    width: int
    height: int
    samples: int
    """a pixel, of the real-time methods"""
    paths: str = 'full'
    """'full': all light; 'two_interface': only light that enters the glass, leaves it, and goes straight into
    the world"""
    tir: bool = True
    """with 'two_interface': whether totally reflected light goes on inside until it leaves, or is lost"""


class Subject:
    """A scene in its current frame, exported once for one size. Raises Fault where there is nothing to
    compare: no camera, or no glass in the picture; warn takes what Verglas can't render of it."""

    core_scene: core.Scene
    mask: np.ndarray
    """(H, W) bool: where the pixel's centre meets the glass"""
    triangles: int
    """of all that Verglas renders"""

    def __init__(self, scene: bpy.types.Scene, conditions: Conditions, warn: Warn):
        self.scene = scene
        self.conditions = conditions
        self._warn = warn
        self.core_scene = export.core_scene(scene, conditions.width, conditions.height, warn)
        self.triangles = self.core_scene.triangle_count
        self.mask = self._mask()
        if not self.mask.any():
            raise Fault(f"Scene '{scene.name}' shows no glass that Verglas can render.")

    def _mask(self) -> np.ndarray:
        tracer = self.path_tracer()
        tracer.render(1)
        return tracer.frame().depth < BACKGROUND_DEPTH

    def _settings(self, method: str) -> core.Settings:
        """The file's, changed to the conditions."""
        conditions = self.conditions
        result = settings.from_blender(self.scene, conditions.width, conditions.height, self._warn)
        result.region = None
        result.samples = conditions.samples
        if method in SCREEN_SPACE:
            result.transport = method.upper()
        if conditions.paths == 'two_interface':
            result.reflection = False
            result.paths = 'TWO_INTERFACE'
            if not conditions.tir:
                result.tir = 'NONE'
        if method == ANALYTIC:
            result.transport = 'BUNDLE'
            result.lobes = 'ANALYTIC'
        if method in TIR_MODES:
            result.transport = 'BUNDLE'
            result.tir = TIR_MODES[method]
        return result

    def real_time(self, method: str, repeats: int = 5, **overrides) -> Picture:
        """One of REAL_TIME, with the times of the median of several renders. overrides: attributes of
        core.Settings that are to differ from the file's and the conditions'."""
        device = 'CPU' if method == TRACED else 'OPENGL'
        chosen = self._settings(method)
        for name, value in overrides.items():
            setattr(chosen, name, value)
        frames = [renderer.render(device, self.core_scene, chosen) for _ in range(repeats)]
        median = statistics.median_low(frame.seconds for frame in frames)
        frame = next(frame for frame in frames if frame.seconds == median)
        return Picture(_rgb(frame), frame.seconds, dict(frame.pass_seconds), chosen.samples)

    def path_tracer(self, seed: int = 0) -> core.PathTracer:
        """The core's path tracer on this scene, without samples yet."""
        conditions = self.conditions
        chosen = settings.reference(self.scene, conditions.width, conditions.height, self._warn)
        chosen.region = None
        chosen.mode = conditions.paths.upper()
        chosen.tir = conditions.tir
        chosen.seed = seed
        return core.PathTracer(self.core_scene, chosen)

    def reference(self, samples: int, seed: int = 0,
                  progress: Callable[[int, int], bool] | None = None) -> Picture | None:
        """By the core's path tracer; None when progress has ended it."""
        tracer = self.path_tracer(seed)
        return Picture.of(tracer) if tracer.render(samples, progress) else None

    def cycles(self, samples: int, seed: int = 0, denoised: bool = False,
               light_samples: bool = False) -> Picture:
        """By Cycles on the CPU, with all light, whatever the conditions' paths. light_samples: draws
        directions from the world's map, too, as by default, which makes rough GGX glass up to 8 % too bright
        in Blender 3.4; without, it is noisier. Raises Fault where Cycles or its denoiser isn't there, or
        fails."""
        if not hasattr(self.scene, "cycles"):
            raise Fault("Blender's Cycles add-on is switched off; switch it on in the preferences.")
        if denoised and not _has_denoiser():
            raise Fault("this Blender's Cycles is built without its denoiser, OpenImageDenoise.")
        chosen = CYCLES | (DENOISED if denoised else {})
        width = self.scene.verglas.filter_width
        with (self._engine('CYCLES'),
              changed(self.scene.cycles, **chosen, samples=samples, seed=seed, filter_width=width),
              self._world_light_samples(light_samples), tempfile.TemporaryDirectory() as folder):
            start = time.perf_counter()
            try:
                bpy.ops.render.render(scene=self.scene.name)
            except RuntimeError as error:
                raise Fault(f"Cycles could not render scene '{self.scene.name}': {error}") from error
            seconds = time.perf_counter() - start
            path = Path(folder) / "cycles.exr"
            bpy.data.images["Render Result"].save_render(str(path), scene=self.scene)
            return Picture(images.read_exr(path), seconds, samples=samples)

    def _world_light_samples(self, drawn: bool) -> contextlib.AbstractContextManager:
        world = self.scene.world
        if world is None or not hasattr(world, "cycles"):
            return contextlib.nullcontext()
        return changed(world.cycles, sampling_method='AUTOMATIC' if drawn else 'NONE')

    def eevee(self) -> Picture:
        """By EEVEE with refraction and the file's other settings, in another Blender, as it needs a
        display. Raises Fault where it can't run."""
        with self._engine(compat.EEVEE), tempfile.TemporaryDirectory() as folder:
            blend, path, report = (Path(folder) / name for name in ("eevee.blend", "eevee.exr", "eevee.json"))
            bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True, compress=False)
            command = [*_display(), bpy.app.binary_path, "--background", str(blend),
                       "--scene", self.scene.name, "--python-exit-code", "1",
                       "--python", str(EEVEE_SCRIPT), "--", str(path), str(report)]
            done = subprocess.run(command, capture_output=True, text=True, errors="replace")
            if done.returncode != 0 or not path.is_file():
                lines = (done.stderr.strip() or done.stdout.strip() or "no message").splitlines()
                raise Fault(f"EEVEE could not render scene '{self.scene.name}': {lines[-1]}")
            cost = json.loads(report.read_text())
            return Picture(images.read_exr(path), cost["seconds"], samples=cost["samples"])

    @contextlib.contextmanager
    def _engine(self, engine: str):
        """Renders by another engine give a plain float picture of the conditions' size."""
        render = self.scene.render
        with (plain_picture(self.scene, self.conditions.width, self.conditions.height),
              changed(render, engine=engine), changed(render.image_settings, **compat.EXR)):
            yield


def _rgb(frame: core.Frame) -> np.ndarray:
    return np.ascontiguousarray(frame.combined[..., :3])


def _has_denoiser() -> bool:
    import _cycles  # of Blender's Cycles add-on
    return _cycles.with_openimagedenoise


def _display() -> list[str]:
    """What to put before a command that needs a display. Raises Fault where there is none."""
    if os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
        return []
    if shutil.which("xvfb-run") is None:
        raise Fault("EEVEE needs a display, or xvfb-run (on Debian: xvfb and xauth), and finds neither.")
    return ["xvfb-run", "--auto-servernum"]
