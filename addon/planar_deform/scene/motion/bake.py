# SPDX-License-Identifier: GPL-3.0-or-later
"""What a pose sequence shows, frame by frame, kept in other ways.

Each bake is a generator that yields the share done, so that who runs it may show progress. When it is
exhausted, the bake is complete; closed before, or left by an exception, nothing has changed.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator

import bpy
import numpy as np

from ... import compat
from ...errors import Refusal
from ...model.plane.frame import Array32
from ...model.timing.played_curve import SAME_FRAME
from ..objects.any_object import shape_refusal
from ..sequence import playback, pose_edit, pose_showing, pose_state
from ..sequence.pose_blocks import keyed, own_curve
from ..storage import points, shape_keys
from . import cache_age, point_cache

FORMS = (
    (
        "SHAPES",
        "Shapes",
        "A keyed pose for each frame: easing, steps and in-betweens become poses, which can be changed",
    ),
    ("POINT_CACHE", "Point Cache", "A .pc2 file that a Mesh Cache modifier plays, for long shots"),
    (
        "RELATIVE_KEYS",
        "Relative Keys",
        "A relative shape key for each frame, for export to other programs; the poses are taken away",
    ),
)


def refusal(obj: bpy.types.Object | None) -> str | None:
    """Why there is nothing that could be baked, and what to do; None when there is."""
    return shape_refusal(obj) or pose_state.absence(obj)


def frame_range(scene: bpy.types.Scene) -> tuple[int, int]:
    """The first and the last frame that the timeline plays."""
    if scene.use_preview_range:
        return scene.frame_preview_start, scene.frame_preview_end
    return scene.frame_start, scene.frame_end


def frames_of(first: int, last: int, step: int) -> range:
    """The frames to bake. Raises Refusal if there are none."""
    if last < first:
        raise Refusal("The last frame is before the first one: exchange them")
    return range(first, last + 1, step)


def to(
    form: str,
    obj: bpy.types.Object,
    frames: range,
    filepath: str,
    *,
    replace: bool = False,
    free: bool = False,
) -> Generator[float, None, None]:
    """Bake to one of FORMS, by its identifier; what is behind the frames is for point caches."""
    if form == "POINT_CACHE":
        return to_point_cache(obj, frames, filepath, replace=replace, free=free)
    return to_shapes(obj, frames) if form == "SHAPES" else to_relative_keys(obj, frames)


def to_shapes(obj: bpy.types.Object, frames: range) -> Generator[float, None, None]:
    """Key a pose for each of these frames, evenly blended to the next one; what was keyed between them goes.

    The curve's modifiers, which are in the poses then, go, too. Raises Refusal and ObjectGone.
    """
    find = playback.finder(obj)
    shapes: dict[float, Array32] = {}
    for share, shape in _shown(find, frames):
        shapes[float(frames[len(shapes)])] = shape
        yield 0.5 * share
    for share in pose_edit.put_coordinates(find(), shapes, throughout=True):
        yield 0.5 + 0.5 * share
    curve = own_curve(find().data.shape_keys)
    assert curve is not None  # it has just got keys
    for modifier in [modifier for modifier in curve.modifiers if not modifier.mute]:
        curve.modifiers.remove(modifier)
    blend_evenly(find(), frames)


def blend_evenly(obj: bpy.types.Object, frames: range) -> None:
    """Blend from each of these frames, at which poses are keyed, to the next one on a straight line."""
    keys = obj.data.shape_keys
    curve = own_curve(keys)
    assert curve is not None  # there are keys
    for point, frame in zip(curve.keyframe_points, keyed(keys)[:, 0], strict=True):
        if frames[0] - SAME_FRAME < frame < frames[-1] - SAME_FRAME:
            point.interpolation = "LINEAR"
    curve.update()
    pose_showing.show_frame(obj)


def to_point_cache(
    obj: bpy.types.Object, frames: range, filepath: str, *, replace: bool = False, free: bool = False
) -> Generator[float, None, None]:
    """Write what is shown at these frames to a .pc2 file, and let a Mesh Cache modifier play it.

    `replace`: a file that is not the object's own cache may be replaced; `free`: the poses are taken away.
    Raises Refusal and ObjectGone.
    """
    if obj.type != "MESH":
        raise Refusal(f"'{obj.name}' is not a mesh: bake to Shapes or Relative Keys")
    path = point_cache.checked_path(obj, filepath, replace=replace)
    find = playback.finder(obj)
    with point_cache.written(path, points.count(obj), frames) as file:
        for share, shape in _shown(find, frames):
            file.write(point_cache.packed(shape))
            yield share
    obj = find()
    point_cache.play(obj, path, frames)
    obj.planar.cache_stamp = cache_age.stamp(obj, frames)
    if free:
        pose_edit.clear(obj)


def play_point_cache(obj: bpy.types.Object, filepath: str) -> range:
    """Let a Mesh Cache modifier play a .pc2 file that is baked already, elsewhere; its frames.

    Raises Refusal where there is none, or it is of another mesh or object.
    """
    if obj.type != "MESH":
        raise Refusal(f"'{obj.name}' is not a mesh and has no point cache")
    path = point_cache.file_at(filepath)
    point_cache.check_unshared(obj, path)
    frames = point_cache.baked_frames(path, points.count(obj))
    point_cache.play(obj, path, frames)
    obj.planar.cache_stamp = cache_age.stamp(obj, frames)
    return frames


def to_relative_keys(obj: bpy.types.Object, frames: range) -> Generator[float, None, None]:
    """A relative shape key for each frame, each with a curve that blends it in and out; the poses go.

    The Basis is the rest shape. Raises Refusal and ObjectGone.
    """
    find = playback.finder(obj)
    shapes = []
    for share, shape in _shown(find, frames):
        shapes.append(shape)
        yield share
    obj = find()
    rest = points.read_block(obj, obj.data.shape_keys.reference_key)
    pose_edit.clear(obj)
    if obj.data.shape_keys is not None:
        obj.data.shape_keys.animation_data_clear()
        obj.shape_key_clear()
    points.write(obj, rest)
    obj.shape_key_add(name="Basis", from_mix=False)
    names = []
    for frame, shape in zip(frames, shapes, strict=True):
        block = obj.shape_key_add(name=shape_keys.baked_name(frame), from_mix=False)
        points.write_block(block, shape)
        names.append(block.name)
    obj.active_shape_key_index = 0
    _blend(obj, names, frames)
    points.update(obj)


def _blend(obj: bpy.types.Object, names: list[str], frames: range) -> None:
    """Curves that bring each key from 0 at the frame before its own to 1 and back to 0 at the next one.

    Before the first and after the last frame, these stay.
    """
    keys = obj.data.shape_keys
    curves = compat.new_action(keys, f"{obj.name} Frames")
    now = bpy.context.scene.frame_current_final
    for name, frame in zip(names, frames, strict=True):
        timing = [(frame, 1.0)]
        if frame != frames[0]:
            timing.insert(0, (frame - frames.step, 0.0))
        if frame != frames[-1]:
            timing.append((frame + frames.step, 0.0))
        block = keys.key_blocks[name]
        curve = curves.new(block.path_from_id("value"))
        curve.keyframe_points.add(len(timing))
        curve.keyframe_points.foreach_set("co", np.array(timing, np.float32).ravel())
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
        curve.update()
        block.value = curve.evaluate(now)


def _shown(find: Callable[[], bpy.types.Object], frames: range) -> Iterator[tuple[float, Array32]]:
    """The share done and the shape, frame by frame."""
    for done, frame in enumerate(frames, 1):
        yield done / len(frames), pose_state.shape_at(find(), frame)
