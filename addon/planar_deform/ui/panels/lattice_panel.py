# SPDX-License-Identifier: GPL-3.0-or-later
"""Lattices in the sidebar tab: a new one, or the active one with what it deforms and cannot reach."""

from __future__ import annotations

import bpy

from ...scene.lattice.rig import deformed
from ...scene.objects import modifiers
from ...scene.view import snapshot
from .pins_panel import unreached
from .posing_panel import is_pinnable_mesh
from .tab import PlanarPanel, lines

MOST_OBJECTS = 12  # that are listed


class PLANAR_PT_fit_lattice(PlanarPanel, bpy.types.Panel):
    bl_label = "Lattice"
    bl_order = 3  # below what is needed all the time

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and is_pinnable_mesh(context.object)

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.operator("planar.fit_lattice", icon="LATTICE_DATA")


class PLANAR_PT_lattice(PlanarPanel, bpy.types.Panel):
    bl_label = "Lattice"
    bl_order = 1  # below the list of poses

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and context.object.type == "LATTICE"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        _draw_far_pins(layout, context)
        _draw_grid(layout, context.object.data)
        _draw_objects(layout, context)
        row = layout.row(align=True)
        row.operator("planar.add_to_lattice", icon="ADD", text="Add Selected")
        row.operator("planar.apply_lattice", icon="CHECKMARK", text="Apply")


def _draw_far_pins(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What the points cannot reach, and the remedy."""
    obj, seen = context.object, snapshot.of_active(context)
    far = {} if seen is None else unreached(seen)
    if not far:
        return
    table = layout.grid_flow(row_major=True, columns=2, even_columns=True, align=True)
    for index, gap in far.items():
        table.label(text=obj.planar.pins[index].name, icon="ERROR")
        table.label(text=f"{gap:.4g} away")
    lines(layout, "A lattice with more points may get there", "BLANK1", context)


def _draw_grid(layout: bpy.types.UILayout, data: bpy.types.Lattice) -> None:
    column = layout.column(align=True)
    column.use_property_decorate = False
    for axis in "uvw":
        row = column.row(align=True)
        row.prop(data, f"points_{axis}", text=axis.upper())
        row.prop(data, f"interpolation_type_{axis}", text="")


def _draw_objects(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What is deformed, how strongly, and where pins are not seen in their places."""
    pairs = list(deformed(context.object))
    column = layout.column(align=True)
    for obj, modifier in pairs[:MOST_OBJECTS]:
        row = column.row(align=True)
        row.label(text=obj.name, icon="OBJECT_DATA")
        strength = row.row(align=True)
        strength.ui_units_x = 4.0
        strength.prop(modifier, "strength", text="")
    if len(pairs) > MOST_OBJECTS:
        column.label(text=f"{len(pairs) - MOST_OBJECTS} more", icon="BLANK1")
    for obj, modifier in pairs[:MOST_OBJECTS]:
        shifting = modifiers.shifting(obj, modifier)
        if shifting:
            text = f"Pins on '{obj.name}' are shown without {', '.join(shifting)}"
            lines(layout, text, "INFO", context)


CLASSES = (PLANAR_PT_fit_lattice, PLANAR_PT_lattice)
