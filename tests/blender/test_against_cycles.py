# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures compared with Cycles, whose Refraction BSDF is the truth."""

import math
import time

import bpy
import numpy as np
import pytest
from scenes import (
    Picture, add_camera, add_mapping, add_monkey, add_sphere, empty_scene, frosted, render, set_map,
    world_map,
)
from verglas import renderer, sync
from verglas.sync import camera, settings

ROUGHNESS = 0.55


def relative_mse(picture: np.ndarray, truth: np.ndarray, mask: np.ndarray) -> float:
    """Mean over the object's pixels; (H, W, 3) linear RGB each."""
    a, b = picture[mask], truth[mask]
    return float(((a - b) ** 2 / (b ** 2 + 0.01)).mean())


by_each_device = pytest.mark.parametrize("device", ['OPENGL', 'CPU'])


def build(shape: str, size: int, device: str = 'OPENGL') -> bpy.types.Scene:
    """Monkey or sphere of frosted glass in the forest map."""
    scene = empty_scene()
    scene.verglas.device = device
    add_camera(scene)
    set_map(scene, world_map("forest"))
    material = frosted(ROUGHNESS)
    if shape == "monkey":
        add_monkey(material, subdivisions=3)
    else:
        add_sphere(material, 144, 72)
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.verglas.samples = 16
    scene.verglas.tir = 'NONE'
    return scene


def render_cycles(scene: bpy.types.Scene, samples: int, bounces: int = 32) -> tuple[Picture, float]:
    """The picture, and the seconds that Blender took for it. So many bounces cut nothing off."""
    scene.render.engine = 'CYCLES'
    cycles = scene.cycles
    cycles.device = 'CPU'
    cycles.samples = samples
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = cycles.transmission_bounces = bounces
    start = time.perf_counter()
    picture = render(scene)
    seconds = time.perf_counter() - start
    scene.render.engine = 'VERGLAS'
    return picture, seconds


@pytest.fixture(scope="module")
def truths() -> dict[tuple[str, int, int], Picture]:
    """Cycles' pictures by shape, size and samples, each rendered once."""
    class Truths(dict):
        def __missing__(self, key):
            shape, size, samples = key
            self[key] = render_cycles(build(shape, size), samples)[0]
            return self[key]
    return Truths()


def error(truth: Picture, scene: bpy.types.Scene, transport: str = 'BUNDLE') -> float:
    scene.verglas.transport = transport
    picture = render(scene)
    return relative_mse(picture.rgb, truth.rgb, picture.mask)


@by_each_device
@pytest.mark.parametrize("shape, bound", [("monkey", 0.05), ("sphere", 0.03)])
def test_small_picture(truths, shape, bound, device):
    """The glass would not look like glass: the bound holds Cycles' own noise at 128 samples too."""
    found = error(truths[shape, 128, 128], build(shape, 128, device))
    print(f"{shape}, 128 x 128, {device}: relative MSE {found:.4f}")
    assert found <= bound


@pytest.mark.parametrize("flip", [np.s_[:, ::-1], np.s_[::-1, :]], ids=["mirrored", "upside down"])
@by_each_device
@pytest.mark.parametrize("shape", ["monkey", "sphere"])
def test_orientation(truths, shape, flip, device):
    """The environment would be seen mirrored or upside down through the glass."""
    truth = truths[shape, 128, 128]
    picture = render(build(shape, 128, device))
    mask = picture.mask & picture.mask[flip]
    right = relative_mse(picture.rgb, truth.rgb, mask)
    assert relative_mse(picture.rgb[flip], truth.rgb, mask) > 3.0 * right
    background = ~(picture.mask | picture.mask[flip])
    right = relative_mse(picture.rgb, truth.rgb, background)
    assert right < 0.01 < relative_mse(picture.rgb[flip], truth.rgb, background)


@by_each_device
@pytest.mark.parametrize("kind", ['POINT', 'TEXTURE', 'VECTOR', 'NORMAL'])
def test_rotated_world(kind, device):
    """A turned environment would be turned otherwise than in Cycles."""
    scene = empty_scene()
    scene.verglas.device = device
    add_camera(scene)
    turned = [math.radians(angle) for angle in (20, -35, 110)]
    add_mapping(scene, set_map(scene, world_map("courtyard")), rotation=turned, kind=kind)
    scene.verglas.samples = 64
    truth, _ = render_cycles(scene, 64)
    everywhere = np.ones(truth.rgb.shape[:2], bool)
    assert relative_mse(render(scene).rgb, truth.rgb, everywhere) < 0.002


@pytest.mark.slow
def test_monkey(truths):
    """The stated precision of the bundle would not hold, or another method be more exact."""
    truth = truths["monkey", 512, 256]
    scene = build("monkey", 512)
    found = {transport: error(truth, scene, transport) for transport in ('BUNDLE', 'PAPER', 'SINGLE')}
    print("monkey, 512 x 512, relative MSE:", {name: round(value, 4) for name, value in found.items()})
    assert found['BUNDLE'] <= 0.035
    assert found['BUNDLE'] < found['PAPER'] and found['BUNDLE'] < found['SINGLE']


@pytest.mark.slow
def test_sphere(truths):
    """The stated precision of the bundle would not hold."""
    found = error(truths["sphere", 512, 256], build("sphere", 512))
    print(f"sphere, 512 x 512: relative MSE {found:.4f}")
    assert found <= 0.010


def frame_seconds(scene: bpy.types.Scene) -> float:
    """Median of a few frames of one sample, without export and uploads."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    width, height = scene.render.resolution_x, scene.render.resolution_y
    core_scene = sync.scene_from(depsgraph, print)
    camera_object = scene.camera.evaluated_get(depsgraph)
    core_scene.camera = camera.from_blender(camera_object, depsgraph, width, height, print)
    core_settings = settings.from_blender(scene, width, height, print)
    core_settings.samples = 1
    seconds = [renderer.render('OPENGL', core_scene, core_settings).seconds for _ in range(6)]
    return float(np.median(seconds[1:]))


@pytest.mark.slow
def test_speed():
    """The engine's reason to be: hundreds of times faster than Cycles with its default bounces."""
    scene = build("monkey", 512)
    seconds = frame_seconds(scene)
    set_up = render_cycles(scene, 1, bounces=12)[1]
    cycles_seconds = render_cycles(scene, 512, bounces=12)[1] - set_up
    print(f"monkey, 512 x 512: Verglas, 1 sample, {seconds:.3f} s; "
          f"Cycles, 512 samples, {cycles_seconds:.1f} s; ratio {cycles_seconds / seconds:.0f}")
    assert cycles_seconds >= 400.0 * seconds
