# SPDX-License-Identifier: GPL-3.0-or-later
"""Clicks of the Pose tool that hit no pin."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty
from mathutils import Vector

from ..errors import Refusal
from ..model.plane.frame import Array
from ..scene.objects.cutout_object import begin
from ..scene.view import snapshot
from ..scene.view.mouse import on_ring, pin_under, ray, ring_about


class PLANAR_OT_click(bpy.types.Operator):
    bl_idname = "planar.click"
    bl_label = "Click in the Pose Tool"
    bl_description = "Make the mesh under the mouse active, deselect all pins, or add a pin"
    # No undo step of its own: what it does has one, under its own name.
    bl_options = {"INTERNAL"}

    add: BoolProperty(name="Add", description="Add a pin under the mouse", options={"SKIP_SAVE"})
    extend: BoolProperty(name="Extend", description="Keep what is selected", options={"SKIP_SAVE"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        region, view = context.region, context.region_data
        if view is None:
            return {"PASS_THROUGH"}
        mouse = (event.mouse_region_x, event.mouse_region_y)
        seen = snapshot.in_view(context)
        if seen is not None and not self.add:
            # Neither gizmo has lit up where the event that ended a drag's settling comes right here.
            pin = pin_under(region, view, seen.pins, mouse)
            if pin is not None:
                bpy.ops.planar.drag_pins("INVOKE_DEFAULT", True, pin=pin)
                return {"FINISHED"}
            ring = ring_about(context.object, seen.pins)
            if ring is not None and on_ring(region, view, ring, mouse):
                bpy.ops.planar.rotate_pins("INVOKE_DEFAULT", True, release_confirm=True)
                return {"FINISHED"}
        origin, direction = ray(region, view, mouse)
        if self.add:
            return self._add(context, origin, direction)
        other = _object_under(context, origin, direction)
        if other is not None and other != context.object:
            return self._activate(context, other)
        obj = context.object
        if not self.extend and obj is not None and any(pin.select for pin in obj.planar.pins):
            bpy.ops.planar.select_pins("EXEC_DEFAULT", True, action="NONE")
        return {"FINISHED"}

    def _add(self, context: bpy.types.Context, origin: Array, direction: Array) -> set[str]:
        try:
            drawing = begin(context)
            point = drawing.pick(origin, direction)
            if point is None:
                raise Refusal(
                    f"'{drawing.object_name}' is not under the mouse: click a layer to make it active"
                )
        except Refusal as refusal:
            self.report({"WARNING"}, str(refusal))
            return {"CANCELLED"}
        corners = drawing.cutout.triangles[point.triangle]
        place = point.weights[None, :] @ drawing.positions[corners]
        place = drawing.to_world(place, drawing.cutout.parts[corners[:1]])
        bpy.ops.planar.add_pin("EXEC_DEFAULT", True, location=place[0].tolist())
        return {"FINISHED"}

    def _activate(self, context: bpy.types.Context, obj: bpy.types.Object) -> set[str]:
        if not self.extend:
            for selected in context.selected_objects:
                selected.select_set(False)
        obj.select_set(True)
        context.view_layer.objects.active = obj
        bpy.ops.ed.undo_push(message="Select")
        return {"FINISHED"}


def _object_under(context: bpy.types.Context, start: Array, towards: Array) -> bpy.types.Object | None:
    """The first selectable object that a ray meets."""
    origin, direction = Vector(start), Vector(towards)
    depsgraph = context.evaluated_depsgraph_get()
    for _ in context.scene.objects:
        hit, place, _normal, _index, obj, _matrix = context.scene.ray_cast(depsgraph, origin, direction)
        if not hit:
            return None
        if not obj.original.hide_select and obj.original.visible_get(viewport=context.space_data):
            return obj.original
        origin = place + direction * 1e-4
    return None


CLASSES = (PLANAR_OT_click,)
