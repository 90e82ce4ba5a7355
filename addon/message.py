# SPDX-License-Identifier: GPL-3.0-or-later
"""Text over the picture of a viewport. Blender draws an engine's own (update_stats) only with overlays and
their Text Info switched on; a fault must be read without them, too."""

import textwrap

import bpy

from . import compat

BACKGROUND = (0.0, 0.0, 0.0, 0.7)
COLOR = (1.0, 0.75, 0.3, 1.0)
FONT = 0
"""Blender's own"""
POINTS = 12.0


def draw(context: bpy.types.Context, sentence: str) -> None:
    """Draws it, wrapped, on a dark band along the lower edge of the region, in pixel space, as view_draw is
    called in."""
    # Only where Blender draws: in background the gpu module can't be used
    import blf
    import gpu
    from gpu_extras.batch import batch_for_shader

    blf.size(FONT, POINTS * context.preferences.system.ui_scale)
    width, height = blf.dimensions(FONT, "x")[0], 1.5 * blf.dimensions(FONT, "Xg")[1]
    margin = height
    lines = textwrap.wrap(sentence, max(20, int((context.region.width - 2.0 * margin) / width)))
    top = margin + height * len(lines) + 0.5 * margin
    right = context.region.width
    shader = gpu.shader.from_builtin(compat.UNIFORM_COLOR_SHADER)
    band = batch_for_shader(shader, 'TRI_STRIP',
                            {"pos": ((0.0, 0.0), (right, 0.0), (0.0, top), (right, top))})
    gpu.state.blend_set('ALPHA')
    shader.uniform_float("color", BACKGROUND)
    band.draw(shader)
    gpu.state.blend_set('NONE')
    blf.color(FONT, *COLOR)
    for row, line in enumerate(reversed(lines)):
        blf.position(FONT, margin, margin + row * height, 0.0)
        blf.draw(FONT, line)
