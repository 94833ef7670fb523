# SPDX-License-Identifier: GPL-3.0-or-later
"""A pose sequence begun, changed and ended."""

from __future__ import annotations

from collections.abc import Mapping

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array, Array32
from ...model.timing.played_curve import SAME_EVAL_TIME
from ..storage import migration, pin_paths, points
from . import playback, pose_curve, pose_insertion
from .playback import Steps
from .pose_blocks import FIRST, block_at, keyed, own_curve
from .pose_showing import drop_scratch, show_frame
from .pose_state import is_ours, pose_at, refusal


def put_coordinates(
    obj: bpy.types.Object,
    shapes: Mapping[float, Array32],
    rest: Array32 | None = None,
    *,
    throughout: bool = False,
) -> Steps:
    """Key a pose for each shape (by frame; see storage/points.py), step by step.

    A frame at which a pose is keyed gets the new one in its place, with its easing; the object's sequence is
    begun, with the shape `rest`, if it has none. `throughout`: keys between the frames go away, with what
    only they show and what is generated there. Yields the share done, see playback.together(). Closed before
    its end, everything is back to the bit. Raises Refusal, with nothing changed.
    """
    reason = refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    begun = not is_ours(obj)
    if begun:
        assert rest is not None  # only where the sequence is there already, it may be left out
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


def removing(obj: bpy.types.Object, pose: int) -> Steps:
    """Take a pose out of the sequence, and its keys, step by step; with the last one the sequence ends.

    What is generated before and behind it stays, and is stale, but not at the ends of the sequence. Yields
    the share done, see playback.together().
    """
    if len(obj.planar.poses) == 1:
        yield 1.0
        clear(obj)
        return
    eval_time, name = obj.planar.poses[pose].at, obj.planar.poses[pose].name

    def then(obj: bpy.types.Object, old: Array, new: Array) -> None:
        keys = obj.data.shape_keys
        pose_curve.remove_keys(keys, np.abs(keyed(keys)[:, 1] - eval_time) < SAME_EVAL_TIME)
        playback.follow(obj, old, new)
        curve = own_curve(keys)
        if curve is not None:
            curve.update()  # of a pose without keys none were removed

    blocks = [block for block in playback.blocks_of(obj) if block.source != eval_time]
    yield from playback.relay(obj, pose_insertion.close_up(blocks), then)
    pin_paths.forget_pose(obj, name)
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
    pin_paths.forget_all(obj)


def end_sequence(obj: bpy.types.Object) -> None:
    """Take all blocks away, and their curve."""
    settings = obj.planar
    keys = obj.data.shape_keys
    below = [block for block in keys.key_blocks if block.frame < FIRST - SAME_EVAL_TIME]
    # It may raise Refusal, while nothing has changed.
    before = points.read_block(obj, below[-1]) if below else points.read(obj)
    action = None if keys.animation_data is None else keys.animation_data.action
    keys.animation_data_clear()
    if action is not None and not action.users:
        bpy.data.actions.remove(action)
    for name in [block.name for block in keys.key_blocks if block.frame > FIRST - SAME_EVAL_TIME]:
        obj.shape_key_remove(keys.key_blocks[name])
    keys.eval_time = 0.0
    if settings.key_before < 0:
        obj.shape_key_clear()
        points.write(obj, before)
    else:
        keys.use_relative = True
        obj.active_shape_key_index = settings.key_before
    points.update(obj)


def begin_sequence(obj: bpy.types.Object, rest: Array32) -> None:
    """Make an object's shape keys absolute, with the shape `rest` as the Basis, for poses to be added."""
    migration.migrate(obj)
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
