# SPDX-License-Identifier: GPL-3.0-or-later
"""Notes what has changed in Blender, so that what is kept from earlier frames is neither made again nor
out of date."""

import bpy

from .. import compat
from . import images, readings, world

SHAPES = (bpy.types.Mesh, bpy.types.Curve, bpy.types.MetaBall)
"""Kinds of data that objects have their meshes of."""


@bpy.app.handlers.persistent
def _on_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Of viewports: a final frame's depsgraph is new, and in it everything has changed."""
    if depsgraph.mode == 'RENDER':
        return
    for update in depsgraph.updates:
        changed = update.id
        if isinstance(changed, bpy.types.Object):
            if update.is_updated_geometry:
                readings.note_object(changed)
            if changed.type == 'META':
                readings.note_metaballs()
        elif isinstance(changed, SHAPES):
            if update.is_updated_geometry:  # from 5.0 on they are told of for their materials, too
                readings.note_data(changed)
        elif isinstance(changed, bpy.types.Image):
            images.note_change(changed)


@bpy.app.handlers.persistent
def _on_undo(*_) -> None:
    """Undo replaces all data."""
    images.note_all_changes()
    readings.note_all()
    compat.keep_subdivided_meshes_valid()


@bpy.app.handlers.persistent
def _on_load(*_) -> None:
    images.note_all_changes()
    readings.clear()
    world.clear()


HANDLERS = (
    (bpy.app.handlers.depsgraph_update_post, _on_update),
    (bpy.app.handlers.frame_change_post, _on_update),
    (bpy.app.handlers.undo_post, _on_undo),
    (bpy.app.handlers.redo_post, _on_undo),
    (bpy.app.handlers.load_pre, _on_load),
)


def register():
    for handlers, handler in HANDLERS:
        handlers.append(handler)


def unregister():
    for handlers, handler in HANDLERS:
        handlers.remove(handler)
    _on_load()
