# SPDX-License-Identifier: GPL-3.0-or-later
"""What to do first, in the status bar, while the Pose tool is active and there are no pins."""

from __future__ import annotations

import bpy

from ...scene.objects.cutout_object import pose_refusal
from ...scene.pins.pin_list import has_pins
from .tool_state import pose_tool_is_active

CLASSES = ()


def _draw(header: bpy.types.Header, context: bpy.types.Context) -> None:
    if not pose_tool_is_active(context) or has_pins(context.object):
        return
    reason = pose_refusal(context.object)
    text = "Ctrl-click the drawing to add a pin, then drag it" if reason is None else reason
    header.layout.label(text=text, icon="INFO")


def register() -> None:
    bpy.types.STATUSBAR_HT_header.prepend(_draw)


def unregister() -> None:
    bpy.types.STATUSBAR_HT_header.remove(_draw)
