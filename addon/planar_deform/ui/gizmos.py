# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins under the mouse: each one is a gizmo that lights up and starts a drag when it is pressed."""

from __future__ import annotations

import bpy
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Matrix, Vector

from ..scene import snapshot
from . import marks
from .tool_state import pose_tool_is_active

REACH = 12.0  # pixels at a UI scale of 1 from the middle of a pin within which the mouse is on it
SHOWN_GAP = 3.0  # pixels from its target below which a pin counts as there


def pin_at(context: bpy.types.Context, mouse: tuple[float, float]) -> int | None:
    """The index of the pin nearest to a pixel of the region, if it is in reach."""
    seen = snapshot.of_active(context)
    if seen is None:
        return None
    best, nearest = None, REACH * context.preferences.system.ui_scale
    for pin in seen.pins:
        place = location_3d_to_region_2d(context.region, context.region_data, Vector(pin.place))
        if place is not None and (distance := (place - Vector(mouse)).length) <= nearest:
            best, nearest = pin.key, distance
    return best


class PLANAR_GT_pin(bpy.types.Gizmo):
    bl_idname = "PLANAR_GT_pin"

    __slots__ = ("key",)

    def test_select(self, context, location):
        return 0 if pin_at(context, location) == self.key else -1

    def draw(self, context):
        seen = snapshot.of_active(context)
        found = None if seen is None else seen.pin(self.key)
        if found is None or self.key >= len(context.object.planar.pins):
            return
        settings = context.object.planar
        pin = settings.pins[self.key]
        region, view = context.region, context.region_data
        place = location_3d_to_region_2d(region, view, Vector(found.place))
        if place is None:
            return
        scale = context.preferences.system.ui_scale
        fill = marks.SELECTED if pin.select else marks.PLAIN
        if not pin.enabled:
            fill = tuple(0.5 * (a + b) for a, b in zip(fill, marks.OFF, strict=True))
        state = {"lit": self.is_highlight, "active": settings.active_pin == self.key}
        with marks.pixels(region):
            target = location_3d_to_region_2d(region, view, Vector(found.target))
            if target is not None and (target - place).length > SHOWN_GAP * scale:
                marks.draw_gap(place, target, scale)
            if pin.kind == "PATCH":
                arm = Vector(found.place + 0.01 * view.view_distance * found.turned)
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
        self._match(context)

    def refresh(self, context):
        self._match(context)

    def draw_prepare(self, context):
        self._match(context)

    def _match(self, context):
        """A gizmo for each pin, where the pin is. What is left over is hidden, not removed: the one under the
        mouse may be among them."""
        seen = snapshot.of_active(context)
        places = {} if seen is None else {pin.key: pin.place for pin in seen.pins}
        while len(self.gizmos) <= max(places, default=-1):
            gizmo = self.gizmos.new(PLANAR_GT_pin.bl_idname)
            gizmo.key = len(self.gizmos) - 1
            gizmo.target_set_operator("planar.drag_pins").pin = gizmo.key
            gizmo.use_draw_modal = True
        for gizmo in self.gizmos:
            gizmo.hide = gizmo.key not in places
            if not gizmo.hide:
                gizmo.matrix_basis = Matrix.Translation(Vector(places[gizmo.key]))


CLASSES = (PLANAR_GT_pin, PLANAR_GGT_pins)


def unregister() -> None:
    marks.forget()
