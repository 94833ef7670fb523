# SPDX-License-Identifier: GPL-3.0-or-later
"""Making patches of pins by how far they reach."""

from __future__ import annotations

import math
from collections.abc import Iterator

import bpy
import numpy as np
from bpy.props import BoolProperty, FloatProperty
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector

from ..errors import Refusal
from ..model.input.numeric import Numeric
from ..model.plane.frame import Indices
from ..model.posing.patch_radius import least_radius, vertices_within
from ..model.posing.pins import Holder
from ..scene.lattice.posed import PosedObject, begin_posing
from ..scene.pins import pin_list
from ..scene.view.mouse import ray, refuse_hidden, towards
from .click import add_pin_under
from .drag import HIDDEN
from .modal import running
from .modal.gesture_run import GestureOperator, GestureRun
from .modal.plane_mouse import EDGE_ON
from .modal.session import CONFIRM, PASSED_ON, is_dragged

KEYS = "LMB or Enter: Confirm   Esc or RMB: Cancel   Digits: Type the Radius"
CORNERS = 64  # of the circle that is drawn


class PLANAR_OT_set_pin_radius(GestureOperator, bpy.types.Operator):
    """Has no poll, as the Pose tool's drags must not go on to Blender's own operators."""

    bl_idname = "planar.set_pin_radius"
    bl_label = "Set Patch Radius"
    bl_description = "Make patches of the selected pins: each holds all vertices within a radius about it"
    bl_options = {"REGISTER", "UNDO"}

    radius: FloatProperty(
        name="Radius",
        description="How far from its pin a vertex of the patch may be, as the drawing is shown",
        subtype="DISTANCE",
        unit="LENGTH",
        default=0.1,
        min=0.0,
        options={"SKIP_SAVE"},
    )
    release_confirm: BoolProperty(
        name="Confirm on Release", description="End when the mouse button is released", options=HIDDEN
    )

    def execute(self, context: bpy.types.Context) -> set[str]:
        running.end()
        try:
            drawing = begin_posing(context)
            found = [
                (holder.pin.key, self._vertices(holder, drawing)) for holder in _chosen(context, drawing)
            ]
        except Refusal as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        for key, vertices in found:
            _, held = drawing.vertices_held(vertices)
            pin_list.hold_as_patch(context.object, key, held.tolist())
        return {"FINISHED"}

    def _vertices(self, holder: Holder, drawing: PosedObject) -> Indices:
        vertices = vertices_within(holder, drawing.positions, self.radius)
        if not len(vertices):
            least = least_radius(holder, drawing.positions)
            raise Refusal(f"A patch holds several vertices: make its radius {least:.3g} or more")
        return vertices

    # ---- by mouse and keys

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if context.region_data is None:
            self.report({"ERROR"}, "A radius is dragged in a 3D view: start it there")
            return {"CANCELLED"}
        running.end()
        try:
            refuse_hidden(context)
            self._drawing = begin_posing(context, facing=towards(context.region_data))
            self._holders = list(_chosen(context, self._drawing))
            active = context.object.planar.active_pin
            self._about = next((h for h in self._holders if h.pin.key == active), self._holders[0])
            if self._distance(context, event) is None:
                raise Refusal(EDGE_ON)
        except Refusal as refusal:
            self.report({"WARNING"}, str(refusal))
            return {"CANCELLED"}
        self._press = (event.mouse_x, event.mouse_y) if self.release_confirm else None
        self._numeric = Numeric(("",))
        self._run = GestureRun(context, KEYS, "SCROLL_XY")
        if self._press is None:
            self._show(context, event)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def handle(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        self._drawing.resolve()
        pressed = event.value == "PRESS"
        if event.type == "LEFTMOUSE" and event.value == "RELEASE" and self._press is not None:
            add_pin_under(self, context, event)  # it was a click beside the pin
            return {"CANCELLED"}
        let_go = event.value == "RELEASE" and self.release_confirm
        if (event.type == "LEFTMOUSE" and (pressed or let_go)) or (event.type in CONFIRM and pressed):
            return self.execute(context)
        if event.type.startswith(PASSED_ON):
            return {"PASS_THROUGH"}
        if self._press is not None and not is_dragged(context, event, self._press):
            return {"RUNNING_MODAL"}
        self._press = None
        if pressed:
            self._numeric = self._numeric.pressed(event.type) or self._numeric
        self._show(context, event)
        return {"RUNNING_MODAL"}

    def _show(self, context: bpy.types.Context, event: bpy.types.Event) -> None:
        by_mouse = self._distance(context, event)
        if self._numeric.active:
            self.radius = self._numeric.values[0]
        elif by_mouse is not None:
            self.radius = by_mouse
        drawing = self._drawing
        counts = [len(vertices_within(holder, drawing.positions, self.radius)) for holder in self._holders]
        shown = self._numeric.shown(0) if self._numeric.active else f"{self.radius:.4f}"
        holds = "too few vertices for a patch" if 0 in counts else f"{sum(counts)} vertices"
        self._run.show(context, [self._circle(context)], f"Patch Radius: {shown}   ({holds})")

    def _distance(self, context: bpy.types.Context, event: bpy.types.Event) -> float | None:
        """Of the mouse from the pin, in the plane of the pin; None edge-on."""
        mouse = event.mouse_region_x, event.mouse_region_y
        sight = ray(context.region, context.region_data, mouse)
        point = self._drawing.plane_from_ray(*sight, self._about)
        place = self._about.place(self._drawing.positions)
        return None if point is None else math.dist(point, place[:2])

    def _circle(self, context: bpy.types.Context) -> list[tuple[float, float]]:
        """The circle of the radius about the pin, on the screen."""
        turns = np.linspace(0.0, math.tau, CORNERS + 1)
        circle = np.tile(self._about.place(self._drawing.positions), (len(turns), 1))
        circle[:, :2] += self.radius * np.stack([np.cos(turns), np.sin(turns)], axis=1)
        parts = np.full(len(circle), self._about.part, np.int32)
        seen = [
            location_3d_to_region_2d(context.region, context.region_data, Vector(corner))
            for corner in self._drawing.to_world(circle, parts)
        ]
        return [(place.x, place.y) for place in seen if place is not None]


def _chosen(context: bpy.types.Context, drawing: PosedObject) -> Iterator[Holder]:
    """The selected pins. Raises Refusal if there are none that hold something."""
    obj = context.object
    pin_list.sync(obj)
    pins = [pin for pin in pin_list.model_pins(obj, drawing) if obj.planar.pins[pin.key].select]
    pins = [pin for pin in pins if obj.planar.pins[pin.key].lattice_point < 0]
    if not pins:
        raise Refusal("No pins that hold vertices are selected: click one first")
    return (Holder(pin, drawing.cutout) for pin in pins)


CLASSES = (PLANAR_OT_set_pin_radius,)
