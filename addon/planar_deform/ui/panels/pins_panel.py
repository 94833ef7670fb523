# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of pins, in the sidebar tab."""

from __future__ import annotations

import math

import bpy
import numpy as np

from ...model.posing.pins import AS_AT_REST
from ...scene.image import blended_materials, file_state
from ...scene.lattice.posed import posing_refusal
from ...scene.lattice.rig import waiting
from ...scene.objects import modifiers
from ...scene.pins.pin_list import is_joint, pinned_object
from ...scene.pins.pose_holding import unheld
from ...scene.pins.taking_part import control_in_hand, taking_part, with_pins
from ...scene.view import coarseness, snapshot
from ..tool.pin_menu import draw_depths
from .tab import PlanarPanel, lines

KIND_ICONS = {"POINT": "DOT", "PATCH": "MESH_PLANE", "HINGE": "MESH_CIRCLE", "WELD": "SNAP_FACE"}
# Of the drawing's size, as pins are soft: three pixels where it fills a view, as in ui/tool/gizmos.py.
SHOWN_GAP = 3e-3


WIDE = 300.0  # pixels at a UI scale of 1: in a narrower sidebar the names need the room of the weights


def _fault(context: bpy.types.Context, pin: bpy.types.PropertyGroup, index: int) -> str | None:
    """Why a pin does not hold the drawing, and what to do."""
    seen = snapshot.of_active(context)
    lost = seen is not None and not seen.refusal and seen.pin(index) is None
    if pin.lattice_point >= 0:
        return "The lattice has no such point any more: remove the pin" if lost else None
    pinned = pinned_object(pin)
    if pinned is None:
        return "Its object is gone: choose another one, or remove the pin"
    if pin.group not in pinned.vertex_groups:
        return "The vertex group is gone: choose another one"
    if is_joint(pin) and context.object.type == "LATTICE":
        return "Joints hold parts of a mesh together: make it a Point or a Patch"
    if is_joint(pin) and pin.enabled and context.object.planar.method != "HOLD":
        return "AKVF and ARAP do not hold joints: choose Hold Shape, or switch the joints off"
    if not lost:
        return None
    if is_joint(pin):
        return (
            "It waits: its vertices do not lie on each other at rest, of two parts. Assign some of both in "
            "Edit Mode, or remove it and attach again"
        )
    if pinned == context.object:
        return "The vertex group holds no vertices of faces: assign some in Edit Mode"
    return waiting(context.object, [index]) or (
        f"The lattice deforms no vertices of faces of '{pinned.name}' that are in the group"
    )


def unreached(seen: snapshot.Snapshot) -> dict[int, float]:
    """How far pins are from where they were asked to be, by their indices; only what can be seen."""
    if seen.shape is None:
        return {}
    size = float(np.ptp(seen.shape[0].cutout.rest, axis=0).max())  # a lattice has no dimensions in Blender
    gaps = {pin.key: float(np.linalg.norm(pin.target - pin.place)) for pin in seen.pins}
    return {key: gap for key, gap in gaps.items() if gap > SHOWN_GAP * size}


class PLANAR_UL_pins(bpy.types.UIList):
    bl_idname = "PLANAR_UL_pins"

    def draw_item(
        self,
        context: bpy.types.Context,
        layout: bpy.types.UILayout,
        data: bpy.types.PropertyGroup,
        item: bpy.types.PropertyGroup,
        icon: int,
        active_data: bpy.types.PropertyGroup,
        active_propname: str,
        index: int,
    ) -> None:
        row = layout.row(align=True)
        row.active = item.enabled
        row.prop(item, "select", text="", emboss=False, icon="RADIOBUT_ON" if item.select else "RADIOBUT_OFF")
        kind = "LATTICE_DATA" if item.lattice_point >= 0 else KIND_ICONS[item.kind]
        row.prop(item, "name", text="", emboss=False, icon=kind)
        if context.object.type == "LATTICE" and item.object is not None:
            row.label(text=item.object.name)
        if _fault(context, item, index) is not None:
            row.label(text="", icon="ERROR")
        if context.region.width > WIDE * context.preferences.system.ui_scale:
            weight = row.row(align=True)
            weight.ui_units_x = 2.5
            weight.prop(item, "weight", text="", emboss=False)
        row.prop(item, "enabled", text="", emboss=False, icon="PINNED" if item.enabled else "UNPINNED")


