# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins for a character, and poses reached by the add-on's operators, as an animator's hand would reach them.

A pose is written as the turns of an imaginary skeleton through the pins. It only says where pins go: the
drawing itself follows by the solver, never by bones.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np
from mathutils import Vector

from cutout import layer_vertices
from drawing import Layer
from planar_deform.model.posing.posing import Sample
from planar_deform.operators.drag import pack_path


@dataclass(frozen=True)
class PinPlan:
    """A pin: in which layer, where (x, z), and the pin it turns about. A radius makes it a patch."""

    name: str
    layer: str
    at: tuple[float, float]
    parent: str | None = None
    radius: float = 0.0


@dataclass(frozen=True)
class Pose:
    """Turns in degrees, counterclockwise as seen, by pin name: how far the line from its parent to it turns
    from rest. A pin without an entry turns with its parent. `step` moves all pins. `stands` names pins that
    are unturned in the end and at an offset from their place at rest, whatever their limb does."""

    name: str
    turns: Mapping[str, float]
    step: tuple[float, float] = (0.0, 0.0)
    stands: Mapping[str, tuple[float, float]] = field(default_factory=dict)


@dataclass
class Effort:
    """What a pose took: drags (and turns), and wall time in seconds."""

    drags: int = 0
    seconds: float = 0.0

    def add(self, seconds: float) -> None:
        """Counts one drag."""
        self.drags += 1
        self.seconds += seconds


def add_pins(obj: bpy.types.Object, layers: Sequence[Layer], plans: Sequence[PinPlan]) -> None:
    """Adds the planned pins: points at their places, patches on the vertices within their radius."""
    points = shown_points(obj)
    for plan in plans:
        layer = next(layer for layer in layers if layer.name == plan.layer)
        if plan.radius:
            members = layer_vertices(obj, layer)
            chosen = members[np.hypot(*(points[members] - plan.at).T) <= plan.radius]
            obj.vertex_groups.new(name=plan.name).add(chosen.tolist(), 1.0, "REPLACE")
            bpy.ops.planar.add_pin_from_group(group=plan.name, kind="PATCH")
        else:
            x, z = plan.at
            bpy.ops.planar.add_pin(location=obj.matrix_world @ Vector((x, layer.depth, z)))
            pin = obj.planar.pins[-1]
            obj.vertex_groups[pin.group].name = plan.name
            pin.name = pin.group = plan.name


def shown_points(obj: bpy.types.Object) -> np.ndarray:
    """The shape that is shown, n x 2 (x, z) in the object's space."""
    vertices = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices
    points = np.empty(3 * len(vertices), np.float32)
    vertices.foreach_get("co", points)
    return points.reshape(-1, 3)[:, (0, 2)].astype(float)


def rest_points(obj: bpy.types.Object) -> np.ndarray:
    """The rest shape of an object with keyed poses, n x 2 (x, z) in the object's space."""
    block = obj.data.shape_keys.key_blocks[0]
    points = np.empty(3 * len(block.points), np.float32)
    block.points.foreach_get("co", points)
    return points.reshape(-1, 3)[:, (0, 2)].astype(float)


def pin_points(obj: bpy.types.Object) -> dict[str, np.ndarray]:
    """Where each pin that is on is shown (x, z): the weighted mean of its group's vertices."""
    points = shown_points(obj)
    sums: dict[int, np.ndarray] = {}  # by group: x, z and 1 by weight
    for vertex in obj.data.vertices:
        for group in vertex.groups:
            weighed = group.weight * np.array([*points[vertex.index], 1.0])
            sums[group.group] = sums.get(group.group, 0.0) + weighed
    found = {pin.group: sums[obj.vertex_groups[pin.group].index] for pin in obj.planar.pins if pin.enabled}
    return {name: total[:2] / total[2] for name, total in found.items()}


def key_rest(obj: bpy.types.Object, frame: int) -> None:
    """Keys the drawing as it was drawn."""
    bpy.context.scene.frame_set(frame)
    bpy.ops.planar.reset_to_rest()
    _key(obj, "Rest")


def strike(obj: bpy.types.Object, plans: Sequence[PinPlan], pose: Pose, frame: int) -> Effort:
    """Poses the object from rest at a frame and keys that.

    All pins move by the step, then one limb after the other turns about its joint; what stands comes last.
    """
    bpy.context.scene.frame_set(frame)
    bpy.ops.planar.reset_to_rest()
    effort = Effort()
    places = pin_points(obj)
    stands = {name: places[name] + offset for name, offset in pose.stands.items()}
    if any(pose.step):
        bpy.ops.planar.select_pins(action="ALL")
        start = time.perf_counter()
        bpy.ops.planar.drag_pins(offset=pose.step)
        effort.add(time.perf_counter() - start)
        places = {name: place + pose.step for name, place in places.items()}
    turned: dict[str, float] = {}
    for plan in plans:
        inherited = turned[plan.parent] if plan.parent else 0.0
        turned[plan.name] = np.radians(pose.turns[plan.name]) if plan.name in pose.turns else inherited
        if plan.name in stands:
            turned[plan.name] = 0.0
        angle = turned[plan.name] - inherited
        if angle:
            start = time.perf_counter()
            _turn_limb(obj, plans, places, plan, angle)
            effort.add(time.perf_counter() - start)
    for name, stand in stands.items():
        start = time.perf_counter()
        bpy.ops.planar.select_pins(action="SELECT", pin=obj.planar.pins.find(name))
        bpy.ops.planar.drag_pins(offset=stand - places[name])
        effort.add(time.perf_counter() - start)
    _key(obj, pose.name)
    return effort


def _key(obj: bpy.types.Object, name: str) -> None:
    bpy.ops.planar.key_pose()
    obj.planar.poses[obj.planar.active_pose].name = name


def lead(pin: str, way: Sequence[Sample]) -> None:
    """Takes one pin of the active object along samples, and lets the drawing settle."""
    pins = bpy.context.object.planar.pins
    bpy.ops.planar.select_pins(action="SELECT", pin=pins.find(pin))
    bpy.ops.planar.rotate_pins(angle=way[-1][2], path=pack_path(list(way)))
    bpy.ops.planar.settle_pose()


def _turn_limb(
    obj: bpy.types.Object,
    plans: Sequence[PinPlan],
    places: dict[str, np.ndarray],
    plan: PinPlan,
    angle: float,
) -> None:
    """Turns a pin and all that hang on it about its parent, and updates their places."""
    joint = places[plan.parent or plan.name]
    limb = {plan.name}
    for other in plans:
        if other.parent in limb:
            limb.add(other.name)
    bpy.ops.planar.select_pins(action="NONE")
    for i, pin in enumerate(obj.planar.pins):
        if pin.group in limb:
            bpy.ops.planar.select_pins(action="SELECT", pin=i, extend=True)
    x, z = joint
    bpy.ops.planar.rotate_pins(angle=angle, pivot=obj.matrix_world @ Vector((x, 0, z)))
    for name in limb:
        places[name] = joint + _rotated(places[name] - joint, angle)


def _rotated(vector: np.ndarray, angle: float) -> np.ndarray:
    x, z = vector
    return np.array([np.cos(angle) * x - np.sin(angle) * z, np.sin(angle) * x + np.cos(angle) * z])
