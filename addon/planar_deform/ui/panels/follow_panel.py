# SPDX-License-Identifier: GPL-3.0-or-later
"""What the pins follow, in the sidebar tab."""

from __future__ import annotations

import bpy

from ...scene.motion.bake_pins import FORMS
from ...scene.pins import controls, pin_list
from .tab import PlanarPanel


class PLANAR_PT_follow(PlanarPanel, bpy.types.Panel):
    bl_label = "Follow"
    bl_parent_id = "PLANAR_PT_pins"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return pin_list.has_pins(context.object)

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.object.planar
        active = settings.pins[settings.active_pin] if 0 <= settings.active_pin < len(settings.pins) else None
        if active is not None and not pin_list.is_joint(active):
            _draw_pin(layout, active)
        row = layout.row(align=True)
        row.operator("planar.add_controls", icon="EMPTY_DATA")
        row.operator("planar.follow_bones", icon="BONE_DATA")
        if not controls.follows_any(context.object):
            return
        row = layout.row(align=True)
        row.prop(settings, "live", toggle=True)
        row.operator("planar.follow_now", icon="TRACKER")
        row = layout.row(align=True)
        for form, name, _ in FORMS:
            row.operator("planar.bake_pins", text=f"Bake {name}").to = form
        if settings.live and not context.scene.render.use_lock_interface:
            layout.prop(context.scene.render, "use_lock_interface", text="Lock Interface in Renders")


def _draw_pin(layout: bpy.types.UILayout, pin: bpy.types.PropertyGroup) -> None:
    column = layout.column()
    column.use_property_split = True
    column.use_property_decorate = False
    column.prop(pin, "follow")
    if pin.follow is None:
        return
    if pin.follow.type == "ARMATURE":
        column.prop_search(pin, "follow_bone", pin.follow.data, "bones", text="Bone")
    if pin.follow.type == "MESH":
        column.prop_search(pin, "follow_group", pin.follow, "vertex_groups", text="Place")
    row = layout.row(align=True)
    row.operator("planar.set_follow_offset")
    row.operator("planar.clear_follow_offset")


CLASSES = (PLANAR_PT_follow,)
