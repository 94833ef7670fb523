# SPDX-License-Identifier: GPL-3.0-or-later
"""Solving the present pose again, for what has changed since: weights, pins turned off, method, stiffness."""

from __future__ import annotations

import bpy

from ..errors import Refusal
from ..model.posing.posing import Sample
from ..model.posing.together import SolvedTogether
from .modal import running
from .modal.session import Interactive, Session
from .modal.several_posing import begin_settling
from .posing_operator import PinPosingOperator

STILL: Sample = (0.0, 0.0, 0.0)


class PLANAR_OT_settle_pose(Interactive, PinPosingOperator, bpy.types.Operator):
    bl_idname = "planar.settle_pose"
    bl_label = "Settle Pose"
    bl_description = (
        "Solve the pose again with the pins where they are, as after a change of weights or method"
    )

    def apply(self, context: bpy.types.Context) -> None:
        begin_settling(context).run([STILL], settle=True)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        running.end()
        try:
            posing = begin_settling(context)
        except Refusal as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        self._session = Session(context, posing, "Settling")
        self._session.ask(STILL)
        result = self.guarded(self.release)  # it may have come to something, or gone wrong, by now
        if result == {"RUNNING_MODAL"}:
            context.window_manager.modal_handler_add(self)
        return result

    def keep_result(self, solved: SolvedTogether) -> None:
        pass  # there is nothing to edit and nothing to repeat


CLASSES = (PLANAR_OT_settle_pose,)
