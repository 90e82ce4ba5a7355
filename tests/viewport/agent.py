# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside the Blender of blender_window.py: a timer takes calls from a channel and answers them."""

import faulthandler
import importlib
import signal
import socket
import sys
import traceback

import addon_utils
import bpy
from channel import Channel

WAIT_SECONDS = 0.005
"""As long as Blender sleeps where it has no events; it doesn't where they are simulated."""

_rest_seconds = 0.0


def ready() -> None:
    """Answered as soon as the event loop runs."""


def rest(seconds: float) -> None:
    """No call is looked for as long, so that Blender does only what it does by itself."""
    global _rest_seconds
    _rest_seconds = seconds


def quit() -> None:
    bpy.ops.wm.quit_blender()


def _serve(channel: Channel) -> float:
    """Answers at most one call, so that Blender handles and draws what it has changed before the next one.
    Returns the seconds until it wants to be called again."""
    global _rest_seconds
    try:
        if channel.poll(WAIT_SECONDS):
            channel.send(_answer(*channel.receive()))
    except (EOFError, OSError):  # the caller is gone
        quit()
    pause, _rest_seconds = _rest_seconds, 0.0
    return pause


def _answer(function: str, arguments: tuple) -> tuple[bool, object]:
    module, _, name = function.rpartition(".")
    try:
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            return True, getattr(importlib.import_module(module), name)(*arguments)
    except Exception:
        return False, traceback.format_exc()


def start(descriptor: int) -> None:
    """descriptor: of the socket that calls come from."""
    faulthandler.register(signal.SIGUSR1)
    if addon_utils.enable("verglas") is None:
        sys.exit("The add-on 'verglas' isn't installed in this Blender, or can't be enabled.")
    bpy.context.preferences.view.show_splash = False
    channel = Channel(socket.socket(fileno=descriptor))
    bpy.app.timers.register(lambda: _serve(channel), persistent=True)
