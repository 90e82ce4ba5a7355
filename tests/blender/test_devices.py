# SPDX-License-Identifier: GPL-3.0-or-later
"""The two devices: which of them renders what, and what the user sees and sets of them."""

import os
import subprocess
import textwrap
import threading
import time

import bpy
import numpy as np
import pytest
from scenes import add_sphere, frosted, render, set_map
from verglas import devices, renderer, ui
from verglas import verglas_core as core
from verglas.engine import VerglasRenderEngine
from verglas.sync import settings


class _Renderer:
    """A device's core renderer; tells which it is in place of a picture."""

    def __init__(self, name: str, driver: str = ""):
        self.name = name
        self.device = driver

    def render(self, scene, settings, progress=None):
        return self.name


def _cannot_be_had():
    raise core.Error("There is no OpenGL.")


@pytest.fixture
def machine(monkeypatch):
    """A function that takes the driver of this machine's OpenGL, None for a machine without."""
    def set_driver(driver: str | None) -> None:
        opengl = _cannot_be_had if driver is None else lambda: _Renderer('OPENGL', driver)
        monkeypatch.setattr(renderer, "MAKERS", {'OPENGL': opengl, 'CPU': lambda: _Renderer('CPU')})
        monkeypatch.setattr(renderer, "_final", {})
        monkeypatch.setattr(devices, "automatic", None)

    return set_driver


