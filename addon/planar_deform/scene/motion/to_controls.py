# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins taken to where what they follow wants them.

A drawing, or a lattice, always begins with the same shape: with what its poses show at the frame, or without
poses with its rest. So what is shown depends on the frame and on where things are then, and not on what was
shown before. Pins that follow nothing stand where they were asked to, with poses where these have them, or
where they have been posed by hand at this frame.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.plane.frame import Array, Array32, is_of
from ...model.posing import solving
from ...model.posing.joints import Joint, hanging_on
from ...model.posing.pin_follow import Goal, PinFollow, nearest_turn
from ...model.posing.pins import Holder
from ...model.posing.posing import start_of, start_scale_of
from ..lattice.posed import PosedObject
from ..lattice.posed_lattice import PosedLattice
from ..lattice.rig import waiting
from ..objects.cutout_object import CutoutObject, read_cutout
from ..pins import controls, dependencies, followed_mesh, joint_list, partners, pin_list
from ..sequence import pose_state

ALONG = 1e-6  # of a unit vector: a camera looks along the normal of a lattice's plane


def solve(
    obj: bpy.types.Object,
    drawing: PosedObject,
    frame: float,
    depsgraph: bpy.types.Depsgraph,
    *,
    beside: bool = False,
    keeps_hand: bool = False,
) -> None:
    """Show the object with its pins where what they follow wants them.

    `beside`: while another object is dragged, whose solver goes on. `keeps_hand`: what shows a pose that was
    made by hand at this frame, and that no frame has, goes on from that; see at_frame(). Raises Refusal, with
    nothing changed.
    """
    by_hand = keeps_hand and pose_state.unkeyed(obj) and pin_list.posed_by_hand(obj, frame)
    if not beside:
        solving.halt()
    pin_list.sync(obj)
    try:
        posing, shape = at_frame(obj, drawing, frame, depsgraph, by_hand=by_hand)
    except native.SolveError as error:
        raise Refusal(str(error)) from error
    if shape is None:
        drawing.write(posing.positions)
    else:
        drawing.show(shape)
    pin_list.store_results(obj, drawing, posing.results(), by_hand=by_hand)


def at_frame(
    obj: bpy.types.Object,
    drawing: PosedObject,
    frame: float,
    depsgraph: bpy.types.Depsgraph,
    read_at: Array | None = None,
    *,
    by_hand: bool = False,
) -> tuple[PinFollow, Array32 | None]:
    """The posing that has come to the shape of a frame, and that shape if the drawing has poses.

    `read_at`: as in followed(). `by_hand`: pins that follow nothing stand where they are in `drawing`, and
    not where the poses have them. Raises Refusal and native.SolveError.
    """
    groups = pin_list.read_groups(obj)
    holders = pin_list.bound_pins(obj, drawing, groups)
    cutout = isinstance(drawing, CutoutObject)
    joints = joint_list.bound_joints(obj, drawing, groups) if cutout else []
    shown = pose_state.shape_at(obj, frame) if pose_state.is_ours(obj) else None
    begin = _rest(drawing, holders, joints) if shown is None else drawing.flattened(shown)
    standing = {}
    if shown is None or by_hand:
        for holder in holders:
            scale = start_scale_of(holder, drawing.positions)
            standing[holder.pin.key] = Goal(*start_of(holder, drawing.positions), scale)
    unposed = [
        holder.holding(replace(holder.pin, target=None, angle=0.0, scale=1.0), drawing.cutout)
        for holder in holders
    ]
    posing = followed(obj, drawing, unposed, begin, depsgraph, read_at, standing, joints)
    posing.run()
    return posing, None if shown is None else drawing.moved(shown, posing.positions)


def look_at_carriers(obj: bpy.types.Object, frame: float, depsgraph: bpy.types.Depsgraph) -> None:
    """Find what the drawings show with Live on, on whose meshes an object hangs, where nothing is written.

    Raises Refusal and native.SolveError.
    """
    followed_mesh.evaluated()
    for carrier in dependencies.in_order(dependencies.above(obj)):
        if carrier.type != "MESH" or not pin_list.has_pins(carrier) or not carrier.planar.live:
            continue
        if controls.stamp(carrier, frame, depsgraph):
            drawing = read_cutout(carrier, unkeyed=True)
            posing, shape = at_frame(carrier, drawing, frame, depsgraph)
            followed_mesh.wrote(carrier, drawing.coordinates(posing.positions) if shape is None else shape)


def _rest(drawing: PosedObject, holders: Sequence[Holder], joints: Sequence[Joint]) -> Array:
    """The rest shape of all that pins hold and of what hangs on it; other parts stay where they are."""
    if not isinstance(drawing, CutoutObject):
        return drawing.flattened(drawing.rest_coordinates())
    held = hanging_on({holder.part for holder in holders if holder.pin.enabled}, joints)
    rest: Array = np.where(is_of(drawing.parts, held)[:, None], drawing.rest, drawing.positions)
    return rest


