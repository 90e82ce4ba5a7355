# SPDX-License-Identifier: GPL-3.0-or-later
"""What the times were measured on, and of what."""

import os
import platform
import subprocess
from pathlib import Path

import bpy
from verglas import renderer
from verglas import verglas_core as core

REPOSITORY = Path(__file__).resolve().parents[2]


def describe() -> dict[str, str | int | None]:
    return {"cpu": _cpu(), "cores": len(os.sched_getaffinity(0)), "opengl": renderer.opengl_name(),
            "blender": bpy.app.version_string, "verglas": core.__version__, "commit": _commit()}


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def _commit() -> str | None:
    """With '-dirty' where files differ from it; None outside of a checkout, or without git."""
    command = ["git", "-C", str(REPOSITORY), "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
    try:
        done = subprocess.run(command, capture_output=True, text=True)
    except OSError:
        return None
    return done.stdout.strip() or None
