# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's evaluated scene to the core's scene, a file for each kind of data."""

import bpy

from .. import compat
from .. import verglas_core as core
from ..faults import Warn
from . import changes, images, meshes, objects, painting, tangents, world


def scene_from(depsgraph: bpy.types.Depsgraph, warn: Warn) -> core.Scene:
    """All but the camera."""
    scene = core.Scene()
    world.set_environment(scene, compat.world_of(depsgraph), warn)
    objects.add_objects(scene, depsgraph, warn)
    for kept in (images, meshes, painting, tangents, world):
        kept.sweep()
    return scene


def register():
    changes.register()


def unregister():
    changes.unregister()
