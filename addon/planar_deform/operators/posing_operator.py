# SPDX-License-Identifier: GPL-3.0-or-later
"""What the operators on a mesh that can be posed share."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import bpy

from ..errors import Refusal, naming
from ..scene.lattice.posed import posing_refusal
from ..scene.objects import modifiers
from ..scene.objects.any_object import shape_refusal
from ..scene.objects.cutout_object import pose_refusal
from ..scene.pins.taking_part import TakingPart, taking_part
from ..scene.sequence import playback
from ..scene.storage import redraw
from .modal import reports, running
from .modal.reports import Tell, telling


class Refusing:
    """Greyed out where `refusal` gives a reason, which the tooltip tells."""

    poll_message_set: ClassVar[Callable[[str], None]]  # of Blender's operators

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        """Why this cannot be used at present, and what to do: the mesh cannot be posed, or not be seen."""
        return pose_refusal(context.object) or modifiers.covering(context.object)

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        reason = cls.refusal(context)
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None


class PosingOperator(Refusing):
    """Works on a mesh that can be posed; every refusal is a report, and changes nothing.

    It ends what is running, see modal/running.py.
    """

    bl_options = {"REGISTER", "UNDO"}
    report: Callable[[set[str], str], None]  # of Blender's operators

    def execute(self, context: bpy.types.Context) -> set[str]:
        running.end()
        try:
            self.apply(context)
        except Refusal as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        redraw.views()  # panels, too, which Blender does not do for what a script sets of pins and poses
        return {"FINISHED"}

    def apply(self, context: bpy.types.Context) -> None:
        """Do it, in a subclass. Raises Refusal, with nothing changed."""
        raise NotImplementedError


class ForAll(Refusing):
    """Does the same to all objects that take part, see scene/pins/taking_part.py: to all of them, or to none.

    Those for which `refusal_of` gives a reason are left out, which is told, unless it does so for all.
    """

    @classmethod
    def refusal_of(cls, context: bpy.types.Context, obj: bpy.types.Object | None) -> str | None:
        """Why it cannot be done to an object, and what to do, in a subclass."""
        raise NotImplementedError

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        reasons = [cls.refusal_of(context, obj) for obj in taking_part(context).objects or [None]]
        return None if None in reasons else reasons[0]

    @classmethod
    def chosen(cls, context: bpy.types.Context) -> TakingPart:
        """The objects that it is done to, and why it is not to others. Raises Refusal if there are none."""
        found, left_out = taking_part(context)
        reasons = {obj.name: cls.refusal_of(context, obj) for obj in found}
        left_out |= {name: reason for name, reason in reasons.items() if reason is not None}
        chosen = [obj for obj in found if reasons[obj.name] is None]
        if not chosen:
            raise Refusal(next(iter(left_out.values()), cls.refusal_of(context, None) or ""))
        return TakingPart(chosen, left_out)


class TogetherOperator(ForAll, PosingOperator):
    """Does so at once."""

    def apply(self, context: bpy.types.Context) -> None:
        chosen = self.chosen(context)
        told: list[str] = []
        playback.run(playback.together(self.steps(context, chosen.objects, told)))
        self.tell([*told, *left_out_told(chosen)])

    def steps(
        self, context: bpy.types.Context, objects: list[bpy.types.Object], told: list[str]
    ) -> list[playback.Steps]:
        """What does it to each, see playback.together(), when all of them have been checked.

        `told` takes what the user is to be told. Raises Refusal, with nothing changed.
        """
        several = len(objects) > 1
        steps = []
        for obj in objects:
            name = obj.name if several else None
            with naming(name):
                steps.append(playback.named(name, self.begin(context, obj, telling(told, name))))
        return steps

    def begin(self, context: bpy.types.Context, obj: bpy.types.Object, tell: Tell) -> playback.Steps:
        """What does it to one of them, in a subclass. Raises Refusal, with nothing changed."""
        raise NotImplementedError

    def tell(self, told: list[str]) -> None:
        """Report what was done otherwise than one may think."""
        reports.inform(self, ". ".join(told) or None)


def left_out_told(chosen: TakingPart) -> list[str]:
    """What to tell of those that were left out."""
    return [f"'{name}' is left out: {reason}" for name, reason in chosen.left_out.items()]


class PinPosingOperator(PosingOperator):
    """Works on what pins pose, which lattices are as well as meshes with faces."""

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return posing_refusal(context.object) or modifiers.covering(context.object)


class ShapeOperator(PosingOperator):
    """Works on shapes over time, which outlines have as well as meshes with faces."""

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return shape_refusal(context.object)
