# SPDX-License-Identifier: GPL-3.0-or-later
"""Verglas: frosted, misted and coated glass in real time, without noise."""

bl_info = {
    "name": "Verglas",
    "author": "The Verglas developers",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Render Properties > Render Engine > Verglas",
    "description": "Render engine for frosted glass: real time, free of noise",
    "category": "Render",
}

from importlib import import_module

from . import operators, preferences, properties, ui

try:
    import_module(".verglas_core", __package__)
except ImportError as error:
    from . import unavailable as engine

    engine.reason = str(error)
else:
    from . import engine


def register():
    preferences.register()
    properties.register()
    engine.register()
    ui.register()
    operators.register()


def unregister():
    operators.unregister()
    ui.unregister()
    engine.unregister()
    properties.unregister()
    preferences.unregister()
