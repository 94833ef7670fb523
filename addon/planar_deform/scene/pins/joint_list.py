# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints among the pins of an object: what in its list holds two parts of its mesh together.

They are kept as pins are, by vertex groups, but have no target and are no handles of the solver.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array, Indices
from ...model.posing import joints
from ...model.posing.joints import Joint
from ...model.posing.posing import PinResult
from ..objects.cutout_object import CutoutObject
from ..storage import vertex_groups
from ..storage.vertex_groups import Members
from . import pin_list
from .pin_list import Drawing

NAMES = {"HINGE": "Hinge", "WELD": "Weld"}


def has_joints(obj: bpy.types.Object) -> bool:
    """Whether any joint of an object is on."""
    return any(pin.enabled and pin_list.is_joint(pin) for pin in obj.planar.pins)


def bound_joints(
    obj: bpy.types.Object, drawing: Drawing, groups: Mapping[int, Mapping[str, Members]] | None = None
) -> list[Joint]:
    """The joints of an object that hold two of its parts; the others wait. `groups`: as of bound_pins()."""
    if not isinstance(drawing, CutoutObject) or not any(map(pin_list.is_joint, obj.planar.pins)):
        return []
    groups = pin_list.read_groups(obj) if groups is None else groups
    found = []
    for key, pin in enumerate(obj.planar.pins):
        if not pin_list.is_joint(pin):
            continue
        rows, weights = pin_list.members_held(pin, drawing, groups)
        inside = (rows >= 0) & (weights > 0.0)
        settings = {"enabled": pin.enabled, "weight": pin.weight}
        joint = joints.bound(key, pin.kind, rows[inside], weights[inside], drawing.cutout, **settings)
        if joint is not None:
            found.append(joint)
    return found


def solver_of(
    obj: bpy.types.Object, drawing: Drawing, bound: Iterable[Joint] | None = None
) -> Callable[..., Any]:
    """What makes a solver of given positions, for any thread, that holds the joints. Raises Refusal.

    `bound`: what bound_joints() gives, where it has been asked already.
    """
    method = obj.planar.method.lower()
    if not isinstance(drawing, CutoutObject):
        return partial(drawing.poser, method)
    ties = joints.ties_of(bound_joints(obj, drawing) if bound is None else bound)
    if ties is not None and method != "hold":
        raise Refusal("AKVF and ARAP do not hold joints: choose Hold Shape, or switch the joints off")
    return partial(drawing.poser, method, ties=ties)


def unmoved(obj: bpy.types.Object, chosen: Iterable[int]) -> str | None:
    """Why nothing moves where only joints of an object are chosen, and what to do."""
    pins = obj.planar.pins
    if not all(key < len(pins) and pin_list.is_joint(pins[key]) for key in chosen):
        return None
    return "Joints go where the parts take them that they hold together: select a pin"


def carried(found: Iterable[Joint], drawing: Drawing, positions: Array) -> list[PinResult]:
    """Where joints are on positions n x 2."""
    return joints.carried(found, positions, drawing.cutout.triangles)


def layer_of(obj: bpy.types.Object, vertices: Indices) -> str | None:
    """The name of the layer that a part of a drawing of several ones is, as its material says; else None."""
    mesh = obj.data
    corners, slots = np.empty(len(mesh.loops), np.int32), np.empty(len(mesh.polygons), np.int32)
    sides = np.empty(len(mesh.polygons), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    mesh.polygons.foreach_get("material_index", slots)
    mesh.polygons.foreach_get("loop_total", sides)
    used = np.unique(np.repeat(slots, sides)[np.isin(corners, vertices)])
    if len(used) != 1 or len(np.unique(slots)) < 2 or used[0] >= len(mesh.materials):
        return None
    material = mesh.materials[int(used[0])]
    return None if material is None else material.name


def add(
    obj: bpy.types.Object, kind: str, vertices: Indices, weights: Array, name: str | None = None
) -> bpy.types.PropertyGroup:
    """Add a joint on mesh vertices of two parts. `name`: by what it is known, if not by its kind."""
    group = pin_list.new_group(obj, NAMES[kind])
    vertex_groups.fill(group, vertices, weights)
    joint = pin_list.append(obj, group, kind, owns_group=True)
    names = {other.name for other in obj.planar.pins if other != joint}
    joint.name = pin_list.free_name(name or NAMES[kind], names)
    return joint


def remove(obj: bpy.types.Object, *, selected: bool) -> int:
    """Remove joints, all or those selected; how many there were."""
    gone = [
        index
        for index, pin in enumerate(obj.planar.pins)
        if pin_list.is_joint(pin) and (pin.select or not selected)
    ]
    if gone:
        pin_list.remove(obj, gone)
    return len(gone)
