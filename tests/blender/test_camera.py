# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's cameras as the core gets them."""

import math

import bpy
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector
from scenes import add, add_sphere, frosted, render, set_background
from verglas import faults
from verglas.sync import camera

POINTS = [Vector(p) for p in ((0, 0, 0), (1, 0.5, 0.3), (-0.7, 1, -0.4), (0.2, 3, 1.1), (-1.3, -1, 0.6))]


def core_camera(scene):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    size = scene.render.resolution_x, scene.render.resolution_y
    return camera.from_blender(scene.camera.evaluated_get(depsgraph), depsgraph, *size, lambda _: None)


def projected(core_camera, point: Vector) -> np.ndarray:
    """(x, y) in the frame, 0 … 1 from the lower left, and the distance along the camera's axis."""
    in_camera = core_camera.view @ (*point, 1.0)
    clip = core_camera.projection @ in_camera
    return np.array([*(0.5 + 0.5 * clip[:2] / clip[3]), -in_camera[2]])


def check(scene):
    bpy.context.view_layer.update()
    read = core_camera(scene)
    for point in POINTS:
        expected = np.array(world_to_camera_view(scene, scene.camera, point))
        assert np.allclose(projected(read, point), expected, atol=2e-4), point


@pytest.mark.parametrize("size", [(64, 48), (48, 64), (50, 50)])
@pytest.mark.parametrize("fit", ['AUTO', 'HORIZONTAL', 'VERTICAL'])
@pytest.mark.parametrize("kind", ['PERSP', 'ORTHO'])
def test_sensor_fit(scene, size, fit, kind):
    """The picture would be framed otherwise than in the viewport and in Cycles."""
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.camera.data.type = kind
    scene.camera.data.sensor_fit = fit
    scene.camera.data.sensor_width, scene.camera.data.sensor_height = 36, 20
    check(scene)


@pytest.mark.parametrize("kind", ['PERSP', 'ORTHO'])
def test_shift(scene, kind):
    """Shift lenses, as in architecture, would be ignored."""
    scene.camera.data.type = kind
    scene.camera.data.shift_x, scene.camera.data.shift_y = 0.2, -0.35
    check(scene)


def test_pixel_aspect(scene):
    """Anamorphic pictures would be squeezed."""
    scene.render.pixel_aspect_x, scene.render.pixel_aspect_y = 2.0, 1.0
    check(scene)


def test_scaled_and_parented_camera(scene):
    """A camera under a scaled rig would show another picture."""
    rig = add(None, "Rig", location=(0.3, -0.2, 0.1), rotation_euler=(0.0, 0.1, 0.2), scale=(2.0, 2.0, 2.0))
    scene.camera.parent = rig
    scene.camera.scale = (0.5, 3.0, 1.5)
    check(scene)


@pytest.mark.usefixtures("device")
@pytest.mark.parametrize("kind, shift", [('PERSP', 0.0), ('PERSP', 0.3), ('ORTHO', 0.0)])
def test_sphere_lands_where_blender_says(scene, kind, shift):
    """Matrices could be right and the picture still shifted, mirrored or upside down."""
    set_background(scene)
    scene.camera.data.type = kind
    scene.camera.data.shift_x = shift
    scene.render.resolution_x, scene.render.resolution_y = 120, 90
    sphere = add_sphere(frosted())
    sphere.location = (0.6, 0.0, 0.5)
    sphere.scale = (0.3, 0.3, 0.3)
    mask = render(scene).mask
    rows, columns = np.nonzero(mask)
    center = world_to_camera_view(scene, scene.camera, sphere.location)
    assert (columns.mean() + 0.5) / 120 == pytest.approx(center.x, abs=0.01)
    assert (rows.mean() + 0.5) / 90 == pytest.approx(center.y, abs=0.01)


def test_panorama_is_refused(scene):
    """A panorama would come out as something else."""
    scene.camera.data.type = 'PANO'
    with pytest.raises(RuntimeError, match="Camera 'Camera'.*perspective and orthographic"):
        bpy.ops.render.render()


def test_depth_of_field_is_named(scene):
    """A picture without its depth of field would come without a word."""
    scene.camera.data.dof.use_dof = True
    render(scene)
    assert len(faults.warnings()) == 1 and "Camera 'Camera'" in faults.warnings()[0]


def test_any_object_can_be_the_camera(scene):
    """Looking through an empty, which Blender allows, would crash."""
    scene.camera = add(None, "Eye", location=(0.0, -5.2, 0.3), rotation_euler=(math.radians(87), 0.0, 0.0))
    set_background(scene)
    add_sphere(frosted())
    assert render(scene).mask.any()
