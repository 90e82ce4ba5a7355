# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of the tests that run inside Blender."""

import bpy
import pytest
from scenes import add_camera, empty_scene


@pytest.fixture
def scene() -> bpy.types.Scene:
    """An empty file: 64 x 48 pixels, one sample, black world, a camera that looks along +Y at the origin."""
    scene = empty_scene()
    add_camera(scene)
    return scene


@pytest.fixture(params=['OPENGL', 'CPU'])
def device(request, scene) -> str:
    """Runs a test by each device."""
    scene.verglas.device = request.param
    return request.param


@pytest.fixture
def warned() -> list[str]:
    """A list whose append is what the sync functions take to warn."""
    return []
