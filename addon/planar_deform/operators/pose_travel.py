# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses on their way: to another object, to the other side, back to rest."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import partial

import bpy
from bpy.props import EnumProperty, FloatProperty

from .. import native
from ..errors import Refusal
from ..model.plane.frame import Array
from ..model.posing import solving
from ..model.posing.depths import spread
from ..model.posing.pin_mirror import PinMirror
from ..model.posing.pin_reset import PinReset
from ..model.posing.pins import Holder
from ..model.posing.pose_copy import CopiedPose, copied, pasted
from ..model.posing.posing import PinResult, result_of
from ..model.posing.symmetry import NotSymmetricError, find_symmetry, partner_pins
from ..scene.lattice.posed import PosedObject, begin_posing
from ..scene.objects import modifiers
from ..scene.objects.any_object import begin_shape
from ..scene.objects.connectivity import shape_connectivity
from ..scene.objects.cutout_object import CutoutObject
from ..scene.objects.lattice_object import LatticeObject, in_space, lattice_refusal
from ..scene.pins import joint_list, pin_list
from .keying import auto_key
from .modal import reports
from .posing_operator import PinPosingOperator, PosingOperator

_clipboard: CopiedPose | None = None  # as long as Blender runs, whatever files are opened


class TravelOperator(PosingOperator):
    """Works on the pose of a drawing or of a flat lattice."""

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        obj = context.object
        if obj is None or obj.type != "LATTICE":
            return super().refusal(context)
        if in_space(obj, polled=True):
            return _in_space(obj)
        return lattice_refusal(obj) or modifiers.covering(obj)

    def begin(self, context: bpy.types.Context) -> CutoutObject | LatticeObject:
        """What the pose is of. Raises Refusal."""
        drawing = begin_shape(context)
        if isinstance(drawing, LatticeObject) and not drawing.elements:
            raise Refusal(_in_space(context.object))
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

    def apply(self, context: bpy.types.Context) -> None:
        global _clipboard
        drawing = self.begin(context)
        connectivity = shape_connectivity(drawing)
        pose = copied(connectivity, drawing.rest, drawing.positions, _named(context.object, drawing))
        _clipboard = replace(pose, depths=_depths(drawing))


class PLANAR_OT_paste_pose(TravelOperator, bpy.types.Operator):
    bl_idname = "planar.paste_pose"
    bl_label = "Paste Pose"
    bl_description = "Give the drawing the copied pose"

    def apply(self, context: bpy.types.Context) -> None:
        if _clipboard is None:
            raise Refusal("No pose has been copied: use Copy Pose first")
        obj, drawing = context.object, self.begin(context)
        differs = shape_connectivity(drawing).difference(_clipboard.connectivity)
        if differs is not None:
            raise Refusal(f"The copied pose is of another {obj.type.lower()}: this one has {differs}")
        pose = pasted(_clipboard, drawing.rest, _named(obj, drawing))
        _show(self, context, drawing, *pose, depths=_clipboard.depths)


