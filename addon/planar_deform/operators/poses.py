# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyed poses: made, shown again, taken away."""

from __future__ import annotations

import bpy
from bpy.props import FloatProperty, IntProperty

from ..errors import Refusal
from ..scene.objects import modifiers
from ..scene.objects.any_object import begin_shape
from ..scene.objects.flat_object import make_current
from ..scene.sequence import pose_edit, pose_list, pose_state
from ..scene.view.mouse import hidden_refusal
from .keying import key_shown
from .modal import reports
from .posing_operator import ShapeOperator


class PLANAR_OT_key_pose(ShapeOperator, bpy.types.Operator):
    bl_idname = "planar.key_pose"
    bl_label = "Key Pose"
    bl_description = "Keep the pose that is shown as the pose of the current frame"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        obj = context.object
        return super().refusal(context) or modifiers.covering(obj) or pose_state.refusal(obj)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        hidden = hidden_refusal(context)  # a script may key what nobody sees, hands may not
        if hidden is not None:
            self.report({"WARNING"}, hidden)
            return {"CANCELLED"}
        return self.execute(context)

    def apply(self, context: bpy.types.Context) -> None:
        reports.inform(self, key_shown(context))


class PoseListOperator(ShapeOperator):
    """Works on the poses of an object that has some."""

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return super().refusal(context) or pose_state.absence(context.object)


class OnePoseOperator(PoseListOperator):
    """Works on one pose."""

    pose: IntProperty(
        name="Pose",
        description="Index of the pose; the active one if negative",
        default=-1,
        min=-1,
        options={"SKIP_SAVE"},
    )

    def apply(self, context: bpy.types.Context) -> None:
        settings = context.object.planar
        pose = settings.active_pose if self.pose < 0 else self.pose
        if not 0 <= pose < len(settings.poses):
            raise Refusal(f"There is no pose {pose}: the object has {len(settings.poses)}")
        self.act(context, pose)

    def act(self, context: bpy.types.Context, pose: int) -> None:
        """Do it to the pose of this index, in a subclass. Raises Refusal, with nothing changed."""
        raise NotImplementedError


class PLANAR_OT_delete_pose(OnePoseOperator, bpy.types.Operator):
    bl_idname = "planar.delete_pose"
    bl_label = "Delete Pose"
    bl_description = "Take a pose and its keys away; with the last one, the object is as it was before them"

    def act(self, context: bpy.types.Context, pose: int) -> None:
        pose_edit.remove(context.object, pose)


class PLANAR_OT_jump_to_pose(OnePoseOperator, bpy.types.Operator):
    bl_idname = "planar.jump_to_pose"
    bl_label = "Jump to Pose"
    bl_description = "Go to the frame of a pose"

    def act(self, context: bpy.types.Context, pose: int) -> None:
        obj = context.object
        frames = pose_state.frames_of(obj, pose)
        if not frames:
            raise Refusal(f"Pose '{obj.planar.poses[pose].name}' has no key on the curve: delete it")
        pose_edit.activate(obj, pose)
        frame = int(frames[0] // 1)
        context.scene.frame_set(frame, subframe=frames[0] - frame)


class PLANAR_OT_clear_poses(PoseListOperator, bpy.types.Operator):
    bl_idname = "planar.clear_poses"
    bl_label = "Clear Poses"
    bl_description = "Take all poses away: the object is as it was before the first one was keyed"

    def apply(self, context: bpy.types.Context) -> None:
        pose_edit.clear(context.object)


class PLANAR_OT_update_pose(OnePoseOperator, bpy.types.Operator):
    bl_idname = "planar.update_pose"
    bl_label = "Update Pose"
    bl_description = "Replace a pose by what is shown"

    def act(self, context: bpy.types.Context, pose: int) -> None:
        drawing = begin_shape(context)
        pose_list.give_shape(context.object, pose, drawing.coordinates(drawing.positions))


class PoseAtFrameOperator(OnePoseOperator):
    """Works on one pose and a frame."""

    properties: bpy.types.OperatorProperties  # of Blender's operators

    frame: FloatProperty(
        name="Frame", description="Frame to use; by default the current one", options={"SKIP_SAVE"}
    )

    def apply(self, context: bpy.types.Context) -> None:
        if not self.properties.is_property_set("frame"):
            self.frame = context.scene.frame_current_final
        super().apply(context)


class PLANAR_OT_duplicate_pose(PoseAtFrameOperator, bpy.types.Operator):
    bl_idname = "planar.duplicate_pose"
    bl_label = "Duplicate Pose"
    bl_description = "Key a pose once more at the current frame, as a pose of its own"

    def act(self, context: bpy.types.Context, pose: int) -> None:
        pose_list.duplicate(context.object, pose, self.frame)


class PLANAR_OT_retime_pose(PoseAtFrameOperator, bpy.types.Operator):
    bl_idname = "planar.retime_pose"
    bl_label = "Move Pose to Frame"
    bl_description = "Show a pose at the current frame, and no longer where it was, also past other poses"

    def act(self, context: bpy.types.Context, pose: int) -> None:
        pose_list.retime(context.object, pose, self.frame)


class PLANAR_OT_step_poses(PoseListOperator, bpy.types.Operator):
    bl_idname = "planar.step_poses"
    bl_label = "Step Poses"
    bl_description = "Show every frame for this many frames: 2 is on twos, 1 shows each one"

    step: IntProperty(name="Step", description="Frames for which each one stays", default=2, min=1, max=100)

    def apply(self, context: bpy.types.Context) -> None:
        make_current(context)
        pose_list.set_step(context.object, self.step)


CLASSES = (
    PLANAR_OT_key_pose,
    PLANAR_OT_delete_pose,
    PLANAR_OT_jump_to_pose,
    PLANAR_OT_clear_poses,
    PLANAR_OT_update_pose,
    PLANAR_OT_duplicate_pose,
    PLANAR_OT_retime_pose,
    PLANAR_OT_step_poses,
)
