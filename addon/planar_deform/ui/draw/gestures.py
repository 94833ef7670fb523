# SPDX-License-Identifier: GPL-3.0-or-later
"""The box or circle that the mouse draws while it chooses."""

from __future__ import annotations

import bpy

from ...scene.view import gesture
from . import marks
from .in_views import InViews

CLASSES = ()


def _draw() -> None:
    context = bpy.context
    shown = gesture.now(context.region)
    if shown is None:
        return
    with marks.pixels(context.region):
        for strip in shown.strips:
            marks.draw_strip(strip, context.preferences.system.ui_scale)


_drawn = InViews(_draw, "POST_PIXEL")


def register() -> None:
    _drawn.on()


def unregister() -> None:
    _drawn.off()
