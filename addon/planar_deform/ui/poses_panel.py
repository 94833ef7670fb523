# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of keyed poses in the sidebar tab."""

from __future__ import annotations

import bpy

from ..scene import sequence
from ..scene.shape import is_outline, shape_refusal
from .panel import PlanarPanel, lines


class PLANAR_UL_poses(bpy.types.UIList):
    bl_idname = "PLANAR_UL_poses"

    def draw_item(self, context, layout, data, item, icon, active_data, active_propname, index):
        row = layout.row(align=True)
        row.prop(item, "name", text="", emboss=False, icon="SHAPEKEY_DATA")
        frames = sequence.frames_of(item.id_data, index)
        text = ", ".join(f"{frame:g}" for frame in frames) if frames else "no frame"
        side = row.row()
        side.alignment = "RIGHT"
        side.label(text=text)


class PLANAR_PT_poses(PlanarPanel, bpy.types.Panel):
    bl_label = "Poses"
    bl_order = 1

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type in {"MESH", "CURVE"}

    def draw(self, context):
        layout = self.layout
        obj = context.object
        if sequence.has_blocks(obj):
            row = layout.row()
            row.template_list("PLANAR_UL_poses", "", obj.planar, "poses", obj.planar, "active_pose", rows=4)
            column = row.column(align=True)
            column.operator("planar.jump_to_pose", text="", icon="EYEDROPPER").pose = -1
            column.operator("planar.delete_pose", text="", icon="REMOVE").pose = -1
            column.separator()
            column.operator("planar.clear_poses", text="", icon="TRASH")
            column.separator()
            column.prop(obj.planar, "show_onion", text="", icon="ONIONSKIN_ON")
        row = layout.row(align=True)
        row.operator("planar.key_pose", icon="KEY_HLT")
        row.operator("planar.breakdown", icon="ARROW_LEFTRIGHT")
        row.operator("planar.record_pins", icon="REC")
        row = layout.row(align=True)
        row.operator("planar.copy_pose", text="Copy", icon="COPYDOWN")
        row.operator("planar.paste_pose", text="Paste", icon="PASTEDOWN")
        row.operator("planar.mirror_pose", text="Mirror", icon="MOD_MIRROR")
        note = _note(obj)
        if note is not None:
            lines(layout, note, "INFO", context)


def _note(obj):
    """What the user should know of the object's poses."""
    if obj.mode == "EDIT" and sequence.is_ours(obj):
        return f"Edit Mode edits the shape key that is active: '{obj.active_shape_key.name}'"
    if sequence.unkeyed(obj):
        return "The pose shown is not keyed: the next frame change takes it away"
    reason = shape_refusal(obj)
    if reason is None:
        return sequence.refusal(obj)
    return reason if is_outline(obj) else None  # of a mesh with faces the pins' panel says it


CLASSES = (PLANAR_UL_poses, PLANAR_PT_poses)
