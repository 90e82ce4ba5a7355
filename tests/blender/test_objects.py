# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects, meshes and instances as they come into the picture."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from scenes import (
    add, add_monkey, add_node, add_sphere, frosted, new_group, node_of, render, set_background, set_map,
    set_smooth,
)
from verglas import faults, sync
from verglas.sync import meshes


def evaluated(obj: bpy.types.Object) -> bpy.types.Object:
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get())


@pytest.fixture
def uploads(monkeypatch) -> list[str]:
    """Names of the meshes given to the core, once for each time."""
    names = []

    class CountedMesh(meshes.core.Mesh):
        def __init__(self, name, *arrays):
            names.append(name)
            super().__init__(name, *arrays)

    monkeypatch.setattr(meshes.core, "Mesh", CountedMesh)
    return names


def sync_scene(warn=lambda _: None):
    return sync.scene_from(bpy.context.evaluated_depsgraph_get(), warn)


def test_smooth_mesh_shares_vertices(scene):
    """Large smooth meshes would take six times the memory."""
    monkey = add_monkey(None)
    arrays = meshes.read(evaluated(monkey))
    assert arrays.positions.shape == arrays.normals.shape == (len(monkey.data.vertices), 3)
    assert arrays.triangles.shape == (968, 3) and arrays.slots.shape == (968,)