def test_auto_is_the_default():
    """Who has no graphics card would get the slow and less exact device, who has one the slow one."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, load_ui=False)
    assert bpy.context.scene.verglas.device == 'AUTO'
    bpy.context.scene.render.engine = 'VERGLAS'


@pytest.mark.parametrize("driver, device", [
    ("NVIDIA H100 PCIe/PCIe/SSE2", 'OPENGL'), ("Mesa Intel(R) UHD Graphics 620 (KBL GT2)", 'OPENGL'),
    ("AMD Radeon RX 7600 (navi33, LLVM 15.0.6, DRM 3.49)", 'OPENGL'), (None, 'CPU'),
    ("llvmpipe (LLVM 15.0.6, 256 bits)", 'CPU'), ("virgl (LLVMPIPE (LLVM 15.0.6))", 'CPU'),
    ("softpipe", 'CPU'), ("Software Rasterizer", 'CPU'),
])
def test_auto(machine, driver, device):
    """Auto would take the CPU beside a graphics card, or software OpenGL, or end where there is no OpenGL."""
    machine(driver)
    assert devices.automatic is None  # the panel says nothing that isn't known
    assert renderer.render('AUTO', core.Scene(), core.Settings()) == device
    assert renderer.resolved('AUTO') == devices.automatic == device


def test_chosen_device_is_taken(machine):
    """A choice would be overruled, or missing OpenGL be replaced without a word where it was asked for."""
    machine("llvmpipe (LLVM 15.0.6, 256 bits)")
    for device in ('OPENGL', 'CPU'):
        assert renderer.render(device, core.Scene(), core.Settings()) == device
    machine(None)
    assert renderer.render('CPU', core.Scene(), core.Settings()) == 'CPU'
    with pytest.raises(core.Error, match="There is no OpenGL"):
        renderer.render('OPENGL', core.Scene(), core.Settings())


@pytest.mark.parametrize("device", ['OPENGL', 'CPU'])
def test_viewport_does_not_wait_for_a_final_frame(device):
    """The viewport would stand still for as long as F12 takes."""
    begun, end = threading.Event(), threading.Event()

    def progress(done, total):
        begun.set()
        return not end.wait(30)

    scene, chosen = core.Scene(), core.Settings()
    chosen.width, chosen.height, chosen.samples = 32, 24, 1
    final = threading.Thread(target=renderer.render, args=(device, scene, chosen, progress))
    final.start()
    try:
        assert begun.wait(30)
        view = core.ViewportView(renderer.of_viewports(device))
        view.show(scene, chosen, 1.0)
        assert picture_of(view).combined.shape == (24, 32, 4)
        assert final.is_alive()
    finally:
        end.set()
        final.join()


def picture_of(view: core.ViewportView) -> core.Frame:
    """The last one of what it was asked for."""
    last = time.monotonic() + 30
    while not view.is_done and time.monotonic() < last:
        time.sleep(0.01)
    assert view.is_done and not view.fault
    frame, _ = view.take()
    return frame


class _Engine:
    """What the viewport and progress ask of a render engine."""

    def __init__(self):
        self.told = None
        self.stats: list[str] = []

    def update_stats(self, _, text):
        self.stats.append(text)

    def update_progress(self, part):
        pass

    def test_break(self):
        return len(self.stats) > 2


ATTRIBUTES = [name for name in dir(core.Settings) if not name.startswith("_")]


def rendered(scene, monkeypatch) -> tuple[tuple[str, dict], tuple[str, dict]]:
    """Device and settings of the viewport and of a final frame of the same size."""
    finals = []

    def values(chosen):
        return {name: getattr(chosen, name) for name in ATTRIBUTES}

    def note(device, _, chosen, progress=None):
        finals.append((device, values(chosen)))

    monkeypatch.setattr(renderer, "render", note)
    bpy.ops.render.render()
    final, = finals
    shown = settings.viewport(scene, final[1]["width"], final[1]["height"])
    return (devices.of_viewport(scene), values(shown)), final


@pytest.mark.parametrize("device", ['AUTO', 'OPENGL', 'CPU'])
def test_final_frame_shows_what_the_viewport_shows(scene, monkeypatch, device):
    """F12 would show another picture than the viewport, but for its smoother edges."""
    set_map(scene)
    add_sphere(frosted())
    scene.verglas.device = device
    scene.verglas.samples, scene.verglas.viewport_samples, scene.verglas.max_interfaces = 5, 4, 3
    scene.verglas.tir, scene.verglas.reflection = 'NONE', False
    scene.render.threads_mode, scene.render.threads = 'FIXED', 3
    scene.render.film_transparent = True
    shown, final = rendered(scene, monkeypatch)
    assert (shown[1].pop("samples"), final[1].pop("samples")) == (4, 5)
    assert shown == final
    assert shown[0] == device and shown[1]["max_interfaces"] == shown[1]["threads"] == 3

    scene.verglas.traced_final = True
    scene.render.threads_mode = 'AUTO'
    shown, final = rendered(scene, monkeypatch)
    assert (shown[0], final[0]) == (device, 'CPU')
    assert shown[1]["threads"] == 0


def test_progress_is_told_once_a_sample():
    """Blender would redraw its window for every tile, and a long sample couldn't be cancelled."""
    engine = _Engine()
    answers = [VerglasRenderEngine._progress(engine, done, 4) for done in (0, 0, 0, 1, 1, 2, 2)]
    assert engine.stats == [f"Verglas | sample {done}/4" for done in range(3)]
    assert answers == [True] * 5 + [False] * 2


def test_without_opengl():
    """On a server without any OpenGL nothing would be rendered, though the CPU needs none; or the CPU would
    take OpenGL's place where that was asked for."""
    script = textwrap.dedent("""
        import addon_utils, bpy
        addon_utils.enable("verglas")
        scene = bpy.context.scene
        scene.render.engine = 'VERGLAS'
        scene.render.resolution_x = scene.render.resolution_y = 32
        print("by Auto:", bpy.ops.render.render(), scene.verglas.device)
        scene.verglas.device = 'OPENGL'
        try:
            bpy.ops.render.render()
        except RuntimeError as error:
            print("by OpenGL:", error)
    """)
    done = subprocess.run(
        [bpy.app.binary_path, "--background", "--factory-startup", "--python-expr", script],
        env=os.environ | {"VERGLAS_EGL_DEVICE": "99"}, capture_output=True, text=True, timeout=60)
    assert "by Auto: {'FINISHED'} AUTO" in done.stdout, done.stdout + done.stderr
    before, _, after = done.stdout.partition("by Auto:")
    assert "VERGLAS_EGL_DEVICE" not in before
    assert "by OpenGL: Error: VERGLAS_EGL_DEVICE is '99'" in after


