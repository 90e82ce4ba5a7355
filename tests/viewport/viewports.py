# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside the Blender of blender_window.py: the window's 3D viewports, by number from 0 on. Those of a
quad view are each one."""

from collections.abc import Callable
from contextlib import AbstractContextManager

import bpy
import numpy as np
from mathutils import Euler, Matrix
from verglas import viewport

SHOWN_AGAIN = ("tool_header",) if bpy.app.version >= (5, 0, 0) else ()
"""Regions that have to be hidden twice, as they come again with the header's end."""

Place = tuple[bpy.types.Area, bpy.types.Region]


def window() -> bpy.types.Window:
    return bpy.context.window_manager.windows[0]


def places() -> list[Place]:
    return [(area, region) for area in window().screen.areas if area.type == 'VIEW_3D'
            for region in area.regions if region.type == 'WINDOW' and region.width > 1]


def context_of(index: int) -> AbstractContextManager:
    """Makes a viewport Blender's context."""
    area, region = places()[index]
    return bpy.context.temp_override(window=window(), area=area, region=region)


def space_of(index: int) -> bpy.types.SpaceView3D:
    return places()[index][0].spaces.active


def matrices(index: int) -> tuple[np.ndarray, np.ndarray]:
    """(4, 4) each: world -> view, view -> clip space."""
    with context_of(index):
        view = bpy.context.region_data
        return np.array(view.view_matrix), np.array(view.window_matrix)


def rectangle(index: int) -> tuple[int, int, int, int]:
    """x, y of the lower left corner in the window, width, height; in pixels."""
    region = places()[index][1]
    return region.x, region.y, region.width, region.height


def border(index: int) -> tuple[int, int, int, int]:
    """The scene's render border in a viewport's camera view: left, bottom, right and top in its pixels."""
    _, _, width, height = rectangle(index)
    view, projection = (Matrix(matrix.tolist()) for matrix in matrices(index))
    scene = bpy.context.scene
    camera, render = scene.camera, scene.render
    corners = [camera.matrix_world @ corner for corner in camera.data.view_frame(scene=scene)]
    places = [(projection @ view @ corner.to_4d()) for corner in corners]
    xs, ys = ([0.5 * (1.0 + place[axis] / place.w) for place in places] for axis in (0, 1))
    frame_left, frame_right, frame_bottom, frame_top = min(xs), max(xs), min(ys), max(ys)

    def between(low: float, high: float, share: float, pixels: int) -> int:
        return round(pixels * (low + (high - low) * share))
    return (between(frame_left, frame_right, render.border_min_x, width),
            between(frame_bottom, frame_top, render.border_min_y, height),
            between(frame_left, frame_right, render.border_max_x, width),
            between(frame_bottom, frame_top, render.border_max_y, height))


# Layout

def lay_out_one() -> None:
    """Leaves one viewport in the window, nothing over its picture, and a view of the scene from near."""
    _close(lambda area: True)
    space = space_of(0)
    if space.region_quadviews:
        toggle_quad_view(0)
    if space.local_view:
        with context_of(0):
            bpy.ops.view3d.localview()
    with context_of(0):
        for name in ("header", "tool_header", "toolbar", "ui", "hud", *SHOWN_AGAIN):
            setattr(space, f"show_region_{name}", False)
    space.overlay.show_overlays = False
    space.show_gizmo = False
    set_clipping(0, 0.01, 1000.0)
    view = space.region_3d
    view.view_perspective = 'PERSP'
    view.view_distance = 4.5
    view.view_location = (0.4, 0.0, 0.0)
    view.view_rotation = Euler((1.2, 0.0, 0.5)).to_quaternion()
    space.shading.type = 'RENDERED'


def cut(width: int, height: int) -> None:
    """Makes the only viewport smaller; an empty area has the rest of the window."""
    _, _, old_width, old_height = rectangle(0)
    for direction, share in (('HORIZONTAL', height / old_height), ('VERTICAL', width / old_width)):
        if share < 1.0:
            with context_of(0):
                bpy.ops.screen.area_split(direction=direction, factor=share)
            window().screen.areas[-1].type = 'CONSOLE'


def split(direction: str = 'VERTICAL', factor: float = 0.6) -> None:
    """Makes two viewports of the first."""
    with context_of(0):
        bpy.ops.screen.area_split(direction=direction, factor=factor)
    set_shading(1, 'RENDERED')  # Blender leaves that to the first


def leave_one() -> None:
    """Closes the other viewports."""
    _close(lambda area: area.type == 'VIEW_3D')


def _close(chosen: Callable[[bpy.types.Area], bool]) -> None:
    """All of the chosen areas but that of the first viewport."""
    while others := [area for area in window().screen.areas if area != places()[0][0] and chosen(area)]:
        with bpy.context.temp_override(window=window(), area=others[0]):
            bpy.ops.screen.area_close()


def open_window() -> None:
    """Another one, with the same areas. It isn't the one that all else here is about."""
    with context_of(0):
        bpy.ops.wm.window_new()


def close_windows() -> None:
    """All but the first."""
    for other in bpy.context.window_manager.windows[1:]:
        with bpy.context.temp_override(window=other):
            bpy.ops.wm.window_close()


def toggle_quad_view(index: int) -> None:
    with context_of(index):
        bpy.ops.screen.region_quadview()


# State

def states() -> list[tuple[bool, int, str]]:
    """is_done, pictures and fault of each viewport's View; those that have none yet aren't done."""
    views = {view.region: view for view in viewport.views()}
    found = [views.get(region.as_pointer()) for _, region in places()]
    return [(view.is_done, view.pictures, view.fault) if view else (False, 0, "") for view in found]


def live() -> int:
    """How many rendered viewports the add-on works for."""
    return len(viewport.views())


def picture(index: int) -> np.ndarray:
    """(H, W, 4) float32, scene-linear: what is drawn, of a border that alone, row 0 at the bottom."""
    pointer = places()[index][1].as_pointer()
    return next(np.array(view.frame.combined) for view in viewport.views() if view.region == pointer)


# Input

def send(event: str, value: str, x: int, y: int) -> None:
    """Simulates an event of the mouse or keyboard at a place in the window, in pixels."""
    window().event_simulate(type=event, value=value, x=x, y=y)


def toggle_orthographic(index: int) -> None:
    with context_of(index):
        bpy.ops.view3d.view_persportho()


def toggle_camera_view(index: int) -> None:
    with context_of(index):
        bpy.ops.view3d.view_camera()


def set_clipping(index: int, start: float, end: float) -> None:
    space = space_of(index)
    space.clip_start, space.clip_end = start, end


def set_shading(index: int, shading: str) -> None:
    space_of(index).shading.type = shading


def zoom(index: int, steps: int) -> None:
    """In by positive steps, out by negative ones."""
    with context_of(index):
        for _ in range(abs(steps)):
            bpy.ops.view3d.zoom(delta=1 if steps > 0 else -1)


def count() -> int:
    return len(places())
