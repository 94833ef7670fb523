# SPDX-License-Identifier: GPL-3.0-or-later
"""A pose sequence that is made over to other objects built alike."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Generator

import bpy
import numpy as np

from ... import compat, native
from ...errors import Refusal
from ...model.plane.frame import Array, Array32
from ...model.work import Progress
from ..objects.any_object import AnyObject, begin_shape, is_outline, read_shape
from ..objects.connectivity import shape_connectivity
from ..objects.cutout_object import CutoutObject
from ..objects.lattice_object import space_refusal
from ..pins import pin_list
from ..sequence import playback, pose_curve, pose_edit, pose_showing, pose_state, stretches
from ..sequence.pose_blocks import played
from ..storage import vertex_groups
from ..storage.points import read_block
from ..storage.vertex_groups import members

CHUNK = 64  # frames between two looks at whether anybody still waits
Setting = str | bool
SETTINGS = (
    "anchor_path",
    "smooth",
    "depth_between",
    "curve_before",
)  # of the object, which tell how its in-betweens are made


def transfer_refusal(context: bpy.types.Context) -> str | None:
    """Why there is nothing to transfer a motion to, and what to do about it; None if there may be."""
    if any(obj != context.object for obj in context.selected_objects):
        return None
    return "No other object is selected: select those that are to move alike, then this one"


class Transfer:
    """Read from the scene once: what is transferred, and onto what. Raises Refusal; changes nothing."""

    def __init__(self, context: bpy.types.Context):
        source = context.object
        reason = pose_state.refusal(source) or transfer_refusal(context) or space_refusal(source)
        if reason is not None:
            raise Refusal(reason)
        self._source = begin_shape(context)
        self._connectivity = shape_connectivity(self._source)
        self._receivers = [self._read(obj) for obj in context.selected_objects if obj != source]
        self._blocks = playback.blocks_of(source)
        self._shapes = [read_block(source, block) for block in played(source.data.shape_keys)]
        self._stale = {pose for pose, _ in stretches.stale(source)}
        eval_times = np.array([block.stands_at for block in self._blocks])
        self._eval_times = eval_times, playback.eval_times_of(self._blocks)

    def _read(self, obj: bpy.types.Object) -> AnyObject:
        try:
            receiver = read_shape(obj)
        except Refusal as refusal:
            about = "" if f"'{obj.name}'" in str(refusal) else f"'{obj.name}': "
            raise Refusal(about + str(refusal)) from refusal
        if pose_state.has_blocks(obj):
            raise Refusal(f"'{obj.name}' has poses already: take them away with Clear Poses")
        reason = pose_state.refusal(obj)
        if reason is not None:
            raise Refusal(f"'{obj.name}': {reason}")
        differs = shape_connectivity(receiver).difference(self._connectivity)
        if differs is not None:
            raise Refusal(f"'{obj.name}' is built differently from '{self._source.object_name}': {differs}")
        return receiver

    def solve(self, progress: Progress) -> list[list[Array32]]:
        """The shapes of each receiver, see storage/points.py, in the order of the blocks; for a thread."""
        source = self._source
        frames = [source.flattened(shape) for shape in self._shapes]
        starts = range(0, len(frames), CHUNK)
        result = []
        for count, receiver in enumerate(self._receivers):
            shapes: list[Array32] = []
            side = _side(source, receiver)
            for start in starts:
                if not progress((count + start / len(frames)) / len(self._receivers)):
                    raise native.Cancelled
                chunk = [source.rest, *frames[start : start + CHUNK]]
                moved = native.transfer_motion(chunk, receiver.rest * side, **source.elements)
                shapes += [
                    _shape(receiver, positions * side, source, self._shapes[number])
                    for number, positions in enumerate(moved[1:], start)
                ]
            result.append(shapes)
        return result

    def write(self, shapes: list[list[Array32]]) -> Generator[float, None, None]:
        """Give each receiver its sequence, a block at each step; the share done. Closed before: as it was."""
        begun: list[tuple[AnyObject, list[Setting]]] = []
        written: list[Callable[[], bpy.types.Object]] = []
        try:
            for count, (receiver, own) in enumerate(zip(self._receivers, shapes, strict=True)):
                obj = receiver.resolve()
                begun.append((receiver, [getattr(obj.planar, name) for name in SETTINGS]))
                pose_edit.begin_sequence(obj, receiver.rest_coordinates())
                blocks = [
                    dataclasses.replace(block, shape=shape, source=None)
                    for block, shape in zip(self._blocks, own, strict=True)
                ]
                for share in playback.relay(obj, blocks, self._play):
                    yield (count + share) / len(shapes)
                pose_showing.show_frame(obj)
                written.append(playback.finder(obj))
        except BaseException:
            for receiver, settings in begun:
                _take_back(receiver, settings)
            raise
        for find in written:
            self._finish(find())

    def _finish(self, obj: bpy.types.Object) -> None:
        """Give a receiver without pins those of the source; what is generated is as the source's is."""
        if obj.type == "MESH" and not is_outline(obj) and not obj.planar.pins:
            _pin_alike(self._source.resolve(), obj)
        for index, pose in enumerate(obj.planar.poses):
            if index not in self._stale:
                stretches.mark(obj, [index], edited=pose.edited)

    def _play(self, obj: bpy.types.Object, *_: Array) -> None:
        """Give a receiver that has all blocks the source's timing and settings."""
        source, keys = self._source.resolve(), obj.data.shape_keys
        animation = source.data.shape_keys.animation_data
        if animation is not None and animation.action is not None:
            action = animation.action.copy()
            action.name = f"{obj.name} Poses"
            compat.assign_action(keys.animation_data_create(), action, compat.slot_of(animation))
            pose_curve.follow(keys, *self._eval_times)
        obj.planar.active_pose = source.planar.active_pose
        for name in SETTINGS:
            setattr(obj.planar, name, getattr(source.planar, name))


