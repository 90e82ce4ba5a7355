# SPDX-License-Identifier: GPL-3.0-or-later
"""Which device renders what: 'OPENGL', the paper's passes in screen space, or 'CPU', traced bundles. It needs
no core, so that panels can ask where that doesn't load."""

import bpy

SOFTWARE = ("llvmpipe", "softpipe", "swrast", "software rasterizer")
"""What tells an OpenGL driver that computes on the CPU: part of its name, also where another one wraps it."""

automatic: str | None = None
"""What 'AUTO' stands for on this machine; None until the renderer has asked the driver."""


def is_software(driver: str) -> bool:
    """Whether an OpenGL driver of this name computes on the CPU."""
    return any(part in driver.lower() for part in SOFTWARE)


def of_viewport(scene: bpy.types.Scene) -> str:
    """'OPENGL', 'CPU' or 'AUTO'."""
    return scene.verglas.device


def of_final_frames(scene: bpy.types.Scene) -> str:
    """'OPENGL', 'CPU' or 'AUTO'; of those in real time."""
    return 'CPU' if scene.verglas.traced_final else scene.verglas.device


def in_use(scene: bpy.types.Scene) -> set[str]:
    """'OPENGL', 'CPU' or both: those whose settings matter. Both as long as it isn't known what 'AUTO' is."""
    chosen = {of_viewport(scene)}
    if scene.verglas.method == 'REAL_TIME':
        chosen.add(of_final_frames(scene))
    if 'AUTO' in chosen:
        chosen.remove('AUTO')
        chosen |= {automatic} if automatic else {'OPENGL', 'CPU'}
    return chosen
