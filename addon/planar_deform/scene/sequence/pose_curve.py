# SPDX-License-Identifier: GPL-3.0-or-later
"""The keys of the curve that plays a pose sequence: made, moved, removed, and kept to be put back."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import bpy
import numpy as np

from ... import compat
from ...model.plane.frame import Array, Array32, Indices, Mask
from ...model.timing import progress
from ...model.timing.ease import KeyEase
from ...model.timing.played_curve import SAME_FRAME, Rows, moved
from .pose_blocks import keyed, own_curve, shown_curve

_Column = Array32 | Indices | Mask  # one field of all keys, as Blender stores it

_PAIRS = ("co", "handle_left", "handle_right")
_TYPES = ("handle_left_type", "handle_right_type")
_NUMBERS = ("back", "amplitude", "period")
_ENUMS = (*_TYPES, "interpolation", "easing", "type")
_WAYS = ("interpolation", "easing", "type")
_FLAGS = ("select_control_point", "select_left_handle", "select_right_handle")


def follow(keys: bpy.types.Key, old: Array, new: Array) -> None:
    """Take the values of the curve from where blocks were to where they are; between blocks in proportion.

    Does not update the curve: what edits it next does.
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
    keys, left, right = (read(curve, field) for field in _PAIRS)
    types = np.stack([_numbers(curve, field, np.int32) for field in _TYPES], axis=1)
    amplitude = np.asarray(_numbers(curve, "amplitude", np.float32), np.float32)
    return Rows(keys, left, right, np.asarray(types, np.int32), amplitude)


def write_rows(curve: bpy.types.FCurve, wanted: Rows, exact: Mask | None = None) -> None:
    """Put the keys and their handles there, with these types and amplitudes.

    Automatic handles stay automatic where that is where Blender puts them; they become free elsewhere. Values
    that are `exact` (k x 3) are so to the bit; where all are, types are what they should be.
    """
    types = wanted.types.copy()
    bezier = _numbers(curve, "interpolation", np.int32) == number_of("interpolation", "BEZIER")
    curve.keyframe_points.foreach_set("amplitude", wanted.amplitude)
    while True:
        for side, field in enumerate(_TYPES):
            curve.keyframe_points.foreach_set(field, types[:, side].copy())
        _write_pairs(curve, wanted, np.ones((len(types), 3), bool))
        curve.update()
        if exact is not None and exact.all():
            break
        free = number_of("handle_left_type", "FREE")
        off = progress.off(rows(curve), wanted, bezier) & (types != free).any(axis=1)
        if not off.any():
            break
        types[off] = free
    if exact is not None:
        _write_pairs(curve, wanted, exact)


def _write_pairs(curve: bpy.types.FCurve, wanted: Rows, chosen: Mask) -> None:
    for column, (field, new) in enumerate(zip(_PAIRS, (wanted.keys, wanted.left, wanted.right), strict=True)):
        pairs = read(curve, field)
        pairs[chosen[:, column]] = new[chosen[:, column]]
        curve.keyframe_points.foreach_set(field, pairs.ravel())


def _numbers(curve: bpy.types.FCurve, field: str, kind: type) -> _Column:
    """A number of each key, or an enum's."""
    values: _Column = np.empty(len(curve.keyframe_points), kind)
    curve.keyframe_points.foreach_get(field, values)
    return values


def number_of(field: str, name: str) -> int:
    """Blender's number of one of the values of a key's enum."""
    return int(bpy.types.Keyframe.bl_rna.properties[field].enum_items[name].value)


KeySettings = dict[str, _Column]  # by field


def key_settings(curve: bpy.types.FCurve) -> KeySettings:
    """What keys have beside their places, handles and amplitude."""
    numbers: KeySettings = {field: _numbers(curve, field, np.float32) for field in ("back", "period")}
    return numbers | {field: _numbers(curve, field, np.int32) for field in _WAYS}


def settings_of_new(count: int, new: KeyEase) -> KeySettings:
    """The same for keys of one ease."""
    enums = {"interpolation": new.interpolation, "easing": new.easing, "type": "KEYFRAME"}
    found: KeySettings = {
        field: np.full(count, number_of(field, name), np.int32) for field, name in enums.items()
    }
    found["back"], found["period"] = np.full(count, 1.70158, np.float32), np.zeros(count, np.float32)
    return found


def ways(curve: bpy.types.FCurve) -> tuple[Array, Mask]:
    """What tells the way behind each key, k x 4, and whether handles and nothing else do (k,)."""
    settings = key_settings(curve)
    names = ("interpolation", "easing", "back", "period")
    found: Array = np.stack([np.asarray(settings[name], np.float64) for name in names], axis=1)
    bezier: Mask = found[:, 0] == number_of("interpolation", "BEZIER")
    found[bezier, 1:] = 0.0
    return found, bezier


def replace(curve: bpy.types.FCurve, wanted: Rows, settings: KeySettings) -> None:
    """Give a curve these keys in place of its own."""
    points = curve.keyframe_points
    points.clear()
    points.add(len(wanted.keys))
    points.foreach_set("co", wanted.keys.ravel())
    for field, values in settings.items():
        points.foreach_set(field, values)
    write_rows(curve, wanted)


def remove_keys(keys: bpy.types.Key, chosen: Mask) -> None:
    """Remove those keys of the curve that are chosen (a mask)."""
    if chosen.any():
        curve = own_curve(keys)
        assert curve is not None  # it has these keys
        for index in np.flatnonzero(chosen)[::-1].tolist():
            curve.keyframe_points.remove(curve.keyframe_points[index], fast=True)
        curve.update()


def key(obj: bpy.types.Object, at: Mapping[float, float], new: KeyEase) -> None:
    """Key an eval_time at each frame; what keys there were keep their easing, new ones get this."""
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
    frames = keyed(keys)[:, 0]
    chosen = ~(np.abs(frames[:, None] - before[None, :]) < SAME_FRAME).any(axis=1)
    for field, name in (
        ("interpolation", new.interpolation),
        ("easing", new.easing),
        *((field, new.handles) for field in _TYPES),
    ):
        numbers = _numbers(curve, field, np.int32)
        numbers[chosen] = number_of(field, name)
        curve.keyframe_points.foreach_set(field, numbers)
    curve.update()


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
            result[field] = _numbers(curve, field, kind)
    return result


def _remove_unused(action: bpy.types.Action) -> None:
    if not action.users:
        bpy.data.actions.remove(action)
