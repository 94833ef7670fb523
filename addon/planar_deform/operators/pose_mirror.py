# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses turned to the other side: of a drawing by itself, or from one drawing to the one opposite."""

from __future__ import annotations

from collections.abc import Callable

import bpy
from bpy.props import EnumProperty, FloatProperty

from .. import native
from ..errors import Refusal
from ..model.plane.frame import Array
from ..model.posing import other_side, solving
from ..model.posing.depths import spread
from ..model.posing.other_side import OtherSide, Reflection, Side
from ..model.posing.pin_mirror import PinMirror
from ..model.posing.pins_led import PinsLed
from ..model.posing.posing import result_of
from ..model.posing.symmetry import NotSymmetricError, find_symmetry, partner_pins
from ..scene.objects.connectivity import shape_connectivity
from ..scene.objects.cutout_object import CutoutObject
from ..scene.objects.lattice_object import LatticeObject
from ..scene.pins import joint_list
from ..scene.sequence.playback import Steps
from .modal.reports import Tell, counted
from .pose_travel import TravelOperator, begin_travel, depths_of, named_pins
from .showing import showing


class PLANAR_OT_mirror_pose(TravelOperator, bpy.types.Operator):
    bl_idname = "planar.mirror_pose"
    bl_label = "Mirror Pose"
    bl_description = (
        "Turn the pose to the other side: vertex by vertex where the drawing is symmetric at rest, else by "
        "its pins, paired by their names (Hand.L, Hand.R) or places. Of several drawings, two whose names or "
        "pins tell so (Arm.L, Arm.R) exchange their poses"
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

    def steps(
        self, context: bpy.types.Context, objects: list[bpy.types.Object], told: list[str]
    ) -> list[Steps]:
        solving.halt()
        self._drawings = {obj.name: begin_travel(context, obj) for obj in objects}
        cutouts = [obj for obj in objects if isinstance(self._drawings[obj.name], CutoutObject)]
        self._opposites = other_side.opposites(
            {obj.name: [pin.name for pin in obj.planar.pins] for obj in cutouts}
        )
        frame = self._drawings[objects[0].name].frame
        self._across = frame.v if self.axis == "VERTICAL" else frame.u
        return super().steps(context, objects, told)

    def begin(self, context: bpy.types.Context, obj: bpy.types.Object, tell: Tell) -> Steps:
        drawing = self._drawings[obj.name]
        opposite = self._drawings.get(self._opposites.get(obj.name, ""))
        if isinstance(drawing, CutoutObject) and isinstance(opposite, CutoutObject):
            shown = self._from_other_side(context, obj, drawing, opposite, tell)
            if shown is not None:
                return shown
        return self._by_itself(context, obj, drawing, tell)

    # ---- from one drawing to another

    def _from_other_side(
        self,
        context: bpy.types.Context,
        obj: bpy.types.Object,
        drawing: CutoutObject,
        opposite: CutoutObject,
        tell: Tell,
    ) -> Steps | None:
        """The pose of the opposite drawing, in the mirror; None where nothing tells how it is led."""
        side, source = _side(obj, drawing), _side(opposite.resolve(), opposite)
        reflection = Reflection.of(drawing.frame, opposite.frame, self._across)
        try:
            found = other_side.mirrored(side, source, reflection, self.tolerance * drawing.diagonal)
        except NotSymmetricError:
            try:
                posing = OtherSide(side, source, reflection, joint_list.solver_of(obj, drawing))
            except ValueError:
                return None
            depths = _solved(obj, posing, side, posing.asked_depths)
            tell(f"Mirrored from '{opposite.object_name}' by {posing.pairs} of its pins")
            return showing(context, drawing, posing.positions, posing.results(), tell, depths=depths)
        return showing(context, drawing, found.positions, found.results, tell, depths=found.depths)

    # ---- each by itself

    def _by_itself(
        self,
        context: bpy.types.Context,
        obj: bpy.types.Object,
        drawing: CutoutObject | LatticeObject,
        tell: Tell,
    ) -> Steps:
        rest, tolerance = drawing.rest, self.tolerance * drawing.diagonal
        edges = shape_connectivity(drawing).edges()
        try:
            symmetry = find_symmetry(rest, edges, int(self.axis == "VERTICAL"), tolerance)
        except NotSymmetricError as error:
            if isinstance(drawing, LatticeObject):
                raise Refusal(f"The lattice is not symmetric at rest, as it is sheared: {error}") from error
            return self._by_pins(context, obj, drawing, str(error), tell)
        positions = symmetry.mirrored(drawing.positions)
        holders = [holder for _, holder in named_pins(obj, drawing)]
        results = []
        for index, partner in partner_pins(holders, rest, symmetry, tolerance).items():
            holder, other = holders[index], holders[partner].pin
            if other.target is not None:
                target = symmetry.reflected(other.target)
                results.append(result_of(holder, positions, target, -other.angle, other.scale))
        depths = depths_of(drawing)
        depths = None if depths is None else depths[symmetry.partners]
        return showing(context, drawing, positions, results, tell, depths=depths)

    def _by_pins(
        self,
        context: bpy.types.Context,
        obj: bpy.types.Object,
        drawing: CutoutObject,
        why: str,
        tell: Tell,
    ) -> Steps:
        side = _side(obj, drawing)
        if not any(holder.pin.enabled for _, holder in side.pins):
            raise Refusal(
                f"The rest shape is not symmetric: {why}. With pins that are on, it can be mirrored by these"
            )
        poser = joint_list.solver_of(obj, drawing)
        posing = PinMirror(side.cutout, side.positions, side.pins, int(self.axis == "VERTICAL"), poser)
        depths = _solved(obj, posing, side, lambda: posing.asked_depths(side.depths))
        by = f"by {counted(posing.pairs, 'pair')} of pins, as" if posing.pairs else "with no pairs of pins;"
        tell(f"Mirrored {by} the rest shape is not symmetric: {why}")
        return showing(context, drawing, posing.positions, posing.results(), tell, depths=depths)


def _side(obj: bpy.types.Object, drawing: CutoutObject) -> Side:
    edges = shape_connectivity(drawing).edges()
    return Side(drawing.cutout, drawing.positions, drawing.depths, edges, named_pins(obj, drawing))


def _solved(
    obj: bpy.types.Object, posing: PinsLed, side: Side, asked: Callable[[], dict[int, float]]
) -> Array:
    """The depths that go with what a posing of an object comes to, which is solved. Raises Refusal."""
    try:
        posing.run()
        holders = [holder for _, holder in side.pins]
        return spread(obj.session_uid, side.cutout, holders, asked(), side.depths)
    except native.SolveError as error:
        raise Refusal(str(error)) from error


CLASSES = (PLANAR_OT_mirror_pose,)
