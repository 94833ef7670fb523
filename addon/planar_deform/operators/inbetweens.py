# SPDX-License-Identifier: GPL-3.0-or-later
"""In-betweens: generated, and removed."""

from __future__ import annotations

from functools import partial

import bpy
from bpy.props import BoolProperty, EnumProperty

from ..scene.inbetweens import planning, writing
from ..scene.objects.any_object import begin_shape
from ..scene.objects.flat_object import make_current
from ..scene.properties import PATHS
from ..scene.sequence import stretches
from .modal.long_job import Job, LongOperator
from .posing_operator import ShapeOperator

ONCE = {"SKIP_SAVE"}  # what is not told is the object's own, not that of the last use


class PLANAR_OT_generate_inbetweens(LongOperator, bpy.types.Operator):
    bl_idname = "planar.generate_inbetweens"
    bl_label = "Generate In-Betweens"
    bl_description = (
        "Fill the frames between the keyed poses, with as little distortion as possible. Their timing stays "
        "a matter of the curve"
    )
    bl_options = {"REGISTER", "UNDO"}

    path: EnumProperty(
        name="Path", description="Way of what is held, from pose to pose", items=PATHS, options=ONCE
    )
    smooth: BoolProperty(
        name="Smooth",
        description="Pass through the poses without a change of speed or direction there",
        options=ONCE,
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return planning.refusal(context.object)

    def job(self, context: bpy.types.Context) -> Job:
        settings = context.object.planar
        if not self.properties.is_property_set("path"):
            self.path = settings.anchor_path
        if not self.properties.is_property_set("smooth"):
            self.smooth = settings.smooth
        drawing = begin_shape(context)
        plan = planning.plan(drawing, path=self.path, smooth=self.smooth)
        return Job(partial(writing.write, drawing, plan), plan.solve)


class PLANAR_OT_remove_inbetweens(ShapeOperator, bpy.types.Operator):
    bl_idname = "planar.remove_inbetweens"
    bl_label = "Remove In-Betweens"
    bl_description = "Take all generated shapes out: the poses and their timing are as before generating"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        reason = super().refusal(context)
        if reason is None and not stretches.has_inbetweens(context.object):
            return "There are no in-betweens: use Generate In-Betweens first"
        return reason

    def apply(self, context: bpy.types.Context) -> None:
        make_current(context)
        writing.remove(context.object)


CLASSES = (PLANAR_OT_generate_inbetweens, PLANAR_OT_remove_inbetweens)
