# SPDX-License-Identifier: GPL-3.0-or-later
"""The rest shape's two commands."""

from __future__ import annotations

import bpy

from ..scene.lattice.posed import PosedObject, begin_posing, posing_refusal
from ..scene.objects import modifiers, rest_shape
from ..scene.pins import controls, pin_list
from ..scene.sequence.playback import Steps
from .modal.reports import Tell
from .posing_operator import PosingOperator, TogetherOperator


class PLANAR_OT_set_rest_to_current(PosingOperator, bpy.types.Operator):
    bl_idname = "planar.set_rest_to_current"
    bl_label = "Set as Rest"
    bl_description = (
        "Take the current shape as the rest shape. With shape keys, the pose in the active key goes into "
        "the Basis and the other keys keep their differences"
    )

    def apply(self, context: bpy.types.Context) -> None:
        with controls.beside(context.object):
            rest_shape.set_to_current(context.object)
        pin_list.forget_targets(context.object)


class PLANAR_OT_reset_to_rest(TogetherOperator, bpy.types.Operator):
    bl_idname = "planar.reset_to_rest"
    bl_label = "Reset to Rest"
    bl_description = (
        "Take the pose away: the mesh, or the active shape key, goes back to the rest shape, the pins with it"
    )

    @classmethod
    def refusal_of(cls, context: bpy.types.Context, obj: bpy.types.Object | None) -> str | None:
        return posing_refusal(obj) or (None if obj is None else modifiers.covering(obj))

    def begin(self, context: bpy.types.Context, obj: bpy.types.Object, tell: Tell) -> Steps:
        return _resetting(begin_posing(context, obj))


def _resetting(drawing: PosedObject) -> Steps:
    before = pin_list.SavedResults(drawing.resolve())
    try:
        drawing.write_rest()
        pin_list.forget_targets(drawing.resolve())
        yield 1.0
    except BaseException:
        drawing.restore()
        before.restore(drawing.resolve())
        raise


CLASSES = (PLANAR_OT_set_rest_to_current, PLANAR_OT_reset_to_rest)
