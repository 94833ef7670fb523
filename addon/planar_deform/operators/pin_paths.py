# SPDX-License-Identifier: GPL-3.0-or-later
"""The paths of pins from one pose to the next."""

from __future__ import annotations

import bpy
from bpy.props import IntProperty

from ..errors import Refusal
from ..scene.pins import pin_list
from ..scene.pins.taking_part import TakingPart
from ..scene.sequence.playback import Steps
from ..scene.storage import pin_paths
from .modal.reports import Tell
from .poses import OnePoseOperator


class PinPathOperator(OnePoseOperator):
    """Works on the path of one pin behind one pose."""

    pin: IntProperty(
        name="Pin",
        description="Index of the pin; the active one if negative",
        default=-1,
        min=-1,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def refusal_of(cls, context: bpy.types.Context, obj: bpy.types.Object | None) -> str | None:
        reason = super().refusal_of(context, obj)
        return reason or (None if pin_list.has_pins(obj) else "No pins: add some first")

    @classmethod
    def chosen(cls, context: bpy.types.Context) -> TakingPart:
        return TakingPart([context.object], {})

    def act(self, context: bpy.types.Context, obj: bpy.types.Object, pose: int) -> Steps:
        settings = obj.planar
        pin = settings.active_pin if self.pin < 0 else self.pin
        if not 0 <= pin < len(settings.pins):
            raise Refusal(f"There is no pin {pin}: the object has {len(settings.pins)}")
        self.change(settings.pins[pin], settings.poses[pose].name)
        yield 1.0

    def change(self, pin: bpy.types.PropertyGroup, pose: str) -> None:
        """Do it, in a subclass. Raises Refusal, with nothing changed."""
        raise NotImplementedError


class PLANAR_OT_add_pin_path(PinPathOperator, bpy.types.Operator):
    bl_idname = "planar.add_pin_path"
    bl_label = "Add Pin Path"
    bl_description = (
        "Give the active pin a path and a timing of its own on the way from the active pose to the next one"
    )

    def begin(self, context: bpy.types.Context, obj: bpy.types.Object, tell: Tell) -> Steps:
        """The active pose need not be one of those between which the frame is."""
        yield from super().begin(context, obj, tell)
        names = [pose.name for pose in obj.planar.poses][self._pose_of[obj.name] :]
        way = " to ".join(f"'{name}'" for name in names[:2])
        tell(f"From {way}: choose its path in the panel In-Betweens")

    def change(self, pin: bpy.types.PropertyGroup, pose: str) -> None:
        if pin_paths.path_of(pin, pose) is not None:
            raise Refusal(f"Pin '{pin.name}' has a path from '{pose}' already: change it in the panel")
        pin.paths.add().pose = pose


class PLANAR_OT_remove_pin_path(PinPathOperator, bpy.types.Operator):
    bl_idname = "planar.remove_pin_path"
    bl_label = "Remove Pin Path"
    bl_description = "Let the pin go its own way again from this pose to the next one"

    def change(self, pin: bpy.types.PropertyGroup, pose: str) -> None:
        if pin_paths.path_of(pin, pose) is None:
            raise Refusal(f"Pin '{pin.name}' has no path from '{pose}'")
        pin_paths.remove(pin, pose)


CLASSES = (PLANAR_OT_add_pin_path, PLANAR_OT_remove_pin_path)
