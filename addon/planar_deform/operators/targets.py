# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins taken to their targets: at once, and for every frame."""

from __future__ import annotations

import bpy

from ..scene.lattice.posed import begin_posing
from ..scene.motion import to_targets
from ..scene.pins import pin_list, targets
from .frame_range import FrameRange
from .keying import auto_key
from .modal import reports
from .modal.long_job import Job, LongOperator
from .posing_operator import PinPosingOperator


def _refusal(context: bpy.types.Context) -> str | None:
    """Why nothing can be taken to a target, and what to do."""
    reason = PinPosingOperator.refusal(context)
    if reason is None and not (pin_list.has_pins(context.object) and targets.has_targets(context.object)):
        reason = "No pin has a target: choose one in the list of pins"
    return reason


class PLANAR_OT_solve_to_targets(PinPosingOperator, bpy.types.Operator):
    bl_idname = "planar.solve_to_targets"
    bl_label = "Solve to Targets"
    bl_description = "Take the pins that have a target there, the other ones hold; what they pose follows"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return _refusal(context)

    def apply(self, context: bpy.types.Context) -> None:
        to_targets.solve(context.object, begin_posing(context))
        reports.inform(self, auto_key(context))


class PLANAR_OT_bake_targets(FrameRange, LongOperator, bpy.types.Operator):
    bl_idname = "planar.bake_targets"
    bl_label = "Bake Targets"
    bl_description = "Key a pose for every frame, with the pins where their targets are then"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return _refusal(context)

    def job(self, context: bpy.types.Context) -> Job:
        obj = context.object
        self.complete_range(context)
        frames = self.frames
        return Job(
            write=lambda _: to_targets.bake_frames(obj, frames),
            summary=lambda _: f"Keyed the pins at their targets from frame {frames[0]} to {frames[-1]}",
        )


CLASSES = (PLANAR_OT_solve_to_targets, PLANAR_OT_bake_targets)
