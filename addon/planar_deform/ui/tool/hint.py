# SPDX-License-Identifier: GPL-3.0-or-later
"""What to do in the status bar while the Pose tool is active: first, with no pins, and after a miss."""

from __future__ import annotations

import bpy

from ...scene.lattice.posed import posing_refusal
from ...scene.objects.modifiers import lattices_of
from ...scene.pins.taking_part import control_in_hand, with_pins
from ...scene.telling import said
from ..draw.in_views import InViews
from .tool_state import pose_tool_is_active

CLASSES = ()

FIRST = "Ctrl-click the drawing to add a pin, then drag it"
ON_LATTICE = "Ctrl-click what the lattice deforms, or one of its points, to add a pin, then drag it"

_shown: dict[int, str] = {}  # by a window's address: what its status bar has been drawn with


def _text(context: bpy.types.Context) -> str:
    if not pose_tool_is_active(context):
        return ""
    obj = context.object
    if said() or with_pins(context):
        return said()
    lattices = [] if obj is None else lattices_of(obj)
    if lattices:
        return (
            f"'{obj.name}' hangs in '{lattices[0].name}': select that, and its pins pose all that hangs there"
        )
    return control_in_hand(context) or posing_refusal(obj) or (ON_LATTICE if obj.type == "LATTICE" else FIRST)


def _draw(header: bpy.types.Header, context: bpy.types.Context) -> None:
    text = _text(context)
    if text:
        header.layout.label(text=text, icon="INFO")


def _watch() -> None:
    """Whatever brings or takes the hint redraws a 3D view, and nothing else tells the status bar."""
    context = bpy.context
    if context.window is None:
        return  # drawn into a picture
    window, text = context.window.as_pointer(), _text(context)
    if _shown.get(window, "") != text:
        _shown[window] = text
        context.workspace.status_text_set(None)  # there is no other way to have it drawn anew


_drawn = InViews(_watch, "POST_PIXEL")


def register() -> None:
    bpy.types.STATUSBAR_HT_header.prepend(_draw)
    _drawn.on()


def unregister() -> None:
    _drawn.off()
    bpy.types.STATUSBAR_HT_header.remove(_draw)
    _shown.clear()
