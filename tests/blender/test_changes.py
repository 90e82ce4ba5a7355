# SPDX-License-Identifier: GPL-3.0-or-later
"""Which meshes are read from Blender again after a change of the scene, and which aren't."""

import bmesh
import bpy
import numpy as np
import pytest
from scenes import add, add_node, add_sphere, frosted, new_group, node_of, render, set_background
from textures import add_image, new_image, textured
from verglas import sync
from verglas import verglas_core as core
from verglas.sync import meshes, painting, readings

pytestmark = pytest.mark.usefixtures("scene")


class Log:
    """What has been read from Blender and made for the core since it was last asked for."""

    def __init__(self):
        self.read: list[str] = []
        self.made: list[str] = []

    def sync(self, space=None) -> tuple[list[str], list[str]]:
        """Names of objects whose meshes were read and of meshes that were made, by one synchronisation."""
        self.read.clear()
        self.made.clear()
        bpy.context.view_layer.update()
        self.scene = sync.scene_from(bpy.context.evaluated_depsgraph_get(), lambda _: None, space)
        return sorted(self.read), sorted(self.made)


@pytest.fixture
def log(monkeypatch) -> Log:
    found = Log()
    real_read, real_mesh = meshes.read, core.Mesh

    def read(evaluated):
        found.read.append(evaluated.name)
        return real_read(evaluated)

    def make(name, *arguments, **coordinates):
        found.made.append(name)
        return real_mesh(name, *arguments, **coordinates)
    monkeypatch.setattr(meshes, "read", read)
    monkeypatch.setattr(core, "Mesh", make)
    return found


@pytest.fixture
def pair(log) -> tuple[bpy.types.Object, bpy.types.Object]:
    """Two spheres, known to the viewport, of one material."""
    glass = frosted()
    first, second = add_sphere(glass, 8, 4), add_sphere(glass, 8, 4, location=(3.0, 0.0, 0.0))
    first.name = first.data.name = "First"
    second.name = second.data.name = "Second"
    assert log.sync() == (["First", "Second"], ["First", "Second"])
    return first, second


def move(obj: bpy.types.Object) -> None:
    """One vertex of its mesh."""
    obj.data.vertices[0].co.z += 0.5
    obj.data.update()


NOTHING = ([], [])


@pytest.mark.parametrize("change", [
    lambda pair: setattr(pair[0], "location", (1.0, 2.0, 3.0)),
    lambda pair: setattr(pair[0].parent or pair[0], "scale", (1.0, 2.0, 1.0)),
    lambda pair: node_of(pair[0].data.materials[0].node_tree, "ShaderNodeBsdfRefraction").inputs[
        "Roughness"].__setattr__("default_value", 0.7),
    lambda pair: set_background(bpy.context.scene, strength=2.0),
    lambda pair: setattr(bpy.context.scene.camera, "location", (1.0, -4.0, 0.0)),
    lambda pair: pair[0].select_set(False),
    lambda pair: setattr(bpy.context.scene, "frame_current", 7),
], ids=["moved", "scaled", "roughness", "world", "camera", "selected", "frame"])
def test_changes_that_leave_meshes_alone(log, pair, change):
    """Dragging a large object or a slider would stutter, as its mesh would be exported at each step."""
    change(pair)
    assert log.sync() == NOTHING


def test_an_edited_mesh_is_read_alone(log, pair):
    """Each stroke on a small object would export the large ones beside it, too."""
    move(pair[0])
    assert log.sync() == (["First"], ["First"])


def test_edit_mode(log, pair):
    """The viewport would show the mesh as it was before Edit Mode, until that is left."""
    first, second = pair
    second.select_set(False)
    bpy.context.view_layer.objects.active = first
    bpy.ops.object.mode_set(mode='EDIT')
    log.sync()
    edited = bmesh.from_edit_mesh(first.data)
    edited.verts.ensure_lookup_table()
    edited.verts[0].co.x = 7.0
    bmesh.update_edit_mesh(first.data)
    assert log.sync() == (["First"], ["First"])
    bpy.ops.mesh.select_all(action='SELECT')
    bpy.ops.mesh.delete(type='VERT')
    log.sync()
    assert log.scene.triangle_count == triangles(second)
    bpy.ops.object.mode_set(mode='OBJECT')
    log.sync()
    assert log.scene.triangle_count == triangles(second)


