# SPDX-License-Identifier: GPL-3.0-or-later
"""Targets of pins: objects and bones to which they are taken."""

from __future__ import annotations

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array, mapped


def has_targets(obj: bpy.types.Object) -> bool:
    """Whether any pin of an object has a target."""
    return any(pin.follow is not None for pin in obj.planar.pins)


def stamp(obj: bpy.types.Object) -> str:
    """Which pins that are on go where, seen from the object; empty: none does. Raises Refusal."""
    goals = {
        number: place_of(pin)
        for number, pin in enumerate(obj.planar.pins)
        if pin.enabled and pin.follow is not None
    }
    if not goals:
        return ""
    inverse = np.linalg.pinv(np.array(obj.matrix_world, np.float64))  # what is flat is refused elsewhere
    local = mapped(np.stack(list(goals.values())), inverse[:3, :3]) + inverse[:3, 3]
    return repr(list(goals)) + local.astype(np.float32).tobytes().hex()


def place_of(pin: bpy.types.PropertyGroup) -> Array:
    """Where the target of a pin, which has one, is in the world at present (3,). Raises Refusal."""
    target = pin.follow.evaluated_get(bpy.context.evaluated_depsgraph_get())
    place = target.matrix_world.translation
    if pin.follow_bone:
        bone = None if target.pose is None else target.pose.bones.get(pin.follow_bone)
        if bone is None:
            raise Refusal(
                f"'{pin.follow.name}' has no bone '{pin.follow_bone}': choose another one for pin "
                f"'{pin.name}'"
            )
        place = target.matrix_world @ bone.head
    found = np.array(place, np.float64)
    if not np.isfinite(found).all():
        raise Refusal(
            f"The target of pin '{pin.name}', '{pin.follow.name}', is nowhere: look at its transform"
        )
    return found