def test_flat_faces_keep_their_edges(scene):
    """A cut crystal would be smoothed to a pebble."""
    bpy.ops.mesh.primitive_cube_add()
    arrays = meshes.read(evaluated(bpy.context.object))
    corners = arrays.positions[arrays.triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    faces /= np.linalg.norm(faces, axis=1, keepdims=True)
    assert np.allclose(arrays.normals[arrays.triangles], faces[:, None], atol=1e-5)


def test_custom_normals(scene):
    """Custom normals, as of imported CAD models, would be lost."""
    bpy.ops.mesh.primitive_cube_add()
    mesh = bpy.context.object.data
    if bpy.app.version < (4, 1, 0):
        mesh.use_auto_smooth = True
    set_smooth(mesh, True)
    wanted = np.array([0.6, 0.0, 0.8])
    mesh.normals_split_custom_set([wanted] * len(mesh.loops))
    arrays = meshes.read(evaluated(bpy.context.object))
    assert np.allclose(arrays.normals, wanted, atol=1e-3)


@pytest.mark.skipif(bpy.app.version >= (4, 1, 0), reason="auto smooth is a modifier from 4.1")
def test_auto_smooth(scene):
    """Sharp edges of a smooth mesh would be rounded off."""
    bpy.ops.mesh.primitive_cube_add()
    mesh = bpy.context.object.data
    set_smooth(mesh, True)
    mesh.use_auto_smooth, mesh.auto_smooth_angle = True, math.radians(30)
    arrays = meshes.read(evaluated(bpy.context.object))
    assert np.allclose(np.abs(arrays.normals).max(axis=1), 1.0, atol=1e-4)


def test_modifiers(scene):
    """The picture would show the mesh without its modifiers, or with the viewport's level of them."""
    monkey = add_monkey(frosted())
    modifier = monkey.modifiers.new("Subdivision", 'SUBSURF')
    modifier.levels, modifier.render_levels = 0, 2
    scene.render.resolution_x, scene.render.resolution_y = 128, 96
    subdivided = render(scene).normal
    modifier.render_levels = 0
    assert np.abs(subdivided - render(scene).normal).max() > 0.05


def test_user_mesh_is_not_changed(scene):
    """Rendering would leave split normals or triangles behind in the user's mesh."""
    monkey = add_monkey(frosted())
    set_smooth(monkey.data, False)

    def state():
        return len(monkey.data.vertices), len(monkey.data.loops), monkey.data.users, len(bpy.data.meshes)

    before = state()
    render(scene)
    assert state() == before


def test_linked_duplicates_are_uploaded_once(scene, uploads):
    """A thousand duplicates would take the memory of a thousand meshes."""
    monkey = add_monkey(frosted())
    for i in range(5):
        add(monkey.data, f"Copy {i}", location=(i, 0, 0))
    sync_scene()
    assert uploads == ["Suzanne"]


def test_collection_instances(scene, uploads):
    """Instanced collections would be missing, or each copied in memory."""
    sphere = add_sphere(frosted())
    sphere.scale = (0.3, 0.3, 0.3)
    scene.collection.objects.unlink(sphere)
    collection = bpy.data.collections.new("Glasses")
    collection.objects.link(sphere)
    for x in (-0.8, 0.8):
        add(None, location=(x, 0.0, 0.0), instance_type='COLLECTION', instance_collection=collection)
    mask = render(scene).mask
    assert mask[:, :28].any() and mask[:, 36:].any() and not mask[:, 30:34].any()
    assert len(uploads) == 1


def test_geometry_nodes_instances(scene, uploads):
    """Meshes that Geometry Nodes make and scatter would be missing, or lack their material."""
    group = new_group('GeometryNodeTree', {}, {"Geometry": 'NodeSocketGeometry'})
    line = add_node(group, "GeometryNodeMeshLine", Count=3, Start_Location=(-1, 0, 0), Offset=(1, 0, 0))
    sphere = add_node(group, "GeometryNodeMeshIcoSphere", Radius=0.2, Subdivisions=3)
    material = add_node(group, "GeometryNodeSetMaterial", Material=frosted())
    scatter = group.nodes.new("GeometryNodeInstanceOnPoints")
    group.links.new(line.outputs[0], scatter.inputs["Points"])
    group.links.new(sphere.outputs[0], material.inputs["Geometry"])
    group.links.new(material.outputs[0], scatter.inputs["Instance"])
    group.links.new(scatter.outputs[0], node_of(group, "NodeGroupOutput").inputs["Geometry"])
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.modifiers.new("Scatter", 'NODES').node_group = group
    mask = render(scene).mask
    assert all(mask[:, columns].any() for columns in (np.s_[:21], np.s_[24:40], np.s_[43:]))
    assert not mask[:, 21:24].any() and not mask[:, 40:43].any()
    assert len(uploads) == 1
    assert faults.warnings() == ()


def test_modified_duplicates_stay_different(scene):
    """Duplicates with modifiers of their own would all look like the first."""
    monkey = add_monkey(frosted())
    monkey.location = (-1.0, 0.0, 0.0)
    twin = add(monkey.data, "Twin", location=(1.0, 0.0, 0.0))
    twin.modifiers.new("Decimate", 'DECIMATE').ratio = 0.05
    picture = render(scene)
    normals = picture.normal[:, :32], picture.normal[:, 32:]
    assert np.abs(normals[0] - normals[1]).max() > 0.3


@pytest.mark.usefixtures("device")
def test_mirrored_object(scene):
    """A mirrored object, scaled by -1, would be drawn inside out."""
    set_map(scene)
    monkey = add_monkey(frosted())
    monkey.rotation_euler = (0.1, 0.2, 0.4)
    monkey.scale = (-0.9, 0.9, 0.9)
    bpy.context.view_layer.update()
    mirrored = render(scene)
    matrix = monkey.matrix_world.copy()
    monkey.data.transform(matrix)
    monkey.data.flip_normals()
    monkey.matrix_world = Matrix()
    baked = render(scene)
    assert (mirrored.mask != baked.mask).mean() < 0.002
    both = mirrored.mask & baked.mask
    assert np.abs(mirrored.normal - baked.normal)[both].mean() < 0.01
    assert np.abs(mirrored.rgb - baked.rgb)[both].mean() < 0.02 * baked.rgb[both].mean()


@pytest.mark.usefixtures("device")
def test_flat_and_smooth_differ(scene):
    """Shade Flat would have no effect."""
    sphere = add_sphere(frosted(), 16, 8)
    smooth = render(scene).normal
    set_smooth(sphere.data, False)
    assert np.abs(smooth - render(scene).normal).max() > 0.05


@pytest.mark.parametrize("make", [
    lambda: bpy.ops.object.text_add(rotation=(math.radians(90), 0, 0)),
    lambda: bpy.ops.curve.primitive_bezier_circle_add(),
    lambda: bpy.ops.surface.primitive_nurbs_surface_sphere_add(),
    lambda: bpy.ops.object.metaball_add(),
], ids=["text", "curve", "surface", "metaball"])
def test_other_geometry(scene, make, uploads):
    """Text, curves, surfaces or metaballs would be missing, or drawn twice."""
    make()
    obj = bpy.context.object
    if obj.type in {'CURVE', 'FONT'}:
        obj.data.extrude = 0.1
        obj.data.bevel_depth = 0.05
    obj.data.materials.append(frosted())
    assert render(scene).mask.any()
    assert len(uploads) == 1
    assert not any("supported" in sentence for sentence in faults.warnings())


def test_hidden_objects(scene):
    """Objects that are hidden from renders would be rendered."""
    add_monkey(frosted()).hide_render = True
    assert not render(scene).mask.any()


def test_objects_hidden_from_the_camera(scene):
    """Objects whose visibility to the camera is off would be rendered."""
    add_monkey(frosted()).visible_camera = False
    assert not render(scene).mask.any()


def test_excluded_collection(scene):
    """A collection that the view layer leaves out would be rendered."""
    collection = bpy.data.collections.new("Out")
    scene.collection.children.link(collection)
    monkey = add_monkey(frosted())
    collection.objects.link(monkey)
    scene.collection.objects.unlink(monkey)
    scene.view_layers[0].layer_collection.children["Out"].exclude = True
    assert not render(scene).mask.any()


@pytest.mark.usefixtures("device")
def test_nearer_object_hides_farther_one(scene):
    """Of two objects the farther would be drawn over the nearer."""
    set_background(scene)
    add_sphere(frosted()).location = (0.0, 3.0, 0.0)
    add_sphere(frosted()).scale = (0.5, 0.5, 0.5)
    picture = render(scene)
    assert picture.depth[24, 32] == pytest.approx(4.7, abs=0.1)
    assert picture.mask.sum() > 0 and picture.depth[picture.mask].max() > 7.0


def test_unsupported_objects_are_named(scene):
    """Volumes and the like would be missing without a word."""
    add(bpy.data.volumes.new("Smoke"), "Smoke")
    add(bpy.data.grease_pencils.new("Sketch"), "Sketch")
    render(scene)
    assert len(faults.warnings()) == 2
    assert any("'Smoke'" in text for text in faults.warnings())
    assert any("'Sketch'" in text for text in faults.warnings())


def test_hair_and_holdout_are_named(scene):
    """Hair and holdouts would be left out without a word."""
    monkey = add_monkey(frosted())
    monkey.is_holdout = True
    monkey.modifiers.new("Hair", 'PARTICLE_SYSTEM')
    settings = monkey.particle_systems[0].settings
    settings.type, settings.count = 'HAIR', 10
    render(scene)
    assert len(faults.warnings()) == 2
    assert all("'Suzanne'" in text for text in faults.warnings())