def triangles(obj: bpy.types.Object) -> int:
    return sum(len(polygon.vertices) - 2 for polygon in obj.data.polygons)


def test_a_mesh_changes_through_another_object(log, pair):
    """Linked duplicates would keep the old shape when one of them is edited."""
    first, second = pair
    second.data = first.data
    second.modifiers.new("Subdivision", 'SUBSURF')
    log.sync()
    move(second)
    assert log.sync()[0] == ["First", "Second"]


def test_a_modifier_and_shape_keys(log, pair):
    """A modifier's slider, or a shape key's, would do nothing in the viewport."""
    first, _ = pair
    modifier = first.modifiers.new("Subdivision", 'SUBSURF')
    assert log.sync() == (["First"], ["First"])
    modifier.levels = 2
    assert log.sync() == (["First"], ["First"])
    first.modifiers.remove(modifier)
    first.shape_key_add(name="Basis")
    key = first.shape_key_add(name="Key")
    key.data[0].co.z += 1.0
    key.value = 0.0
    log.sync()
    key.value = 1.0
    assert log.sync() == (["First"], ["First"])


def test_an_animated_mesh(log, pair):
    """Playback would show the first frame of an animated modifier all along: Blender tells of changes by
    time in another way than of a user's."""
    modifier = pair[0].modifiers.new("Wave", 'WAVE')
    modifier.height = 0.5
    bpy.context.scene.frame_set(1)
    log.sync()
    bpy.context.scene.frame_set(20)
    assert log.sync()[0] == ["First"]


def test_an_armature(log, pair):
    """A posed character would stand still in the viewport."""
    first, _ = pair
    bones = bpy.data.armatures.new("Bones")
    rig = add(bones, "Rig")
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode='EDIT')
    bones.edit_bones.new("Bone").tail = (0.0, 0.0, 1.0)
    bpy.ops.object.mode_set(mode='OBJECT')
    first.modifiers.new("Armature", 'ARMATURE').object = rig
    first.vertex_groups.new(name="Bone").add(range(len(first.data.vertices)), 1.0, 'REPLACE')
    log.sync()
    rig.pose.bones["Bone"].location = (0.0, 1.0, 0.0)
    assert log.sync() == (["First"], ["First"])


def test_metaballs_that_move(log):
    """A ball that is moved would not melt into the others: the mesh of both lies with the first."""
    for name in ("Ball", "Ball.001"):
        add(bpy.data.metaballs.new(name), name).data.elements.new()
    log.sync()
    bpy.data.objects["Ball.001"].location.x = 1.0
    assert log.sync()[0] == ["Ball"]


def test_names_that_are_exchanged(log, pair):
    """Objects would swap their shapes with their names."""
    first, second = pair
    first.modifiers.new("Subdivision", 'SUBSURF').levels = 2
    log.sync()
    count = log.scene.triangle_count
    first.data.name, second.data.name = "Other", "First"
    first.name, second.name = "Other", "First"
    log.sync()
    assert log.scene.triangle_count == count


def test_a_mesh_that_is_replaced_by_one_of_its_name(log, pair):
    """A script that makes an object anew would see the old one."""
    first, second = pair
    bpy.data.meshes.remove(first.data)
    log.sync()
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.name = bpy.context.object.data.name = "First"
    bpy.context.object.data.materials.append(second.data.materials[0])
    log.sync()
    assert log.scene.triangle_count == 12 + triangles(second)


def test_undo_shows_the_state_before(log, pair):
    """After undo the viewport would show what has been undone."""
    bpy.context.preferences.edit.use_global_undo = True
    bpy.ops.ed.undo_push(message="before")
    move(pair[0])
    bpy.ops.ed.undo_push(message="after")
    log.sync()
    moved = readings_of("First")
    if not bpy.ops.ed.undo.poll():
        pytest.skip("Blender has no undo in background")
    bpy.ops.ed.undo()
    log.sync()
    assert "First" in log.read and not meshes.are_equal(readings_of("First"), moved)
    assert log.made in ([], ["First"]), "the other mesh is the same"


