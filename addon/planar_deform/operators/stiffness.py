# SPDX-License-Identifier: GPL-3.0-or-later
"""Painting stiffness with Blender's own Weight Paint."""

from __future__ import annotations

import bpy

from ..scene import pins, stiffness
from ..scene.access import Refusal, begin
from .posing_operator import PosingOperator


class PLANAR_OT_paint_stiffness(PosingOperator, bpy.types.Operator):
    bl_idname = "planar.paint_stiffness"
    bl_label = "Paint Stiffness"
    bl_description = (
        "Paint where the drawing is stiff (a weight of 1) and where it is soft (0), in Weight Paint. Makes "
        "the vertex group if there is none"
    )

    def apply(self, context):
        obj = context.object
        if not obj.visible_get():
            raise Refusal(f"'{obj.name}' is hidden: show it to paint on it")
        begin(context)  # a mesh that cannot be posed needs no stiffness
        pins.sync(obj)
        group = stiffness.ensure_group(obj)
        pins.sync(obj)
        obj.vertex_groups.active_index = group.index
        bpy.ops.object.mode_set(mode="WEIGHT_PAINT")


CLASSES = (PLANAR_OT_paint_stiffness,)
