# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the open file with ground truth, by another Blender in the background."""

import os
import signal
import subprocess
import tempfile
from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

COMPARE_SCRIPT = Path(__file__).parent / "cli" / "compare.py"

POLL_SECONDS = 0.5


class VERGLAS_OT_compare(bpy.types.Operator):
    """Render the scene by several methods, measure how far each is from the truth, and show a report"""
    bl_idname = "verglas.compare"
    bl_label = "Compare with Ground Truth..."

    methods: EnumProperty(
        name="Methods",
        description="What is compared",
        items=(
            ('bundle', "Bundle", "Verglas by OpenGL: four rays, each refracted at its own exit"),
            ('traced', "Traced", "Verglas by the CPU: light is followed through all of the glass"),
            ('paper', "Paper", "Verglas: one lobe against the exits' mean normal"),
            ('single', "Single", "Verglas: one ray along the lobe's axis"),
            ('depth_mip', "Depth Mip", "Sharp refraction, blurred by the way through the glass"),
            ('specular', "Specular", "Sharp refraction, as if the glass were polished"),
            ('analytic', "Bundle, Analytic", "Bundle, lobes being closed forms in place of tables"),
            ('tir_none', "Bundle, None", "Bundle, totally reflected light being lost"),
            ('tir_incident', "Bundle, Incident", "Bundle, totally reflected light going straight on"),
            ('tir_clamp', "Bundle, Clamp", "Bundle, totally reflected light leaving along the surface"),
            ('tir_bounce', "Bundle, Bounce", "Bundle, light being followed that is reflected inside"),
            ('reference', "Reference", "Verglas' path tracer, with noise"),
            ('cycles', "Cycles", "Blender's path tracer, with noise"),
            ('cycles_denoised', "Cycles, Denoised", "Blender's path tracer and OpenImageDenoise"),
            ('eevee', "EEVEE", "Blender's real-time engine"),
        ),
        options={'ENUM_FLAG'},
        default={'bundle', 'traced', 'paper', 'single', 'depth_mip', 'specular'},
    )
    truth: EnumProperty(
        name="Truth",
        description="What they are measured against",
        items=(
            ('reference', "Reference", "Verglas' path tracer: the same materials exactly"),
            ('cycles', "Cycles", "Blender's path tracer"),
        ),
        default='reference',
    )
    paths: EnumProperty(
        name="Paths",
        description="The light that counts",
        items=(
            ('full', "All", "Reflection, inner reflections and re-entry too"),
            ('two_interface', "Two Interfaces", "What enters the glass, leaves it, and goes into the world"),
        ),
        default='full',
    )
    tir: BoolProperty(
        name="Total Internal Reflection",
        description="Follow totally reflected light until it leaves; else it is lost",
        default=False,
    )
    spp: IntProperty(
        name="Samples of the Truth",
        description="Samples for each pixel of the truth; 0 takes as many as make its noise small",
        default=0, min=0, max=1 << 24, soft_max=65536,
    )
    folder: StringProperty(
        name="Folder",
        description="Where the report is written; default: beside the file",
        subtype='DIR_PATH', options={'SKIP_SAVE'},
    )

    _comparison: "_Comparison | None" = None
    _timer = None

    def invoke(self, context, event):
        self.folder = self.folder or str(_default_folder())
        return context.window_manager.invoke_props_dialog(self, width=420)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.column(align=True).prop(self, "methods")
        layout.prop(self, "truth")
        layout.prop(self, "paths")
        row = layout.row()
        row.active = self.paths == 'two_interface'
        row.prop(self, "tir")
        layout.prop(self, "spp")
        layout.prop(self, "folder")

    def execute(self, context):
        if not self.methods:
            self.report({'ERROR'}, "There is nothing to compare: choose a method.")
            return {'CANCELLED'}
        try:
            self._comparison = _Comparison(self._folder(), self._arguments())
        except (OSError, RuntimeError) as error:
            self.report({'ERROR'}, f"The comparison can't start: {error}")
            return {'CANCELLED'}
        if bpy.app.background:
            self._comparison.wait()
            return self._finish()
        self._timer = context.window_manager.event_timer_add(POLL_SECONDS, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {'RUNNING_MODAL'}

    def modal(self, context, event):
        if event.type == 'ESC' and event.value == 'PRESS':
            self.cancel(context)
            self.report({'INFO'}, "The comparison was cancelled")
            return {'CANCELLED'}
        if event.type == 'TIMER':
            if not self._comparison.is_running:
                self._leave(context)
                return self._finish()
            context.workspace.status_text_set(f"{self._comparison.last_line()}    Esc: cancel")
        return {'PASS_THROUGH'}

    def cancel(self, context):
        """Blender calls this too, when it quits meanwhile or the dialog is closed."""
        if self._comparison is not None:
            self._comparison.kill()
            self._leave(context)

    def _leave(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.workspace.status_text_set(None)

    def _finish(self):
        """Opens the report, or says why there is none."""
        if not self._comparison.has_succeeded:
            self.report({'ERROR'}, f"The comparison failed: {self._comparison.last_line()} "
                                   f"({self._comparison.log} tells more)")
            return {'CANCELLED'}
        page = self._folder() / "index.html"
        if not bpy.app.background:
            bpy.ops.wm.url_open(url=page.as_uri())
        self.report({'INFO'}, f"The report is {page}")
        return {'FINISHED'}

    def _folder(self) -> Path:
        return Path(bpy.path.abspath(self.folder)).resolve() if self.folder else _default_folder()

    def _arguments(self) -> list[str]:
        """Options of cli/compare.py."""
        arguments = ["--methods", ",".join(sorted(self.methods)), "--truth", self.truth]
        arguments += ["--paths", self.paths, *(["--tir"] if self.tir else [])]
        arguments += ["--spp", str(self.spp)] if self.spp else []
        return arguments


class _Comparison:
    """A background Blender that compares a copy of the open file. The copy stays with the report, so that
    it can be made again."""

    def __init__(self, folder: Path, arguments: list[str]):
        """Raises OSError where the folder can't be made, RuntimeError where the file can't be saved."""
        folder.mkdir(parents=True, exist_ok=True)
        copy = folder / f"{_name()}.blend"
        if copy == Path(bpy.data.filepath):
            copy = copy.with_stem(f"{_name()}_copy")
        copy.unlink(missing_ok=True)  # else Blender keeps it as a backup
        bpy.ops.wm.save_as_mainfile(filepath=str(copy), copy=True)
        self.log = folder / "compare.log"
        with open(self.log, "w", encoding="utf-8") as log:
            self._process = subprocess.Popen(
                [bpy.app.binary_path, "--background", "--python-exit-code", "1", "--python",
                 str(COMPARE_SCRIPT), "--", str(copy), *arguments, "--out", str(folder)],
                stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, start_new_session=True)

    @property
    def is_running(self) -> bool:
        return self._process.poll() is None

    @property
    def has_succeeded(self) -> bool:
        return self._process.returncode == 0

    def wait(self) -> None:
        self._process.wait()

    def kill(self) -> None:
        """Ends it and what it has started."""
        if self.is_running:
            os.killpg(self._process.pid, signal.SIGTERM)
            self.wait()

    def last_line(self) -> str:
        """What it has said last."""
        log = self.log.read_text(encoding="utf-8", errors="replace")
        lines = [line for line in log.splitlines() if line.startswith("verglas: ")]
        return lines[-1].removeprefix("verglas: ") if lines else "Blender starts"


def _name() -> str:
    return bpy.path.display_name_from_filepath(bpy.data.filepath) or "untitled"


def _default_folder() -> Path:
    """Beside the file, or among temporary files where there is none yet."""
    parent = Path(bpy.data.filepath).parent if bpy.data.filepath else Path(tempfile.gettempdir())
    return parent / f"{_name()}_compare"


def _draw_in_render_menu(menu, context):
    menu.layout.separator()
    menu.layout.operator_context = 'INVOKE_DEFAULT'
    menu.layout.operator(VERGLAS_OT_compare.bl_idname)


def register():
    bpy.utils.register_class(VERGLAS_OT_compare)
    bpy.types.TOPBAR_MT_render.append(_draw_in_render_menu)


def unregister():
    bpy.types.TOPBAR_MT_render.remove(_draw_in_render_menu)
    bpy.utils.unregister_class(VERGLAS_OT_compare)
