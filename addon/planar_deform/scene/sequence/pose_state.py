# SPDX-License-Identifier: GPL-3.0-or-later
"""The pose sequence: shapes kept over time, as absolute shape keys that one F-curve plays.

Blocks, in the order of their place on the curve, which is what eval_time has to be to show them:

    Basis          0             the rest shape
    Before Poses   < FIRST       the shape before the sequence was begun, or the user's own key "Pose"
    poses          FIRST + 8 i   the keyed poses in the order of time, and what is generated in between
    hold, scratch  HOLD, SCRATCH only while an unkeyed pose is shown, see below

`eval_time` has one F-curve with a key for each keyed pose, whose value is the place of the pose's block; the
curve alone says when a pose is shown, so that the user times and eases them in Blender's own editors. A pose
whose key was duplicated there is shown, and edited, at several frames; one whose key was removed has none.
Keys with other values are the user's retiming and stay what they are. `Object.planar.poses` lists the poses
by the places of their blocks; what else is in the played range is no keyed pose.

The played range begins far above the blocks below it, and ends in a copy of its last shape far above that: a
curve that overshoots holds the first or the last pose, as at the ends of any sequence of absolute shape keys.

An unkeyed pose is written to the scratch block and shown by setting `eval_time`, which any frame change takes
back, as it does with every animated value. No curve reaches it: below it comes the hold.

Beginning changes only how shapes are stored. Without shape keys the rest shape becomes the Basis and the
object's own shape is kept in a block. A mesh with a Basis and at most one key "Pose", which is what posing
makes, keeps both. `clear` undoes exactly that. Other shape keys, drivers and actions are the user's and are
refused.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import bpy
import numpy as np

from ... import compat
from ...errors import Refusal
from ...model.plane.frame import Array
from ...model.timing.played_curve import SAME_FRAME, SAME_PLACE
from ..storage import points
from ..storage.shape_keys import POSE_KEY
from . import playback, pose_curve, pose_insertion
from .pose_blocks import (
    FIRST,
    HOLD,
    SCRATCH,
    add,
    blended,
    block_at,
    keyed,
    own_curve,
    places,
    played,
    shown_curve,
    take_out,
)

ON_A_COPY = "work on a copy of the object, with Apply All in the Shape Keys panel's menu"


def has_blocks(obj: bpy.types.Object) -> bool:
    """Whether the mesh has shape keys of a pose sequence."""
    keys = obj.data.shape_keys
    return keys is not None and any(block_at(keys, pose.at) is not None for pose in obj.planar.poses)


def is_ours(obj: bpy.types.Object) -> bool:
    """Whether the object shows a pose sequence."""
    return has_blocks(obj) and not obj.data.shape_keys.use_relative


def absence(obj: bpy.types.Object) -> str | None:
    """Why nothing can be done with the object's poses: that there are none; None when there are some."""
    return None if is_ours(obj) else "No poses are keyed: use Key Pose first"


def refusal(obj: bpy.types.Object) -> str | None:
    """Why poses of the object cannot be keyed, and what to do about it; None when they can."""
    keys = obj.data.shape_keys
    if keys is None:
        return None
    if obj.show_only_shape_key:
        return "Only the active shape key is shown: turn off Shape Key Lock in the Shape Keys panel"
    ours = has_blocks(obj)
    reason = _own_blocks_refusal(keys) if ours else _foreign_blocks_refusal(keys)
    return reason or _animation_refusal(keys, ours)


def _own_blocks_refusal(keys: bpy.types.Key) -> str | None:
    if keys.use_relative:
        return "Keyed poses are absolute shape keys: turn off Relative in the Shape Keys panel"
    out_of_order = np.flatnonzero(np.diff(places(keys)) < SAME_PLACE)
    if len(out_of_order):
        name = keys.key_blocks[int(out_of_order[0]) + 1].name
        return f"Shape key '{name}' came from another object's poses: undo joining them, or clear those first"
    return None


def _foreign_blocks_refusal(keys: bpy.types.Key) -> str | None:
    if not keys.use_relative:
        return f"The mesh has absolute shape keys of its own: {ON_A_COPY}"
    others = [block.name for block in keys.key_blocks[1:]]
    if others not in ([], [POSE_KEY]) or places(keys).max() >= FIRST:
        names = ", ".join(others[:3]) + (", ..." if others[3:] else "")
        return f"The mesh has shape keys of its own ({names}): {ON_A_COPY}"
    return None


