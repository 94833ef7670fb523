# SPDX-License-Identifier: GPL-3.0-or-later
"""What an object with a pose sequence shows: what the curve says, or an unkeyed pose."""

from __future__ import annotations

import bpy

from ...model.plane.frame import Array32
from ..storage import points
from . import pose_state, strips
from .pose_blocks import HOLD, SCRATCH, add, block_at, own_curve, played, played_value, shown_curve, take_out


def show_unkeyed(obj: bpy.types.Object, coordinates: Array32) -> None:
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
    """Take the eval_time of unkeyed poses away. What is shown then is for the caller to say."""
    for eval_time in (SCRATCH, HOLD):
        block = block_at(obj.data.shape_keys, eval_time)
        if block is not None:
            take_out(obj, block)


def show_frame(obj: bpy.types.Object) -> None:
    """Show what the curve says for the present frame."""
    keys = obj.data.shape_keys
    keys.eval_time = played_value(keys, bpy.context.scene.frame_current_final)
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


def let_play(obj: bpy.types.Object, playing: bool) -> None:
    """Let the curve show the poses, or nothing of it while what is shown comes from elsewhere.

    Behind all handlers of a change of the frame Blender would read the curve once more.
    """
    curve = shown_curve(obj.data.shape_keys)
    if curve is None or curve.mute != playing:
        return
    own = own_curve(obj.data.shape_keys)
    assert own is not None  # there is one to be shown
    own.mute = not playing
    if playing:
        show(obj, pose_state.unkeyed(obj))


def let_strip_play(obj: bpy.types.Object) -> None:
    """Let the curve show the poses again that has been pushed down meanwhile."""
    strip = strips.strip_of(obj.data.shape_keys)
    curve = None if strip is None else strips.curve_of(strip)
    if curve is not None and curve.mute:
        curve.mute = False
        show_frame(obj)


_brought_back: list[str] = []  # objects that show an unkeyed pose again, after undo


def undone() -> None:
    """Undo or redo has brought other data: note which unkeyed poses they show.

    Where the frame is another one by that, too, Blender then reads the curves anew, and takes these back.
    """
    _brought_back[:] = [
        obj.name for obj in bpy.data.objects if _may_have_poses(obj) and pose_state.unkeyed(obj)
    ]


def keep(obj: bpy.types.Object) -> None:
    """Show the unkeyed pose of an object again after Blender has read its curve, which has become another.

    It does so behind the handlers of the present update, and tells of the next one only if there is one.
    """
    _brought_back.append(obj.name)
    bpy.app.timers.register(keep_brought_back, first_interval=0.0)


def keep_brought_back() -> None:
    """Blender has read the curves anew: show these unkeyed poses again."""
    names = _brought_back.copy()
    _brought_back.clear()
    for name in names:
        obj = bpy.data.objects.get(name)
        if obj is not None and block_at(obj.data.shape_keys, SCRATCH) is not None:
            obj.data.shape_keys.eval_time = SCRATCH
            points.update(obj)


def _may_have_poses(obj: bpy.types.Object) -> bool:
    return obj.library is None and obj.type in points.TYPES and obj.is_property_set("planar")
