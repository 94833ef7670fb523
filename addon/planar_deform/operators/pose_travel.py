# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses on their way: to other objects, back to rest."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import bpy

from .. import native
from ..errors import Refusal
from ..model.plane.frame import Array
from ..model.posing import solving
from ..model.posing.pin_reset import PinReset
from ..model.posing.pins import Holder
from ..model.posing.pose_copy import CopiedPose, copied, given, pasted
from ..scene.lattice.posed import begin_posing, posing_refusal
from ..scene.objects import modifiers
from ..scene.objects.any_object import begin_shape
from ..scene.objects.connectivity import shape_connectivity
from ..scene.objects.cutout_object import CutoutObject, pose_refusal
from ..scene.objects.lattice_object import LatticeObject, in_space, lattice_refusal
from ..scene.pins import joint_list, pin_list
from ..scene.sequence.playback import Steps
from .modal.reports import Tell
from .posing_operator import TogetherOperator
from .showing import showing

_clipboard: dict[str, CopiedPose] = {}  # by the objects' names; as long as Blender runs, whatever is opened


class TravelOperator(TogetherOperator):
    """Works on the poses of drawings and of flat lattices."""

    @classmethod
    def refusal_of(cls, context: bpy.types.Context, obj: bpy.types.Object | None) -> str | None:
        if obj is None or obj.type != "LATTICE":
            return pose_refusal(obj) or (None if obj is None else modifiers.covering(obj))
        if in_space(obj, polled=True):
            return _in_space(obj)
        return lattice_refusal(obj) or modifiers.covering(obj)


def begin_travel(context: bpy.types.Context, obj: bpy.types.Object) -> CutoutObject | LatticeObject:
    """What a pose is of. Raises Refusal."""
    drawing = begin_shape(context, obj)
    if isinstance(drawing, LatticeObject) and not drawing.elements:
        raise Refusal(_in_space(obj))
    assert isinstance(drawing, CutoutObject | LatticeObject)  # others are refused
    return drawing


def _in_space(lattice: bpy.types.Object) -> str:
    return (
        f"'{lattice.name}' is a lattice in space, whose poses lie in no plane: use Duplicate Pose, or a "
        "lattice with one point in one axis"
    )


class PLANAR_OT_copy_pose(TravelOperator, bpy.types.Operator):
    bl_idname = "planar.copy_pose"
    bl_label = "Copy Pose"
    bl_description = "Copy the pose that is shown, to be pasted on this or an equally built drawing"
    bl_options = {"REGISTER"}

    def steps(
        self, context: bpy.types.Context, objects: list[bpy.types.Object], told: list[str]
    ) -> list[Steps]:
        self._copies: dict[str, CopiedPose] = {}
        return [*super().steps(context, objects, told), self._keep()]

    def begin(self, context: bpy.types.Context, obj: bpy.types.Object, tell: Tell) -> Steps:
        drawing = begin_travel(context, obj)
        connectivity = shape_connectivity(drawing)
        pose = copied(connectivity, drawing.rest, drawing.positions, named_pins(obj, drawing))
        self._copies[obj.name] = replace(pose, depths=depths_of(drawing))
        yield 1.0

    def _keep(self) -> Steps:
        yield 1.0
        _clipboard.clear()
        _clipboard.update(self._copies)


class PLANAR_OT_paste_pose(TravelOperator, bpy.types.Operator):
    bl_idname = "planar.paste_pose"
    bl_label = "Paste Pose"
    bl_description = (
        "Give the drawings the copied poses, each the one of its name, or of one that is built alike"
    )

    def steps(
        self, context: bpy.types.Context, objects: list[bpy.types.Object], told: list[str]
    ) -> list[Steps]:
        if not _clipboard:
            raise Refusal("No pose has been copied: use Copy Pose first")
        self._drawings = {obj.name: begin_travel(context, obj) for obj in objects}
        built = {name: shape_connectivity(drawing) for name, drawing in self._drawings.items()}
        self._given = given(_clipboard, built)
        for obj in objects:
            if obj.name in self._given:
                continue
            source = obj.name if obj.name in _clipboard else next(iter(_clipboard))
            differs = built[obj.name].difference(_clipboard[source].connectivity)
            reason = f"The copied pose is of another {obj.type.lower()}: this one has {differs}"
            if not self._given:
                raise Refusal(reason)
            told.append(f"'{obj.name}' is left out: {reason if differs else 'The poses went to others'}")
        return super().steps(context, [obj for obj in objects if obj.name in self._given], told)

    def begin(self, context: bpy.types.Context, obj: bpy.types.Object, tell: Tell) -> Steps:
        drawing, pose = self._drawings[obj.name], _clipboard[self._given[obj.name]]
        shown = pasted(pose, drawing.rest, named_pins(obj, drawing))
        return showing(context, drawing, *shown, tell, depths=pose.depths)


class PLANAR_OT_reset_selected_pins(TogetherOperator, bpy.types.Operator):
    bl_idname = "planar.reset_selected_pins"
    bl_label = "Reset Selected Pins"
    bl_description = "Take the selected pins back to where they are at rest; the drawing follows"

    @classmethod
    def refusal_of(cls, context: bpy.types.Context, obj: bpy.types.Object | None) -> str | None:
        return posing_refusal(obj) or (None if obj is None else modifiers.covering(obj))

    def steps(
        self, context: bpy.types.Context, objects: list[bpy.types.Object], told: list[str]
    ) -> list[Steps]:
        chosen = [obj for obj in objects if any(pin.select for pin in obj.planar.pins)]
        return super().steps(context, chosen or objects[:1], told)

    def begin(self, context: bpy.types.Context, obj: bpy.types.Object, tell: Tell) -> Steps:
        solving.halt()
        drawing = begin_posing(context, obj)
        pin_list.sync(obj)
        usable = pin_list.model_pins(obj, drawing)
        moving = {pin.key for pin in usable if pin.enabled and obj.planar.pins[pin.key].select}
        if not moving:
            raise Refusal("No pins that hold the drawing are selected: click one first")
        poser = partial(joint_list.solver_of(obj, drawing), drawing.positions)
        posing = PinReset(drawing.cutout, drawing.positions, usable, moving, poser)
        try:
            posing.run()
        except native.SolveError as error:
            raise Refusal(str(error)) from error
        return showing(context, drawing, posing.positions, posing.results(), tell)


def named_pins(obj: bpy.types.Object, drawing: CutoutObject | LatticeObject) -> list[tuple[str, Holder]]:
    """The object's usable pins by name, bound to its cutout; those of a lattice hold what is shown then."""
    if isinstance(drawing, LatticeObject):
        return []
    pin_list.sync(obj)
    usable = pin_list.model_pins(obj, drawing)
    return [(obj.planar.pins[pin.key].name, Holder(pin, drawing.cutout)) for pin in usable]


def depths_of(drawing: CutoutObject | LatticeObject) -> Array | None:
    """How far each point of a drawing is in front; a lattice has no such."""
    return None if isinstance(drawing, LatticeObject) else drawing.depths


CLASSES = (PLANAR_OT_copy_pose, PLANAR_OT_paste_pose, PLANAR_OT_reset_selected_pins)
