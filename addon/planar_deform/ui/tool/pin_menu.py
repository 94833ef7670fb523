# SPDX-License-Identifier: GPL-3.0-or-later
"""The menus of the right mouse button: of pins, over one, and of the drawing, beside them."""

from __future__ import annotations

import bpy


class PLANAR_MT_pin_context(bpy.types.Menu):
    bl_idname = "PLANAR_MT_pin_context"
    bl_label = "Pins"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator_context = "INVOKE_REGION_WIN"
        layout.operator("planar.key_pose", icon="KEY_HLT")
        layout.separator()
        layout.operator("planar.reset_selected_pins")
        layout.operator("planar.settle_pose")
        layout.separator()
        layout.operator("planar.set_pin_kind", text="Make Points", icon="DOT").kind = "POINT"
        layout.operator("planar.set_pin_kind", text="Make Patches", icon="MESH_PLANE").kind = "PATCH"
        layout.operator("planar.set_pin_radius")
        layout.operator("planar.set_weld_radius")
        layout.menu("PLANAR_MT_follow")
        layout.separator()
        draw_depths(layout)
        layout.separator()
        layout.operator("planar.disable_pins", icon="UNPINNED")
        layout.operator("planar.enable_pins", icon="PINNED")
        layout.separator()
        for text, action in (("Select All", "ALL"), ("Select None", "NONE"), ("Invert Selection", "INVERT")):
            layout.operator("planar.select_pins", text=text).action = action
        layout.operator("planar.box_select_pins")
        layout.separator()
        layout.operator("planar.remove_pins", icon="X")


def draw_carrying(layout: bpy.types.UILayout) -> None:
    """What hangs whole objects and their pins on a drawing."""
    layout.operator("planar.attach_to", icon="CON_CHILDOF")
    layout.operator("planar.detach_from", icon="X")


def draw_depths(
    layout: bpy.types.UILayout, *, front: str = "Bring Forward", back: str = "Send Backward"
) -> None:
    """The buttons that take the selected pins one depth forward and backward."""
    for depth, text, icon in ((1.0, front, "TRIA_UP"), (-1.0, back, "TRIA_DOWN")):
        nearer = layout.operator("planar.set_depth", text=text, icon=icon)
        nearer.depth, nearer.relative = depth, True


class PLANAR_MT_drawing_context(bpy.types.Menu):
    bl_idname = "PLANAR_MT_drawing_context"
    bl_label = "Drawing"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator_context = "INVOKE_REGION_WIN"
        layout.operator("planar.key_pose", icon="KEY_HLT")
        layout.separator()
        layout.operator("planar.copy_pose", icon="COPYDOWN")
        layout.operator("planar.paste_pose", icon="PASTEDOWN")
        layout.operator("planar.mirror_pose", icon="MOD_MIRROR")
        layout.separator()
        layout.operator("planar.settle_pose")
        layout.operator("planar.reset_to_rest")
        layout.separator()
        layout.operator("planar.attach", icon="LINKED")
        layout.operator("planar.detach", icon="UNLINKED")
        draw_carrying(layout)
        layout.separator()
        for text, action in (("Select All", "ALL"), ("Select None", "NONE"), ("Invert Selection", "INVERT")):
            layout.operator("planar.select_pins", text=text).action = action
        layout.operator("planar.box_select_pins")
        layout.separator()
        layout.operator("planar.remove_pins", text="Remove Selected Pins", icon="X")
        layout.separator()
        layout.menu("VIEW3D_MT_object_context_menu", text="Object")


CLASSES = (PLANAR_MT_pin_context, PLANAR_MT_drawing_context)
