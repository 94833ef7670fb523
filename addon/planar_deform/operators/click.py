# SPDX-License-Identifier: GPL-3.0-or-later
"""Clicks of the Pose tool that hit no pin."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.props import BoolProperty
from bpy_extras.view3d_utils import region_2d_to_origin_3d, region_2d_to_vector_3d
from mathutils import Vector

from ..scene.access import Refusal, begin


class PLANAR_OT_click(bpy.types.Operator):
    bl_idname = "planar.click"
    bl_label = "Click in the Pose Tool"
    bl_description = "Make the mesh under the mouse active, deselect all pins, or add a pin"
    # No undo step of its own: what it does has one, under its own name.
    bl_options = {"INTERNAL"}

    add: BoolProperty(name="Add", description="Add a pin under the mouse", options={"SKIP_SAVE"})
    extend: BoolProperty(name="Extend", description="Keep what is selected", options={"SKIP_SAVE"})

    def invoke(self, context, event):
        region, view = context.region, context.region_data
        if view is None:
            return {"PASS_THROUGH"}
        mouse = (event.mouse_region_x, event.mouse_region_y)
        origin = region_2d_to_origin_3d(region, view, mouse)
        direction = region_2d_to_vector_3d(region, view, mouse)
        if self.add:
            return self._add(context, origin, direction)
        other = _object_under(context, origin, direction)
        if other is not None and other != context.object:
            return self._activate(context, other)
        obj = context.object
        if not self.extend and obj is not None and any(pin.select for pin in obj.planar.pins):
            bpy.ops.planar.select_pins("EXEC_DEFAULT", True, action="NONE")
        return {"FINISHED"}

    def _add(self, context, origin, direction):
        try:
            scene = begin(context)
            point = scene.pick(np.array(origin, dtype=np.float64), np.array(direction, dtype=np.float64))
            if point is None:
                raise Refusal(
                    f"'{scene.object_name}' is not under the mouse: click a layer to make it active"
                )
        except Refusal as refusal:
            self.report({"WARNING"}, str(refusal))
            return {"CANCELLED"}
        corners = scene.cutout.triangles[point.triangle]
        place = point.weights[None, :] @ scene.positions[corners]
        place = scene.to_world(place, scene.cutout.parts[corners[:1]])
        bpy.ops.planar.add_pin("EXEC_DEFAULT", True, location=place[0].tolist())
        return {"FINISHED"}

    def _activate(self, context, obj):
        if not self.extend:
            for selected in context.selected_objects:
                selected.select_set(False)
        obj.select_set(True)
        context.view_layer.objects.active = obj
        bpy.ops.ed.undo_push(message="Select")
        return {"FINISHED"}


def _object_under(context: bpy.types.Context, origin: Vector, direction: Vector) -> bpy.types.Object | None:
    """The first selectable object that a ray meets."""
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