def _shape(receiver: AnyObject, positions: Array, source: AnyObject, like: Array32) -> Array32:
    """The shape in which a receiver shows positions, with the depths of a shape of the source."""
    if isinstance(source, CutoutObject) and isinstance(receiver, CutoutObject):
        return receiver.coordinates_with(positions, source.depths_of(like))
    return receiver.coordinates(positions)


def _pin_alike(source: bpy.types.Object, obj: bpy.types.Object) -> None:
    """Give an object without pins those of another one that is built alike: it can be posed on at once."""
    groups = members(source, pin_list.groups_of(source))
    for pin in source.planar.pins:
        rows, weights = groups.get(pin.group, pin_list.NOBODY)
        copy = pin_list.add_on_vertices(obj, rows.tolist(), pin.kind)
        vertex_groups.fill(obj.vertex_groups[copy.group], rows, weights)
        for name in ("name", "enabled", "weight"):
            setattr(copy, name, getattr(pin, name))
    obj.planar.active_pin = source.planar.active_pin


def _take_back(receiver: AnyObject, settings: list[Setting]) -> None:
    """Leave an object as it was before it was begun to be written."""
    obj = bpy.data.objects.get(receiver.object_name)
    if obj is None or obj.session_uid != receiver.session_uid:
        return
    if not pose_state.is_ours(obj):  # its blocks are gone again
        pose_edit.end_sequence(obj)
    pose_edit.clear(obj)
    for name, value in zip(SETTINGS, settings, strict=True):
        setattr(obj.planar, name, value)


def _side(source: AnyObject, receiver: AnyObject) -> Array:
    """What takes the receiver's plane coordinates to the source's side: (1, 1), else (-1, 1).

    Faces tell by their winding, and both are seen from their fronts. Lines have none: theirs is the side from
    which both rest shapes are more alike.
    """
    if "edges" not in source.elements:
        return np.ones(2)
    here, there = ((x - x.mean(axis=0)) @ [1.0, 1.0j] for x in (source.rest, receiver.rest))
    mirrored = np.abs(here @ there) > np.abs(here.conj() @ there) * (1.0 + 1e-6)
    return np.array([-1.0 if mirrored else 1.0, 1.0])
