# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins that come with a drawing that is joined to another, and what else its object tells of it.

A join keeps the vertex groups, and makes one of those of the same name; the list of pins goes with its
object. So the lists are remembered, by the owner of the mesh (storage/migration.py), as long as Blender runs.
Vertices with that owner in another mesh tell of a join, and where its pins are.

What is separated from a drawing has its whole list, and so has what is left. Each lets go of the pins that
the other holds; they are remembered, as undo brings back the mesh alone where no more was changed by Blender.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from ...model.image import image_files
from ...model.plane.affine import Affine
from ...model.posing.joints import KINDS as JOINTS
from ..objects import mesh_edits, rest_shape, triangulation
from ..objects.mesh_edits import Joined
from ..storage import vertex_groups
from ..storage.vertex_groups import Members, members
from . import controls, pin_list

# What a pin keeps, beside its group.
_KEPT = (
    *("name", "kind", "enabled", "has_target", "has_posed"),
    *("target", "reached", "angle", "scale", "reached_scale"),
    *("follow_bone", "follow_group", "follow_offset", "follow_axis"),
)


@dataclass(frozen=True)
class _Pin:
    """A pin as it was last seen."""

    group: str
    owned: bool
    weight: float  # with that of all pins of its object
    follow: str  # the object that it follows, by name
    settings: dict[str, Any]


_lists: dict[int, list[_Pin]] = {}  # by owner
_stiffness: dict[int, str] = {}  # by owner, the group in which it is painted
_images: dict[int, str] = {}  # by owner, what the files of its images were
_gone: dict[int, list[_Pin]] = {}  # by owner, what went with a part that was separated
_parted: dict[int, set[int]] = {}  # by owner, the meshes (session_uid) that were separated from it


def remember(obj: bpy.types.Object) -> None:
    """Keep the pins of an object, for when it is joined to another."""
    owner = mesh_edits.owner_of(obj.data)
    if owner:
        _stiffness[owner] = obj.planar.stiffness_group
        _images[owner] = obj.planar.image_state
        _lists[owner] = [_remembered(pin, obj.planar.pin_weight) for pin in obj.planar.pins]


def take_in(obj: bpy.types.Object, joined: Mapping[int, Joined]) -> None:
    """Add the pins of what has been joined to an object, each on its own vertices."""
    pins = [(part, pin) for owner, part in joined.items() for pin in _lists.get(owner, [])]
    groups = members(obj, pin_list.groups_of(obj) | {pin.group for _, pin in pins})
    whole = _whole_again(obj, groups, [pin for _, pin in pins])
    own = np.ones(len(obj.data.vertices), bool)
    for part in joined.values():
        own &= ~part.rows
    for index in reversed(range(len(obj.planar.pins))):
        pin = obj.planar.pins[index]
        vertices, weights = groups.get(pin.group, pin_list.NOBODY)
        mine = own[vertices]
        if len(mine) and not mine.any():  # it had nothing to hold, as what is separated leaves it
            obj.planar.pins.remove(index)
        elif not mine.all() and pin.group not in whole:
            if not pin.owns_group:
                pin.group_before = pin.group
            pin_list.rebind(obj, pin, vertices[mine], weights[mine])
    used = pin_list.groups_of(obj)
    for owner, part in joined.items():
        for pin in _lists.get(owner, []):
            vertices, weights = groups.get(pin.group, pin_list.NOBODY)
            mine = part.rows[vertices]
            if mine.any() and (pin.group not in whole or pin.group not in used):
                alone = pin.group not in used and (bool(mine.all()) or pin.group in whole)
                _add(obj, pin, part, owner, None if alone else (vertices[mine], weights[mine]))
                used.add(pin.group)
        _add_stiffness(obj, _stiffness.get(owner, ""), part)
        obj.planar.image_state = image_files.joined(obj.planar.image_state, _images.get(owner, ""))
    held = pin_list.groups_of(obj)
    for name in {pin.group for _, pin in pins if pin.owned} - held:
        group = obj.vertex_groups.get(name)
        if group is not None:  # several have become one, and each has another one by now
            obj.vertex_groups.remove(group)
    pin_list.sync(obj)


def _whole_again(obj: bpy.types.Object, groups: Mapping[str, Members], pins: Iterable[_Pin]) -> set[str]:
    """The groups of joints whose halves came from several, and hold two parts of one drawing again."""
    kinds = [(pin.group, pin.kind) for pin in obj.planar.pins]
    kinds += [(pin.group, pin.settings["kind"]) for pin in pins]
    again = {group for group, kind in kinds if kind in JOINTS and kinds.count((group, kind)) > 1}
    if not again:
        return set()
    faces = triangulation.faces_of(obj.data, rest_shape.reference(obj))
    parts = np.full(len(obj.data.vertices), -1, np.int32)
    parts[faces.vertices] = faces.parts
    return {group for group in again & set(groups) if len(np.unique(parts[groups[group][0]])) == 2}


