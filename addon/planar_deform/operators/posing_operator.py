# SPDX-License-Identifier: GPL-3.0-or-later
"""What the operators on a mesh that can be posed share."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import bpy

from ..errors import Refusal
from ..scene.lattice.posed import posing_refusal
from ..scene.objects import modifiers
from ..scene.objects.any_object import shape_refusal
from ..scene.objects.cutout_object import pose_refusal
from .modal import running


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
        return {"FINISHED"}

    def apply(self, context: bpy.types.Context) -> None:
        """Do it, in a subclass. Raises Refusal, with nothing changed."""
        raise NotImplementedError


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
