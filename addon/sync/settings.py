# SPDX-License-Identifier: GPL-3.0-or-later
"""Render properties to core settings."""

import bpy
import numpy as np

from .. import verglas_core as core
from ..faults import Warn


def from_blender(scene: bpy.types.Scene, width: int, height: int, warn: Warn) -> core.Settings:
    """Of a final frame. width, height: of the whole frame in pixels, resolution percentage included."""
    settings = viewport(scene, width, height)
    settings.region = border(scene.render, width, height)
    settings.samples = scene.verglas.samples
    _warn_of_features(scene, warn)
    return settings


def reference(scene: bpy.types.Scene, width: int, height: int, warn: Warn) -> core.PathSettings:
    """Of a path-traced final frame."""
    settings = core.PathSettings()
    settings.width = width
    settings.height = height
    settings.region = border(scene.render, width, height)
    settings.filter_width = scene.verglas.filter_width
    settings.mode = scene.verglas.reference_paths
    settings.tir = scene.verglas.reference_tir
    settings.seed = scene.verglas.reference_seed
    settings.transparent = scene.render.film_transparent
    _warn_of_features(scene, warn)
    return settings


def _warn_of_features(scene: bpy.types.Scene, warn: Warn) -> None:
    if scene.render.use_motion_blur:
        warn(f"Scene '{scene.name}' has motion blur, which isn't supported yet; it is rendered sharp.")
    if scene.render.use_multiview:
        warn(f"Scene '{scene.name}' is stereoscopic, which isn't supported yet; all views show the same.")


def viewport(scene: bpy.types.Scene, width: int, height: int) -> core.Settings:
    """Of a picture of width x height pixels in the viewport."""
    settings = core.Settings()
    settings.width = width
    settings.height = height
    settings.samples = scene.verglas.viewport_samples
    settings.filter_width = scene.verglas.filter_width
    settings.background_alpha = 0.0 if scene.render.film_transparent else 1.0
    settings.transport = scene.verglas.transport
    settings.intersection = scene.verglas.intersection
    settings.lobes = scene.verglas.lobes
    settings.tir = scene.verglas.tir
    settings.back_roughness = scene.verglas.back_roughness
    settings.roughness_classes = scene.verglas.roughness_classes
    settings.reflection = scene.verglas.reflection
    settings.max_interfaces = scene.verglas.max_interfaces
    settings.threads = threads(scene.render)
    return settings


def threads(render: bpy.types.RenderSettings) -> int:
    """As Blender's Performance panel or its option --threads say; 0: one for each core."""
    return render.threads if render.threads_mode == 'FIXED' else 0


def border(render: bpy.types.RenderSettings, width: int, height: int) -> tuple[int, int, int, int] | None:
    """The render border as (x, y, width, height) in pixels, rounded in float32 as Blender does;
    None without one. Blender wants the border's pixels alone, whether it crops to them or not."""
    if not render.use_border:
        return None
    low = np.float32([render.border_min_x, render.border_min_y])
    high = np.float32([render.border_max_x, render.border_max_y])
    size = np.float32([width, height])
    left, bottom = (low * size).astype(int).tolist()
    right, top = (high * size).astype(int).tolist()
    return left, bottom, right - left, top - bottom
