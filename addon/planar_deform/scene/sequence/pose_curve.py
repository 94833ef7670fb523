# SPDX-License-Identifier: GPL-3.0-or-later
"""The keys of the curve that plays a pose sequence: made, moved, removed, and kept to be put back."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import bpy
import numpy as np

from ... import compat
from ...model.plane.frame import Array, Array32, Indices, Mask
from ...model.timing.played_curve import SAME_FRAME, Offsets, Rows, moved
from .pose_blocks import keyed, own_curve, shown_curve

_Column = Array32 | Indices | Mask  # one field of all keys, as Blender stores it

_PAIRS = ("co", "handle_left", "handle_right")
_NUMBERS = ("back", "amplitude", "period")
_ENUMS = ("handle_left_type", "handle_right_type", "interpolation", "easing", "type")
_FLAGS = ("select_control_point", "select_left_handle", "select_right_handle")


def follow(keys: bpy.types.Key, old: Array, new: Array) -> None:
    """Take the values of the curve from where blocks were to where they are; between blocks in proportion.

    Does not update the curve: what edits it next does. Doing it here would also mark all animation as
    changed, and the unkeyed pose that has just been keyed would be lost when that is undone.
    """
    curve = own_curve(keys)
    if curve is None or np.array_equal(old, new):
        return
    for field in _PAIRS:
        values = read(curve, field)
        values[:, 1] = moved(values[:, 1].astype(np.float64), old, new)
        curve.keyframe_points.foreach_set(field, values.ravel())


def read(curve: bpy.types.FCurve, field: str) -> Array32:
    """Coordinates of the keys ("co") or their handles, k x 2 float32."""
    values = np.empty(len(curve.keyframe_points) * 2, np.float32)
    curve.keyframe_points.foreach_get(field, values)
    return values.reshape(-1, 2)


def rows(curve: bpy.types.FCurve) -> Rows:
    """All keys with their handles."""
    return Rows(*(read(curve, field) for field in _PAIRS))


def write_rows(curve: bpy.types.FCurve, values: Array, kept: Offsets | None = None) -> None:
    """Give the keys and their handles these values (k x 3), and let Blender set its automatic handles.

    Of `kept`, what is to the bit what it was stays so, with the frames of the handles.
    """
    _write_values(curve, values, np.ones(values.shape, bool))
    curve.update()
    if kept is not None:
        for side, field in enumerate(_PAIRS[1:]):
            pairs = read(curve, field)
            exact = kept.exact[:, side + 1]
            pairs[exact, 0] = kept.sides[exact, side]
            curve.keyframe_points.foreach_set(field, pairs.ravel())
        _write_values(curve, values, kept.exact)


def _write_values(curve: bpy.types.FCurve, values: Array, chosen: Mask) -> None:
    for column, field in enumerate(_PAIRS):
        pairs = read(curve, field)
        pairs[chosen[:, column], 1] = values[chosen[:, column], column]
        curve.keyframe_points.foreach_set(field, pairs.ravel())


def remove_keys(keys: bpy.types.Key, chosen: Mask) -> None:
    """Remove those keys of the curve that are chosen (a mask)."""
    if chosen.any():
        curve = own_curve(keys)
        assert curve is not None  # it has these keys
        for index in np.flatnonzero(chosen)[::-1].tolist():
            curve.keyframe_points.remove(curve.keyframe_points[index], fast=True)
        curve.update()


def key(obj: bpy.types.Object, at: Mapping[float, float]) -> None:
    """Key an eval_time at each frame; what keys there were keep their easing, new ones are linear."""
    keys = obj.data.shape_keys
    own_curve(keys)
    before = keyed(keys)[:, 0]
    for frame, eval_time in at.items():
        keys.eval_time = eval_time
        keys.keyframe_insert("eval_time", frame=frame)
    if not len(before):
        keys.animation_data.action.name = f"{obj.name} Poses"
    curve = own_curve(keys)
    assert curve is not None  # keying has made it
    points = curve.keyframe_points
    frames = keyed(keys)[:, 0]
    new = ~(np.abs(frames[:, None] - before[None, :]) < SAME_FRAME).any(axis=1)
    easing = np.empty(len(points), np.int32)
    points.foreach_get("interpolation", easing)
    easing[new] = points[0].bl_rna.properties["interpolation"].enum_items["LINEAR"].value
    points.foreach_set("interpolation", easing)


def value_at(keys: bpy.types.Key, frame: float) -> float:
    """What the keys alone say at a frame, without the curve's modifiers; there is a curve."""
    curve = shown_curve(keys)
    assert curve is not None
    active = [modifier for modifier in curve.modifiers if not modifier.mute]
    _mute(active, True)
    try:
        return float(curve.evaluate(frame))
    finally:
        _mute(active, False)


def _mute(modifiers: Iterable[bpy.types.FModifier], mute: bool) -> None:
    for modifier in modifiers:
        modifier.mute = mute


class SavedCurve:
    """The curve's keys at some time, to be put back to the bit."""

    def __init__(self, keys: bpy.types.Key):
        animation = keys.animation_data
        action = None if animation is None else animation.action
        self._action = None if action is None else action.name
        self._slot = compat.slot_of(animation)
        curve = shown_curve(keys)
        self._fields: dict[str, _Column] | None = None if curve is None else _fields(curve)

    def restore(self, keys: bpy.types.Key) -> None:
        """Put everything back; a copy of the action that has been made since is removed."""
        animation = keys.animation_data
        if self._action is None:
            if animation is not None and animation.action is not None:
                action = animation.action
                keys.animation_data_clear()
                _remove_unused(action)
            return
        if animation.action.name != self._action:
            copy = animation.action
            compat.assign_action(animation, bpy.data.actions[self._action], self._slot)
            _remove_unused(copy)
        curve = shown_curve(keys)
        if self._fields is None:
            curves = compat.curves_of(animation)
            if curve is not None and curves is not None:
                curves.remove(curve)
            return
        assert curve is not None  # the action that had it is back
        points = curve.keyframe_points
        count = len(self._fields["back"])
        if len(points) != count:
            points.clear()
            points.add(count)
        for field, values in self._fields.items():
            points.foreach_set(field, values)


def _fields(curve: bpy.types.FCurve) -> dict[str, _Column]:
    result: dict[str, _Column] = {field: read(curve, field).ravel() for field in _PAIRS}
    for fields, kind in ((_NUMBERS, np.float32), (_ENUMS, np.int32), (_FLAGS, bool)):
        for field in fields:
            values = np.empty(len(curve.keyframe_points), kind)
            curve.keyframe_points.foreach_get(field, values)
            result[field] = values
    return result


def _remove_unused(action: bpy.types.Action) -> None:
    if not action.users:
        bpy.data.actions.remove(action)
