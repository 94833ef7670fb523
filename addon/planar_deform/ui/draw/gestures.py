# SPDX-License-Identifier: GPL-3.0-or-later
"""The box or circle that the mouse draws while it chooses."""

from __future__ import annotations

import bpy

from ...scene.view import gesture
from . import marks

CLASSES = ()

_handle: object | None = None


def _draw() -> None:
    context = bpy.context
    shown = gesture.now(context.region)
    if shown is None:
        return
    with marks.pixels(context.region):
        for strip in shown.strips:
            marks.draw_strip(strip, context.preferences.system.ui_scale)


def register() -> None:
    global _handle
    _handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")


def unregister() -> None:
    global _handle
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
    _handle = None