def _animation_refusal(keys: bpy.types.Key, ours: bool) -> str | None:
    animation = keys.animation_data
    if animation is None:
        return None
    if animation.drivers:
        return "The shape keys have drivers: delete them in the Drivers editor"
    if animation.nla_tracks:
        return "The shape keys are animated in the Nonlinear Animation editor: delete their tracks there"
    if animation.action is None:
        return None
    if not ours:
        return (
            f"The shape keys have an action of their own ('{animation.action.name}'): unlink it in the "
            "Dope Sheet's Shape Key Editor, or work on a copy of the object"
        )
    if not animation.action.is_editable:
        return "The poses' action is linked from a library: make it local in the Dope Sheet"
    for curve in compat.curves_of(animation) or ():
        if curve.data_path != "eval_time":
            return "The poses' action animates something else, too: delete its other curves in the Dope Sheet"
        if curve.lock or (curve.group is not None and curve.group.lock):
            return "The poses' curve is locked: open its lock in the Graph Editor"
        if curve.sampled_points:
            return "The poses' curve is made of samples: turn them into keys in the Graph Editor"
    return None


# -- reading


def frames_of(obj: bpy.types.Object, pose: int) -> list[float]:
    """The frames at which a keyed pose stands on the curve, in order."""
    return frames_at(obj, obj.planar.poses[pose].at)


def frames_at(obj: bpy.types.Object, place: float) -> list[float]:
    """The frames at which keys of the curve have this value, in order."""
    timeline = keyed(obj.data.shape_keys)
    frames: list[float] = timeline[np.abs(timeline[:, 1] - place) < SAME_PLACE, 0].tolist()
    return frames


def pose_at(obj: bpy.types.Object, frame: float) -> int | None:
    """The index of the pose that is keyed at a frame."""
    timeline = keyed(obj.data.shape_keys)
    for value in timeline[np.abs(timeline[:, 0] - frame) < SAME_FRAME, 1]:
        for index, pose in enumerate(obj.planar.poses):
            if abs(pose.at - value) < SAME_PLACE:
                return index
    return None


def shown_points(obj: bpy.types.Object) -> np.ndarray:
    """The shape that is shown at present, see storage/points.py. Raises Refusal as pose_blocks.blended()."""
    return blended(obj, obj.data.shape_keys.eval_time)


def shape_at(obj: bpy.types.Object, frame: float) -> np.ndarray:
    """The shape that the sequence shows at any frame, see storage/points.py. Raises Refusal as blended()."""
    keys = obj.data.shape_keys
    curve = shown_curve(keys)
    return blended(obj, keys.eval_time if curve is None else curve.evaluate(frame))


def unkeyed(obj: bpy.types.Object) -> bool:
    """Whether what is shown is a pose that no frame has."""
    return is_ours(obj) and obj.data.shape_keys.eval_time > HOLD


def keyed_pose_shown(obj: bpy.types.Object, frame: float) -> bpy.types.ShapeKey | None:
    """The block of the pose that is keyed at this frame, if that is what is shown."""
    pose = pose_at(obj, frame)
    if pose is None:
        return None
    at = obj.planar.poses[pose].at
    keys = obj.data.shape_keys
    return block_at(keys, at) if abs(keys.eval_time - at) < SAME_PLACE else None


# -- writing


def put_coordinates(
    obj: bpy.types.Object,
    shapes: Mapping[float, np.ndarray],
    rest: np.ndarray | None = None,
    *,
    throughout: bool = False,
) -> Iterator[float]:
    """Key a pose for each shape (by frame; see storage/points.py), step by step; yields the share done.

    A frame at which a pose is keyed gets the new one in its place, with its easing; the object's sequence is
    begun, with the shape `rest`, if it has none. `throughout`: keys between the frames go away, with what
    only they show and what is generated there. Closed before its end, everything is back to the bit. Raises
    Refusal, with nothing changed.
    """
    reason = refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    begun = not is_ours(obj)
    if begun:
        begin_sequence(obj, rest)
    frames = {float(frame): shape for frame, shape in shapes.items()}
    try:
        yield from pose_insertion.insert(obj, frames, throughout=throughout)
    except BaseException:
        if begun:
            end_sequence(obj)
        raise
    drop_scratch(obj)
    latest = pose_at(obj, max(frames))
    if latest is not None:
        activate(obj, latest)
    show_frame(obj)


def activate(obj: bpy.types.Object, pose: int) -> None:
    """Make a pose the active one, in our list and in Blender's, where Edit Mode edits it."""
    obj.planar.active_pose = pose
    keys = obj.data.shape_keys
    block = block_at(keys, obj.planar.poses[pose].at)
    if block is not None:
        obj.active_shape_key_index = keys.key_blocks.find(block.name)