class PLANAR_PT_pins(PlanarPanel, bpy.types.Panel):
    bl_label = "Pins"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        obj = context.object
        if obj is not None:
            _draw_taking_part(layout, context)
            _draw_lattices(layout, obj)
        seen = snapshot.of_active(context)
        reason = control_in_hand(context) or posing_refusal(obj) or modifiers.covering(obj)
        reason = reason or (seen.refusal if seen is not None else None)
        if reason is not None:
            lines(layout, reason, "INFO", context)
        if obj is None:
            layout.operator("planar.cutout_from_image", icon="IMAGE_DATA")
        if obj is None or obj.type not in {"MESH", "LATTICE"}:
            return
        if reason is None and obj.type == "MESH" and coarseness.of(obj):
            lines(
                layout,
                "The mesh is too coarse to bend: it needs two rows of faces and more",
                "ERROR",
                context,
            )
            layout.operator("planar.refine_mesh", icon="MOD_SUBSURF")
            layout.operator("planar.make_cutout", icon="OUTLINER_OB_IMAGE")
        if reason is None and obj.type == "MESH" and file_state.is_changed(obj):
            lines(layout, "The image has been changed on disk", "INFO", context)
            again = layout.operator("planar.remesh", text="Reload and Remesh", icon="FILE_REFRESH")
            again.reload = True
        told = _unheld(obj, seen) if reason is None and seen is not None else None
        if told is not None:
            lines(layout, told, "INFO", context)
        settings = obj.planar
        row = layout.row()
        row.template_list("PLANAR_UL_pins", "", settings, "pins", settings, "active_pin", rows=4)
        column = row.column(align=True)
        column.menu("PLANAR_MT_add_pins", text="", icon="ADD")
        row = column.row()
        row.enabled = any(pin.select for one in with_pins(context) for pin in one.planar.pins)
        row.operator("planar.remove_pins", text="", icon="REMOVE")
        column.separator()
        column.prop(settings, "use_mirror_x", text="", icon="MOD_MIRROR")
        if 0 <= settings.active_pin < len(settings.pins):
            _draw_pin(layout, context, settings.pins[settings.active_pin], settings.active_pin)


def _draw_taking_part(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """How many drawings are posed as one, and why selected ones are not."""
    objects, left_out = taking_part(context)
    if len(objects) > 1:
        layout.label(
            text=f"{len(objects)} drawings: pins and poses of all", icon="OUTLINER_OB_GROUP_INSTANCE"
        )
    for name, reason in left_out.items():
        lines(layout, f"'{name}' is left out: {reason}", "INFO", context)


def _draw_lattices(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    """The lattices in which an object hangs, whose pins pose it."""
    for lattice in modifiers.lattices_of(obj):
        split = layout.split(factor=0.4)
        split.label(text="Hangs in")
        split.operator("planar.select_lattice", text=lattice.name, icon="LATTICE_DATA").lattice = lattice.name


def _unheld(obj: bpy.types.Object, seen: snapshot.Snapshot) -> str | None:
    """What the pins do not hold of the pose, unless a drag is moving them."""
    return None if snapshot.following(obj) else unheld(obj, lambda: seen.distortion)


class PLANAR_MT_add_pins(bpy.types.Menu):
    bl_label = "Add Pins"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.label(text="Ctrl-Click the Mesh in the Pose Tool, or:")
        if context.object is not None and context.object.type == "LATTICE":
            layout.operator("planar.add_pins_from_selected", text="Pin per Selected Lattice Point")
        else:
            layout.operator("planar.add_pins_from_selected", text="Point per Selected Vertex").kind = "POINT"
            layout.operator("planar.add_pins_from_selected", text="Patch on Selected Vertices").kind = "PATCH"
        layout.separator()
        layout.operator("planar.add_pin_from_group", text="Point on Active Vertex Group").kind = "POINT"
        layout.operator("planar.add_pin_from_group", text="Patch on Active Vertex Group").kind = "PATCH"
        layout.separator()
        layout.operator("planar.add_pins_from_all_groups", text="Points on All Vertex Groups").kind = "POINT"
        layout.operator("planar.add_pins_from_all_groups", text="Patches on All Vertex Groups").kind = "PATCH"
        if context.object is not None and context.object.type == "MESH":
            layout.separator()
            layout.operator("planar.attach", text="Joints Between Parts (Attach)", icon="LINKED")


def _draw_pin(
    layout: bpy.types.UILayout, context: bpy.types.Context, pin: bpy.types.PropertyGroup, index: int
) -> None:
    obj = context.object
    column = layout.column()
    column.use_property_split = True
    column.use_property_decorate = False
    if pin.lattice_point >= 0:
        column.label(text=f"Holds point {pin.lattice_point} of the lattice")
    else:
        column.prop(pin, "kind")
        if obj.type == "LATTICE":
            column.prop(pin, "object")
        column.prop_search(pin, "group", pinned_object(pin) or obj, "vertex_groups", text="Group")
    column.prop(pin, "enabled")
    if pin.lattice_point < 0:
        column.prop(pin, "weight")
        if obj.type == "MESH" and pin.enabled and not is_joint(pin):
            row = column.row(align=True)
            row.prop(pin, "depth")
            draw_depths(row, front="", back="")
    fault = _fault(context, pin, index)
    if fault is not None:
        lines(column, fault, "ERROR", context)
    seen = snapshot.of_active(context)
    place = None if seen is None else seen.pin(index)
    if seen is None or place is None:
        return
    if pin.kind == "PATCH":
        split = column.split(factor=0.4)
        split.alignment = "RIGHT"
        split.label(text="Turned")
        grown = f", Scaled {place.scale:.2f}" if abs(place.scale - 1.0) >= AS_AT_REST else ""
        split.label(text=f"{math.degrees(place.angle):.1f}°{grown}")
    if any(seen.depths.values()) and blended_materials.blended(obj):
        lines(column, "EEVEE blends a material, in which depths do not count", "ERROR", context)
        column.operator("planar.dither_materials", icon="MATERIAL")
    gap = unreached(seen).get(index)
    if gap is not None:
        lines(layout, f"{gap:.2g} away from its target", "ERROR", context)


CLASSES = (PLANAR_UL_pins, PLANAR_MT_add_pins, PLANAR_PT_pins)
