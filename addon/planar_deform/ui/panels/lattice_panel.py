# SPDX-License-Identifier: GPL-3.0-or-later
"""Lattices, in the sidebar tab: one put round objects, and what the active one deforms."""

from __future__ import annotations

import bpy

from ...scene.lattice import fitting
from ...scene.objects.modifiers import DEFORMING
from .tab import PlanarPanel, lines


class PLANAR_PT_lattice(PlanarPanel, bpy.types.Panel):
    bl_label = "Lattice"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 3

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and context.object.type in {"MESH", "LATTICE"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        obj = context.object
        if obj.type == "MESH":
            layout.operator("planar.fit_lattice", icon="LATTICE_DATA")
            return
        column = layout.column(align=True)
        column.operator("planar.add_to_lattice", icon="ADD")
        column.operator("planar.apply_lattice", icon="CHECKMARK")
        column = layout.column(align=True)
        for deformed, modifier in fitting.modifiers_of(obj):
            column.label(text=deformed.name, icon="OUTLINER_OB_MESH")
            below = _below(deformed, modifier)
            if below:
                text = f"Pins are shown without {', '.join(below)}: the object may be seen elsewhere"
                lines(column, text, "INFO", context)


def _below(obj: bpy.types.Object, modifier: bpy.types.Modifier) -> list[str]:
    """The modifiers behind one that move vertices, too."""
    behind = list(obj.modifiers)[list(obj.modifiers).index(modifier) + 1 :]
    return [other.name for other in behind if other.show_viewport and other.type in DEFORMING]


CLASSES = (PLANAR_PT_lattice,)
