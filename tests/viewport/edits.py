# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside the Blender of blender_window.py: the scene that viewports show, and what users do to it."""

import functools
import os
import tempfile

import bpy
import OpenImageIO as oiio
import scenes
import viewports
from verglas import compat

SAMPLES = 3


@functools.cache
def _world_map() -> str:
    """Path of one of Blender's studio maps, small, so that it is filtered in no time."""
    size = oiio.ROI(0, 256, 0, 128, 0, 1, 0, 3)
    small = oiio.ImageBufAlgo.resize(oiio.ImageBuf(scenes.world_map("forest")), roi=size)
    path = os.path.join(tempfile.gettempdir(), "forest.exr")  # in the folder of this Blender's window
    oiio.ImageBufAlgo.abs(small).write(path)
    return path


def new_file(device: str) -> None:
    """The monkey and a sphere beside it, each of a frosted glass of its own, in a forest."""
    scene = scenes.empty_scene()
    scene.verglas.device = device
    scene.verglas.samples = scene.verglas.viewport_samples = SAMPLES
    scenes.set_map(scene, _world_map())
    with viewports.context_of(0):
        scenes.add_monkey(scenes.frosted(0.2), subdivisions=1).name = "Monkey"
        scenes.add_sphere(scenes.frosted(0.4), radius=0.6, location=(1.6, 0.4, -0.3)).name = "Sphere"
        scenes.add_camera(scene)
        bpy.ops.ed.undo_push(message="New file")


def set_roughness(name: str, roughness: float) -> None:
    material = bpy.data.objects[name].material_slots[0].material
    shader = next(node for node in material.node_tree.nodes if "Roughness" in node.inputs)
    shader.inputs["Roughness"].default_value = roughness


def move(name: str, x: float, y: float, z: float) -> None:
    """To a place."""
    bpy.data.objects[name].location = (x, y, z)


def push_undo(message: str) -> None:
    with viewports.context_of(0):
        bpy.ops.ed.undo_push(message=message)


def undo() -> None:
    """Nothing where nothing is left to undo; so redo()."""
    with viewports.context_of(0):
        if bpy.ops.ed.undo.poll():
            bpy.ops.ed.undo()


def redo() -> None:
    with viewports.context_of(0):
        if bpy.ops.ed.redo.poll():
            bpy.ops.ed.redo()


def select(name: str) -> None:
    """Alone, and makes it active."""
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj.name == name)
    bpy.context.view_layer.objects.active = bpy.data.objects[name]


def set_mode(mode: str) -> None:
    """Of the active object."""
    with viewports.context_of(0):
        bpy.ops.object.mode_set(mode=mode)


def stretch_mesh(factor: float) -> None:
    """In edit mode, along X."""
    with viewports.context_of(0):
        bpy.ops.mesh.select_all(action='SELECT')
        bpy.ops.transform.resize(value=(factor, 1.0, 1.0))


def toggle_particles() -> None:
    """Gives the monkey some small spheres, or takes them away."""
    monkey = bpy.data.objects["Monkey"]
    if monkey.particle_systems:
        monkey.modifiers.remove(next(each for each in monkey.modifiers if each.type == 'PARTICLE_SYSTEM'))
        return
    monkey.modifiers.new("Particles", 'PARTICLE_SYSTEM')
    particles = monkey.particle_systems[0].settings
    particles.type = 'HAIR'
    particles.count = 10
    particles.render_type = 'OBJECT'
    particles.instance_object = bpy.data.objects["Sphere"]
    particles.particle_size = 0.1


def set_setting(name: str, value: object) -> object:
    """One of Verglas' own, of the scene. Returns what it was."""
    settings = bpy.context.scene.verglas
    before = getattr(settings, name)
    setattr(settings, name, value)
    return before


def set_material_setting(obj: str, name: str, value: object) -> None:
    """One of Verglas' own, of an object's material."""
    setattr(bpy.data.objects[obj].material_slots[0].material.verglas, name, value)


def set_transparent(is_transparent: bool) -> None:
    bpy.context.scene.render.film_transparent = is_transparent


def set_engine(engine: str) -> None:
    """engine: its name, or 'EEVEE', whose name changes from version to version."""
    bpy.context.scene.render.engine = compat.EEVEE if engine == 'EEVEE' else engine


def save(path: str) -> None:
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)


def load(path: str) -> None:
    """The scene alone; the window's layout stays."""
    bpy.ops.wm.open_mainfile(filepath=path, load_ui=False)


def toggle_local_view() -> None:
    """Of the selected objects."""
    with viewports.context_of(0):
        bpy.ops.view3d.localview(frame_selected=False)


def set_border(left: float, bottom: float, right: float, top: float) -> None:
    """Of the camera's picture, whose corners are 0, 0 and 1, 1."""
    render = bpy.context.scene.render
    render.use_border = True
    render.border_min_x, render.border_min_y = left, bottom
    render.border_max_x, render.border_max_y = right, top


def clear_border() -> None:
    bpy.context.scene.render.use_border = False


def set_view_transform(name: str) -> None:
    bpy.context.scene.view_settings.view_transform = name


def set_world_strength(strength: float) -> None:
    background = scenes.node_of(bpy.context.scene.world.node_tree, "ShaderNodeBackground")
    background.inputs["Strength"].default_value = strength


def add_copy(name: str, x: float, y: float, z: float) -> None:
    """Of an object, with the same mesh, at a place."""
    obj = bpy.data.objects[name].copy()
    obj.location = (x, y, z)
    bpy.context.scene.collection.objects.link(obj)


def save_library(path: str) -> None:
    """A file with a collection "Library", which holds a copy of the sphere."""
    collection = bpy.data.collections.new("Library")
    obj = bpy.data.objects["Sphere"].copy()
    collection.objects.link(obj)
    bpy.data.libraries.write(path, {collection})
    bpy.data.collections.remove(collection)
    bpy.data.objects.remove(obj)


def add_linked(path: str, x: float, y: float, z: float) -> None:
    """An instance, at a place, of a library's collection."""
    with bpy.data.libraries.load(path, link=True) as (_, linked):
        linked.collections = ["Library"]
    obj = bpy.data.objects.new("Linked.001", None)
    obj.instance_type = 'COLLECTION'
    obj.instance_collection = linked.collections[0]
    obj.location = (x, y, z)
    bpy.context.scene.collection.objects.link(obj)


def delete_copies() -> None:
    """All but the objects of a new file."""
    for obj in list(bpy.context.scene.objects):
        if "." in obj.name:
            bpy.data.objects.remove(obj)


# Final frames

def press_f12(width: int, height: int) -> None:
    """Starts a final frame beside the viewport."""
    bpy.context.preferences.view.render_display_type = 'NONE'
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y = width, height
    with viewports.context_of(0):
        bpy.ops.render.render('INVOKE_DEFAULT')


def is_rendering() -> bool:
    return bpy.app.is_job_running('RENDER')