def part(obj: bpy.types.Object, before: int) -> None:
    """After vertices of an object have gone: let go of the pins of which a part that was separated has all.

    `before`: the owner by which the mesh was known until now, that of what it was separated from.
    """
    mesh, pins, owner = obj.data, obj.planar.pins, mesh_edits.owner_of(obj.data)
    held = _with_vertices(obj)
    if owner == before:
        parted = [other for other in bpy.data.objects if _is_parted(other, mesh, owner)]
        held |= pin_list.groups_of(obj) - {group for other in parted for group in _with_vertices(other)}
    else:  # what is not here is in what it was separated from, which may be in Edit Mode still
        _parted.setdefault(before, set()).add(mesh.session_uid)
    gone = [index for index, pin in enumerate(pins) if pin.group not in held]
    if gone:
        _gone.setdefault(owner, []).extend(_remembered(pins[key], obj.planar.pin_weight) for key in gone)
        pin_list.remove(obj, gone)


def _with_vertices(obj: bpy.types.Object) -> set[str]:
    """The groups of an object's pins that have vertices."""
    return {name for name, found in members(obj, pin_list.groups_of(obj)).items() if len(found[0])}


def _is_parted(other: bpy.types.Object, mesh: bpy.types.Mesh, owner: int) -> bool:
    """Whether an object was separated from the mesh with this owner, which it has until it is seen."""
    if other.type != "MESH" or other.mode == "EDIT" or other.data == mesh or not pin_list.has_pins(other):
        return False
    return mesh_edits.owner_of(other.data) == owner or other.data.session_uid in _parted.get(owner, ())


def _bring_back(obj: bpy.types.Object) -> None:
    """Undo has brought the vertices of pins that had been let go."""
    owner = mesh_edits.owner_of(obj.data)
    lost = {pin.group: pin for pin in _gone.get(owner, ()) if pin.group not in pin_list.groups_of(obj)}
    held = members(obj, set(lost))
    for group, pin in lost.items():
        if group in held and len(held[group][0]):
            rows = np.ones(len(obj.data.vertices), bool)
            _add(obj, pin, Joined(rows, Affine(np.eye(3), np.zeros(3)), False), 0, None)


def undone(obj: bpy.types.Object) -> None:
    """Blender may undo a join of the mesh alone, as nothing else of the object was changed by it."""
    groups = obj.vertex_groups
    if _gone:
        _bring_back(obj)
    for pin in obj.planar.pins:
        if pin.group_before and pin.group not in groups and pin.group_before in groups:
            pin_list.give_group(pin, pin.group_before)
            pin.group_before = ""
    gone = [
        index
        for index, pin in enumerate(obj.planar.pins)
        if pin.came_from and pin.group not in groups and mesh_edits.is_elsewhere(pin.came_from, obj.data)
    ]
    if gone:
        pin_list.remove(obj, gone)


def forget() -> None:
    """Of another file nothing is known."""
    _lists.clear()
    _stiffness.clear()
    _images.clear()
    _gone.clear()
    _parted.clear()


def _add_stiffness(obj: bpy.types.Object, name: str, part: Joined) -> None:
    """What has been joined stays as stiff as it was painted."""
    settings, found = obj.planar, members(obj, [name]).get(name)
    if found is None or settings.stiffness_group == name:
        return
    if settings.stiffness_group not in obj.vertex_groups:
        settings.stiffness_group = name
        return
    mine = part.rows[found[0]]
    vertex_groups.fill(obj.vertex_groups[settings.stiffness_group], found[0][mine], found[1][mine])


def _remembered(pin: bpy.types.PropertyGroup, weight: float) -> _Pin:
    kept = {name: getattr(pin, name) for name in _KEPT}
    for name in ("target", "reached", "follow_offset", "follow_axis"):
        kept[name] = tuple(kept[name])
    return _Pin(
        pin.group, pin.owns_group, pin.weight * weight, "" if pin.follow is None else pin.follow.name, kept
    )


def _add(
    obj: bpy.types.Object,
    pin: _Pin,
    part: Joined,
    owner: int,
    of: Members | None,
) -> None:
    """Add a pin that was remembered, on its group or, `of` these vertices, on a new one."""
    group = obj.vertex_groups[pin.group] if of is None else pin_list.new_group(obj)
    if of is not None:
        vertex_groups.fill(group, *of)
    active = obj.planar.active_pin
    added = pin_list.append(obj, group, pin.settings["kind"], owns_group=pin.owned or of is not None)
    if len(obj.planar.pins) > 1:
        obj.planar.active_pin = active
    names = {other.name for other in obj.planar.pins if other != added}
    with controls.given():
        followed = bpy.data.objects.get(pin.follow)
        added.follow = None if followed == obj else followed  # it is of one piece with that now
        for name, value in pin.settings.items():
            setattr(added, name, value)
    added.name = pin_list.free_name(pin.settings["name"], names)
    added.weight = pin.weight / obj.planar.pin_weight
    added.came_from = owner
    if part.map is None:
        added.has_target = False
        return
    added.target, added.reached = part.map.of(np.array([added.target, added.reached]))
    added.follow_axis = part.map.linear @ np.array(added.follow_axis)
    if part.turned_over:
        added.angle = -added.angle
