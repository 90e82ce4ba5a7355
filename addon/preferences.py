# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user chooses for this machine, in Preferences > Add-ons > Verglas."""

import bpy
from bpy.props import IntProperty


class VerglasPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    viewport_fps: IntProperty(
        name="Viewport Frame Rate",
        description="Pictures each second that the viewport aims at while the view or the scene changes; it "
                    "lowers its resolution as far as that needs",
        default=15, min=1, max=120,
    )

    def draw(self, context):
        self.layout.use_property_split = True
        self.layout.prop(self, "viewport_fps")


def of(context: bpy.types.Context) -> VerglasPreferences:
    return context.preferences.addons[__package__].preferences


def register():
    bpy.utils.register_class(VerglasPreferences)


def unregister():
    bpy.utils.unregister_class(VerglasPreferences)
