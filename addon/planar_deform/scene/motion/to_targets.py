# SPDX-License-Identifier: GPL-3.0-or-later
"""Taking pins to their targets, now or frame by frame."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.plane.frame import Array
from ...model.posing import solving
from ...model.posing.pin_follow import PinFollow
from ...model.posing.pins import Holder
from ...model.posing.posing import start_of
from ..lattice.posed import PosedObject, read_posed
from ..lattice.posed_lattice import PosedLattice
from ..lattice.rig import waiting
from ..pins import joint_list, pin_list, targets
from ..sequence import playback, pose_edit
from ..storage.vertex_groups import Members
from . import bake

ALONG = 1e-6  # of a unit vector: a camera looks along the normal of a lattice's plane


def followed(
    obj: bpy.types.Object,
    drawing: PosedObject,
    holders: Sequence[Holder],
    positions: Array,
    read_at: Array | None = None,
) -> PinFollow:
    """The posing that takes the pins of an object from positions to where their targets are.

    `holders`: its usable pins. `read_at`: the object's matrix when it was read, if it may have moved since.
    Raises Refusal.
    """
    enabled = [holder for holder in holders if holder.pin.enabled]
    going = [holder for holder in enabled if obj.planar.pins[holder.pin.key].follow is not None]
    if not going:
        following = [key for key, pin in enumerate(obj.planar.pins) if pin.follow is not None]
        raise Refusal(
            waiting(obj, following)
            or "No pin that is on and holds vertices has a target: choose one in the list of pins"
        )
    matrix = np.array(obj.matrix_world, np.float64)
    back = np.eye(4)  # takes the world to where it was about the object when that was read
    if read_at is not None and not np.array_equal(matrix, read_at):
        back = read_at @ np.linalg.inv(matrix)
    goals = {
        holder.pin.key: _goal(obj.planar.pins[holder.pin.key], holder, drawing, back) for holder in going
    }
    poser = partial(joint_list.solver_of(obj, drawing), positions)
    return PinFollow(drawing.cutout, positions, [holder.pin for holder in holders], goals, poser)


def solve(obj: bpy.types.Object, drawing: PosedObject) -> None:
    """Show the object with its pins at their targets. Raises Refusal, with nothing changed."""
    solving.halt()
    pin_list.sync(obj)
    holders = pin_list.bound_pins(obj, drawing, pin_list.read_groups(obj))
    posing = followed(obj, drawing, holders, drawing.positions)
    try:
        posing.run()
    except native.SolveError as error:
        raise Refusal(str(error)) from error
    drawing.write(posing.positions)
    pin_list.store_results(obj, drawing, posing.results())


def bake_frames(obj: bpy.types.Object, frames: range) -> Generator[float, None, None]:
    """Key a pose with the pins at their targets for each of these frames, evenly blended to the next one.

    Each is solved from the one before it, and what was keyed between them goes. Pins without a target stand
    where they were before the first one. The targets are where the frames have them as seen from the object
    itself, which may move; what a lattice deforms is in each frame as it reaches the modifiers then. Live
    goes off. Yields the share done; closed before its end, everything is as it was. Raises Refusal and
    ObjectGone.
    """
    scene, now = bpy.context.scene, bpy.context.scene.frame_current_final
    drawing, groups = read_posed(obj, unkeyed=True), pin_list.read_groups(obj)
    positions, read_at = drawing.positions, np.array(obj.matrix_world, np.float64)
    asked = _asked(drawing, pin_list.bound_pins(obj, drawing, groups))
    holders = _holding(obj, drawing, groups, asked)
    shape, shapes = drawing.coordinates(positions), {}
    try:
        for done, frame in enumerate(frames, 1):
            scene.frame_set(frame)
            solving.halt()
            obj = drawing.resolve()
            if isinstance(drawing, PosedLattice):
                drawing, read_at = _read_lattice_at(obj, frame), np.array(obj.matrix_world, np.float64)
                holders, positions = _holding(obj, drawing, groups, asked), drawing.flattened(shape)
            posing = followed(obj, drawing, holders, positions, read_at)
            posing.run()
            positions = posing.positions
            shape = shapes[float(frame)] = drawing.coordinates(positions)
            yield 0.9 * done / len(frames)
    except native.SolveError as error:
        raise Refusal(str(error)) from error
    finally:
        scene.frame_set(int(now), subframe=now - int(now))
    find = playback.finder(obj)  # keyed, it is stored in another way
    rest = drawing.rest_coordinates()
    for share in pose_edit.put_coordinates(drawing.resolve(), shapes, rest, throughout=True):
        yield 0.9 + 0.1 * share
    bake.blend_evenly(find(), frames)
    find().planar.live = False  # it would show something else than what is keyed


Asked = dict[int, tuple[Array, float]]  # by the key of a pin: where in the object's space, and its angle


def _asked(drawing: PosedObject, holders: Iterable[Holder]) -> Asked:
    """Where pins are to stand, and how they are turned."""
    asked = {}
    for holder in holders:
        place, angle = start_of(holder, drawing.positions)
        asked[holder.pin.key] = (
            drawing.to_local(place[None, :], np.array([holder.part], np.int32))[0],
            angle,
        )
    return asked


def _holding(
    obj: bpy.types.Object,
    drawing: PosedObject,
    groups: Mapping[int, Mapping[str, Members]],
    asked: Asked,
) -> list[Holder]:
    """The usable pins of an object, which stand where they were asked to."""
    holders = []
    for holder in pin_list.bound_pins(obj, drawing, groups):
        if holder.pin.key in asked:
            place, angle = asked[holder.pin.key]
            pin = replace(holder.pin, target=drawing.from_local(place[None, :])[0], angle=angle)
            holder = holder.holding(pin, drawing.cutout)
        holders.append(holder)
    return holders


def _read_lattice_at(obj: bpy.types.Object, frame: int) -> PosedObject:
    """What a lattice deforms at the present frame. Raises Refusal."""
    try:
        return read_posed(obj, unkeyed=True)
    except Refusal as refusal:
        raise Refusal(f"At frame {frame}: {refusal}") from refusal


def _goal(listed: bpy.types.PropertyGroup, holder: Holder, drawing: PosedObject, back: Array) -> Array:
    """Where a pin is to go in the drawing's frame."""
    place = _moved(back, targets.place_of(listed))
    seen = _seen_by_camera(drawing, holder, place, back)
    return _in_depth(drawing, holder, drawing.from_world(place[None, :])[0] if seen is None else seen)


def _moved(back: Array, place: Array) -> Array:
    moved: Array = back[:3, :3] @ place + back[:3, 3]
    return moved


def _in_depth(drawing: PosedObject, holder: Holder, goal: Array) -> Array:
    """A goal at the depth of the pin itself, where it is moved in a plane."""
    if not isinstance(drawing, PosedLattice) or not drawing.flat:
        return goal
    return np.append(goal[:2], holder.place(drawing.positions)[2])


def _seen_by_camera(drawing: PosedObject, holder: Holder, place: Array, back: Array) -> Array | None:
    """Where the scene's camera, if it looks across a flat lattice, sees a place at a pin's depth (2,)."""
    camera = bpy.context.scene.camera
    if not isinstance(drawing, PosedLattice) or not drawing.flat:
        return None
    if camera is None or camera.type != "CAMERA" or camera.data.type != "PERSP":
        return None
    matrix = back @ np.array(camera.matrix_world, np.float64)
    axis = matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
    if abs(float(axis @ drawing.frame.n)) < 1.0 - ALONG:
        return None
    return drawing.plane_from_ray(matrix[:3, 3], place - matrix[:3, 3], holder)
