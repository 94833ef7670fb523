# SPDX-License-Identifier: GPL-3.0-or-later
"""Hanging parts of a drawing together by joints, and taking these away."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty

from ..errors import Refusal
from ..model.plane.frame import Array, Indices
from ..model.posing import attaching, joints
from ..model.posing.attaching import Attachment
from ..scene.objects.cutout_object import CutoutObject, begin
from ..scene.pin_properties import JOINT_KINDS
from ..scene.pins import joint_list, pin_list
from .modal import running
from .modal.pin_selection import select_only
from .modal.reports import counted
from .pins import ON_MESH, PinListChange
from .posing_operator import PosingOperator

ONE_PART = (
    "The drawing is all one part: join the layers that hang together as one object (Ctrl-J), or select others"
)
NEW_RADIUS = 0.05  # of a weld, of the diagonal


class JointOperator(PosingOperator):
    """Changes the joints of a mesh of several parts."""

    def apply(self, context: bpy.types.Context) -> None:
        obj, drawing = context.object, begin(context)
        if not drawing.parts.any():
            raise Refusal(ONE_PART)
        pin_list.check_groups_of(obj)
        pin_list.sync(obj)
        self.change(obj, drawing)

    def change(self, obj: bpy.types.Object, drawing: CutoutObject) -> None:
        """Change the joints, in a subclass. Raises Refusal, with nothing changed."""
        raise NotImplementedError


class WeldRadius:
    """How far from its place a weld holds vertices."""

    radius: FloatProperty(
        name="Radius",
        description="How far from it a weld holds vertices, at rest; 0: a twentieth of the drawing",
        subtype="DISTANCE",
        unit="LENGTH",
        min=0.0,
    )


class PLANAR_OT_attach(JointOperator, bpy.types.Operator):
    bl_idname = "planar.attach"
    bl_label = "Attach"
    bl_description = (
        "Hang the parts of the drawing together that lie on each other at rest: each by a joint on another "
        "one. Joints that are there stay"
    )

    def change(self, obj: bpy.types.Object, drawing: CutoutObject) -> None:
        cutout = drawing.cutout
        there = [joint.parts for joint in joint_list.bound_joints(obj, drawing)]
        found = attaching.attachments(cutout, drawing.heights, there)
        if not found:
            raise Refusal(
                "All parts that lie on each other hang together already"
                if there
                else "No parts of the drawing lie on each other at rest: lay them so and use Set as Rest"
            )
        select_only(obj, set())
        welds = 0
        for attachment in found:
            joint = _added(obj, drawing, attachment)
            joint.select = True
            welds += joint.kind == "WELD"
        told = [counted(len(found) - welds, "hinge")] * (welds < len(found)) + [counted(welds, "weld")] * (
            welds > 0
        )
        hanging = {part for pair in there for part in pair}
        hanging.update(part for one in found for part in (one.carrier, one.carried))
        alone = int(drawing.parts.max()) + 1 - len(hanging)
        left = f"; not attached: {counted(alone, 'part')}, on which no other lies at rest" * bool(alone)
        self.report({"INFO"}, f"Attached by {' and '.join(told)}{left}")


class PLANAR_OT_add_joint(WeldRadius, JointOperator, bpy.types.Operator):
    bl_idname = "planar.add_joint"
    bl_label = "Add Joint"
    bl_description = "Hang two parts of the drawing together at a place where they lie on each other at rest"

    location: FloatVectorProperty(
        name="Location", description="World position of the joint", subtype="TRANSLATION", unit="LENGTH"
    )
    kind: EnumProperty(name="Kind", description="How the joint holds the two parts", items=JOINT_KINDS)
    extend: BoolProperty(
        name="Extend", description="Keep the selected pins selected", default=False, options={"SKIP_SAVE"}
    )

    def draw(self, _context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.use_property_split = True
        column.prop(self, "kind")
        if self.kind == "WELD":
            column.prop(self, "radius")

    def change(self, obj: bpy.types.Object, drawing: CutoutObject) -> None:
        cutout = drawing.cutout
        upper = drawing.nearest(np.array(self.location, np.float64), ON_MESH * cutout.diagonal)
        if upper is None:
            raise Refusal("No mesh there: add the joint where two parts lie on each other")
        corners = cutout.triangles[upper.triangle]
        part, place = int(cutout.parts[corners[0]]), upper.weights @ cutout.rest[corners]
        below = [
            other
            for other in drawing.parts_by_height(part)
            if joints.point_on(cutout, other, place).distance <= joints.ON * cutout.diagonal
        ]
        if not below:
            raise Refusal("No other part lies there at rest: add the joint where two parts lie on each other")
        joint = _add(obj, drawing, Attachment(below[0], part, place, self.kind == "WELD"), self.radius)
        if not self.extend:
            select_only(obj, set())
        joint.select = True


class PLANAR_OT_set_weld_radius(WeldRadius, JointOperator, bpy.types.Operator):
    bl_idname = "planar.set_weld_radius"
    bl_label = "Set Weld Radius"
    bl_description = (
        "Make welds of the selected joints: each holds what of its parts is within a radius at rest"
    )

    def change(self, obj: bpy.types.Object, drawing: CutoutObject) -> None:
        cutout = drawing.cutout
        found = [
            joint for joint in joint_list.bound_joints(obj, drawing) if obj.planar.pins[joint.key].select
        ]
        if not found:
            raise Refusal("No joints that hold two parts are selected: click one first")
        held = [
            _welded(drawing, joint.parts, joint.place(cutout.rest, cutout.triangles), self.radius)
            for joint in found
        ]
        for joint, rows in zip(found, held, strict=True):
            pin = obj.planar.pins[joint.key]
            pin_list.rebind(obj, pin, drawing.vertex_indices[rows], np.ones(len(rows)))
            pin.kind = "WELD"


class PLANAR_OT_detach(PinListChange, bpy.types.Operator):
    bl_idname = "planar.detach"
    bl_label = "Detach"
    bl_description = "Remove the selected joints, or all if none is selected; the drawing stays as it is"

    def change(self, context: bpy.types.Context) -> set[str]:
        running.end()
        obj = context.object
        if not (joint_list.remove(obj, selected=True) or joint_list.remove(obj, selected=False)):
            self.report({"WARNING"}, "There are no joints to remove")
            return {"CANCELLED"}
        return {"FINISHED"}


def _add(
    obj: bpy.types.Object, drawing: CutoutObject, attachment: Attachment, radius: float
) -> bpy.types.PropertyGroup:
    """Add a joint, named after the layer that it carries; a weld holds what is within the radius.

    Raises Refusal.
    """
    parts = (attachment.carrier, attachment.carried)
    name = joint_list.layer_of(obj, drawing.vertex_indices[drawing.parts == attachment.carried])
    if attachment.rigid:
        rows = _welded(drawing, parts, attachment.place, radius)
        return joint_list.add(obj, "WELD", drawing.vertex_indices[rows], np.ones(len(rows)), name)
    rows, weights = joints.hinge_binding(drawing.cutout, parts, attachment.place)
    return joint_list.add(obj, "HINGE", drawing.vertex_indices[rows], weights, name)


def _added(obj: bpy.types.Object, drawing: CutoutObject, attachment: Attachment) -> bpy.types.PropertyGroup:
    """Add a joint that has been found; a weld, which holds all of its part, where it can hold anything."""
    try:
        return _add(obj, drawing, attachment, _reach(drawing, attachment))
    except Refusal:
        return _add(obj, drawing, replace(attachment, rigid=False), 0.0)


def _reach(drawing: CutoutObject, attachment: Attachment) -> float:
    """How far the carried part reaches from its joint, at rest."""
    arms = drawing.cutout.rest[drawing.parts == attachment.carried] - attachment.place
    return float(np.linalg.norm(arms, axis=1).max())


def _welded(drawing: CutoutObject, parts: tuple[int, int], place: Array, radius: float) -> Indices:
    """What a weld holds at a place: rows of both parts within a radius at rest (0: that of a new one), and of
    each the corners of the triangle there. Raises Refusal.
    """
    cutout = drawing.cutout
    near = np.isin(cutout.parts, parts)
    near &= np.linalg.norm(cutout.rest - place, axis=1) <= (radius or NEW_RADIUS * cutout.diagonal)
    for part in parts:
        near[cutout.triangles[joints.point_on(cutout, part, place).triangle]] = True
    rows = np.flatnonzero(near).astype(np.int32)
    if joints.bound(0, "WELD", rows, np.ones(len(rows)), cutout) is None:
        raise Refusal("Fewer than two vertices lie on the other part there: make the radius larger")
    return rows


CLASSES = (PLANAR_OT_attach, PLANAR_OT_add_joint, PLANAR_OT_set_weld_radius, PLANAR_OT_detach)
