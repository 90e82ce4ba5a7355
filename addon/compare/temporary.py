# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of Blender's settings that are taken back."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import bpy


@contextmanager
def changed(owner: bpy.types.bpy_struct, **values) -> Iterator[None]:
    """Sets properties in the order given and puts the old values back in the same order."""
    old = {name: getattr(owner, name) for name in values}
    try:
        for name, value in values.items():
            setattr(owner, name, value)
        yield
    finally:
        for name, value in old.items():
            setattr(owner, name, value)


@contextmanager
def plain_picture(scene: bpy.types.Scene, width: int, height: int) -> Iterator[None]:
    """A render of the scene gives one whole picture of this size: the first view layer that is switched
    on, without border, compositing and the effects of time that Verglas doesn't have."""
    layer = next((layer for layer in scene.view_layers if layer.use), scene.view_layers[0])
    with ExitStack() as stack:
        stack.enter_context(changed(
            scene.render, resolution_x=width, resolution_y=height, resolution_percentage=100,
            use_border=False, use_compositing=False, use_sequencer=False, use_multiview=False,
            use_motion_blur=False))
        for other in scene.view_layers:
            stack.enter_context(changed(other, use=other == layer))
        yield
