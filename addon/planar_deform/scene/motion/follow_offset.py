# SPDX-License-Identifier: GPL-3.0-or-later
"""Where pins are beside what they follow: kept when that is chosen, as by the inverse of Child Of."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array
from ...model.posing.pins import Holder, turned
from ...model.posing.posing import start_of
from ..lattice.posed import PosedObject, read_posed
from ..lattice.rig import waiting
from ..pins import controls, dependencies, pin_list


def keep(obj: bpy.types.Object, keys: Iterable[int]) -> None:
    """Let these pins of an object, which follow something, stay where they are beside it from now on.

    Raises Refusal, with nothing changed.
    """
    depsgraph = bpy.context.evaluated_depsgraph_get()
    keys = list(keys)
    for key in keys:
        pin = obj.planar.pins[key]
        reason = dependencies.refusal(obj, pin.follow, on_mesh=bool(pin.follow_group))
        if reason is not None:
            raise Refusal(reason)
    drawing = read_posed(obj, unkeyed=True)
    placed = matrices(obj, drawing, keys)
    offsets = {}
    for key, (matrix, _) in placed.items():
        control = controls.control_matrix(obj.planar.pins[key], depsgraph)
        if not abs(np.linalg.det(control)) > 0.0:
            raise Refusal(
                f"'{obj.planar.pins[key].follow.name}' has a scale of zero: give it a scale in every axis"
            )
        offsets[key] = np.linalg.inv(control) @ matrix
    for key, offset in offsets.items():
        obj.planar.pins[key].follow_offset = offset.ravel()
        obj.planar.pins[key].follow_axis = placed[key][1]


def clear(obj: bpy.types.Object, keys: Iterable[int]) -> None:
    """Let these pins be at the origin of what they follow; how patches are turned beside it stays."""
    for key in keys:
        offset = np.array(obj.planar.pins[key].follow_offset, np.float64).reshape(4, 4)
        offset[:3, 3] = 0.0
        obj.planar.pins[key].follow_offset = offset.ravel()


def matrices(
    obj: bpy.types.Object, drawing: PosedObject, keys: Iterable[int]
) -> dict[int, tuple[Array, Array]]:
    """Of each of these pins its matrix in the world (4 x 4), and its follow_axis (3,).

    Raises Refusal for a pin that holds nothing.
    """
    holders = {
        holder.pin.key: holder for holder in pin_list.bound_pins(obj, drawing, pin_list.read_groups(obj))
    }
    found = {}
    for key in keys:
        if key not in holders:
            name = obj.planar.pins[key].name
            raise Refusal(
                waiting(obj, [key]) or f"Pin '{name}' holds no vertices of faces: give its group some first"
            )
        found[key] = _matrix(drawing, holders[key])
    return found


def _matrix(drawing: PosedObject, holder: Holder) -> tuple[Array, Array]:
    place, angle = start_of(holder, drawing.positions)
    frame, u = drawing.frame, np.array([1.0, 0.0])
    direction = turned(u, angle if drawing.cutout.flat else 0.0)
    matrix = np.eye(4)
    matrix[:3, 0] = frame.u * direction[0] + frame.v * direction[1]
    matrix[:3, 1] = np.cross(frame.n, matrix[:3, 0])
    matrix[:3, 2] = frame.n
    matrix[:3, 3] = drawing.to_world(place[None, :], np.array([holder.part], np.int32))[0]
    return matrix, drawing.axis_from_world(frame.u)
