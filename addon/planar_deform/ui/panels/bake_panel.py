# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking, in the sidebar tab."""

from __future__ import annotations

import bpy

from ...scene.motion import point_cache
from ...scene.motion.bake import FORMS
from ...scene.sequence import pose_state
from .tab import PlanarPanel

ICONS = {
    "SHAPES": "SHAPEKEY_DATA",
    "POINT_CACHE": "FILE_CACHE",
    "RELATIVE_KEYS": "EXPORT",
}


class PLANAR_PT_bake(PlanarPanel, bpy.types.Panel):
    bl_label = "Bake"
    bl_parent_id = "PLANAR_PT_poses"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 1

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.object
        return obj is not None and (pose_state.has_blocks(obj) or point_cache.modifier_of(obj) is not None)

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        column = layout.column(align=True)
        for form, name, _ in FORMS:
            column.operator("planar.bake", text=name, icon=ICONS[form]).to = form
        modifier = point_cache.modifier_of(context.object)
        if modifier is not None:
            layout.prop(modifier, "show_viewport", text="Show the Point Cache", icon="NONE")


CLASSES = (PLANAR_PT_bake,)
