# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of keyed poses in the sidebar tab."""

from __future__ import annotations

from typing import ClassVar

import bpy

from ...scene.motion import cache_age
from ...scene.objects.any_object import is_outline, shape_refusal
from ...scene.pins import pin_list
from ...scene.sequence import pose_list, pose_state, stretches
from ...scene.sequence.held import Held, held
from ...scene.storage import points
from ...scene.storage.pin_paths import path_of
from .tab import PlanarPanel, lines


class PLANAR_UL_poses(bpy.types.UIList):
    bl_idname = "PLANAR_UL_poses"

    stale: ClassVar[set[int]] = set()  # poses behind which in-betweens are to be generated again
    held: ClassVar[set[int]] = set()  # poses that no frame shows

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
        frames = pose_state.frames_of(item.id_data, index)
        here = context.scene.frame_current_final in frames
        row = layout.row(align=True)
        row.prop(item, "name", text="", emboss=False, icon="KEYFRAME_HLT" if here else "KEYFRAME")
        if index in self.stale:
            row.label(text="", icon="FILE_REFRESH")
        if index in self.held:
            row.label(text="", icon="HIDE_ON")
        side = row.row(align=True)
        side.ui_units_x = 3.4  # four digits between the arrows; what is left is for the name
        side.alignment = "RIGHT"
        if len(frames) == 1 and frames[0] == round(frames[0]):
            side.prop(item, "frame", text="", emboss=False)
        else:
            more = f" +{len(frames) - 1}" if len(frames) > 1 else ""
            side.label(text=f"{frames[0]:g}{more}" if frames else "none")


class PLANAR_MT_pose(bpy.types.Menu):
    bl_label = "Pose"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator("planar.update_pose", text="Update to What Is Shown", icon="FILE_REFRESH")
        layout.operator("planar.duplicate_pose", text="Duplicate to Current Frame", icon="DUPLICATE")
        layout.operator("planar.retime_pose", text="Move to Current Frame", icon="TIME")
        layout.separator()
        layout.operator("planar.clear_poses", icon="TRASH")


class PLANAR_PT_poses(PlanarPanel, bpy.types.Panel):
    bl_label = "Poses"
    bl_order = 1

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and context.object.type in points.TYPES

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        obj = context.object
        stale, unseen = stretches.stale(obj), held(obj)
        if pose_state.has_blocks(obj):
            PLANAR_UL_poses.stale = {before for before, _ in stale}
            PLANAR_UL_poses.held = {pose for pose, *_ in unseen}
            row = layout.row()
            row.template_list("PLANAR_UL_poses", "", obj.planar, "poses", obj.planar, "active_pose", rows=5)
            column = row.column(align=True)
            column.operator("planar.jump_to_pose", text="", icon="EYEDROPPER").pose = -1
            column.operator("planar.delete_pose", text="", icon="REMOVE").pose = -1
            column.separator()
            column.menu("PLANAR_MT_pose", text="", icon="DOWNARROW_HLT")
            column.separator()
            column.prop(obj.planar, "show_onion", text="", icon="ONIONSKIN_ON")
            _draw_frames(layout, context)
        row = layout.row(align=True)
        row.operator("planar.key_pose", icon="KEY_HLT")
        row.operator("planar.record_pins", icon="REC")
        row.popover("PLANAR_PT_record", text="", icon="DOWNARROW_HLT")
        row = layout.row(align=True)
        row.operator("planar.copy_pose", text="Copy", icon="COPYDOWN")
        row.operator("planar.paste_pose", text="Paste", icon="PASTEDOWN")
        row.operator("planar.mirror_pose", text="Mirror", icon="MOD_MIRROR")
        if pose_state.has_blocks(obj):
            column = layout.column(align=True)
            column.operator("planar.breakdown", icon="ARROW_LEFTRIGHT")
            row = column.row(align=True)
            row.operator("planar.generate_inbetweens", icon="IPO_EASE_IN_OUT")
            if stretches.has_inbetweens(obj):
                row.operator("planar.remove_inbetweens", text="", icon="X")
        for note in (
            _note(obj, context.scene.frame_current_final) or _stale_note(obj, stale),
            _held_note(obj, unseen),
            _cache_note(obj),
        ):
            if note is not None:
                lines(layout, note, "INFO", context)


class PLANAR_PT_record(bpy.types.Panel):
    bl_label = "Record"
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"  # where Blender's own popovers are

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.prop(context.object.planar, "record_loop")
        column.prop(context.object.planar, "record_overwrite")


