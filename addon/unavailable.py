# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine that stands in where the core doesn't load: it says so, and Blender goes on."""

import bpy

reason = ""
"""Why the core doesn't load, as Python puts it."""


class VerglasRenderEngine(bpy.types.RenderEngine):
    bl_idname = 'VERGLAS'
    bl_label = "Verglas"
    bl_use_shading_nodes_custom = False
    bl_use_eevee_viewport = True

    def render(self, depsgraph):
        self.report({'ERROR'}, sentence())

    def view_update(self, context, depsgraph):
        self.update_stats("", sentence())

    def view_draw(self, context, depsgraph):
        pass


def sentence() -> str:
    return f"Verglas can't render, because its core (verglas_core) doesn't load: {reason}"


def register():
    bpy.utils.register_class(VerglasRenderEngine)


def unregister():
    bpy.utils.unregister_class(VerglasRenderEngine)
