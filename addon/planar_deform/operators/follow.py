# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins that follow objects and bones: what they follow, where they are beside it, and baked."""

from __future__ import annotations

from collections.abc import Generator

import bpy
from bpy.props import EnumProperty, StringProperty

from ..errors import Refusal
from ..scene.lattice.posed import PosedObject, begin_posing
from ..scene.motion import bake_pins, follow_offset, make_controls, to_controls
from ..scene.pins import controls, pin_list
from ..scene.sequence import playback
from .bake import BakeOperator
from .keying import auto_key
from .modal import reports
from .pins import PinOperator
from .posing_operator import PinPosingOperator


def _refusal(context: bpy.types.Context) -> str | None:
    """Why no pin can follow anything at present, and what to do."""
    reason = PinPosingOperator.refusal(context)
    if reason is None and not (pin_list.has_pins(context.object) and controls.follows_any(context.object)):
        reason = "No pin follows anything: choose what below Follow, or use Add Controls"
    return reason


class FollowOperator(PinOperator):
    """Works on the selected pins, all if none is selected, that follow something."""

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return _refusal(context)

    @staticmethod
    def following(obj: bpy.types.Object) -> list[int]:
        """Their indices. Raises Refusal if there are none."""
        keys = [key for key in controls.chosen(obj) if obj.planar.pins[key].follow is not None]
        if not keys:
            raise Refusal("No selected pin follows anything: select pins that do")
        return keys


class PLANAR_OT_follow_now(PinPosingOperator, bpy.types.Operator):
    bl_idname = "planar.follow_now"
    bl_label = "Follow Now"
    bl_description = "Take the pins to where what they follow is now, the other ones hold"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return _refusal(context)

    def apply(self, context: bpy.types.Context) -> None:
        _solve(context, begin_posing(context))
        told: list[str] = []
        playback.run(auto_key(context, context.object, told.append))
        reports.inform(self, ". ".join(told) or None)


class PLANAR_OT_set_follow_offset(FollowOperator, bpy.types.Operator):
    bl_idname = "planar.set_follow_offset"
    bl_label = "Set Offset"
    bl_description = "Let the selected pins follow from where they are now"

    def change(self, obj: bpy.types.Object, drawing: PosedObject) -> None:
        follow_offset.keep(obj, self.following(obj))


class PLANAR_OT_clear_follow_offset(FollowOperator, bpy.types.Operator):
    bl_idname = "planar.clear_follow_offset"
    bl_label = "Clear Offset"
    bl_description = "Take the selected pins to the origin of what they follow; the turn of patches stays"

    def apply(self, context: bpy.types.Context) -> None:
        drawing, obj = begin_posing(context), context.object
        keys = self.following(obj)
        before = {key: tuple(obj.planar.pins[key].follow_offset) for key in keys}
        follow_offset.clear(obj, keys)
        try:
            _solve(context, drawing)
        except Refusal:
            for key, offset in before.items():
                obj.planar.pins[key].follow_offset = offset
            raise


class PLANAR_OT_add_controls(PinOperator, bpy.types.Operator):
    bl_idname = "planar.add_controls"
    bl_label = "Add Controls"
    bl_description = (
        "Add an Empty at each selected pin, at all if none is selected, and let the pins follow them, live"
    )

    def change(self, obj: bpy.types.Object, drawing: PosedObject) -> None:
        keys = [key for key in controls.chosen(obj) if obj.planar.pins[key].follow is None]
        if not keys:
            raise Refusal("There is no pin that follows nothing yet: add or select one")
        added = make_controls.add(obj, drawing, keys)
        obj.planar.live = True
        _select(added)


class PLANAR_OT_follow_bones(PinOperator, bpy.types.Operator):
    bl_idname = "planar.follow_bones"
    bl_label = "Follow Bones"
    bl_description = "Let the selected pins, or all if none is, follow the nearest bones of an armature, live"

    armature: StringProperty(
        name="Armature",
        description="Object whose bones are followed; by default the selected one, or the only one there is",
        options={"SKIP_SAVE"},
    )

    def change(self, obj: bpy.types.Object, drawing: PosedObject) -> None:
        rig = self._rig()
        self.armature = rig.name
        keys = controls.chosen(obj)
        if not keys:
            raise Refusal("There are no pins: add some first")
        make_controls.follow_bones(obj, drawing, keys, rig)
        obj.planar.live = True

    def _rig(self) -> bpy.types.Object:
        """Raises Refusal."""
        if self.armature:
            named = bpy.context.scene.objects.get(self.armature)
            if named is None or named.type != "ARMATURE":
                raise Refusal(f"There is no armature '{self.armature}' in the scene: choose another one")
            return named
        selected = [obj for obj in bpy.context.selected_objects if obj.type == "ARMATURE"]
        rigs = selected or [obj for obj in bpy.context.view_layer.objects if obj.type == "ARMATURE"]
        if len(rigs) != 1:
            found = "There are several armatures" if rigs else "There is no armature"
            raise Refusal(f"{found}: select the one to follow, and the drawing last")
        return rigs[0]

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.prop_search(self, "armature", context.scene, "objects", icon="ARMATURE_DATA")


class PLANAR_OT_bake_pins(BakeOperator, bpy.types.Operator):
    bl_idname = "planar.bake_pins"
    bl_label = "Bake Pins"
    bl_description = "Keep for every frame the shape with the pins where what they follow is then"

    to: EnumProperty(name="To", description="What the frames become", items=bake_pins.FORMS)

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return _refusal(context)

    def steps(self, obj: bpy.types.Object, frames: range) -> Generator[float, None, None]:
        if self.to == "POSES":
            return bake_pins.to_poses(obj, frames)
        return bake_pins.to_point_cache(obj, frames, self.filepath, replace=self.replace)


def _solve(context: bpy.types.Context, drawing: PosedObject) -> None:
    """Raises Refusal."""
    frame = context.scene.frame_current_final
    to_controls.solve(context.object, drawing, frame, context.evaluated_depsgraph_get(), keeps_hand=True)


def _select(objects: list[bpy.types.Object]) -> None:
    """These alone, the first of them active."""
    layer = bpy.context.view_layer
    for other in layer.objects:
        other.select_set(other in objects)
    layer.objects.active = objects[0]


CLASSES = (
    PLANAR_OT_follow_now,
    PLANAR_OT_set_follow_offset,
    PLANAR_OT_clear_follow_offset,
    PLANAR_OT_add_controls,
    PLANAR_OT_follow_bones,
    PLANAR_OT_bake_pins,
)
