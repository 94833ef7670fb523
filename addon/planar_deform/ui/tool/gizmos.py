# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins under the mouse, and the ring that turns them: gizmos that light up and start a drag when pressed."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Matrix, Vector

from ...model.plane.frame import Array
from ...preferences import looks
from ...scene.pins.pin_list import is_joint
from ...scene.view import snapshot
from ...scene.view.mouse import REACH, RING, Ring, on_ring, pin_at, pin_under, pixels_to, ring_about
from ...scene.view.snapshot import PinPlace
from ..draw import marks
from .tool_state import pose_tool_is_active

SHOWN_GAP = 3.0  # pixels from its target below which a pin counts as there
BESIDE_KNOB = 24.0  # pixels from the ring to the angle written beside it


class PLANAR_GT_pin(bpy.types.Gizmo):
    bl_idname = "PLANAR_GT_pin"

    __slots__ = ("all_marks", "mark", "pressed")
    all_marks: list[PinPlace]  # where all pins of the view are
    mark: PinPlace | None  # where it is now, if anywhere
    pressed: bpy.types.OperatorProperties  # of what a press on it begins

    def test_select(self, context: bpy.types.Context, location: Sequence[float]) -> int:
        """Whether the mouse is on this pin and on no other one more closely."""
        if self.mark is None:
            return -1
        own = _distance(context, self.mark.place, location)
        if own > REACH * context.preferences.system.ui_scale:
            return -1
        nearer = (_distance(context, mark.place, location) < own for mark in self.all_marks)
        return -1 if any(nearer) else 0

    def draw(self, context: bpy.types.Context) -> None:
        pin = None if self.mark is None else pin_at(self.mark)
        if self.mark is None or pin is None:
            return
        mark, active = self.mark, context.object is not None and self.mark.owner == context.object.name
        region, view = context.region, context.region_data
        place = location_3d_to_region_2d(region, view, Vector(mark.place))
        if place is None:
            return
        scale, wanted = context.preferences.system.ui_scale, looks()
        fill: marks.Colour = wanted.selected if pin.select else wanted.pin
        if not pin.enabled:
            fill = tuple(0.5 * (a + b) for a, b in zip(fill, marks.OFF, strict=True))
        state = {"lit": self.is_highlight, "active": active and pin.id_data.planar.active_pin == mark.key}
        with marks.pixels(region):
            target = location_3d_to_region_2d(region, view, Vector(mark.target))
            if target is not None and (target - place).length > SHOWN_GAP * scale:
                marks.draw_gap(place, target, scale)
            scale *= wanted.size / marks.RADIUS
            if pin.lattice_point >= 0:
                marks.draw_lattice_point(place, scale, fill, **state)
            elif is_joint(pin):
                marks.draw_joint(place, scale, fill, rigid=pin.kind == "WELD", **state)
            elif pin.kind == "PATCH":
                marks.draw_patch(place, _seen(context, mark.place, mark.turned), scale, fill, **state)
            else:
                marks.draw_point(place, scale, fill, **state)


class PLANAR_GT_ring(bpy.types.Gizmo):
    bl_idname = "PLANAR_GT_ring"

    __slots__ = ("all_marks", "ring")
    all_marks: list[PinPlace]  # where all pins of the view are
    ring: Ring | None  # what the ring is about, if anything

    def test_select(self, context: bpy.types.Context, location: Sequence[float]) -> int:
        """Whether the mouse is on the ring of what can be turned and on no pin."""
        if self.ring is None or not self.ring.turns:
            return -1
        region, view = context.region, context.region_data
        if pin_under(region, view, self.all_marks, location) is not None:
            return -1
        return 0 if on_ring(region, view, self.ring, location) else -1

    def draw(self, context: bpy.types.Context) -> None:
        if self.ring is None:
            return
        region, ring, only = context.region, self.ring, self.ring.only
        centre = location_3d_to_region_2d(region, context.region_data, Vector(ring.centre))
        if centre is None:
            return
        scale = context.preferences.system.ui_scale
        if not ring.turns:
            with marks.pixels(region):
                marks.draw_size_ring(centre, RING * scale, scale)
            return
        knob = Vector((0.0, 1.0)) if only is None else _seen(context, ring.centre, only.turned)
        with marks.pixels(region):
            marks.draw_ring(centre, RING * scale, knob, scale, lit=self.is_highlight or self.is_modal)
            if only is not None:
                x, y = centre + (RING + BESIDE_KNOB) * scale * knob
                y -= 0.35 * marks.TEXT * scale  # from the middle of the letters to their foot
                marks.draw_text(x, y, f"{math.degrees(only.angle):.1f}°", scale, centred=True)


