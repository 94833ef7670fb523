# SPDX-License-Identifier: GPL-3.0-or-later
"""Flatten in the sidebar tab: a surface laid flat, or what a flat mesh can do for its surface."""

from __future__ import annotations

import bpy

from ...scene.flatten.link import is_flat_mesh
from .tab import PlanarPanel


class PLANAR_PT_flatten(PlanarPanel, bpy.types.Panel):
    bl_label = "Flatten"
    bl_order = 4  # below what is needed all the time

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.object
        return obj is not None and obj.type == "MESH" and not is_flat_mesh(obj)

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.operator("planar.flatten", icon="MOD_UVPROJECT")


class PLANAR_PT_flat_mesh(PlanarPanel, bpy.types.Panel):
    bl_label = "Flat Mesh"
    bl_order = 1  # below the list of poses

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_flat_mesh(context.object)

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.object.planar
        layout.prop(settings, "surface")
        layout.prop(settings, "live_uv")
        column = layout.column(align=True)
        column.operator("planar.push_to_uv_map", icon="UV")
        column.operator("planar.refresh_from_surface", icon="FILE_REFRESH")
        column.operator("planar.export_pattern", icon="EXPORT")


CLASSES = (PLANAR_PT_flatten, PLANAR_PT_flat_mesh)
