# SPDX-License-Identifier: GPL-3.0-or-later
"""Attaching drawings and other objects to the mesh of a drawing that carries them, and letting them go."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty

from ..errors import Refusal
from ..scene.motion import carrying, hanging, live
from ..scene.objects import vertex_parents
from ..scene.objects.cutout_object import begin, pose_refusal
from ..scene.pins import controls, pin_list
from .modal import running
from .modal.reports import counted
from .posing_operator import PosingOperator, Refusing


class PLANAR_OT_attach_to(PosingOperator, bpy.types.Operator):
    bl_idname = "planar.attach_to"
    bl_label = "Attach to Drawing"
    bl_description = (
        "Let the other selected objects go with the mesh of the active drawing, from where they are: "
        "drawings by their selected pins, or by all, everything else as a whole"
    )

    whole: BoolProperty(
        name="As a Whole",
        description=(
            "Carry drawings with pins as rigid objects, too, parented to three vertices. Their pins and "
            "poses stay their own"
        ),
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return pose_refusal(context.object) or (
            None
            if _others(context)
            else "Select what is to be carried first, and the drawing that carries it last"
        )

    def apply(self, context: bpy.types.Context) -> None:
        drawing = begin(context)
        carrier = drawing.resolve()
        others = _others(context)
        by_pins = [] if self.whole else [obj for obj in others if _has_own_pins(obj)]
        hung = [hanging.checked(obj, drawing) for obj in others if obj not in by_pins]
        done: list[tuple[bpy.types.Object, list[int], carrying.Before]] = []
        try:
            for obj in by_pins:
                keys = controls.chosen(obj)
                done.append((obj, keys, carrying.Before(obj, keys)))
                carrying.carry(obj, keys, carrier)
        except Refusal:
            for _, _, before in reversed(done):
                before.restore()
            raise
        for obj, _, before in done:
            before.tidy()
            obj.planar.live = True
        for one in hung:
            hanging.hang(one, carrier)
        context.view_layer.update()
        for obj in by_pins:
            live.stands(obj, context.evaluated_depsgraph_get())
        pins = sum(len(keys) for _, keys, _ in done)
        told = [counted(pins, "pin")] * bool(pins) + [counted(len(hung), "object")] * bool(hung)
        left = sum(not pin_list.is_joint(pin) for obj in by_pins for pin in obj.planar.pins) - pins
        stay = "are not stay" if left > 1 else "is not stays"
        others_stay = f", those that are selected; {left} that {stay} as posed"
        self.report({"INFO"}, f"Attached {' and '.join(told)} to '{carrier.name}'" + others_stay * bool(left))


class PLANAR_OT_detach_from(Refusing, bpy.types.Operator):
    bl_idname = "planar.detach_from"
    bl_label = "Detach from Drawing"
    bl_description = (
        "Let the selected objects go with the mesh of no drawing any more, by their selected pins, or all; "
        "they stay where they are"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return None if context.selected_objects else "Nothing is selected: select what is carried"

    def execute(self, context: bpy.types.Context) -> set[str]:
        running.end()
        count = 0
        for obj in context.selected_objects:
            if obj.library is not None or obj.override_library is not None:
                continue
            if pin_list.has_pins(obj):
                count += carrying.let_go(obj, controls.chosen(obj))
            if vertex_parents.is_hanging(obj):
                hanging.take_down(obj)
                count += 1
        if not count:
            self.report({"WARNING"}, "Nothing that is selected goes with a drawing's mesh")
            return {"CANCELLED"}
        return {"FINISHED"}


def _others(context: bpy.types.Context) -> list[bpy.types.Object]:
    """What is to be carried, in a stable order."""
    return sorted(
        (obj for obj in context.selected_objects if obj != context.object), key=lambda obj: str(obj.name)
    )


def _has_own_pins(obj: bpy.types.Object) -> bool:
    return pin_list.has_pins(obj) and bool(controls.chosen(obj))


CLASSES = (PLANAR_OT_attach_to, PLANAR_OT_detach_from)