class PLANAR_GGT_pins(bpy.types.GizmoGroup):
    bl_idname = "PLANAR_GGT_pins"
    bl_label = "Pins"
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    bl_options = {"3D", "SCALE", "PERSISTENT", "SHOW_MODAL_ALL"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return pose_tool_is_active(context)

    def setup(self, context: bpy.types.Context) -> None:
        self.all_marks: list[PinPlace] = []
        self.pins: dict[tuple[int, int], PLANAR_GT_pin] = {}  # by their object's session_uid and their index
        self.ring = self.gizmos.new(PLANAR_GT_ring.bl_idname)
        self.ring.all_marks = self.all_marks
        self.ring.target_set_operator("planar.rotate_pins").release_confirm = True
        self.ring.use_draw_modal = True
        self._match(context)

    def refresh(self, context: bpy.types.Context) -> None:
        self._match(context)

    def draw_prepare(self, context: bpy.types.Context) -> None:
        self._match(context)

    def _match(self, context: bpy.types.Context) -> None:
        """A gizmo for each pin, where the pin is, and the ring. What is left over is hidden, not removed: the
        one under the mouse may be among them. While the timeline plays nothing is read for them: a large mesh
        would slow it down."""
        self.all_marks[:] = [] if context.screen.is_animation_playing else snapshot.pins_in_view(context)
        listed = [(pin, mark) for mark in self.all_marks if (pin := pin_at(mark)) is not None]
        found = {(pin.id_data.session_uid, mark.key): mark for pin, mark in listed}
        for number in found:
            if number not in self.pins:
                self.pins[number] = self._new(number[1])
        for number, gizmo in self.pins.items():
            gizmo.mark = mark = found.get(number)
            gizmo.hide = mark is None
            if mark is not None:
                gizmo.matrix_basis = Matrix.Translation(Vector(mark.place))
                if gizmo.pressed.object != mark.owner:
                    gizmo.pressed.object = mark.owner
        self.ring.ring = ring = ring_about(self.all_marks)
        self.ring.hide = ring is None
        if ring is not None:
            self.ring.matrix_basis = Matrix.Translation(Vector(ring.centre))

    def _new(self, pin: int) -> PLANAR_GT_pin:
        gizmo: PLANAR_GT_pin = self.gizmos.new(PLANAR_GT_pin.bl_idname)
        gizmo.all_marks = self.all_marks
        gizmo.pressed = gizmo.target_set_operator("planar.drag_pins")
        gizmo.pressed.pin = pin
        gizmo.use_draw_modal = True
        return gizmo


def _distance(context: bpy.types.Context, place: Array, mouse: Sequence[float]) -> float:
    """How many pixels the mouse is from a place in the world."""
    return pixels_to(context.region, context.region_data, place, mouse)


def _seen(context: bpy.types.Context, place: Array, direction: Array) -> Vector:
    """Where a direction at a place in the world points on the screen, with length 1."""
    region, view = context.region, context.region_data
    start = location_3d_to_region_2d(region, view, Vector(place))
    end = location_3d_to_region_2d(region, view, Vector(place + 0.01 * view.view_distance * direction))
    points = start is not None and end is not None and end != start
    return (end - start).normalized() if points else Vector((1.0, 0.0))


CLASSES = (PLANAR_GT_pin, PLANAR_GT_ring, PLANAR_GGT_pins)


def unregister() -> None:
    marks.forget()
