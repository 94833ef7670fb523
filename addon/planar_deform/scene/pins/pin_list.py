# SPDX-License-Identifier: GPL-3.0-or-later
"""The object's pin list: vertex groups in, model pins out, results of posings back."""

from __future__ import annotations

import itertools
import re
from collections.abc import Container, Iterable, Mapping
from dataclasses import replace

import bpy
import numpy as np

from ...model.plane.frame import Array, Indices
from ...model.plane.locate import MeshPoint
from ...model.posing.pins import Holder, Pin
from ...model.posing.posing import PinResult
from ..objects import rest_shape
from ..objects.cutout_object import SAME_PLACE, CutoutObject
from ..storage import migration
from ..storage.vertex_groups import Members, members

GROUP_NAME = "Pin"
DEFAULT_NAME = re.compile(GROUP_NAME + r"(\.\d{3,})?")


def sync(obj: bpy.types.Object) -> None:
    """Make the pins, and the stiffness, follow renamed, removed and reordered vertex groups.

    Groups have no stable identity: a name that is gone is taken to have been renamed to what its index holds
    now, if no group was added or removed since and nothing else uses that group. Anything else stays a
    missing group.
    """
    settings = obj.planar
    groups = obj.vertex_groups
    used = {pin.group for pin in settings.pins} | {settings.stiffness_group}
    unchanged = settings.group_count == len(groups)

    def followed(name: str, index: int) -> bpy.types.VertexGroup | None:
        group = groups.get(name)
        if group is None and name and unchanged and 0 <= index < len(groups):
            renamed = groups[index]
            if renamed.name not in used:
                used.add(renamed.name)
                group = renamed
        return group

    for pin in settings.pins:
        group = followed(pin.group, pin.group_index)
        if group is not None and group.name != pin.group:
            if pin.name == pin.group or DEFAULT_NAME.fullmatch(pin.name):
                pin.name = group.name
            give_group(pin, group.name)
        index = -1 if group is None else group.index
        if pin.group_index != index:
            pin.group_index = index
    group = followed(settings.stiffness_group, settings.stiffness_index)
    if group is not None and group.name != settings.stiffness_group:
        settings.stiffness_group = group.name
    index = -1 if group is None else group.index
    if settings.stiffness_index != index:
        settings.stiffness_index = index
    if settings.group_count != len(groups):
        settings.group_count = len(groups)


def has_pins(obj: bpy.types.Object | None) -> bool:
    """Whether an object is a mesh with pins. One that never had settings does not get them by being asked."""
    if obj is None or obj.type != "MESH" or not obj.is_property_set("planar"):
        return False
    return len(obj.planar.pins) > 0


def groups_of(obj: bpy.types.Object) -> set[str]:
    """The names of the vertex groups that the pins of an object hold."""
    return {pin.group for pin in obj.planar.pins}


def model_pins(obj: bpy.types.Object, drawing: CutoutObject) -> list[Pin]:
    """The usable pins of an object, as bound_pins() finds them."""
    return [holder.pin for holder in bound_pins(obj, drawing, members(obj, groups_of(obj)))]


def bound_pins(
    obj: bpy.types.Object, drawing: CutoutObject, groups: Mapping[str, Members], before: Iterable[Holder] = ()
) -> list[Holder]:
    """The usable pins of an object: those whose group exists and has a vertex of a face in it.

    A pin's stored target is kept while the pin still is where the last posing left it, and dropped otherwise
    (the mesh was edited, reset, shows another key), so that the pin holds what is seen.

    `groups` are those of the pins, as the mesh has them, and `before` the same pins bound earlier.
    """
    settings = obj.planar
    known = {holder.pin.key: holder for holder in before}
    holders = []
    for key, pin in enumerate(settings.pins):
        vertices, weights = groups.get(pin.group, (np.empty(0, np.int32), np.empty(0)))
        rows = drawing.rows_of(vertices)
        inside = (rows >= 0) & (weights > 0.0)
        if not inside.any():
            continue
        weight = pin.weight * settings.pin_weight
        model = Pin(key, pin.kind, rows[inside], weights[inside], pin.enabled, weight, pin.angle)
        old = known.get(key)
        holder = Holder(model, drawing.cutout) if old is None else old.holding(model, drawing.cutout)
        if pin.has_target:
            reached, target = drawing.from_local(np.array([pin.reached, pin.target], dtype=np.float64))
            # Both were stored in float32, which far from the origin is coarser than the drawing asks for.
            rounding = 2.0**-22 * np.linalg.norm(reached)
            gap = np.linalg.norm(holder.place(drawing.positions) - reached)
            if gap <= SAME_PLACE * drawing.cutout.diagonal + rounding:
                holder = holder.holding(replace(model, target=target), drawing.cutout)
        holders.append(holder)
    return holders


