# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins for a character, and poses reached by the add-on's own operators, as an animator's hand would reach them.

A pose is written as the turns of an imaginary skeleton through the pins. It only says where pins go: the drawing
itself follows by the solver, never by bones.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from cutout import layer_vertices
from drawing import Layer

ROUNDS = 10  # a pose is reached in so many small drags of each pin, along the arc a hand would follow
SMALLEST_DRAG = 1e-4  # world units; nobody sees less


@dataclass(frozen=True)
class PinPlan:
    """A pin of a character: in which layer, where (x, z), and the pin it turns about. A radius makes it a patch."""

    name: str
    layer: str
    at: tuple[float, float]
    parent: str | None = None
    radius: float = 0.0


@dataclass(frozen=True)
class Pose:
    """Turns in degrees, counterclockwise as seen, by pin name: the line from its parent to it turns so far from
    rest. A pin without an entry turns with its parent. `step` moves the pins without a parent."""

    name: str
    turns: Mapping[str, float]
    step: tuple[float, float] = (0.0, 0.0)


def add_pins(obj: bpy.types.Object, layers: Sequence[Layer], plans: Sequence[PinPlan]) -> None:
    """Makes a vertex group for each planned pin and turns the groups into pins."""
    points = shown_points(obj)
    for plan in plans:
        members = layer_vertices(obj, next(layer for layer in layers if layer.name == plan.layer))
        distance = np.hypot(*(points[members] - plan.at).T)
        chosen = members[distance <= plan.radius] if plan.radius else members[[distance.argmin()]]
        obj.vertex_groups.new(name=plan.name).add(chosen.tolist(), 1.0, "REPLACE")
        bpy.ops.planar.add_pin_from_group(group=plan.name, kind="PATCH" if plan.radius else "POINT")


def shown_points(obj: bpy.types.Object) -> np.ndarray:
    """The posed shape, n×2 (x, z) in the object's space: the active shape key, else the mesh."""
    key = obj.active_shape_key
    data = key.data if key else obj.data.vertices
    points = np.empty(3 * len(data), np.float32)
    data.foreach_get("co", points)
    return points.reshape(-1, 3)[:, (0, 2)].astype(float)


def pin_points(obj: bpy.types.Object) -> dict[str, np.ndarray]:
    """Where each pin's group now is (x, z): the mean of its vertices on the shown shape."""
    points = shown_points(obj)
    members: dict[int, list[int]] = {}
    for vertex in obj.data.vertices:
        for group in vertex.groups:
            members.setdefault(group.group, []).append(vertex.index)
    return {pin.group: points[members[obj.vertex_groups[pin.group].index]].mean(axis=0) for pin in obj.planar.pins}


def strike(obj: bpy.types.Object, plans: Sequence[PinPlan], pose: Pose) -> list[float]:
    """Poses a new shape key of the object, named after the pose, by dragging and turning pins one at a time.

    Returns the wall time of every drag and turn in seconds.
    """
    for other in obj.data.shape_keys.key_blocks[1:]:
        other.value = 0.0
    key = obj.shape_key_add(name=pose.name, from_mix=False)
    key.value = 1.0
    obj.active_shape_key_index = len(obj.data.shape_keys.key_blocks) - 1

    calls: list[float] = []
    at = pin_points(obj)
    rest = dict(at)
    angle = {plan.name: 0.0 for plan in plans}
    index = {pin.group: i for i, pin in enumerate(obj.planar.pins)}
    for k in range(1, ROUNDS + 1):
        goals, turns = _goals(plans, rest, pose, k / ROUNDS)
        for plan in plans:
            offset = goals[plan.name] - at[plan.name]
            turn = turns[plan.name] - angle[plan.name] if plan.radius else 0.0
            if np.hypot(*offset) < SMALLEST_DRAG and abs(turn) < SMALLEST_DRAG:
                continue
            bpy.ops.planar.select_pins(action="SELECT", pin=index[plan.name])
            start = time.perf_counter()
            if np.hypot(*offset) >= SMALLEST_DRAG:
                bpy.ops.planar.drag_pins(offset=tuple(offset))
                calls.append(time.perf_counter() - start)
                start = time.perf_counter()
            if abs(turn) >= SMALLEST_DRAG:
                bpy.ops.planar.rotate_pins(angle=turn)
                calls.append(time.perf_counter() - start)
            at[plan.name], angle[plan.name] = goals[plan.name], angle[plan.name] + turn
    return calls


def _goals(
    plans: Sequence[PinPlan], rest: Mapping[str, np.ndarray], pose: Pose, fraction: float
) -> tuple[dict[str, np.ndarray], dict[str, float]]:
    """Where the imaginary skeleton takes every pin at a fraction of the pose, and how far each has turned."""
    goals: dict[str, np.ndarray] = {}
    turns: dict[str, float] = {}
    for plan in plans:
        inherited = turns[plan.parent] if plan.parent else 0.0
        turn = np.radians(pose.turns[plan.name]) * fraction if plan.name in pose.turns else inherited
        turns[plan.name] = turn
        if plan.parent is None:
            goals[plan.name] = rest[plan.name] + fraction * np.array(pose.step)
        else:
            x, z = rest[plan.name] - rest[plan.parent]
            arm = np.array([np.cos(turn) * x - np.sin(turn) * z, np.sin(turn) * x + np.cos(turn) * z])
            goals[plan.name] = goals[plan.parent] + arm
    return goals, turns
