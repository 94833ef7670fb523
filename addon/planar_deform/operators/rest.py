# SPDX-License-Identifier: GPL-3.0-or-later
"""The rest shape's two commands."""

from __future__ import annotations

import bpy

from ..scene import pins
from ..scene import rest as rest_store
from ..scene.access import Refusal, begin, pose_refusal


class RestOperator:
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        reason = pose_refusal(context.object)
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None


class PLANAR_OT_set_rest_to_current(RestOperator, bpy.types.Operator):
    bl_idname = "planar.set_rest_to_current"
    bl_label = "Set Rest to Current"
    bl_description = (
        "Take the current shape as the rest shape. With shape keys, the pose in the active key goes into "
        "the Basis and the other keys keep their differences"
    )

    def execute(self, context):
        obj = context.object
        try:
            rest_store.set_to_current(obj)
        except Refusal as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        pins.forget_targets(obj)
        return {"FINISHED"}


class PLANAR_OT_reset_to_rest(RestOperator, bpy.types.Operator):
    bl_idname = "planar.reset_to_rest"
    bl_label = "Reset to Rest"
    bl_description = (
        "Take the pose away: the mesh, or the active shape key, goes back to the rest shape, the pins with it"
    )

    def execute(self, context):
        obj = context.object
        try:
            begin(context).write_rest()
        except Refusal as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        pins.forget_targets(obj)
        return {"FINISHED"}


CLASSES = (PLANAR_OT_set_rest_to_current, PLANAR_OT_reset_to_rest)