def remove(obj: bpy.types.Object, pose: int) -> None:
    """Take a pose out of the sequence, and its keys; with the last one the sequence ends.

    What is generated before and behind it stays, and is stale, but not at the ends of the sequence.
    """
    if len(obj.planar.poses) == 1:
        clear(obj)
        return
    place = obj.planar.poses[pose].at

    def then(obj: bpy.types.Object, old: Array, new: Array) -> None:
        keys = obj.data.shape_keys
        pose_curve.remove_keys(keys, np.abs(keyed(keys)[:, 1] - place) < SAME_PLACE)
        playback.follow(obj, old, new)
        curve = own_curve(keys)
        if curve is not None:
            curve.update()  # of a pose without keys none were removed

    blocks = [block for block in playback.blocks_of(obj) if block.source != place]
    playback.run(playback.relay(obj, pose_insertion.close_up(blocks), then))
    drop_scratch(obj)
    activate(obj, max(0, min(obj.planar.active_pose, len(obj.planar.poses) - 1)))
    show_frame(obj)


def clear(obj: bpy.types.Object) -> None:
    """End the sequence: everything is as it was before it was begun, to the bit."""
    settings = obj.planar
    if is_ours(obj):
        end_sequence(obj)
    settings.poses.clear()
    settings.active_pose = 0
    settings.curve_before = ""


def end_sequence(obj: bpy.types.Object) -> None:
    """Take all blocks away, and their curve."""
    settings = obj.planar
    keys = obj.data.shape_keys
    below = [block for block in keys.key_blocks if block.frame < FIRST - SAME_PLACE]
    # It may raise Refusal, while nothing has changed.
    before = points.read_block(obj, below[-1]) if below else points.read(obj)
    action = None if keys.animation_data is None else keys.animation_data.action
    keys.animation_data_clear()
    if action is not None and not action.users:
        bpy.data.actions.remove(action)
    for name in [block.name for block in keys.key_blocks if block.frame > FIRST - SAME_PLACE]:
        obj.shape_key_remove(keys.key_blocks[name])
    keys.eval_time = 0.0
    if settings.key_before < 0:
        obj.shape_key_clear()
        points.write(obj, before)
    else:
        keys.use_relative = True
        obj.active_shape_key_index = settings.key_before
    points.update(obj)


def show_unkeyed(obj: bpy.types.Object, coordinates: np.ndarray) -> None:
    """Show a shape until the frame changes."""
    keys = obj.data.shape_keys
    scratch = block_at(keys, SCRATCH)
    if scratch is not None and keys.eval_time == SCRATCH:
        points.write_block(scratch, coordinates)
        return
    drop_scratch(obj)  # of another frame: since then, the last pose may have become another
    add(obj, "Hold", HOLD, points.read_block(obj, played(keys)[-1]))
    add(obj, "Unkeyed", SCRATCH, coordinates)


def drop_scratch(obj: bpy.types.Object) -> None:
    """Take the place of unkeyed poses away. What is shown then is for the caller to say."""
    for place in (SCRATCH, HOLD):
        block = block_at(obj.data.shape_keys, place)
        if block is not None:
            take_out(obj, block)


def show_frame(obj: bpy.types.Object) -> None:
    """Show what the curve says for the present frame."""
    keys = obj.data.shape_keys
    curve = shown_curve(keys)
    if curve is not None:
        keys.eval_time = curve.evaluate(bpy.context.scene.frame_current_final)
    points.update(obj)


def show(obj: bpy.types.Object, was_unkeyed: bool) -> None:
    """After the curve has changed: show the frame, or again the unkeyed pose that was shown.

    Blender reads the curve anew after it has been edited, and would take the unkeyed pose back.
    """
    show_frame(obj)
    if was_unkeyed:
        bpy.context.view_layer.update()
        obj.data.shape_keys.eval_time = SCRATCH
        points.update(obj)


def begin_sequence(obj: bpy.types.Object, rest: np.ndarray) -> None:
    """Make an object's shape keys absolute, with the shape `rest` as the Basis, for poses to be added."""
    mesh, settings = obj.data, obj.planar
    settings.poses.clear()
    if mesh.shape_keys is None:
        shape = points.read(obj)
        settings.key_before = -1
        basis = obj.shape_key_add(name="Basis", from_mix=False)
        points.write_block(obj.shape_key_add(name="Before Poses", from_mix=False), shape)
        points.write_block(basis, rest)
        points.write(obj, rest)  # Blender keeps the Basis there
    else:
        settings.key_before = obj.active_shape_key_index
    mesh.shape_keys.use_relative = False