def followed(
    obj: bpy.types.Object,
    drawing: PosedObject,
    holders: Sequence[Holder],
    positions: Array,
    depsgraph: bpy.types.Depsgraph,
    read_at: Array | None = None,
    standing: Mapping[int, Goal] | None = None,
    joints: Sequence[Joint] | None = None,
) -> PinFollow:
    """The posing that takes the pins of an object from positions to where what they follow wants them.

    `holders`: its usable pins. `read_at`: the object's matrix when it was read, if not now. `standing`: where
    pins are to be that follow nothing, if not where they are. `joints`: those that
    hold two of its parts, if they have been read. Raises Refusal.
    """
    enabled = [holder for holder in holders if holder.pin.enabled]
    going = [holder for holder in enabled if obj.planar.pins[holder.pin.key].follow is not None]
    if not going:
        following = [key for key, pin in enumerate(obj.planar.pins) if pin.follow is not None]
        raise Refusal(
            waiting(obj, following)
            or "No pin that is on and holds vertices follows anything: choose what in the list of pins"
        )
    read = np.array(obj.matrix_world, np.float64) if read_at is None else read_at
    matrix = controls.matrix_of(obj, depsgraph)
    back = np.eye(4)  # takes the world to where it was about the object when that was read
    if not np.array_equal(matrix, read):
        back = read @ np.linalg.inv(matrix)
    goals = dict(standing or {})
    for holder in going:
        pin = obj.planar.pins[holder.pin.key]
        goal = _goal(pin, holder, drawing, positions, back, depsgraph)
        stood = goals.get(holder.pin.key)
        goals[holder.pin.key] = goal if stood is None else goal._replace(scale=stood.scale)
    poser = partial(joint_list.solver_of(obj, drawing, joints), positions)
    pins, cutout = [holder.pin for holder in holders], drawing.cutout
    posing = PinFollow(cutout, positions, pins, goals, poser)
    posing.mirrored = partners.going_along(obj, cutout, pins, {holder.pin.key for holder in going})
    return posing


def _goal(
    listed: bpy.types.PropertyGroup,
    holder: Holder,
    drawing: PosedObject,
    positions: Array,
    back: Array,
    depsgraph: bpy.types.Depsgraph,
) -> Goal:
    """Where a pin is to go in the drawing's frame."""
    matrix = back @ controls.goal_of(listed, depsgraph)
    seen = _seen_by_camera(drawing, holder, matrix[:3, 3], back, depsgraph)
    place = drawing.from_world(matrix[None, :3, 3])[0] if seen is None else seen
    angle = None
    if holder.pin.kind == "PATCH" and drawing.cutout.flat:
        angle = _turn(listed, holder, drawing, positions, matrix[:3, 0])
    return Goal(_in_depth(drawing, holder, place), angle)


def _turn(
    listed: bpy.types.PropertyGroup, holder: Holder, drawing: PosedObject, positions: Array, axis: Array
) -> float | None:
    """The angle from rest of a patch whose first axis is to be this one of the world (3,)."""
    frame = drawing.frame
    unturned = drawing.axis_to_world(np.array(listed.follow_axis, np.float64))
    along, at_rest = (complex(float(one @ frame.u), float(one @ frame.v)) for one in (axis, unturned))
    if not along or not at_rest:  # across the plane
        return None
    return nearest_turn(float(np.angle(along / at_rest)), start_of(holder, positions)[1])


def _in_depth(drawing: PosedObject, holder: Holder, goal: Array) -> Array:
    """A goal at the depth of the pin itself, where it is moved in a plane."""
    if not isinstance(drawing, PosedLattice) or not drawing.flat:
        return goal
    return np.append(goal[:2], holder.place(drawing.positions)[2])


def _seen_by_camera(
    drawing: PosedObject, holder: Holder, place: Array, back: Array, depsgraph: bpy.types.Depsgraph
) -> Array | None:
    """Where the scene's camera, if it looks across a flat lattice, sees a place at a pin's depth (2,)."""
    if not isinstance(drawing, PosedLattice) or not drawing.flat:
        return None
    camera = depsgraph.scene.camera
    if camera is None or camera.type != "CAMERA" or camera.data.type != "PERSP":
        return None
    matrix = back @ np.array(camera.matrix_world, np.float64)
    axis = matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
    if abs(float(axis @ drawing.frame.n)) < 1.0 - ALONG:
        return None
    return drawing.plane_from_ray(matrix[:3, 3], place - matrix[:3, 3], holder)