def carried(holders: Iterable[Holder], positions: Array) -> list[PinResult]:
    """Where pins are that go where the drawing, n x 2, takes them."""
    results = []
    for holder in holders:
        place, angle = holder.place(positions), holder.fitted_angle(positions)
        results.append(PinResult(holder.pin.key, holder.part, place, place, angle))
    return results


def store_results(obj: bpy.types.Object, drawing: CutoutObject, results: Iterable[PinResult]) -> None:
    """Keep where a posing asked its pins to be and where it left them."""
    for result in results:
        pin = obj.planar.pins[result.key]
        parts = np.array([result.part, result.part], np.int32)
        pin.target, pin.reached = drawing.to_local(np.array([result.target, result.reached]), parts)
        pin.has_target = True
        if pin.kind == "PATCH":
            pin.angle = result.angle
    obj.planar.solved_stiffness = drawing.stiffness_stamp


class SavedResults:
    """What the pins of an object keep of posings, to be put back to the bit."""

    def __init__(self, obj: bpy.types.Object):
        names = ("target", "reached", "has_target", "angle")
        self._pins = [{name: _value(pin, name) for name in names} for pin in obj.planar.pins]
        self._stiffness = obj.planar.solved_stiffness

    def restore(self, obj: bpy.types.Object) -> None:
        """Put it back, as long as the pins are those."""
        for pin, values in zip(obj.planar.pins, self._pins, strict=False):
            for name, value in values.items():
                setattr(pin, name, value)
        obj.planar.solved_stiffness = self._stiffness


def _value(pin: bpy.types.PropertyGroup, name: str) -> object:
    value = getattr(pin, name)
    return tuple(value) if name in {"target", "reached"} else value


def forget_targets(obj: bpy.types.Object) -> None:
    """After a reset: the pins hold the drawing where it is, unturned."""
    for pin in obj.planar.pins:
        pin.has_target = False
        pin.angle = 0.0


def add_at(obj: bpy.types.Object, drawing: CutoutObject, point: MeshPoint) -> bpy.types.PropertyGroup:
    """Add a point pin at a point of the mesh, with a vertex group of its up to three weights."""
    corners = drawing.vertex_indices[drawing.cutout.triangles[point.triangle]]
    held = point.weights > 0.0
    group = new_group(obj)
    fill(group, corners[held], point.weights[held])
    return _named(obj, append(obj, group, "POINT", owns_group=True))


def add_on_vertices(obj: bpy.types.Object, vertices: list[int], kind: str) -> bpy.types.PropertyGroup:
    """Add a pin with a new vertex group of these mesh vertices."""
    group = new_group(obj)
    group.add(vertices, 1.0, "REPLACE")
    return _named(obj, append(obj, group, kind, owns_group=True))


def add_on_group(obj: bpy.types.Object, group: bpy.types.VertexGroup, kind: str) -> bpy.types.PropertyGroup:
    """Add a pin on an existing vertex group."""
    return append(obj, group, kind, owns_group=False)


