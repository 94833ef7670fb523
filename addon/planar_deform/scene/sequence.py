# SPDX-License-Identifier: GPL-3.0-or-later
"""The pose sequence: shapes kept over time, as absolute shape keys that one F-curve plays.

Blocks, in the order of their place on the curve ("at", what eval_time has to be to show them):

    Basis          0             the rest shape
    Pose           < FIRST       the shape before the sequence was begun, or the user's own "Pose" key
    poses          FIRST + 8 i   the keyed poses, in the order of time in which they were keyed
    hold, scratch  HOLD, SCRATCH only while an unkeyed pose is shown, see below

`eval_time` has one F-curve with a key for each keyed pose, whose value is where the pose's block is; the
curve alone says when a pose is shown, so that the user times and eases them in Blender's own editors. A pose
whose key was duplicated there is shown, and edited, at several frames; one whose key was removed has no frame.
Keys with other values are the user's retiming and stay what they are. `Object.planar.poses` lists the poses by
where their blocks are; what else is in the played range is no keyed pose.

The played range begins far above the blocks below it, and ends in a copy of its last shape far above that: a
curve that overshoots holds the first or the last pose, as at the ends of any sequence of absolute shape keys.

An unkeyed pose is written to the scratch block and shown by setting `eval_time`, which any frame change takes
back, as it does with every animated value. No curve reaches it: below it comes the hold.

Beginning changes only how shapes are stored. Without shape keys the rest shape becomes the Basis and the
mesh's own shape is kept in a block. A mesh with a Basis and at most one key named "Pose", which is what posing
makes, keeps both. `clear` undoes exactly that. Other shape keys, drivers and actions are the user's and are
refused.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..model.frame import Array
from . import compat, shape_keys
from .errors import Refusal

if TYPE_CHECKING:
    from .access import SceneCutout

# Blender stores a block's place divided by 100 in float32 and puts a new block at eval_time unless one is
# within 0.1 of that, or unless it is 10 above the last block.
FIRST = 1024.0
SPACING = 8.0
HOLD = 500_000.0
SCRATCH = 1_000_000.0
SAME_PLACE = 0.05
SAME_FRAME = 0.01  # of two keys of a curve, as in Blender
POSE = "Pose"
SCRATCH_NAMES = ("Hold (unkeyed)", "Unkeyed Pose")


@dataclass
class _Block:
    """A block of the played range while the sequence is put together."""

    name: str
    listed: bool  # a keyed pose
    at: float | None  # None: not in the file yet
    points: np.ndarray | None = None  # count x 3, None: as they are in the file


def is_ours(obj: bpy.types.Object) -> bool:
    """Whether the object has a pose sequence."""
    keys = obj.data.shape_keys
    poses = obj.planar.poses
    if keys is None or keys.use_relative or not poses:
        return False
    places = _places(keys)
    return any(np.abs(places - pose.at).min() < SAME_PLACE for pose in poses)


def refusal(obj: bpy.types.Object) -> str | None:
    """Why poses of the object cannot be keyed, and what to do about it; None when they can."""
    keys = obj.data.shape_keys
    if keys is None:
        return None
    ours = is_ours(obj)
    if obj.show_only_shape_key:
        return "Only the active shape key is shown: turn off Shape Key Lock in the Shape Keys panel"
    if not ours and not keys.use_relative:
        return (
            "The mesh has absolute shape keys of its own: work on a copy of the object, with Apply All in "
            "the Shape Keys panel's menu"
        )
    blocks = list(keys.key_blocks)
    begun_by_posing = [block.name for block in blocks[1:]] in ([], [POSE]) and blocks[-1].frame < FIRST
    if not ours and not begun_by_posing:
        others = [block.name for block in blocks[1:]]
        return (
            f"The mesh has shape keys of its own ({', '.join(others[:3])}{', ...' if others[3:] else ''}): "
            "work on a copy of the object, with Apply All in the Shape Keys panel's menu"
        )
    return _animation_refusal(keys, ours)


def _animation_refusal(keys: bpy.types.Key, ours: bool) -> str | None:
    animation = keys.animation_data
    if animation is None:
        return None
    if animation.drivers:
        return "The shape keys have drivers: delete them in the Drivers editor"
    if animation.nla_tracks:
        return "The shape keys are animated in the Nonlinear Animation editor: delete their tracks there"
    curves = compat.curves_of(animation) or ()
    if animation.action is not None and (not ours or any(curve.data_path != "eval_time" for curve in curves)):
        return (
            f"The shape keys have an action of their own ('{animation.action.name}'): unlink it in the Dope "
            "Sheet's Shape Key Editor, or work on a copy of the object"
        )
    return None


# -- reading


def block_of(obj: bpy.types.Object, at: float) -> bpy.types.ShapeKey | None:
    """The block at a place of the curve."""
    keys = obj.data.shape_keys
    if keys is None:
        return None
    distances = np.abs(_places(keys) - at)
    nearest = int(distances.argmin())
    return keys.key_blocks[nearest] if distances[nearest] < SAME_PLACE else None


def frames_of(obj: bpy.types.Object) -> dict[int, list[float]]:
    """The frames at which each keyed pose stands on the curve, by its index in the list, in order."""
    frames: dict[int, list[float]] = {}
    places = np.array([pose.at for pose in obj.planar.poses])
    for frame, value in _keyed(obj) if len(places) else ():
        distances = np.abs(places - value)
        pose = int(distances.argmin())
        if distances[pose] < SAME_PLACE:
            frames.setdefault(pose, []).append(float(frame))
    return frames


def pose_at(obj: bpy.types.Object, frame: float) -> int | None:
    """The index of the pose that is keyed at a frame."""
    for pose, frames in frames_of(obj).items():
        if any(abs(keyed - frame) < SAME_FRAME for keyed in frames):
            return pose
    return None


def positions_of(obj: bpy.types.Object, pose: int) -> np.ndarray:
    """The coordinates (count x 3 float32, object-local) of a keyed pose. Raises Refusal if it is gone."""
    item = obj.planar.poses[pose]
    block = block_of(obj, item.at)
    if block is None:
        raise Refusal(f"The shape key of pose '{item.name}' is gone: delete the pose")
    return shape_keys.read_points(block.data, len(obj.data.vertices))


def shown_points(obj: bpy.types.Object) -> np.ndarray:
    """The shape that is shown at present, count x 3 float32: as Blender evaluates absolute keys.

    Raises Refusal between blocks that are not interpolated linearly.
    """
    keys = obj.data.shape_keys
    count = len(obj.data.vertices)
    places = _places(keys)
    time = keys.eval_time
    upper = int(np.searchsorted(places, time - SAME_PLACE))
    if upper == len(places) or upper == 0 or abs(places[upper] - time) < SAME_PLACE:
        return shape_keys.read_points(keys.key_blocks[min(upper, len(places) - 1)].data, count)
    pair = keys.key_blocks[upper - 1], keys.key_blocks[upper]
    for block in pair:
        if block.interpolation != "KEY_LINEAR":
            raise Refusal(f"Shape key '{block.name}' is not interpolated linearly: choose Linear for it")
    share = np.float32((time - places[upper - 1]) / (places[upper] - places[upper - 1]))
    low, high = (shape_keys.read_points(block.data, count) for block in pair)
    return low * (np.float32(1.0) - share) + high * share


def unkeyed(obj: bpy.types.Object) -> bool:
    """Whether what is shown is a pose that no frame has."""
    return is_ours(obj) and obj.data.shape_keys.eval_time > HOLD


def keyed_pose_shown(obj: bpy.types.Object, frame: float) -> bpy.types.ShapeKey | None:
    """The block of the pose that is keyed at this frame, if that is what is shown."""
    pose = pose_at(obj, frame)
    if pose is None:
        return None
    at = obj.planar.poses[pose].at
    return block_of(obj, at) if abs(obj.data.shape_keys.eval_time - at) < SAME_PLACE else None


# -- writing


def put(scene: SceneCutout, shapes: Mapping[float, Array]) -> None:
    """Key poses: n x 2 positions, or count x 3 coordinates, of the cutout by frame.

    A frame at which a pose is keyed gets the new one in its place, with its easing; the object's sequence is
    begun if it has none. `scene` is used up by this. Raises Refusal and ObjectGone, with nothing changed.
    """
    obj = scene.resolve()
    reason = refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    coordinates = {float(frame): scene.coordinates(positions) for frame, positions in shapes.items()}
    if is_ours(obj):
        _drop_lost_poses(obj)
        drop_scratch(obj)
    else:
        _begin(obj, scene.rest_coordinates())

    frames = frames_of(obj)
    new: dict[float, np.ndarray] = {}
    for frame, points in coordinates.items():
        pose = pose_at(obj, frame)
        # A pose that is shown at other frames, too, stays as it is there.
        if pose is not None and len(frames[pose]) == 1:
            block_of(obj, obj.planar.poses[pose].at).data.foreach_set("co", points.ravel())
        else:
            new[frame] = points
    placed = _insert(obj, new)
    _key(obj, placed)
    latest = pose_at(obj, max(coordinates)) if coordinates else None
    if latest is not None:
        obj.planar.active_pose = latest
    show_frame(obj)


def remove(obj: bpy.types.Object, pose: int) -> None:
    """Take a pose out of the sequence, and its keys; with the last one the sequence ends."""
    if len(obj.planar.poses) == 1:
        clear(obj)
        return
    at = obj.planar.poses[pose].at
    curve = _own_curve(obj.data.shape_keys)
    if curve is not None:
        for index in reversed(range(len(curve.keyframe_points))):
            if abs(curve.keyframe_points[index].co[1] - at) < SAME_PLACE:
                curve.keyframe_points.remove(curve.keyframe_points[index], fast=True)
        curve.update()
    block = block_of(obj, at)
    if block is not None:
        obj.shape_key_remove(block)
    obj.planar.poses.remove(pose)
    obj.planar.active_pose = max(0, min(obj.planar.active_pose, len(obj.planar.poses) - 1))
    if unkeyed(obj):
        _write_hold(obj)
    else:
        show_frame(obj)


def clear(obj: bpy.types.Object) -> None:
    """End the sequence: everything is as it was before it was begun, to the bit."""
    settings = obj.planar
    if is_ours(obj):
        mesh, keys = obj.data, obj.data.shape_keys
        animation = keys.animation_data
        action = None if animation is None else animation.action
        keys.animation_data_clear()
        if action is not None and not action.users:
            bpy.data.actions.remove(action)
        before = [block.name for block in keys.key_blocks if block.frame < FIRST]
        for name in [block.name for block in keys.key_blocks if block.frame >= FIRST]:
            obj.shape_key_remove(keys.key_blocks[name])
        keys.eval_time = 0.0
        if settings.key_before < 0:
            shape = shape_keys.read_points(keys.key_blocks[before[-1]].data, len(mesh.vertices))
            obj.shape_key_clear()
            mesh.vertices.foreach_set("co", shape.ravel())
        else:
            keys.use_relative = True
            obj.active_shape_key_index = settings.key_before
        mesh.update()
    settings.poses.clear()
    settings.active_pose = 0


def show_unkeyed(obj: bpy.types.Object, coordinates: np.ndarray) -> None:
    """Show a shape, count x 3, until the frame changes."""
    keys = obj.data.shape_keys
    if block_of(obj, SCRATCH) is None:
        for name, at in zip(SCRATCH_NAMES, (HOLD, SCRATCH), strict=True):
            _add_block(obj, name, at)
    if keys.eval_time != SCRATCH:
        _write_hold(obj)  # the last pose may be another by now
        keys.eval_time = SCRATCH
    block_of(obj, SCRATCH).data.foreach_set("co", coordinates.ravel())


def drop_scratch(obj: bpy.types.Object) -> None:
    """Take the place of unkeyed poses away."""
    for at in (SCRATCH, HOLD):
        block = block_of(obj, at)
        if block is not None:
            obj.shape_key_remove(block)


def show_frame(obj: bpy.types.Object) -> None:
    """Show what the curve says for the present frame."""
    curve = _curve(obj.data.shape_keys)
    if curve is not None:
        obj.data.shape_keys.eval_time = curve.evaluate(bpy.context.scene.frame_current_final)
    obj.data.update()


# -- parts of it


def _places(keys: bpy.types.Key) -> np.ndarray:
    places = np.empty(len(keys.key_blocks), np.float32)
    keys.key_blocks.foreach_get("frame", places)
    return places


def _curve(keys: bpy.types.Key) -> bpy.types.FCurve | None:
    curves = compat.curves_of(keys.animation_data)
    return None if curves is None else curves.find("eval_time")


def _own_curve(keys: bpy.types.Key) -> bpy.types.FCurve | None:
    """The curve, to be changed: a duplicated object may use the same action."""
    if keys.animation_data is not None and keys.animation_data.action is not None:
        compat.make_single_user(keys.animation_data)
    return _curve(keys)


def _keyed(obj: bpy.types.Object) -> np.ndarray:
    """Frame and value of each key of the curve, in time, k x 2."""
    keys = obj.data.shape_keys
    curve = None if keys is None else _curve(keys)
    if curve is None:
        return np.empty((0, 2), np.float32)
    points = np.empty(len(curve.keyframe_points) * 2, np.float32)
    curve.keyframe_points.foreach_get("co", points)
    return points.reshape(-1, 2)


def _begin(obj: bpy.types.Object, rest: np.ndarray) -> None:
    mesh, settings = obj.data, obj.planar
    settings.poses.clear()
    if mesh.shape_keys is None:
        shape = shape_keys.read_points(mesh.vertices, len(mesh.vertices))
        settings.key_before = -1
        basis = obj.shape_key_add(name="Basis", from_mix=False)
        obj.shape_key_add(name="Before Poses", from_mix=False).data.foreach_set("co", shape.ravel())
        basis.data.foreach_set("co", rest.ravel())
        mesh.vertices.foreach_set("co", rest.ravel())  # Blender keeps the Basis there
    else:
        settings.key_before = obj.active_shape_key_index
    mesh.shape_keys.use_relative = False


def _drop_lost_poses(obj: bpy.types.Object) -> None:
    """Poses whose blocks the user removed are no poses any more."""
    poses = obj.planar.poses
    for index in reversed(range(len(poses))):
        if block_of(obj, poses[index].at) is None:
            poses.remove(index)


def _add_block(obj: bpy.types.Object, name: str, at: float) -> bpy.types.ShapeKey:
    obj.data.shape_keys.eval_time = at
    block = obj.shape_key_add(name=name, from_mix=False)
    block.interpolation = "KEY_LINEAR"
    return block


def _write_hold(obj: bpy.types.Object) -> None:
    """Let the hold end the played range, in its last shape."""
    keys = obj.data.shape_keys
    hold = block_of(obj, HOLD)
    last = keys.key_blocks[keys.key_blocks.find(hold.name) - 1]
    hold.data.foreach_set("co", shape_keys.read_points(last.data, len(obj.data.vertices)).ravel())


def _insert(obj: bpy.types.Object, shapes: Mapping[float, np.ndarray]) -> dict[float, float]:
    """Add a block for each shape, after the one that the curve shows before its frame; where each is now.

    A block cannot be moved: those behind the first new one are taken out and added again, and the curve's
    values follow.
    """
    if not shapes:
        return {}
    keys, poses = obj.data.shape_keys, obj.planar.poses
    listed = np.array([pose.at for pose in poses])
    blocks = [
        _Block(block.name, bool(len(listed)) and float(np.abs(listed - at).min()) < SAME_PLACE, float(at))
        for block, at in zip(keys.key_blocks, _places(keys), strict=True)
        if at >= FIRST
    ]
    timeline = _keyed(obj)
    taken = {block.name for block in keys.key_blocks}
    new: dict[float, _Block] = {}
    first = len(blocks)
    previous: tuple[float, _Block] | None = None
    for frame in sorted(shapes):
        earlier = timeline[timeline[:, 0] < frame]
        if previous is not None and (not len(earlier) or earlier[-1, 0] <= previous[0]):
            index = next(i for i, block in enumerate(blocks) if block is previous[1]) + 1
        elif len(earlier):
            shown = earlier[-1, 1] + SAME_PLACE
            index = 1 + max(
                (i for i, b in enumerate(blocks) if b.at is not None and b.at <= shown), default=-1
            )
        else:
            index = 0
        new[frame] = _Block(_free_name(taken), True, None, shapes[frame])
        blocks.insert(index, new[frame])
        previous = frame, new[frame]
        first = min(first, index)
    return _place(obj, blocks, first, new)


def _free_name(taken: set[str]) -> str:
    """A name like those that Blender gives, which is taken from now on."""
    numbered = (f"{POSE}.{number:03}" for number in itertools.count(1))
    name = next(name for name in itertools.chain([POSE], numbered) if name not in taken)
    taken.add(name)
    return name


def _place(
    obj: bpy.types.Object, blocks: list[_Block], first: int, new: Mapping[float, _Block]
) -> dict[float, float]:
    keys, count = obj.data.shape_keys, len(obj.data.vertices)
    old: list[float] = []
    moved: list[float] = []
    for block in blocks[first:]:
        if block.at is not None:
            block.points = shape_keys.read_points(keys.key_blocks[block.name].data, count)
    for block in blocks[first:]:
        if block.at is not None:
            obj.shape_key_remove(keys.key_blocks[block.name])
    at = FIRST - SPACING
    for index, block in enumerate(blocks):
        if block.at is not None:
            old.append(block.at)
        if index < first:
            at = block.at
        else:
            at += SPACING
            added = _add_block(obj, block.name, at)
            added.data.foreach_set("co", block.points.ravel())
            block.name = added.name
        if block.at is not None:
            moved.append(at)
        block.at = at
    _follow_blocks(obj, np.array(old), np.array(moved))
    poses = obj.planar.poses
    poses.clear()
    for block in blocks:
        if block.listed:
            pose = poses.add()
            pose.at, pose.name = block.at, block.name
    return {frame: block.at for frame, block in new.items()}


def _follow_blocks(obj: bpy.types.Object, old: np.ndarray, new: np.ndarray) -> None:
    """Take the values of the curve from where blocks were to where they are; between blocks in proportion."""
    curve = _own_curve(obj.data.shape_keys)
    if curve is None or np.array_equal(old, new):
        return

    def followed(value: float) -> float:
        ends = [value - old[0] + new[0]] if value < old[0] else [value - old[-1] + new[-1]]
        return float(np.interp(value, old, new)) if old[0] <= value <= old[-1] else float(ends[0])

    for point in curve.keyframe_points:
        left, right = followed(point.handle_left[1]), followed(point.handle_right[1])
        point.co[1] = followed(point.co[1])
        point.handle_left[1], point.handle_right[1] = left, right
    curve.update()


def _key(obj: bpy.types.Object, places: Mapping[float, float]) -> None:
    """Key eval_time: each frame the value that shows the block at a place. New keys are linear."""
    if not places:
        return
    keys = obj.data.shape_keys
    curve = _own_curve(keys)
    if curve is None:
        keys.keyframe_insert("eval_time", frame=min(places))
        keys.animation_data.action.name = f"{obj.name} Poses"
        curve = _curve(keys)
        curve.keyframe_points[0].interpolation = "LINEAR"
    for frame, at in places.items():
        keyed = _keyed(obj)
        at_frame = np.flatnonzero(np.abs(keyed[:, 0] - frame) < SAME_FRAME)
        if len(at_frame):
            point = curve.keyframe_points[int(at_frame[0])]
            step = at - point.co[1]
            point.co[1] = at
            point.handle_left[1] += step
            point.handle_right[1] += step
        else:
            point = curve.keyframe_points.insert(frame, at, options={"FAST"})
            point.interpolation = "LINEAR"
    curve.update()
