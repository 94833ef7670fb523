# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins under the mouse: each one is a gizmo that lights up and starts a drag when it is pressed."""

from __future__ import annotations

import bpy
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Matrix, Vector

from ..scene import snapshot
from ..scene.view import REACH, pixels_to
from . import marks
from .tool_state import pose_tool_is_active

SHOWN_GAP = 3.0  # pixels from its target below which a pin counts as there


class PLANAR_GT_pin(bpy.types.Gizmo):
    bl_idname = "PLANAR_GT_pin"

    # The pin's index; where it is now, if anywhere; and where all pins of the view are.
    __slots__ = ("all_marks", "key", "mark")

    def test_select(self, context, location):
        """Whether the mouse is on this pin and on no other one more closely."""
        if self.mark is None:
            return -1
        own = _distance(context, self.mark, location)
        if own > REACH * context.preferences.system.ui_scale:
            return -1
        nearer = (_distance(context, mark, location) < own for mark in self.all_marks)
        return -1 if any(nearer) else 0

    def draw(self, context):
        settings = context.object.planar
        if self.mark is None or self.key >= len(settings.pins):
            return
        pin, mark = settings.pins[self.key], self.mark
        region, view = context.region, context.region_data
        place = location_3d_to_region_2d(region, view, Vector(mark.place))
        if place is None:
            return
        scale = context.preferences.system.ui_scale
        fill = marks.SELECTED if pin.select else marks.PLAIN
        if not pin.enabled:
            fill = tuple(0.5 * (a + b) for a, b in zip(fill, marks.OFF, strict=True))
        state = {"lit": self.is_highlight, "active": settings.active_pin == self.key}
        with marks.pixels(region):
            target = location_3d_to_region_2d(region, view, Vector(mark.target))
            if target is not None and (target - place).length > SHOWN_GAP * scale:
                marks.draw_gap(place, target, scale)
            if pin.kind == "PATCH":
                arm = Vector(mark.place + 0.01 * view.view_distance * mark.turned)
                ahead = location_3d_to_region_2d(region, view, arm)
                turned = ahead - place if ahead is not None else Vector((1.0, 0.0))
                marks.draw_patch(place, turned, scale, fill, **state)
            else:
                marks.draw_point(place, scale, fill, **state)


class PLANAR_GGT_pins(bpy.types.GizmoGroup):
    bl_idname = "PLANAR_GGT_pins"
    bl_label = "Pins"
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    bl_options = {"3D", "SCALE", "PERSISTENT", "SHOW_MODAL_ALL"}

    @classmethod
    def poll(cls, context):
        return pose_tool_is_active(context)

    def setup(self, context):
        self.all_marks = []
        self._match(context)

    def refresh(self, context):
        self._match(context)

    def draw_prepare(self, context):
        self._match(context)

    def _match(self, context):
        """A gizmo for each pin, where the pin is. What is left over is hidden, not removed: the one under the
        mouse may be among them."""
        seen = snapshot.of_active(context)
        self.all_marks[:] = [] if seen is None else seen.pins
        found = {mark.key: mark for mark in self.all_marks}
        while len(self.gizmos) <= max(found, default=-1):
            gizmo = self.gizmos.new(PLANAR_GT_pin.bl_idname)
            gizmo.key, gizmo.all_marks = len(self.gizmos) - 1, self.all_marks
            gizmo.target_set_operator("planar.drag_pins").pin = gizmo.key
            gizmo.use_draw_modal = True
        for gizmo in self.gizmos:
            gizmo.mark = found.get(gizmo.key)
            gizmo.hide = gizmo.mark is None
            if gizmo.mark is not None:
                gizmo.matrix_basis = Matrix.Translation(Vector(gizmo.mark.place))


def _distance(context, mark, mouse):
    """How many pixels the mouse is from a pin."""
    return pixels_to(context.region, context.region_data, mark.place, mouse)


CLASSES = (PLANAR_GT_pin, PLANAR_GGT_pins)


def unregister() -> None:
    marks.forget()
