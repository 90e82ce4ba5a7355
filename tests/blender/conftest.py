# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of the tests that run inside Blender."""

import bpy
import pytest
from scenes import add_camera, empty_scene


def pytest_addoption(parser):
    parser.addoption("--all", action="store_true", help="run the slow tests too")


def pytest_configure(config):
    config.addinivalue_line("markers", "slow: takes minutes; runs only with --all")


def pytest_collection_modifyitems(config, items):
    if not config.getoption("--all"):
        for item in items:
            if "slow" in item.keywords:
                item.add_marker(pytest.mark.skip(reason="slow; runs with --all"))


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
