# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's evaluated scene to the core's scene, a file for each kind of data."""

import threading

import bpy

from .. import compat
from .. import verglas_core as core
from ..faults import Warn
from . import changes, images, objects, readings, viewports, world
from .cache import Client
from .viewports import set_background, view_state

__all__ = ["lock", "register", "scene_from", "set_background", "unregister", "view_state"]

lock = threading.Lock()
"""Held while a scene is read: final frames and preview icons are read on threads of their own."""


def scene_from(depsgraph: bpy.types.Depsgraph, warn: Warn,
               space: bpy.types.SpaceView3D | None = None) -> core.Scene:
    """All but the camera. space: as this viewport shows it."""
    scene = core.Scene()
    with lock:
        if space is not None and viewports.has_studio_light(space):
            viewports.set_studio_light(scene, space.shading, warn)
        else:
            world.set_environment(scene, compat.world_of(depsgraph), warn, depsgraph.mode == 'RENDER')
        objects.add_objects(scene, depsgraph, warn, space)
        client = Client.of(depsgraph, space)
        for kept in (images, readings, world):
            kept.sweep(client)
    return scene


def register():
    changes.register()


def unregister():
    changes.unregister()
