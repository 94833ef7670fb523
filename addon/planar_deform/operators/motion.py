# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole motions: made over to other objects, changed by one frame of them, thinned to key poses."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, FloatProperty

from ..scene.motion.sequence_edit import SequenceEdit, edit_refusal
from ..scene.motion.thinning import Thinning, thin_refusal
from ..scene.motion.transfer import Transfer, transfer_refusal
from ..scene.sequence import pose_state
from .modal.long_job import Job, LongOperator


class MotionOperator(LongOperator):
    """Works on the pose sequence of the active object."""

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        obj = context.object
        return super().refusal(context) or pose_state.absence(obj) or pose_state.refusal(obj)

    @classmethod
    def repeats(cls, context: bpy.types.Context) -> bool:
        """Whether it has just been done: the redo panel asks before it takes back what that has changed."""
        return isinstance(context.active_operator, cls)


class PLANAR_OT_transfer_motion(MotionOperator, bpy.types.Operator):
    bl_idname = "planar.transfer_motion"
    bl_label = "Transfer Motion"
    bl_description = (
        "Let the other selected objects, which must be built alike, move as the active one does: with its "
        "poses, in-betweens and timing, each from its own rest shape"
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return super().refusal(context) or transfer_refusal(context)

    def job(self, context: bpy.types.Context) -> Job:
        transfer = Transfer(context)
        return Job(transfer.write, transfer.solve)


class PLANAR_OT_edit_sequence(MotionOperator, bpy.types.Operator):
    bl_idname = "planar.edit_sequence"
    bl_label = "Edit Sequence"
    bl_description = "Spread the change of the pose that is shown over the poses and in-betweens around it"

    keep_poses: BoolProperty(
        name="Keep Poses",
        description="Leave the keyed poses as they are, and change only what is between two of them",
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return super().refusal(context) or (None if cls.repeats(context) else edit_refusal(context))

    def job(self, context: bpy.types.Context) -> Job:
        edit = SequenceEdit(context, self.keep_poses)
        return Job(edit.write, edit.solve)


class PLANAR_OT_thin_poses(MotionOperator, bpy.types.Operator):
    bl_idname = "planar.thin_poses"
    bl_label = "Thin Poses"
    bl_description = "Of a recording, keep the few poses between which in-betweens come near to all others"

    tolerance: FloatProperty(
        name="Tolerance",
        description="How far any point may come off, relative to the size of the drawing",
        default=0.01,
        min=1e-5,
        max=1.0,
        precision=4,
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return super().refusal(context) or (None if cls.repeats(context) else thin_refusal(context))

    def job(self, context: bpy.types.Context) -> Job:
        thinning = Thinning(context, self.tolerance)
        return Job(thinning.write, thinning.solve, thinning.summary)


CLASSES = (PLANAR_OT_transfer_motion, PLANAR_OT_edit_sequence, PLANAR_OT_thin_poses)
