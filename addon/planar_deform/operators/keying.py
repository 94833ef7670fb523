# SPDX-License-Identifier: GPL-3.0-or-later
"""Keying what is shown: by command, and by auto-key at the end of a posing."""

from __future__ import annotations

import bpy

from ..model.timing.played_curve import SAME_FRAME
from ..scene.objects.any_object import AnyObject, begin_shape, keying
from ..scene.sequence import held, pose_blocks, pose_state
from ..scene.sequence.playback import Steps
from .modal.reports import Tell


def key_shown(
    context: bpy.types.Context, obj: bpy.types.Object, tell: Tell, *, kind: str | None = None
) -> Steps:
    """What keys the shape that an object shows at the present frame, see playback.together(). Raises Refusal.

    On twos at the frame whose drawing is seen then: at any other one the pose would not be shown. `kind`: the
    type of the key, one of Blender's; by default it keeps the one it has.
    """
    drawing, frame = begin_shape(context, obj), context.scene.frame_current_final
    return _key(drawing, frame, held.shown_for(obj, frame), tell, kind)


def _key(drawing: AnyObject, frame: float, shown: float, tell: Tell, kind: str | None) -> Steps:
    yield from keying(drawing, {shown: drawing.positions})
    if kind is not None:
        pose_blocks.set_key_type(drawing.resolve().data.shape_keys, shown, kind)
    if abs(shown - frame) >= SAME_FRAME:
        tell(f"Keyed at frame {shown:g}, whose drawing is shown until frame {frame:g}, too: steps hold it")


def auto_key(context: bpy.types.Context, obj: bpy.types.Object, tell: Tell) -> Steps:
    """After a posing: key the pose if auto-key is on and what it would key is not keyed already.

    As with any property of Blender: a mode that only replaces keys, and the preference to insert keys only
    where there are some, leave an object without a sequence alone; so does whatever would be refused. Only
    Active Keying Set keys the pose if the set has the curve of the poses in it. Goes on and tells as
    key_shown() does.
    """
    tools = context.scene.tool_settings
    if not tools.use_keyframe_insert_auto:
        return
    ours = pose_state.is_ours(obj)
    if ours and not pose_state.unkeyed(obj):
        return  # it went into a keyed pose
    frame = held.shown_for(obj, context.scene.frame_current_final)
    if tools.auto_keying_mode == "REPLACE_KEYS" and pose_state.pose_at(obj, frame) is None:
        return
    if not ours and context.preferences.edit.use_keyframe_insert_available:
        return
    if tools.use_keyframe_insert_keyingset and not _in_keying_set(obj, context.scene.keying_sets_all.active):
        return
    if pose_state.refusal(obj) is None:
        yield from key_shown(context, obj, tell)


def _in_keying_set(obj: bpy.types.Object, keying_set: bpy.types.KeyingSet | None) -> bool:
    """Whether a keying set, if there is one, lets the object's poses be keyed."""
    if keying_set is None:
        return True
    keys = obj.data.shape_keys
    return keys is not None and any(
        path.id == keys and path.data_path == "eval_time" for path in keying_set.paths
    )
