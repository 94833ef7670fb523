# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyed poses: made, shown again, taken away."""

from __future__ import annotations

import bpy
from bpy.props import FloatProperty, IntProperty

from ..errors import Refusal
from ..scene.objects import modifiers
from ..scene.objects.any_object import begin_shape, shape_refusal
from ..scene.objects.flat_object import make_current
from ..scene.sequence import pose_edit, pose_list, pose_state
from ..scene.sequence.playback import Steps
from ..scene.view.mouse import hidden_refusal
from .keying import key_shown
from .modal.reports import Tell
from .posing_operator import TogetherOperator


class PLANAR_OT_key_pose(TogetherOperator, bpy.types.Operator):
    bl_idname = "planar.key_pose"
    bl_label = "Key Pose"
    bl_description = "Keep the pose that is shown as the pose of the current frame"

    @classmethod
    def refusal_of(cls, context: bpy.types.Context, obj: bpy.types.Object | None) -> str | None:
        reason = shape_refusal(obj)
        if obj is None or reason is not None:
            return reason
        return modifiers.covering(obj) or pose_state.refusal(obj)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        hidden = hidden_refusal(context)  # a script may key what nobody sees, hands may not
        if hidden is not None:
            self.report({"WARNING"}, hidden)
            return {"CANCELLED"}
        return self.execute(context)

    def begin(self, context: bpy.types.Context, obj: bpy.types.Object, tell: Tell) -> Steps:
        return key_shown(context, obj, tell)


class PoseListOperator(TogetherOperator):
    """Works on the poses of objects that have some."""

    @classmethod
    def refusal_of(cls, context: bpy.types.Context, obj: bpy.types.Object | None) -> str | None:
        reason = shape_refusal(obj)
        return reason if obj is None or reason is not None else pose_state.absence(obj)


class OnePoseOperator(PoseListOperator):
    """Works on one pose of the active object, and on those of others that are first shown at its frame."""

    pose: IntProperty(
        name="Pose",
        description="Index of the pose; the active one if negative",
        default=-1,
        min=-1,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return cls.refusal_of(context, context.object)

    def steps(
        self, context: bpy.types.Context, objects: list[bpy.types.Object], told: list[str]
    ) -> list[Steps]:
        active = context.object
        pose = active.planar.active_pose if self.pose < 0 else self.pose
        if not 0 <= pose < len(active.planar.poses):
            raise Refusal(f"There is no pose {pose}: the object has {len(active.planar.poses)}")
        alike = pose_list.alike(active, pose, objects)
        told += [
            f"'{obj.name}' is left out: it has no pose there" for obj in objects if obj.name not in alike
        ]
        self._pose_of = alike
        return super().steps(context, [obj for obj in objects if obj.name in alike], told)

    def begin(self, context: bpy.types.Context, obj: bpy.types.Object, tell: Tell) -> Steps:
        return self.act(context, obj, self._pose_of[obj.name])

    def act(self, context: bpy.types.Context, obj: bpy.types.Object, pose: int) -> Steps:
        """What does it to the pose of this index, in a subclass. Raises Refusal, with nothing changed."""
        raise NotImplementedError


class PLANAR_OT_delete_pose(OnePoseOperator, bpy.types.Operator):
    bl_idname = "planar.delete_pose"
    bl_label = "Delete Pose"
    bl_description = "Take a pose and its keys away; with the last one, the object is as it was before them"

    def act(self, context: bpy.types.Context, obj: bpy.types.Object, pose: int) -> Steps:
        return pose_edit.removing(obj, pose)


class PLANAR_OT_jump_to_pose(OnePoseOperator, bpy.types.Operator):
    bl_idname = "planar.jump_to_pose"
    bl_label = "Jump to Pose"
    bl_description = "Go to the frame of a pose"

    def act(self, context: bpy.types.Context, obj: bpy.types.Object, pose: int) -> Steps:
        frames = pose_state.frames_of(obj, pose)
        if not frames:
            raise Refusal(f"Pose '{obj.planar.poses[pose].name}' has no key on the curve: delete it")
        yield 1.0
        pose_edit.activate(obj, pose)
        frame = int(frames[0] // 1)
        if context.scene.frame_current_final != frames[0]:
            context.scene.frame_set(frame, subframe=frames[0] - frame)


class PLANAR_OT_clear_poses(PoseListOperator, bpy.types.Operator):
    bl_idname = "planar.clear_poses"
    bl_label = "Clear Poses"
    bl_description = "Take all poses away: the object is as it was before the first one was keyed"

    def begin(self, context: bpy.types.Context, obj: bpy.types.Object, tell: Tell) -> Steps:
        yield 1.0
        pose_edit.clear(obj)


class PLANAR_OT_update_pose(OnePoseOperator, bpy.types.Operator):
    bl_idname = "planar.update_pose"
    bl_label = "Update Pose"
    bl_description = "Replace a pose by what is shown"

    def act(self, context: bpy.types.Context, obj: bpy.types.Object, pose: int) -> Steps:
        drawing = begin_shape(context, obj)
        return pose_list.giving_shape(obj, pose, drawing.coordinates(drawing.positions))


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

    def act(self, context: bpy.types.Context, obj: bpy.types.Object, pose: int) -> Steps:
        return pose_list.duplicating(obj, pose, self.frame)


class PLANAR_OT_retime_pose(PoseAtFrameOperator, bpy.types.Operator):
    bl_idname = "planar.retime_pose"
    bl_label = "Move Pose to Frame"
    bl_description = "Show a pose at the current frame, and no longer where it was, also past other poses"

    def act(self, context: bpy.types.Context, obj: bpy.types.Object, pose: int) -> Steps:
        return pose_list.retiming(obj, pose, self.frame)


class PLANAR_OT_step_poses(PoseListOperator, bpy.types.Operator):
    bl_idname = "planar.step_poses"
    bl_label = "Step Poses"
    bl_description = "Show every frame for this many frames: 2 is on twos, 1 shows each one"

    step: IntProperty(name="Step", description="Frames for which each one stays", default=2, min=1, max=100)

    def begin(self, context: bpy.types.Context, obj: bpy.types.Object, tell: Tell) -> Steps:
        make_current(context, obj)
        return pose_list.setting_step(obj, self.step)


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
