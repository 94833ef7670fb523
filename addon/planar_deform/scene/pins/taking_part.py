# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects are posed, keyed and filled as one."""

from __future__ import annotations

from typing import NamedTuple

import bpy

from ..objects.flat_object import data_refusal
from ..objects.modifiers import lattices_of
from ..storage import points
from .pin_list import has_pins


class TakingPart(NamedTuple):
    """The objects that take part, and why others that are selected do not, by their names."""

    objects: list[bpy.types.Object]
    left_out: dict[str, str]


def taking_part(context: bpy.types.Context) -> TakingPart:
    """The active object, whatever it is, then the others that are selected, visible, ours and can be changed.

    Ours are those with pins or keyed poses. They come in the order of their names. What hangs in a lattice
    that takes part is posed by that; meshes that share their data cannot be posed, and are left out.
    """
    active = context.object
    selected = [obj for obj in context.view_layer.objects.selected if obj != active and _is_ours(obj)]
    found = [] if active is None else [active]
    left_out: dict[str, str] = {}
    for obj in sorted(selected, key=lambda one: one.name):
        if not obj.visible_get() or any(_poses(lattice, active, selected) for lattice in lattices_of(obj)):
            continue
        reason = data_refusal(obj, "OBJECT")
        if reason is None:
            found.append(obj)
        else:
            left_out[obj.name] = reason
    return TakingPart(found, left_out)


def with_pins(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Those that have pins."""
    return [obj for obj in taking_part(context).objects if has_pins(obj)]


def control_in_hand(context: bpy.types.Context) -> str | None:
    """What to do with the active object where it is a control, which a pin follows, and no pins are selected
    with it; else None. Keys move it then, as with any tool.
    """
    active = context.object
    if active is None or active.type in points.TYPES or with_pins(context):
        return None
    pins = (pin for obj in bpy.data.objects if has_pins(obj) for pin in obj.planar.pins)
    led = next((pin for pin in pins if pin.follow == active), None)
    if led is None:
        return None
    return f"'{led.name}' of '{led.id_data.name}' follows '{active.name}': G moves it, I keys it"


def _is_ours(obj: bpy.types.Object) -> bool:
    if obj.type not in points.TYPES or not obj.is_property_set("planar"):
        return False
    return bool(obj.planar.pins) or bool(obj.planar.poses)


def _poses(
    lattice: bpy.types.Object, active: bpy.types.Object | None, selected: list[bpy.types.Object]
) -> bool:
    """Whether a lattice, which may be hidden, poses what hangs in it."""
    return has_pins(lattice) and (lattice == active or lattice in selected)
