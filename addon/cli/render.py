# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the .blend file that Blender has open, with exactly the file names that are asked for.

    blender --background FILE.blend --engine VERGLAS --python addon/cli/render.py -- \
        [--frame N | --animation] [--out PATH ...]

A PATH's extension chooses the format; '#' stands for a digit of the frame number. Without PATH the pictures
go to the current directory. Several PATHs save one still in several formats. The .blend stays as it is.
"""

import argparse
import os
import re
import sys
from pathlib import Path

import bpy

FORMATS = {
    ".png": 'PNG', ".exr": 'OPEN_EXR', ".jpg": 'JPEG', ".jpeg": 'JPEG', ".tif": 'TIFF', ".tiff": 'TIFF',
    ".hdr": 'HDR', ".tga": 'TARGA', ".bmp": 'BMP', ".jp2": 'JPEG2000', ".webp": 'WEBP',
}


def parse_arguments():
    parser = argparse.ArgumentParser(prog="verglas render")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--frame", type=int)
    what.add_argument("--animation", action="store_true")
    parser.add_argument("--out", action="append", default=[])
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:])


def absolute(path):
    """As Blender, '//' stands for the .blend's folder; else paths are relative to the current directory."""
    return os.path.abspath(bpy.path.abspath(path))


def is_movie(settings):
    return settings.file_format in {'FFMPEG', 'AVI_JPEG', 'AVI_RAW'}


def set_format(settings, file_format):
    if settings.file_format == file_format:
        return
    if hasattr(settings, "media_type"):  # from Blender 5.0
        settings.media_type = 'IMAGE'
    settings.file_format = file_format
    if file_format == 'OPEN_EXR':
        settings.color_depth = '32'


def choose_format(scene, path):
    """Sets the format that the path's extension names, else leaves the scene's. Returns path, extension."""
    stem, extension = os.path.splitext(path)
    settings = scene.render.image_settings
    if extension.lower() in FORMATS:
        if (extension.lower(), settings.file_format) != (".exr", 'OPEN_EXR_MULTILAYER'):
            set_format(settings, FORMATS[extension.lower()])
        return stem, extension
    if re.fullmatch(r"\.[A-Za-z]\w*", extension):
        sys.exit(f"verglas: {extension} isn't a picture format; known are {' '.join(FORMATS)}.")
    return path, ""


def output_path(scene, out, animation):
    """The path for Blender, with the scene's format set to match."""
    pattern = bpy.path.display_name_from_filepath(bpy.data.filepath) + "_####"
    if not out or out.endswith("/") or os.path.isdir(absolute(out)):
        stem, extension = os.path.join(absolute(out or "."), pattern), ""
    else:
        stem, extension = choose_format(scene, absolute(out))
        if animation and not extension and "#" not in stem:
            stem = os.path.join(stem, pattern)
        elif animation and "#" not in stem:
            stem += "_####"
    movie = is_movie(scene.render.image_settings)
    if movie and not animation:
        set_format(scene.render.image_settings, 'PNG')
    # To a movie's name Blender adds the frame range and the extension; pictures are named in full here.
    scene.render.use_file_extension = movie and animation
    return stem + ("" if movie and animation else extension or scene.render.file_extension)


def render_still(scene, outs):
    """One render, saved under each of the paths."""
    def path_of(out):
        folder, name = os.path.split(output_path(scene, out, animation=False))
        name = re.sub("#+", lambda digits: str(scene.frame_current).zfill(len(digits[0])), name)
        return os.path.join(folder, name)

    first = scene.render.filepath = path_of(outs[0])
    bpy.ops.render.render(write_still=True)
    written = [first]
    for out in outs[1:]:
        written.append(path_of(out))
        bpy.data.images["Render Result"].save_render(written[-1], scene=scene)
    return written


def render_animation(scene, out):
    written = []

    def note(scene, *_):
        written.append(scene.render.frame_path(frame=scene.frame_current))

    scene.render.filepath = output_path(scene, out, animation=True)
    bpy.app.handlers.render_write.append(note)
    bpy.ops.render.render(animation=True)
    return list(dict.fromkeys(written))


def main():
    arguments = parse_arguments()
    scene = bpy.context.scene
    if not bpy.data.filepath:
        sys.exit("verglas: Blender could not open the file; is it a .blend?")
    if arguments.animation and len(arguments.out) > 1:
        sys.exit("verglas: an animation takes a single --out.")
    if arguments.frame is not None:
        scene.frame_set(arguments.frame)

    cancelled = []
    bpy.app.handlers.render_cancel.append(lambda *_: cancelled.append(True))
    outs = arguments.out or [""]
    try:
        written = render_animation(scene, outs[0]) if arguments.animation else render_still(scene, outs)
    except RuntimeError as error:  # the report of the operator that failed
        sys.exit(f"verglas: {str(error).strip().removeprefix('Error: ')}")

    if cancelled:
        sys.exit("verglas: cancelled")
    missing = [path for path in written if not Path(path).is_file()]
    if missing or not written:
        sys.exit(f"verglas: nothing was written to {missing[0] if missing else scene.render.filepath}")
    for path in written:
        print(f"verglas: wrote {path}")


main()
