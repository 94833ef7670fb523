# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins in front of the rest of the drawing, and behind it."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, FloatProperty

from ..model.posing import solving
from ..model.posing.depths import DEEPEST
from ..scene.image import blended_materials
from ..scene.objects.flat_object import make_current
from ..scene.pins import pin_depths
from ..scene.sequence import playback
from .keying import auto_key
from .modal import reports
from .posing_operator import PosingOperator


class PLANAR_OT_set_depth(PosingOperator, bpy.types.Operator):
    bl_idname = "planar.set_depth"
    bl_label = "Set Depth"
    bl_description = (
        "Bring the drawing forward at the selected pins, or send it backward, where it lies on itself"
    )

    depth: FloatProperty(
        name="Depth",
        description="How far in front, below 0 behind",
        default=1.0,
        min=-DEEPEST,
        max=DEEPEST,
        soft_min=-3.0,
        soft_max=3.0,
        step=100,
        precision=2,
    )
    relative: BoolProperty(
        name="Relative", description="Add it to the depth that each pin has", options={"SKIP_SAVE"}
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return pin_depths.refusal(context.object)

    def apply(self, context: bpy.types.Context) -> None:
        solving.halt()
        make_current(context)
        obj = context.object
        chosen = [index for index, pin in enumerate(obj.planar.pins) if pin.select]
        farthest = pin_depths.give(obj, chosen, self.depth, relative=self.relative)
        told: list[str] = [] if farthest is None else [farthest]
        playback.run(auto_key(context, obj, told.append))
        reports.inform(self, ". ".join(told) or None)


class PLANAR_OT_dither_materials(PosingOperator, bpy.types.Operator):
    bl_idname = "planar.dither_materials"
    bl_label = "Dither Materials"
    bl_description = "Let EEVEE dither the object's materials instead of blending them, so that depths count"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return blended_materials.refusal(context.object)

    def apply(self, context: bpy.types.Context) -> None:
        count = blended_materials.dither(context.object)
        reports.inform(self, f"{count} {'material is' if count == 1 else 'materials are'} dithered")


CLASSES = (PLANAR_OT_set_depth, PLANAR_OT_dither_materials)
