# SPDX-License-Identifier: GPL-3.0-or-later
"""Depths of pins: read from the shape that is shown, and written into it.

Nothing else keeps them. The shape leaves the plane of the drawing by so little that whatever reads the plane
does not see it, see objects/cutout_object.py.
"""

from __future__ import annotations

import time
from collections.abc import Collection

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.posing.depths import DEEPEST, depth_of, spread, told_depth
from ...model.posing.pins import Holder
from ..objects import cutout_object, modifiers
from ..storage import changes
from . import pin_list

SHOWN = 2.0  # seconds for which a change is shown in colours
SAME = 1e-3  # depths that are as near are one
FARTHEST = (
    f"{DEEPEST:g} is the largest depth. If layers still are in between, lay them nearer together: scale the "
    "object across its plane"
)

_given: tuple[int, float] | None = None  # the session_uid of the object changed last, and when


def seconds_shown(obj: bpy.types.Object) -> float:
    """For how long the depths of an object are still to be shown; not above 0 where they are not."""
    if _given is None or _given[0] != obj.session_uid:
        return 0.0
    return SHOWN - (time.monotonic() - _given[1])


def refusal(obj: bpy.types.Object | None) -> str | None:
    """Why no pin of an object can get a depth, and what to do; None when it can."""
    if obj is not None and obj.type == "LATTICE":
        return f"'{obj.name}' is a lattice: give depths to the pins of the drawings that hang in it"
    return cutout_object.pose_refusal(obj) or modifiers.covering(obj)


def holders_of(obj: bpy.types.Object, drawing: cutout_object.CutoutObject) -> list[Holder]:
    """The usable pins of an object."""
    return pin_list.bound_pins(obj, drawing, pin_list.read_groups(obj))


def depth_shown(obj: bpy.types.Object, key: int) -> float:
    """The depth of the pin with this index in the shape that is shown; 0 where it has none."""
    if refusal(obj) is not None:
        return 0.0
    try:
        drawing = cutout_object.read_cutout(obj)
    except Refusal:
        return 0.0
    holders = holders_of(obj, drawing)
    return next((told_depth(one, drawing.depths) for one in holders if one.pin.key == key), 0.0)


def give(
    obj: bpy.types.Object, chosen: Collection[int], depth: float, *, relative: bool = False
) -> str | None:
    """Give the pins with these indices a depth, or add it to theirs; what to do where none goes farther.

    Raises Refusal, with nothing changed.
    """
    global _given
    reason = refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    pin_list.sync(obj)
    drawing = cutout_object.read_cutout(obj)
    holders = holders_of(obj, drawing)
    shown = {one.pin.key: depth_of(one, drawing.depths) for one in holders if one.pin.enabled}
    asked = {
        key: float(np.clip(depth + before if relative else depth, -DEEPEST, DEEPEST))
        for key, before in shown.items()
        if key in chosen
    }
    if not asked:
        raise Refusal("No pins that hold the drawing are selected: click one first")
    if relative and all(abs(shown[key] - to) < SAME for key, to in asked.items()):
        return FARTHEST
    try:
        depths = spread(obj.session_uid, drawing.cutout, holders, asked, drawing.depths)
    except native.SolveError as error:
        raise Refusal(str(error)) from error
    drawing.write_with(drawing.positions, depths)
    changes.tell_pose(obj)
    _given = obj.session_uid, time.monotonic()
    return None
