# SPDX-License-Identifier: GPL-3.0-or-later
"""In-betweens: generated, and removed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import bpy
from bpy.props import BoolProperty, EnumProperty

from .. import native
from ..errors import NothingToDo, Refusal, naming
from ..model.plane.frame import Array
from ..model.work import Progress, part_of
from ..scene.inbetweens import planning, writing
from ..scene.inbetweens.plan import Plan
from ..scene.objects.any_object import AnyObject, begin_shape, shape_refusal
from ..scene.objects.flat_object import make_current
from ..scene.properties import PATHS
from ..scene.sequence import playback, stretches
from ..scene.sequence.playback import Steps
from .modal.long_job import Job, LongOperator
from .modal.reports import Tell
from .posing_operator import ForAll, TogetherOperator, left_out_told

ONCE = {"SKIP_SAVE"}  # what is not told is the object's own, not that of the last use


class PLANAR_OT_generate_inbetweens(ForAll, LongOperator, bpy.types.Operator):
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
    def refusal_of(cls, context: bpy.types.Context, obj: bpy.types.Object | None) -> str | None:
        return planning.refusal(obj)

    def job(self, context: bpy.types.Context) -> Job:
        chosen = self.chosen(context)
        told, ways, idle = left_out_told(chosen), [], []
        path = self.path if self.properties.is_property_set("path") else None
        smooth = self.smooth if self.properties.is_property_set("smooth") else None
        for obj in chosen.objects:
            name = obj.name if len(chosen.objects) > 1 else None
            try:
                with naming(name):
                    drawing = begin_shape(context, obj)
                    ways.append(_Way(name, drawing, planning.plan(drawing, path=path, smooth=smooth)))
            except NothingToDo as refusal:
                idle.append(refusal)
        if not ways:
            raise idle[0]
        told += map(str, idle)
        self.path, self.smooth = ways[0].plan.path, ways[0].plan.smooth
        return Job(
            partial(_write, ways), partial(_solve, ways), (lambda _: ". ".join(told)) if told else None
        )


@dataclass(frozen=True)
class _Way:
    """What is generated for one object."""

    name: str | None  # for refusals; None: it is the only one
    drawing: AnyObject
    plan: Plan


def _solve(ways: Sequence[_Way], progress: Progress) -> list[Sequence[Array]]:
    """The shapes of each. Raises native.Cancelled and Refusal."""
    shapes: list[Sequence[Array]] = []
    for number, way in enumerate(ways):
        try:
            shapes.append(way.plan.solve(part_of(progress, number, len(ways))))
        except native.SolveError as error:
            with naming(way.name):
                raise Refusal(str(error)) from error
    return shapes


def _write(ways: Sequence[_Way], shapes: Sequence[Sequence[Array]]) -> Steps:
    """See Job."""
    steps = [
        playback.named(way.name, writing.write(way.drawing, way.plan, one))
        for way, one in zip(ways, shapes, strict=True)
    ]
    return playback.together(steps)


class PLANAR_OT_remove_inbetweens(TogetherOperator, bpy.types.Operator):
    bl_idname = "planar.remove_inbetweens"
    bl_label = "Remove In-Betweens"
    bl_description = "Take all generated shapes out: the poses and their timing are as before generating"

    @classmethod
    def refusal_of(cls, context: bpy.types.Context, obj: bpy.types.Object | None) -> str | None:
        reason = shape_refusal(obj)
        if obj is not None and reason is None and not stretches.has_inbetweens(obj):
            return "There are no in-betweens: use Generate In-Betweens first"
        return reason

    def begin(self, context: bpy.types.Context, obj: bpy.types.Object, tell: Tell) -> Steps:
        make_current(context, obj)
        return writing.removing(obj)


CLASSES = (PLANAR_OT_generate_inbetweens, PLANAR_OT_remove_inbetweens)
