# SPDX-License-Identifier: GPL-3.0-or-later
"""In-betweens: generated shapes between the keyed poses, one for each whole frame from one to the next.

They are blocks between those of the poses. The curve's values follow, so that a pose is shown when it was,
and with linear timing every generated shape at its frame; all timing stays a matter of the curve. Taking them
out takes the values back, to the bit.

The curve cannot come back to an earlier pose through the blocks in between. Where it does, as in a loop, a
pose of its own repeats the earlier one, and follows it until it is edited; poses that have been moved past
one another in time are put in order. Taking in-betweens out undoes that, too.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import bpy
import numpy as np

from ...errors import NothingToDo, Refusal
from ...model.lattice.pin_places import PinPlaces
from ...model.plane.frame import Array32, Indices
from ...model.posing.held_pins import HeldPin
from ...model.posing.joint_points import JointPoints, points_of
from ...model.posing.pins import Holder
from ...model.timing.order_of_time import Entry, durations, even, frames_between
from ..lattice.pinned_places import pinned_places
from ..objects.any_object import AnyObject, shape_refusal
from ..objects.cutout_object import CutoutObject
from ..objects.lattice_object import LatticeObject, space_refusal
from ..pins import joint_list, pin_list
from ..sequence import pose_state
from ..sequence.pose_blocks import FIRST, HOLD, SPACING, block_at, keyed
from ..sequence.stretches import Stamps, Stretch, depths_held, entries_of, stretches
from ..storage import changes
from ..storage.cage import cage_of
from ..storage.points import read_block
from . import guiding
from .plan import Plan


def refusal(obj: bpy.types.Object | None) -> str | None:
    """Why nothing can be generated for an object, and what to do; None when it can.

    Cheap enough for polls; plan() finds the rest.
    """
    reason = shape_refusal(obj)
    if obj is None or reason is not None:
        return reason
    if not pose_state.is_ours(obj) or len(keyed(obj.data.shape_keys)) < 2:
        return "Key two poses first: Key Pose at one frame, then another one at a later frame"
    return space_refusal(obj, polled=True)


def plan(
    drawing: AnyObject,
    *,
    poses: Sequence[int] | None = None,
    path: str | None = None,
    smooth: bool | None = None,
) -> Plan:
    """What is to be generated for all poses, or for those chosen as if there were no others.

    `path` ("STRAIGHT" or "ARC") and `smooth` are the object's own unless told.

    Stretches that have been edited since they were generated are left as they are, while their poses are the
    same. Raises Refusal; changes nothing.
    """
    obj = drawing.resolve()
    reason = refusal(obj) or space_refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    changes.tell(obj)  # of what a script has done Blender tells later
    found = stretches(obj)
    dropped = set() if poses is None else _eval_times(obj, set(range(len(obj.planar.poses))) - set(poses))
    found = [stretch for stretch in found if stretch.start.source not in dropped]
    starts = [stretch.start.stands_at for stretch in found]
    entries = entries_of(obj, starts)
    played = [index for index, entry in enumerate(entries) if entry.first is not None]
    if len(played) < 2:
        raise Refusal("The curve shows one pose only: key another one at a later frame")
    entries_played = entries[played[0] : played[-1] + 1]
    listed = {pose.at: pose for pose in obj.planar.poses}
    stamps = Stamps(obj)
    made_of, shapes, turns, names = [], [], [], []
    for entry in entries_played:
        pose = listed.get(starts[entry.block])
        eval_time = starts[entry.block]
        if pose is not None and (original := stamps.original(pose)) is not None:
            eval_time = original.at
        made_of.append(stamps.digest(eval_time))
        shapes.append(read_block(obj, block_at(obj.data.shape_keys, eval_time)))
        turns.append(0 if pose is None or entry.copy else pose.turns)
        names.append("" if pose is None or entry.copy else pose.name)
    result = _plan_of(drawing, obj, shapes, turns[:-1], names[:-1])
    if path is not None:
        result.path = path
    if smooth is not None:
        result.smooth = smooth
    result.times = [0.0, *itertools.accumulate(durations(entries_played))]
    result.entries, result.first = entries, played[0]
    result.starts, result.dropped = starts, sorted(dropped)
    for transition, (before, after) in enumerate(itertools.pairwise(entries_played)):
        start, end = found[before.block].start, found[after.block].start
        count = frames_between(before, after)
        if start.pose is None or end.pose is None or made_of[transition] == made_of[transition + 1]:
            count = 0
        elif _stays(stamps, found[before.block], before, after, made_of, transition, result):
            result.kept.add(transition)
            count = 0
        result.counts.append(count)
    result.counts = even(result.counts, entries_played)
    if not any(result.counts) and not result.kept:
        if len(set(made_of)) == 1:
            raise NothingToDo("All poses are alike: there is nothing to fill between them")
        raise NothingToDo("There are no frames to fill between the poses: move their keys apart")
    kept = sum(len(found[entries_played[transition].block].inbetweens) for transition in result.kept)
    generated = sum(result.counts) + kept
    if FIRST + SPACING * (len(entries) + generated) >= HOLD:
        raise Refusal(f"{generated} in-betweens are too many for one object: cut the shot into pieces")
    return result


def way(drawing: AnyObject, poses: Sequence[int], times: Sequence[float]) -> Plan:
    """The way through some poses (indices) at these times; for motion() and coordinates(). Raises Refusal."""
    obj = drawing.resolve()
    chosen = [obj.planar.poses[pose] for pose in poses]
    shapes = [read_block(obj, pose_state.block_of(obj, pose)) for pose in poses]
    turns, names = zip(*((pose.turns, pose.name) for pose in chosen[:-1]), strict=True)
    result = _plan_of(drawing, obj, shapes, list(turns), names)
    result.times = list(times)
    return result


def _plan_of(
    drawing: AnyObject,
    obj: bpy.types.Object,
    shapes: list[Array32],
    turns: list[int],
    names: Sequence[str],
) -> Plan:
    """A plan for these poses, without times and counts; turns and names are of those before transitions."""
    elements, held, places = drawing.elements, _held(drawing, obj), None
    if isinstance(drawing, LatticeObject) and (places := pinned_places(obj, drawing)) is not None:
        joined = places.triangles(drawing.rest, drawing.cells)
        first = len(elements["triangles"])
        elements = {"triangles": np.concatenate([elements["triangles"], joined])}
        held = _held_places(places, len(drawing.rest), elements["triangles"], first)
    hung = _hung(drawing, obj)
    if hung is not None:
        joined = hung.triangles(len(drawing.rest))
        elements = {"triangles": np.concatenate([elements["triangles"], joined])}
    result = Plan(
        drawing=drawing,
        shapes=shapes,
        keys=[drawing.flattened(shape) for shape in shapes],
        rest=drawing.rest,
        elements=elements,
        times=[],
        counts=[],
        turns=turns,
        held=held,
        places=places,
        hung=hung,
        path=obj.planar.anchor_path,
        smooth=obj.planar.smooth,
        cage=cage_of(obj),
        depths_held=depths_held(obj),
    )
    if held:
        result.pin_paths = [guiding.paths(obj, result, number, name) for number, name in enumerate(names)]
    return result


def _hung(drawing: AnyObject, obj: bpy.types.Object) -> JointPoints | None:
    """The points of the joints that are on."""
    if not isinstance(drawing, CutoutObject):
        return None
    return points_of(joint_list.bound_joints(obj, drawing), drawing.rest, drawing.cutout.triangles)


def _held(drawing: AnyObject, obj: bpy.types.Object) -> list[HeldPin]:
    """The enabled pins."""
    if not isinstance(drawing, CutoutObject):
        return []
    found = []
    for pin in pin_list.model_pins(obj, drawing):
        if not pin.enabled:
            continue
        triangles, weights = Holder(pin, drawing.cutout).handle_vertices()
        corners = drawing.faces[triangles]
        rows = corners[np.arange(len(corners)), weights.argmax(axis=1)]
        of_group = drawing.parts[pin.vertices]
        vertices = [pin.vertices[of_group == part] for part in np.unique(of_group)]
        found.append(HeldPin(pin.key, triangles, corners, weights, drawing.parts[rows], vertices))
    return found


def _held_places(places: PinPlaces, first_row: int, triangles: Indices, first: int) -> list[HeldPin]:
    """The pins of a lattice, whose places are vertices from `first_row` on; each begins four triangles."""
    held = []
    for number, key in enumerate(places.keys):
        chosen = np.array([first + 4 * number], np.int32)
        vertices = [np.array([first_row + number], np.int32)]
        weights = np.array([[1.0, 0.0, 0.0]])
        held.append(HeldPin(key, chosen, triangles[chosen], weights, np.zeros(1, np.int32), vertices))
    return held


def _stays(
    stamps: Stamps,
    stretch: Stretch,
    before: Entry,
    after: Entry,
    made_of: list[str],
    transition: int,
    plan: Plan,
) -> bool:
    """Whether what is generated behind a pose has been edited, and is to be generated from the same."""
    record = stretch.start.pose
    if (
        record is None
        or not (record["edited"] and stretch.inbetweens)
        or before.copy
        or after.block != before.block + 1
    ):
        return False
    way = plan.path, plan.smooth, plan.depths_held
    return bool(record["stamp"] == stamps.of(made_of, transition, record["turns"], *way))


def _eval_times(obj: bpy.types.Object, poses: set[int]) -> set[float]:
    return {pose.at for index, pose in enumerate(obj.planar.poses) if index in poses}
