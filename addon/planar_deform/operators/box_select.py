# SPDX-License-Identifier: GPL-3.0-or-later
"""Selecting pins by a box."""

from __future__ import annotations

import bpy

from ..scene.view import snapshot
from ..scene.view.mouse import hidden_refusal, pin_at, pins_within
from .modal.gesture_run import GestureOperator, GestureRun
from .modal.session import PASSED_ON
from .pins import PinListOperator

KEYS = "Drag a Box: Select   Shift or MMB: Deselect   Esc or RMB: Cancel"
BUTTONS = ("LEFTMOUSE", "MIDDLEMOUSE")


class PLANAR_OT_box_select_pins(GestureOperator, PinListOperator, bpy.types.Operator):
    bl_idname = "planar.box_select_pins"
    bl_label = "Box Select Pins"
    bl_description = "Select the pins in a box, with Shift deselect them; the others stay as they are"
    bl_options = {"UNDO"}

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        reason = super().refusal(context) or hidden_refusal(context)
        return reason or (None if context.region_data else "Pins are selected in a 3D view: start it there")

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        self._start: tuple[float, float] | None = None
        self._button = ""
        self._run = GestureRun(context, KEYS, "CROSSHAIR")
        self._show(context, event)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def handle(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if event.type in BUTTONS and event.value == "PRESS" and self._start is None:
            self._start, self._button = _place(event), event.type
        elif self._start is not None and event.type == self._button and event.value == "RELEASE":
            return self._select(context, event, self._start)
        elif event.type.startswith(PASSED_ON):
            return {"PASS_THROUGH"}
        self._show(context, event)
        return {"RUNNING_MODAL"}

    def _select(
        self, context: bpy.types.Context, event: bpy.types.Event, start: tuple[float, float]
    ) -> set[str]:
        shown = snapshot.pins_in_view(context)
        inside = pins_within(context.region, context.region_data, shown, start, _place(event))
        wanted = not event.shift and self._button == "LEFTMOUSE"
        pins = (pin_at(place) for place in inside)
        changed = [pin for pin in pins if pin is not None and pin.select != wanted]
        for pin in changed:
            pin.select = wanted
        return {"FINISHED"} if changed else {"CANCELLED"}

    def _show(self, context: bpy.types.Context, event: bpy.types.Event) -> None:
        (x, y), region = _place(event), context.region
        if self._start is None:
            self._run.show(context, [((x, 0), (x, region.height)), ((0, y), (region.width, y))])
        else:
            a, b = self._start
            self._run.show(context, [((a, b), (x, b), (x, y), (a, y), (a, b))])


def _place(event: bpy.types.Event) -> tuple[float, float]:
    return event.mouse_region_x, event.mouse_region_y


CLASSES = (PLANAR_OT_box_select_pins,)
