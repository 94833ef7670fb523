# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses on their way: to another object, to the other side, back to rest."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

import bpy
from bpy.props import EnumProperty, FloatProperty

from .. import native
from ..errors import Refusal
from ..model.plane.frame import Array
from ..model.posing import solver_cache, solving
from ..model.posing.pin_mirror import PinMirror
from ..model.posing.pin_reset import PinReset
from ..model.posing.pins import Holder
from ..model.posing.pose_copy import CopiedPose, copied, pasted
from ..model.posing.posing import PinResult
from ..model.posing.symmetry import NotSymmetricError, find_symmetry, partner_pins
from ..scene.objects.connectivity import connectivity_of
from ..scene.objects.cutout_object import CutoutObject, begin
from ..scene.pins import pin_list
from .keying import auto_key
from .posing_operator import PosingOperator

_clipboard: CopiedPose | None = None  # as long as Blender runs, whatever files are opened


class PLANAR_OT_copy_pose(PosingOperator, bpy.types.Operator):
    bl_idname = "planar.copy_pose"
    bl_label = "Copy Pose"
    bl_description = "Copy the pose that is shown, to be pasted on this or an equally built drawing"
    bl_options = {"REGISTER"}

    def apply(self, context: bpy.types.Context) -> None:
        global _clipboard
        drawing = begin(context)
        connectivity = connectivity_of(context.object.data, drawing.vertex_indices)
        _clipboard = copied(connectivity, drawing.cutout, drawing.positions, _named(context.object, drawing))


class PLANAR_OT_paste_pose(PosingOperator, bpy.types.Operator):
    bl_idname = "planar.paste_pose"
    bl_label = "Paste Pose"
    bl_description = "Give the drawing the copied pose"

    def apply(self, context: bpy.types.Context) -> None:
        if _clipboard is None:
            raise Refusal("No pose has been copied: use Copy Pose first")
        obj, drawing = context.object, begin(context)
        differs = connectivity_of(obj.data, drawing.vertex_indices).difference(_clipboard.connectivity)
        if differs is not None:
            raise Refusal(f"The copied pose is of another mesh: this one has {differs}")
        _show(self, context, drawing, *pasted(_clipboard, drawing.cutout, _named(obj, drawing)))


class PLANAR_OT_mirror_pose(PosingOperator, bpy.types.Operator):
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
        obj, drawing = context.object, begin(context)
        rest, tolerance = drawing.cutout.rest, self.tolerance * drawing.cutout.diagonal
        edges = connectivity_of(obj.data, drawing.vertex_indices).edges()
        try:
            symmetry = find_symmetry(rest, edges, int(self.axis == "VERTICAL"), tolerance)
        except NotSymmetricError as error:
            self._by_pins(context, drawing, str(error))
            return
        positions = symmetry.mirrored(drawing.positions)
        holders = [holder for _, holder in _named(obj, drawing)]
        results = []
        for index, partner in partner_pins(holders, rest, symmetry, tolerance).items():
            holder, other = holders[index], holders[partner].pin
            if other.target is not None:
                target = symmetry.reflected(other.target)
                place = holder.place(positions)
                results.append(PinResult(holder.pin.key, holder.part, target, place, -other.angle))
        _show(self, context, drawing, positions, results)

    def _by_pins(self, context: bpy.types.Context, drawing: CutoutObject, why: str) -> None:
        solving.halt()
        obj, cutout = context.object, drawing.cutout
        pins = _named(obj, drawing)
        if not any(holder.pin.enabled for _, holder in pins):
            raise Refusal(
                f"The rest shape is not symmetric: {why}. With pins that are on, it can be mirrored by these"
            )
        poser = partial(solver_cache.poser_for, drawing.session_uid, cutout, obj.planar.method.lower())
        posing = PinMirror(cutout, drawing.positions, pins, int(self.axis == "VERTICAL"), poser)
        try:
            posing.run()
        except native.SolveError as error:
            raise Refusal(str(error)) from error
        _show(self, context, drawing, posing.positions, posing.results())
        self.report({"INFO"}, f"Mirrored by {posing.pairs}, as the rest shape is not symmetric: {why}")


class PLANAR_OT_reset_selected_pins(PosingOperator, bpy.types.Operator):
    bl_idname = "planar.reset_selected_pins"
    bl_label = "Reset Selected Pins"
    bl_description = "Take the selected pins back to where they are at rest; the drawing follows"

    def apply(self, context: bpy.types.Context) -> None:
        solving.halt()
        obj, drawing = context.object, begin(context)
        pin_list.sync(obj)
        usable = pin_list.model_pins(obj, drawing)
        moving = {pin.key for pin in usable if pin.enabled and obj.planar.pins[pin.key].select}
        if not moving:
            raise Refusal("No pins that hold the drawing are selected: click one first")
        method = obj.planar.method.lower()
        poser = partial(
            solver_cache.poser_for, drawing.session_uid, drawing.cutout, method, drawing.positions
        )
        posing = PinReset(drawing.cutout, drawing.positions, usable, moving, poser)
        try:
            posing.run()
        except native.SolveError as error:
            raise Refusal(str(error)) from error
        _show(self, context, drawing, posing.positions, posing.results())


def _named(obj: bpy.types.Object, drawing: CutoutObject) -> list[tuple[str, Holder]]:
    """The object's usable pins by name, bound to its cutout."""
    pin_list.sync(obj)
    usable = pin_list.model_pins(obj, drawing)
    return [(obj.planar.pins[pin.key].name, Holder(pin, drawing.cutout)) for pin in usable]


def _show(
    operator: PosingOperator,
    context: bpy.types.Context,
    drawing: CutoutObject,
    positions: Array,
    results: Iterable[PinResult],
) -> None:
    drawing.write(positions)
    pin_list.store_results(context.object, drawing, results)
    told = auto_key(context)
    if told is not None:
        operator.report({"INFO"}, told)


CLASSES = (
    PLANAR_OT_copy_pose,
    PLANAR_OT_paste_pose,
    PLANAR_OT_mirror_pose,
    PLANAR_OT_reset_selected_pins,
)
