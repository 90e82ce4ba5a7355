# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user chooses for this machine, in Preferences > Add-ons > Verglas."""

import bpy
from bpy.props import IntProperty

DEFAULT_FPS = 15


class VerglasPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    viewport_fps: IntProperty(
        name="Viewport Frame Rate",
        description="Pictures each second that the viewport aims at while the view or the scene changes; it "
                    "lowers its resolution as far as that needs",
        default=DEFAULT_FPS, min=1, max=120,
    )

    def draw(self, context):
        self.layout.use_property_split = True
        self.layout.prop(self, "viewport_fps")


def viewport_fps(context: bpy.types.Context) -> int:
    """The user's, or the default where the add-on was enabled by a script."""
    addon = context.preferences.addons.get(__package__)
    return addon.preferences.viewport_fps if addon else DEFAULT_FPS


def register():
    bpy.utils.register_class(VerglasPreferences)


def unregister():
    bpy.utils.unregister_class(VerglasPreferences)