class PLANAR_OT_mirror_pose(TravelOperator, bpy.types.Operator):
    bl_idname = "planar.mirror_pose"
    bl_label = "Mirror Pose"
    bl_description = (
        "Turn the pose to the other side: vertex by vertex where the drawing is symmetric at rest, else by "
        "its pins, paired by their names (Hand.L, Hand.R) or places"
    )

    axis: EnumProperty(
        name="Axis",
        description="Which sides are swapped",
        items=(
            ("HORIZONTAL", "Left and Right", "Along the first axis of the drawing's plane"),
            ("VERTICAL", "Top and Bottom", "Along the second axis of the drawing's plane"),
        ),
    )
    tolerance: FloatProperty(
        name="Tolerance",
        description="How far the rest shape may be from symmetric, relative to its size",
        default=0.01,
        min=1e-6,
        max=1.0,
        precision=4,
    )

    def apply(self, context: bpy.types.Context) -> None:
        obj, drawing = context.object, self.begin(context)
        rest, tolerance = drawing.rest, self.tolerance * drawing.diagonal
        edges = shape_connectivity(drawing).edges()
        try:
            symmetry = find_symmetry(rest, edges, int(self.axis == "VERTICAL"), tolerance)
        except NotSymmetricError as error:
            if isinstance(drawing, LatticeObject):
                raise Refusal(f"The lattice is not symmetric at rest, as it is sheared: {error}") from error
            self._by_pins(context, drawing, str(error))
            return
        positions = symmetry.mirrored(drawing.positions)
        holders = [holder for _, holder in _named(obj, drawing)]
        results = []
        for index, partner in partner_pins(holders, rest, symmetry, tolerance).items():
            holder, other = holders[index], holders[partner].pin
            if other.target is not None:
                target = symmetry.reflected(other.target)
                results.append(result_of(holder, positions, target, -other.angle, other.scale))
        depths = _depths(drawing)
        depths = None if depths is None else depths[symmetry.partners]
        _show(self, context, drawing, positions, results, depths=depths)

    def _by_pins(self, context: bpy.types.Context, drawing: CutoutObject, why: str) -> None:
        solving.halt()
        obj, cutout = context.object, drawing.cutout
        pins = _named(obj, drawing)
        if not any(holder.pin.enabled for _, holder in pins):
            raise Refusal(
                f"The rest shape is not symmetric: {why}. With pins that are on, it can be mirrored by these"
            )
        poser = joint_list.solver_of(obj, drawing)
        posing = PinMirror(cutout, drawing.positions, pins, int(self.axis == "VERTICAL"), poser)
        try:
            posing.run()
            asked = posing.asked_depths(drawing.depths)
            holders = [holder for _, holder in pins]
            depths = spread(obj.session_uid, cutout, holders, asked, drawing.depths)
        except native.SolveError as error:
            raise Refusal(str(error)) from error
        _show(self, context, drawing, posing.positions, posing.results(), depths=depths)
        self.report({"INFO"}, f"Mirrored by {posing.pairs}, as the rest shape is not symmetric: {why}")


class PLANAR_OT_reset_selected_pins(PinPosingOperator, bpy.types.Operator):
    bl_idname = "planar.reset_selected_pins"
    bl_label = "Reset Selected Pins"
    bl_description = "Take the selected pins back to where they are at rest; the drawing follows"

    def apply(self, context: bpy.types.Context) -> None:
        solving.halt()
        obj, drawing = context.object, begin_posing(context)
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
        _show(self, context, drawing, posing.positions, posing.results())


def _named(obj: bpy.types.Object, drawing: CutoutObject | LatticeObject) -> list[tuple[str, Holder]]:
    """The object's usable pins by name, bound to its cutout; those of a lattice hold what is shown then."""
    if isinstance(drawing, LatticeObject):
        return []
    pin_list.sync(obj)
    usable = pin_list.model_pins(obj, drawing)
    return [(obj.planar.pins[pin.key].name, Holder(pin, drawing.cutout)) for pin in usable]


def _depths(drawing: CutoutObject | LatticeObject) -> Array | None:
    return None if isinstance(drawing, LatticeObject) else drawing.depths


def _show(
    operator: PosingOperator,
    context: bpy.types.Context,
    drawing: PosedObject | LatticeObject,
    positions: Array,
    results: Iterable[PinResult],
    *,
    depths: Array | None = None,
) -> None:
    if depths is not None and isinstance(drawing, CutoutObject):
        drawing.write_with(positions, depths)
    else:
        drawing.write(positions)
    if not isinstance(drawing, LatticeObject):
        pin_list.store_results(context.object, drawing, results)
    reports.inform(operator, auto_key(context))


CLASSES = (
    PLANAR_OT_copy_pose,
    PLANAR_OT_paste_pose,
    PLANAR_OT_mirror_pose,
    PLANAR_OT_reset_selected_pins,
)
