# SPDX-License-Identifier: GPL-3.0-or-later
"""What the operators on a mesh that can be posed share."""

from __future__ import annotations

from ..scene.access import Refusal, pose_refusal


class PosingOperator:
    """Works on a mesh that can be posed; every refusal is a report, and changes nothing."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        reason = pose_refusal(context.object)
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None

    def execute(self, context):
        try:
            self.apply(context)
        except Refusal as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        return {"FINISHED"}