@pytest.mark.parametrize("device", ['OPENGL', 'CPU'])
def test_lobes_reach_the_device(scene, device):
    """The choice between tables and closed forms would change nothing, or the picture as a whole."""
    set_map(scene)
    add_sphere(frosted(0.5))
    scene.verglas.device, scene.verglas.samples = device, 1
    table = render(scene).rgb
    scene.verglas.lobes = 'ANALYTIC'
    analytic = render(scene).rgb
    assert not np.array_equal(analytic, table)
    assert np.abs(analytic - table).mean() < 0.03 * table.mean()


# Panels

class _Layout:
    """Takes down what a panel shows."""

    def __init__(self):
        self.shown: list[str] = []
        self.rows = []

    def prop(self, owner, name, **_):
        assert name in owner.bl_rna.properties, name
        self.shown.append(name)

    def label(self, text="", **_):
        self.shown.append(text)

    def row(self, **_):
        return self

    def column(self, **_):
        return self


class _Context:
    engine = 'VERGLAS'

    def __init__(self, scene):
        self.scene = scene


def shown(panel, scene) -> set[str]:
    layout = _Layout()
    panel.draw_settings(None, _Context(scene), layout)
    return set(layout.shown)


OPENGL_ONLY = {"transport", "intersection", "tir"}


@pytest.mark.parametrize("device, automatic, traced_final, opengl, cpu", [
    ('OPENGL', None, False, True, False), ('CPU', None, False, False, True),
    ('OPENGL', None, True, True, True), ('AUTO', None, False, True, True),
    ('AUTO', 'OPENGL', False, True, False), ('AUTO', 'CPU', False, False, True),
])
def test_panels_show_what_matters(scene, monkeypatch, device, automatic, traced_final, opengl, cpu):
    """Users would turn knobs that do nothing, or not find those that do, and not know what Auto took."""
    monkeypatch.setattr(devices, "automatic", automatic)
    scene.verglas.device, scene.verglas.traced_final = device, traced_final
    glass = shown(ui.VERGLAS_RENDER_PT_glass, scene)
    assert OPENGL_ONLY & glass == (OPENGL_ONLY if opengl else set())
    assert ("max_interfaces" in glass) == cpu and {"lobes", "reflection"} <= glass
    sampling = shown(ui.VERGLAS_RENDER_PT_sampling, scene)
    assert {"device", "samples"} <= sampling and ("traced_final" in sampling) == opengl
    assert any("Auto takes" in text for text in sampling) == (device == 'AUTO' and automatic is not None)
    assert ui.VERGLAS_RENDER_PT_performance.poll(_Context(scene)) == cpu
    assert {"threads_mode", "threads"} == shown(ui.VERGLAS_RENDER_PT_performance, scene)


def test_reference_leaves_the_viewport_its_device(scene):
    """With final frames path traced, the settings of the viewport's device couldn't be found."""
    scene.verglas.method, scene.verglas.device, scene.verglas.traced_final = 'REFERENCE', 'OPENGL', True
    assert "device" in shown(ui.VERGLAS_RENDER_PT_sampling, scene)
    assert OPENGL_ONLY <= shown(ui.VERGLAS_RENDER_PT_glass, scene)
    assert "max_interfaces" not in shown(ui.VERGLAS_RENDER_PT_glass, scene)


def test_threads(scene):
    """A machine that renders beside other work couldn't be kept from taking all of its cores."""
    assert settings.threads(scene.render) == 0
    scene.render.threads_mode, scene.render.threads = 'FIXED', 2
    assert settings.threads(scene.render) == 2
