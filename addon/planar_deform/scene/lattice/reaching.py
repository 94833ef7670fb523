# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh as it reaches one of its modifiers, deformed by those above.

Only Blender can tell what these make of it, with the modifier itself and all below it hidden for a moment.
That writes, which is not allowed where things are drawn: there what was read last is taken, and read anew
soon after it if it may have changed since.
"""

from __future__ import annotations

from typing import NamedTuple

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array32
from ..objects.modifiers import DEFORMING
from ..objects.pose_store import store_of
from ..storage import changes, redraw

# Modifiers that leave the vertices as they are.
HARMLESS = frozenset(
    [
        *("DATA_TRANSFER", "NORMAL_EDIT", "UV_PROJECT", "UV_WARP", "WEIGHTED_NORMAL"),
        *("VERTEX_WEIGHT_EDIT", "VERTEX_WEIGHT_MIX", "VERTEX_WEIGHT_PROXIMITY"),
    ]
)


class _Read(NamedTuple):
    told: changes.Count  # of the object, when it was read
    shape: Array32


_read: dict[tuple[int, str], _Read] = {}  # by session_uid of the object and name of the modifier
_asked: set[tuple[str, str]] = set()  # objects and modifiers of which it is to be read anew, by name


def above(obj: bpy.types.Object, modifier: bpy.types.Modifier) -> list[bpy.types.Modifier]:
    """The modifiers before one that change what reaches it."""
    index = list(obj.modifiers).index(modifier)
    return [other for other in obj.modifiers[:index] if other.show_viewport and other.type not in HARMLESS]


def refusal(obj: bpy.types.Object, modifier: bpy.types.Modifier) -> str | None:
    """Why what reaches a modifier cannot be told, and what to do; None if it can. shape() finds the rest."""
    for other in above(obj, modifier):
        if other.type not in DEFORMING:
            return (
                f"Modifier '{other.name}' of '{obj.name}' makes new vertices above '{modifier.name}': move "
                "it below in the Modifiers tab, or apply it"
            )
    return None


def shape(obj: bpy.types.Object, modifier: bpy.types.Modifier, *, drawn: bool) -> Array32:
    """count x 3 of the object's vertices, in its own space, as they reach a modifier. Raises Refusal.

    `drawn`: where things are drawn, so that nothing may be written.
    """
    if not above(obj, modifier):
        return store_of(obj, unkeyed=True).shown.astype(np.float32)
    found = _read.get((obj.session_uid, modifier.name))
    if found is not None and found.told == changes.count(obj):
        return found.shape
    if not drawn:
        return _read_anew(obj, modifier).shape
    if not bpy.app.background:
        _asked.add((obj.name, modifier.name))
        if not bpy.app.timers.is_registered(_answer):
            bpy.app.timers.register(_answer, first_interval=0.0)
    return store_of(obj, unkeyed=True).shown.astype(np.float32) if found is None else found.shape


def forget() -> None:
    """The objects are another file's, or are no more."""
    _read.clear()
    _asked.clear()
    if bpy.app.timers.is_registered(_answer):
        bpy.app.timers.unregister(_answer)


def _read_anew(obj: bpy.types.Object, modifier: bpy.types.Modifier) -> _Read:
    name, uid = modifier.name, obj.session_uid
    index = list(obj.modifiers).index(modifier)
    shown = [other for other in obj.modifiers[index:] if other.show_viewport]
    layer = bpy.context.view_layer
    changes.count(obj)  # it is counted from now on
    try:
        for other in shown:
            other.show_viewport = False
        layer.update()
        vertices = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices
        count = len(vertices)
        found = np.empty(3 * count, np.float32)
        vertices.foreach_get("co", found)
    finally:
        for other in shown:
            other.show_viewport = True
        layer.update()
    if count != len(obj.data.vertices):
        raise Refusal(
            f"Modifiers of '{obj.name}' above '{name}' make new vertices: move them below in the Modifiers "
            "tab, or apply them"
        )
    _read[uid, name] = _Read(changes.count(obj), found.reshape(-1, 3))
    return _read[uid, name]


def _answer() -> None:
    """Read what was asked for where it could not be, and let it be drawn if it is another shape."""
    asked = list(_asked)
    _asked.clear()
    for object_name, name in asked:
        obj = bpy.context.view_layer.objects.get(object_name)
        modifier = None if obj is None else obj.modifiers.get(name)
        if obj is None or modifier is None:
            continue
        before = _read.get((obj.session_uid, name))
        try:
            now = _read_anew(obj, modifier)
        except Refusal:
            continue  # whoever poses is told
        if before is None or not np.array_equal(before.shape, now.shape):
            changes.tell(obj)
            _read[obj.session_uid, name] = _Read(changes.count(obj), now.shape)
    redraw.views()
