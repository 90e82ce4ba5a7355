# SPDX-License-Identifier: GPL-3.0-or-later
"""Notes what has changed in Blender, so that what is kept from earlier frames is neither made again nor
out of date."""

import bpy

from . import images, meshes, painting, tangents, world

SHAPES = (bpy.types.Object, bpy.types.Mesh, bpy.types.Curve, bpy.types.MetaBall)
"""Kinds of data whose changes of geometry change meshes."""


@bpy.app.handlers.persistent
def _on_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    for update in depsgraph.updates:
        if isinstance(update.id, bpy.types.Image):
            images.note_change(update.id)
        elif update.is_updated_geometry and isinstance(update.id, SHAPES):
            meshes.note_change()


@bpy.app.handlers.persistent
def _on_undo(*_) -> None:
    """Undo replaces all data."""
    images.note_all_changes()
    meshes.note_change()


@bpy.app.handlers.persistent
def _on_load(*_) -> None:
    images.note_all_changes()
    for kept in (meshes, painting, tangents, world):
        kept.clear()


HANDLERS = (
    (bpy.app.handlers.depsgraph_update_post, _on_update),
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
