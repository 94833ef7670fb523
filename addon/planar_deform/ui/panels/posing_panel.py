# SPDX-License-Identifier: GPL-3.0-or-later
"""How the drawing is posed: method, stiffness, quality, in the sidebar tab."""

from __future__ import annotations

import bpy

from ... import compat
from ...scene.objects import modifiers, stiffness
from ...scene.objects.any_object import is_outline
from ...scene.storage import cage, shape_keys
from ...scene.view import snapshot
from .tab import PlanarPanel, lines


def is_pinnable_mesh(obj: bpy.types.Object) -> bool:
    """Whether an object is a mesh whose faces pins can hold."""
    return bool(obj.type == "MESH" and not is_outline(obj))


class PLANAR_PT_pose(PlanarPanel, bpy.types.Panel):
    bl_label = "Pose"
    bl_order = 2  # below the list of poses, which is used all the time

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.object
        return obj is not None and (is_pinnable_mesh(obj) or obj.type == "LATTICE")

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        obj = context.object
        settings = obj.planar
        column = layout.column()
        if obj.type == "LATTICE":
            column.prop(settings, "pin_weight")
            layout.operator("planar.reset_to_rest")
        else:
            column.prop(settings, "method")
            column.prop(settings, "pin_weight")
            if cage.may_serve(obj):
                column.prop(settings, "coarse_above", text="Coarse Above")
            row = layout.row()
            row.use_property_split = False
            row.prop(settings, "show_mesh")
            row.operator("planar.remesh", text="Remesh", icon="MOD_REMESH")
            row = layout.row(align=True)
            row.operator("planar.reset_to_rest")
            row.operator("planar.set_rest_to_current")
        row = layout.row(align=True)
        row.operator("planar.reset_selected_pins")
        row.operator("planar.settle_pose")
        baked = None if obj.data.shape_keys is None else shape_keys.baked_key(obj)
        if baked is not None:
            text = f"Baked: posing changes this frame alone, in shape key '{baked.name}'"
            lines(layout, text, "INFO", context)
        coarse = cage.cage_of(obj)
        if coarse is not None:
            lines(layout, f"Solved on a coarse mesh of about {coarse} vertices", "INFO", context)
        shifting = modifiers.shifting(obj) if obj.type == "MESH" else []
        if shifting:
            names = ", ".join(shifting)
            text = f"Pins are shown without {names}: the drawing may be seen elsewhere"
            lines(layout, text, "INFO", context)


class PLANAR_PT_stiffness(PlanarPanel, bpy.types.Panel):
    bl_label = "Stiffness"
    bl_parent_id = "PLANAR_PT_pose"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_pinnable_mesh(context.object)

    def draw(self, context: bpy.types.Context) -> None:
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

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.row().prop(context.object.planar, "show_quality", expand=True)
        seen = snapshot.of_active(context)
        if seen is None or seen.distortion is None:
            layout.label(text="Measured on a flat drawing with pins")
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


CLASSES = (PLANAR_PT_pose, PLANAR_PT_stiffness, PLANAR_PT_quality)