def append(
    obj: bpy.types.Object, group: bpy.types.VertexGroup, kind: str, *, owns_group: bool
) -> bpy.types.PropertyGroup:
    """Add a pin of this name on a vertex group to the list."""
    migration.migrate(obj)
    rest_shape.ensure(obj)
    settings = obj.planar
    pin = settings.pins.add()
    pin.name = pin.group = group.name
    pin.kind, pin.owns_group, pin.group_index = kind, owns_group, group.index
    settings.active_pin = len(settings.pins) - 1
    settings.group_count = len(obj.vertex_groups)
    return pin


def rebind(obj: bpy.types.Object, pin: bpy.types.PropertyGroup, vertices: Indices, weights: Array) -> None:
    """Make a pin hold these mesh vertices, by a new group where the one it has is not its own alone."""
    shared = [other for other in obj.planar.pins if other.group == pin.group]
    group = obj.vertex_groups.get(pin.group)
    if group is None or not pin.owns_group or len(shared) > 1:
        group = new_group(obj)
        give_group(pin, group.name)
        pin.owns_group, pin.group_index = True, group.index
        obj.planar.group_count = len(obj.vertex_groups)
    else:
        group.remove(range(len(obj.data.vertices)))
    fill(group, vertices, weights)


def give_group(pin: bpy.types.PropertyGroup, name: str) -> None:
    """Let a pin go on as it is with what is the same vertices by another name."""
    held = pin.has_target, pin.angle
    pin.group = name  # which lets go of its target, as another group would
    pin.has_target, pin.angle = held


def new_group(obj: bpy.types.Object) -> bpy.types.VertexGroup:
    """A vertex group for a pin, named as no other pin's of the file: a join makes one of equal ones."""
    taken = {name for other in bpy.data.objects if has_pins(other) for name in groups_of(other)}
    return obj.vertex_groups.new(name=free_name(GROUP_NAME, taken | set(obj.vertex_groups.keys())))


def fill(group: bpy.types.VertexGroup, vertices: Indices, weights: Array) -> None:
    """Give these mesh vertices their weights in a group."""
    for vertex, weight in zip(vertices.tolist(), weights.tolist(), strict=True):
        group.add([vertex], weight, "REPLACE")


def free_name(name: str, taken: Container[str]) -> str:
    """A name, with a number behind it as Blender has it where it is taken."""
    base = re.sub(r"\.\d{3,}$", "", name)
    numbers = itertools.chain([name], (f"{base}.{number:03d}" for number in itertools.count(1)))
    return next(free for free in numbers if free not in taken)


def hold_as_patch(obj: bpy.types.Object, index: int, vertices: list[int]) -> None:
    """Let a pin be a patch of these mesh vertices. A group that is not the pin's alone stays as it is."""
    pin = obj.planar.pins[index]
    alone = pin.owns_group and sum(other.group == pin.group for other in obj.planar.pins) == 1
    group = obj.vertex_groups.get(pin.group) if alone else None
    if group is None:
        group = new_group(obj)
    group.remove(range(len(obj.data.vertices)))
    group.add(vertices, 1.0, "REPLACE")
    pin.group, pin.group_index, pin.owns_group, pin.kind = group.name, group.index, True, "PATCH"
    pin.has_target, pin.angle = False, 0.0  # it holds the drawing as it is now
    obj.planar.group_count = len(obj.vertex_groups)


def remove(obj: bpy.types.Object, indices: Iterable[int]) -> None:
    """Remove pins, and the groups that were made for them unless another pin uses them."""
    settings = obj.planar
    sync(obj)
    for index in sorted(indices, reverse=True):
        pin = settings.pins[index]
        name, owned = pin.group, pin.owns_group
        settings.pins.remove(index)
        group = obj.vertex_groups.get(name)
        if owned and group is not None and all(other.group != name for other in settings.pins):
            obj.vertex_groups.remove(group)
    settings.active_pin = max(0, min(settings.active_pin, len(settings.pins) - 1))
    sync(obj)


def _named(obj: bpy.types.Object, pin: bpy.types.PropertyGroup) -> bpy.types.PropertyGroup:
    """With the first name that is free in the list; poses are carried from drawing to drawing by it."""
    pin.name = free_name(GROUP_NAME, {other.name for other in obj.planar.pins if other != pin})
    return pin
