# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the .blend file that Blender has open by EEVEE, with refraction, and tells what it took.

    blender --background FILE.blend --python addon/cli/render_eevee.py -- PICTURE.exr REPORT.json

REPORT.json gets {"seconds", "samples"}. Engine, size and format are those of the file.
"""

import json
import sys
import time
from pathlib import Path

import bpy


def set_where_known(owner, **values):
    """Properties that not every Blender version has."""
    for name, value in values.items():
        if hasattr(owner, name):
            setattr(owner, name, value)


def allow_refraction(scene):
    """Screen-space refraction, without which EEVEE shows only the world through glass (until 4.1), or
    raytracing, which took its place."""
    set_where_known(scene.eevee, use_ssr=True, use_ssr_refraction=True, use_raytracing=True)
    for material in bpy.data.materials:
        set_where_known(material, use_screen_refraction=True, use_raytrace_refraction=True)


def main():
    picture, report = sys.argv[sys.argv.index("--") + 1:]
    scene = bpy.context.scene
    allow_refraction(scene)
    bpy.ops.render.render()  # compiles the shaders
    start = time.perf_counter()
    bpy.ops.render.render()
    seconds = time.perf_counter() - start
    bpy.data.images["Render Result"].save_render(picture, scene=scene)
    Path(report).write_text(json.dumps({"seconds": seconds, "samples": scene.eevee.taa_render_samples}))


main()
