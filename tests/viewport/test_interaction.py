# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever a user does, the viewport ends with the picture that a final frame of that state has."""

import numpy as np
import pytest
from checks import assert_other, assert_same, final_picture, settle, settled_picture
from interaction import orbit


def test_orbit(window):
    """Turning the view by the mouse would leave an old or a coarse picture."""
    before = final_picture(window)
    orbit(window)
    assert_other(final_picture(window), before)


def test_roughness(window):
    """A slider of a material would change nothing, or not what F12 shows."""
    before = settled_picture(window)
    for roughness in np.linspace(0.25, 0.6, 8):
        window.call("edits.set_roughness", "Monkey", float(roughness))
    assert_other(final_picture(window), before)


def test_settings(window):
    """What a script sets would be seen only once the user moves something."""
    before = settled_picture(window)
    window.call("edits.set_setting", "filter_width", 10.0)
    other = final_picture(window)
    assert_other(other, before)
    window.call("edits.set_material_setting", "Monkey", "absorption_density", 10.0)
    assert_other(final_picture(window), other)


def test_move_and_undo(window):
    """Objects would stay where they were, or where undo has taken them from."""
    before = settled_picture(window)
    window.call("edits.move", "Monkey", -0.5, 0.0, 0.3)
    window.call("edits.push_undo", "Move")
    moved = final_picture(window)
    assert_other(moved, before)
    window.call("edits.undo")
    assert_same(final_picture(window), before)
    window.call("edits.redo")
    assert_same(final_picture(window), moved)


def test_solid_after_undo(strict_window):
    """Blender 3.4 would crash in the Solid viewport: undo frees what is needed to subdivide objects. Of many,
    as the memory of some is taken by something else that may do."""
    copies = range(1, 9)
    for _ in copies:
        strict_window.call("edits.add_copy", "Monkey", 0.0, 0.0, 0.0)
    strict_window.call("edits.push_undo", "Add")
    settle(strict_window)
    for number in copies:
        strict_window.call("edits.move", f"Monkey.{number:03}", 0.0, 0.0, 0.05 * number)
    strict_window.call("edits.push_undo", "Move")
    strict_window.call("edits.undo")
    settle(strict_window)
    strict_window.call("viewports.set_shading", 0, 'SOLID')
    strict_window.call("viewports.set_shading", 0, 'RENDERED')
    final_picture(strict_window)


def test_edit_mode(window):
    """The mesh would be shown as it was before edit mode, within it or after it."""
    before = settled_picture(window)
    window.call("edits.select", "Sphere")
    window.call("edits.set_mode", 'EDIT')
    window.call("edits.stretch_mesh", 1.8)
    edited = final_picture(window)
    assert_other(edited, before)
    window.call("edits.set_mode", 'OBJECT')
    assert_same(final_picture(window), edited)


def test_two_viewports(window):
    """A second viewport would show the first one's view, or take its pictures away."""
    window.call("viewports.split")
    settle(window)
    orbit(window, index=1, across=0.4)
    pictures = [final_picture(window, index) for index in (0, 1)]
    assert pictures[0].shape != pictures[1].shape
    window.call("edits.move", "Monkey", 0.0, 0.0, 0.5)
    for index in (0, 1):
        assert_other(final_picture(window, index), pictures[index])
    window.call("viewports.leave_one")
    final_picture(window)
    assert window.call("viewports.live") == 1


def test_quad_view(window):
    """Of the four views some would stay empty, or all show the same."""
    window.call("viewports.toggle_quad_view", 0)
    settle(window)
    views = window.call("viewports.states")
    assert len(views) == 4
    for index in range(4):
        final_picture(window, index)
    window.call("viewports.toggle_quad_view", 0)
    final_picture(window)
    assert window.call("viewports.live") == 1


@pytest.mark.parametrize("engine", ['BLENDER_WORKBENCH', 'EEVEE'])
def test_other_engine_and_back(window, engine):
    """Comparing engines would cost the viewport."""
    before = settled_picture(window)
    window.call("edits.set_engine", engine)
    window.call("edits.move", "Monkey", -0.3, 0.0, 0.0)
    window.call("agent.ready")
    window.call("edits.set_engine", 'VERGLAS')
    assert_other(final_picture(window), before)


def test_load(window, tmp_path):
    """Opening a file would leave the picture of the one before, or none."""
    path = str(tmp_path / "saved.blend")
    saved = settled_picture(window)
    window.call("edits.save", path)
    window.call("edits.set_roughness", "Monkey", 0.7)
    assert_other(settled_picture(window), saved)
    window.call("edits.load", path)
    assert_same(final_picture(window), saved)


def test_local_view(window):
    """Objects out of the local view would still be there, or be missing after it."""
    before = settled_picture(window)
    window.call("edits.select", "Sphere")
    window.call("edits.toggle_local_view")
    assert_other(final_picture(window), before)
    window.call("edits.toggle_local_view")
    assert_same(final_picture(window), before)


def test_orthographic(window):
    """Numpad 5 would show a perspective picture."""
    before = settled_picture(window)
    window.call("viewports.toggle_orthographic", 0)
    assert_other(final_picture(window), before)


def test_clipping(window):
    """What is nearer than Clip Start, or farther than Clip End, would be there."""
    before = settled_picture(window)
    window.call("viewports.set_clipping", 0, 4.4, 1000.0)
    cut = final_picture(window)
    assert_other(cut, before)
    window.call("viewports.set_clipping", 0, 0.01, 4.4)
    assert_other(final_picture(window), cut)


def test_transparent_film(window):
    """The world would hide what stands behind the picture, or the glass be transparent, too."""
    before = settled_picture(window)
    window.call("edits.set_transparent", True)
    picture = final_picture(window)
    assert_other(picture, before)
    assert picture[..., 3].min() == 0.0 and picture[..., 3].max() == 1.0


def test_change_before_the_last_sample(window):
    """What is changed before the picture is finished would come late, or mix with what was before."""
    before = settled_picture(window)
    samples = window.call("edits.set_setting", "viewport_samples", 4096)
    for roughness in (0.3, 0.5, 0.7):
        shown = window.call("viewports.states")[0][1]
        window.call("edits.set_roughness", "Monkey", roughness)
        orbit(window, moves=2)
        window.wait_until(lambda: window.call("viewports.states")[0][1] >= shown + 2, "a picture", 5.0)
    window.call("edits.set_setting", "viewport_samples", samples)
    assert_other(final_picture(window), before)


def test_camera_view_and_border(window):
    """The camera's picture would be larger, smaller or elsewhere than its frame, or go beyond the render
    border."""
    before = settled_picture(window)
    window.call("viewports.toggle_camera_view", 0)
    whole = final_picture(window)
    assert_other(whole, before)
    window.call("edits.set_border", 0.25, 0.3, 0.7, 0.8)
    picture = settled_picture(window)
    left, bottom, right, top = window.call("viewports.border", 0)
    assert_same(picture, whole[bottom:top, left:right])


def test_selection(window):
    """The picture would turn coarse at each click, and be made again."""
    settle(window)
    before = window.call("viewports.states")
    window.call("edits.select", "Sphere")
    settle(window)
    assert window.call("viewports.states") == before