def readings_of(name: str) -> meshes.MeshArrays:
    return next(reading.arrays for key, reading in readings._readings._values.items() if key[1][1] == name)


def test_a_hidden_objects_mesh_may_change(log, pair):
    """What was edited while hidden would come back as it was."""
    first, _ = pair
    first.hide_viewport = True
    log.sync()
    move(first)
    log.sync()
    first.hide_viewport = False
    assert log.sync()[0] == ["First"]


def test_content_that_has_not_changed_is_not_uploaded_again(log, pair):
    """Blender tells of a change where nothing is left of it, as after Edit Mode: a large mesh's upload and
    its tree for rays would be made anew for nothing."""
    pair[0].data.update()
    assert log.sync() == (["First"], [])


def test_an_assigned_material_reads_nothing_else(log, pair):
    """Assigning a material would export the whole scene."""
    pair[0].data.materials[0] = frosted(0.8)
    read, made = log.sync()
    assert set(read) <= {"First"} and made == []


def test_values_of_a_textured_material_bake_nothing(log, monkeypatch):
    """The IOR slider of a textured glass would stutter while its mesh is read and its textures are baked."""
    image = new_image(np.full((4, 4, 3), 0.25, np.float32))
    sphere = add_sphere(textured(lambda tree: add_image(tree, image).outputs[0]), 8, 4)
    log.sync()
    monkeypatch.setattr(painting, "paint", lambda *_: pytest.fail("painted again"))
    monkeypatch.setattr(meshes.Surface, "corner_values", lambda *_: pytest.fail("mesh read again"))
    node_of(sphere.data.materials[0].node_tree, "ShaderNodeBsdfGlass").inputs["IOR"].default_value = 1.2
    assert log.sync() == NOTHING
    assert log.scene.materials[0].ior == pytest.approx(1.2)


def test_warnings_of_what_is_kept_come_again(warned):
    """A missing UV map would be named once, then never again, though the picture still lacks it."""
    image = new_image(np.full((4, 4, 3), 0.25, np.float32))
    sphere = add_sphere(textured(lambda tree: add_image(tree, image).outputs[0]), 8, 4)
    sphere.data.uv_layers.remove(sphere.data.uv_layers[0])
    for _ in range(2):
        warned.clear()
        sync.scene_from(bpy.context.evaluated_depsgraph_get(), warned.append)
        assert len(warned) == 1 and "UV map" in warned[0]


def test_instances_of_nodes(log, pair):
    """Each instance of geometry nodes would be read by itself, and again when anything moves."""
    first, second = pair
    sockets = {"Geometry": "NodeSocketGeometry"}
    group = new_group("GeometryNodeTree", sockets, sockets)
    points = add_node(group, "GeometryNodeMeshLine", Count=20)
    instances = add_node(group, "GeometryNodeInstanceOnPoints")
    source = add_node(group, "GeometryNodeObjectInfo", As_Instance=True)
    source.inputs["Object"].default_value = second
    group.links.new(points.outputs["Mesh"], instances.inputs["Points"])
    group.links.new(source.outputs["Geometry"], instances.inputs["Instance"])
    group.links.new(instances.outputs["Instances"], node_of(group, "NodeGroupOutput").inputs[0])
    first.modifiers.new("Nodes", 'NODES').node_group = group
    log.sync()
    assert log.scene.triangle_count >= 10 * triangles(second)
    first.location.x += 1.0
    assert log.sync() == NOTHING
    move(second)
    assert log.sync()[1] == ["Second"]


def test_final_frames_leave_the_viewport_what_it_has(log, pair):
    """F12 would make the viewport export the scene again, and once more for each further frame."""
    render(bpy.context.scene)
    assert log.sync() == NOTHING


def test_memory_stays(log, pair):
    """A day's work would fill the memory with what has been deleted."""
    first, _ = pair
    for i in range(50):
        first.data.name = f"Name {i}"
        move(first)
        log.sync()
    assert len(readings._readings._values) == 2
    assert len(meshes._meshes._values) == 2
    for reading in readings._readings._values.values():
        assert len(reading._made) == 1
