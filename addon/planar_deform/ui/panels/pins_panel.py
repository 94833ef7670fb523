# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebar tab "Planar"."""

from __future__ import annotations

import math

import bpy
import numpy as np

from ... import compat
from ...scene.objects import modifiers, stiffness
from ...scene.objects.any_object import is_outline
from ...scene.objects.cutout_object import pose_refusal
from ...scene.view import snapshot

KIND_ICONS = {"POINT": "DOT", "PATCH": "MESH_PLANE"}
# Of the drawing's size: pins are soft, and below this the solver itself calls a handle reached.
SHOWN_GAP = 1e-3


class PLANAR_UL_pins(bpy.types.UIList):
    bl_idname = "PLANAR_UL_pins"

    def draw_item(self, context, layout, data, item, icon, active_data, active_propname, index):
        obj = context.object
        row = layout.row(align=True)
        row.active = item.enabled
        row.prop(item, "select", text="", emboss=False, icon="RADIOBUT_ON" if item.select else "RADIOBUT_OFF")
        row.prop(item, "name", text="", emboss=False, icon=KIND_ICONS[item.kind])
        if item.group not in obj.vertex_groups:
            row.label(text="no group", icon="ERROR")
        elif (seen := snapshot.of_active(context)) and not seen.refusal and seen.pin(index) is None:
            row.label(text="empty", icon="ERROR")
        weight = row.row(align=True)
        weight.ui_units_x = 2.5
        weight.prop(item, "weight", text="", emboss=False)
        row.prop(item, "enabled", text="", emboss=False, icon="PINNED" if item.enabled else "UNPINNED")


class PlanarPanel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Planar"


class PLANAR_PT_pins(PlanarPanel, bpy.types.Panel):
    bl_label = "Pins"

    def draw(self, context):
        layout = self.layout
        obj = context.object
        seen = snapshot.of_active(context)
        reason = pose_refusal(obj) or modifiers.covering(obj) or (seen.refusal if seen is not None else None)
        if reason is not None:
            lines(layout, reason, "INFO", context)
        if obj is None or obj.type != "MESH":
            return
        settings = obj.planar
        row = layout.row()
        row.template_list("PLANAR_UL_pins", "", settings, "pins", settings, "active_pin", rows=4)
        column = row.column(align=True)
        column.menu("PLANAR_MT_add_pins", text="", icon="ADD")
        row = column.row()
        row.enabled = any(pin.select for pin in settings.pins)
        row.operator("planar.remove_pins", text="", icon="REMOVE")
        if 0 <= settings.active_pin < len(settings.pins):
            _draw_pin(layout, context, settings.pins[settings.active_pin], settings.active_pin)


class PLANAR_MT_add_pins(bpy.types.Menu):
    bl_label = "Add Pins"

    def draw(self, context):
        layout = self.layout
        layout.label(text="Ctrl-Click the Mesh in the Pose Tool, or:")
        layout.operator("planar.add_pins_from_selected", text="Point per Selected Vertex").kind = "POINT"
        layout.operator("planar.add_pins_from_selected", text="Patch on Selected Vertices").kind = "PATCH"
        layout.separator()
        layout.operator("planar.add_pin_from_group", text="Point on Active Vertex Group").kind = "POINT"
        layout.operator("planar.add_pin_from_group", text="Patch on Active Vertex Group").kind = "PATCH"
        layout.separator()
        layout.operator("planar.add_pins_from_all_groups", text="Points on All Vertex Groups").kind = "POINT"
        layout.operator("planar.add_pins_from_all_groups", text="Patches on All Vertex Groups").kind = "PATCH"