class PLANAR_PT_inbetweens(PlanarPanel, bpy.types.Panel):
    bl_label = "In-Betweens"
    bl_parent_id = "PLANAR_PT_poses"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = -1

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and pose_state.is_ours(context.object)

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        settings = context.object.planar
        row = layout.row(align=True)
        step = pose_list.step_of(context.object)
        for frames, name in ((1, "On Ones"), (2, "On Twos"), (3, "On Threes")):
            row.operator("planar.step_poses", text=name, depress=step == frames).step = frames
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        column.prop(settings, "ease")
        column.row().prop(settings, "anchor_path", expand=True)
        column.prop(settings, "smooth")
        if context.object.type == "MESH" and settings.pins:
            column.row().prop(settings, "depth_between", expand=True)
        if settings.active_pose < len(settings.poses) - 1:
            pose, after = (settings.poses[settings.active_pose + step] for step in (0, 1))
            column.separator()
            column.label(text=f"{pose.name} to {after.name}:", icon="KEYFRAME_HLT")
            column.prop(pose, "turns")
            if pose.edited:
                text = f"Edited behind {pose.name}: kept as long as its poses stay"
                lines(layout, text, "INFO", context)
            if 0 <= settings.active_pin < len(settings.pins):
                _draw_path(column, settings.pins[settings.active_pin], pose.name)


def _draw_path(layout: bpy.types.UILayout, pin: bpy.types.PropertyGroup, pose: str) -> None:
    """The path of a pin from a pose to the next."""
    path = path_of(pin, pose)
    if path is None:
        layout.operator("planar.add_pin_path", text=f"Path of {pin.name}", icon="ADD")
        return
    row = layout.row(align=True)
    row.prop(path, "kind", text=f"Path of {pin.name}")
    row.operator("planar.remove_pin_path", text="", icon="X")
    if path.kind == "CURVE":
        layout.prop(path, "curve")
    layout.prop(path, "ease")


def _draw_frames(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The frames of the active pose, where there are more than the list has room for."""
    settings = context.object.planar
    if 0 <= settings.active_pose < len(settings.poses):
        frames = pose_state.frames_of(context.object, settings.active_pose)
        if len(frames) > 1:
            name = settings.poses[settings.active_pose].name
            lines(
                layout, f"{name}: frames {', '.join(f'{frame:g}' for frame in frames)}", "KEYFRAME", context
            )


def _note(obj: bpy.types.Object, frame: float) -> str | None:
    """What the user should know of the object's poses."""
    if obj.mode == "EDIT" and pose_state.is_ours(obj):
        return f"Edit Mode edits the shape key that is active: '{obj.active_shape_key.name}'"
    if pose_state.unkeyed(obj):
        if obj.planar.live and not pin_list.posed_by_hand(obj, frame):
            return "What is shown is where the pins follow, on top of the poses: Key Pose keys it"
        return "The pose shown is not keyed: the next frame change takes it away"
    reason = shape_refusal(obj)
    if reason is None:
        return pose_state.refusal(obj)
    return reason if is_outline(obj) else None  # of a mesh with faces the pins' panel says it


def _stale_note(obj: bpy.types.Object, stale: list[tuple[int, int]]) -> str | None:
    """Which in-betweens are not those of the poses."""
    if not stale:
        return None
    poses = obj.planar.poses
    ways = []
    for before, after in stale[:3]:
        why = ", ".join(stretches.why_stale(obj, before))
        ways.append(f"{poses[before].name} to {poses[after].name}" + (f" ({why})" if why else ""))
    more = f" and {len(stale) - 3} more" if len(stale) > 3 else ""
    return f"Out of date: {', '.join(ways)}{more}. Generate In-Betweens fills them anew"


def _held_note(obj: bpy.types.Object, unseen: list[Held]) -> str | None:
    """Which poses are keyed where each frame stays for several, so that none shows them."""
    if not unseen:
        return None
    one = unseen[0]
    more = f", nor are {len(unseen) - 1} more" if len(unseen) > 1 else ""
    return (
        f"{obj.planar.poses[one.pose].name} at frame {one.frame:g} is not shown{more}: new ones are shown at "
        f"{one.before:g} and {one.after:g}. Move it there, or use On Ones"
    )


def _cache_note(obj: bpy.types.Object) -> str | None:
    """Whether the point cache shows what the poses no longer do."""
    if not cache_age.is_out_of_date(obj):
        return None
    return "The point cache is out of date: the poses have changed since. Bake to Point Cache again"


CLASSES = (PLANAR_UL_poses, PLANAR_MT_pose, PLANAR_PT_record, PLANAR_PT_poses, PLANAR_PT_inbetweens)