class PLANAR_PT_pose(PlanarPanel, bpy.types.Panel):
    bl_label = "Pose"
    bl_order = 2  # below the list of poses, which is used all the time

    @classmethod
    def poll(cls, context):
        obj = context.object
        return obj is not None and obj.type == "MESH" and not is_outline(obj)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        obj = context.object
        settings = obj.planar
        column = layout.column()
        column.prop(settings, "method")
        column.prop(settings, "pin_weight")
        column.prop(settings, "show_mesh")
        row = layout.row(align=True)
        row.operator("planar.reset_to_rest")
        row.operator("planar.set_rest_to_current")
        row = layout.row(align=True)
        row.operator("planar.reset_selected_pins")
        row.operator("planar.settle_pose")
        shifting = modifiers.shifting(obj)
        if shifting:
            names = ", ".join(shifting)
            text = f"Pins are shown without {names}: the drawing may be seen elsewhere"
            lines(layout, text, "INFO", context)


class PLANAR_PT_stiffness(PlanarPanel, bpy.types.Panel):
    bl_label = "Stiffness"
    bl_parent_id = "PLANAR_PT_pose"

    def draw(self, context):
        layout = self.layout
        obj = context.object
        layout.prop_search(obj.planar, "stiffness_group", obj, "vertex_groups", text="")
        if stiffness.missing(obj):
            text = "There is no group of this name: choose one, or clear the field"
            lines(layout, text, "ERROR", context)
        if obj.mode == "WEIGHT_PAINT":
            lines(layout, "Paint 1 where it is stiff, 0 where it is soft; 0.5 is neutral", "INFO", context)
            brush = compat.brush_weight_owner(context.tool_settings)
            if brush is not None:
                layout.prop(brush, "weight", slider=True)
            layout.operator("object.mode_set", text="Done", icon="CHECKMARK").mode = "OBJECT"
        else:
            layout.operator("planar.paint_stiffness", icon="BRUSH_DATA")


class PLANAR_PT_quality(PlanarPanel, bpy.types.Panel):
    bl_label = "Quality"
    bl_parent_id = "PLANAR_PT_pose"

    def draw(self, context):
        layout = self.layout
        layout.row().prop(context.object.planar, "show_quality", expand=True)
        seen = snapshot.of_active(context)
        if seen is None or seen.distortion is None:
            layout.label(text="Measured on a drawing with pins")
            return
        distortion = seen.distortion
        table = layout.grid_flow(row_major=True, columns=3, even_columns=True, align=True)
        for cell in (
            *("", "Mean", "Worst"),
            *("Area", f"{distortion.area:.3f}", f"{seen.worst[0]:.3f}"),
            *("Angle", f"{distortion.angle:.3f}", f"{seen.worst[1]:.3f}"),
            *("Flipped", str(distortion.flipped), ""),
        ):
            table.label(text=cell)
        layout.label(text="2 is undistorted")


def _draw_pin(layout, context, pin, index):
    obj = context.object
    column = layout.column()
    column.use_property_split = True
    column.use_property_decorate = False
    column.prop(pin, "kind")
    column.prop_search(pin, "group", obj, "vertex_groups", text="Group")
    column.prop(pin, "enabled")
    column.prop(pin, "weight")
    seen = snapshot.of_active(context)
    place = None if seen is None else seen.pin(index)
    if place is None:
        return
    if pin.kind == "PATCH":
        split = column.split(factor=0.4)
        split.alignment = "RIGHT"
        split.label(text="Turned")
        split.label(text=f"{math.degrees(place.angle):.1f}°")
    gap = float(np.linalg.norm(place.target - place.place))
    if gap > SHOWN_GAP * max(obj.dimensions):
        lines(layout, f"{gap:.4g} away from its target", "ERROR", context)


def lines(layout, text, icon, context):
    """A message as wide as the sidebar."""
    width = max(12, int(context.region.width / (7.0 * context.preferences.system.ui_scale)) - 4)
    words, lines = text.split(), [""]
    for word in words:
        if lines[-1] and len(lines[-1]) + 1 + len(word) > width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    column = layout.column(align=True)
    for number, line in enumerate(lines):
        column.label(text=line, icon=icon if number == 0 else "BLANK1")


CLASSES = (
    PLANAR_UL_pins,
    PLANAR_MT_add_pins,
    PLANAR_PT_pins,
    PLANAR_PT_pose,
    PLANAR_PT_stiffness,
    PLANAR_PT_quality,
)
