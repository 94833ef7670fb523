# SPDX-License-Identifier: GPL-3.0-or-later
"""The object's pin list: vertex groups in, model pins out, results of posings back."""

from __future__ import annotations

import itertools
import re
from collections.abc import Container, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, Protocol

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.plane.cutout import Cutout
from ...model.plane.frame import Array, Indices
from ...model.plane.locate import MeshPoint
from ...model.posing.joints import KINDS as JOINTS
from ...model.posing.pins import Holder, Pin
from ...model.posing.posing import PinResult, result_of
from ...model.posing.rebinding import NEGLIGIBLE
from ...model.timing.played_curve import SAME_FRAME
from ..objects import rest_shape
from ..objects.cutout_object import SAME_PLACE
from ..objects.flat_object import MAKE_LOCAL
from ..objects.modifiers import of_lattice
from ..storage import changes, migration, vertex_groups
from ..storage.vertex_groups import Members, members

NO_FRAME = -2097152.0  # below all that Blender has
SAME_SCALE = 1e-3  # of a patch, by which a posing left it

NOBODY: Members = (np.empty(0, np.int32), np.empty(0))
GROUP_NAME = "Pin"
DEFAULT_NAME = re.compile(GROUP_NAME + r"(\.\d{3,})?")


class Drawing(Protocol):
    """What pins hold: a cutout, or all that a lattice deforms with the lattice itself."""

    cutout: Cutout
    positions: Array
    stiffness_stamp: str

    def rows_held(self, pinned: bpy.types.Object | None, numbers: Indices) -> Indices:
        """The rows of vertices of an object, or of a lattice's own points (None); -1 for what has none."""

    def vertices_held(self, rows: Indices) -> tuple[bpy.types.Object, Indices]:
        """Whose vertices, of one object, rows are, and which."""

    def to_local(self, places: Array, parts: Indices) -> Array:
        """Positions k x 3 in the space in which pins are stored."""

    def from_local(self, places: Array) -> Array:
        """The same back."""

    def poser(self, method: native.Method, positions: Array) -> Any:
        """A solver that stands at these positions. May be called in another thread."""


def sync(obj: bpy.types.Object) -> None:
    """Make the pins, and the stiffness, follow renamed, removed and reordered vertex groups.

    Groups have no stable identity: a name that is gone is taken to have been renamed to what its index holds
    now, if no group was added or removed since and nothing else uses that group. Anything else stays a
    missing group.
    """
    settings = obj.planar
    if obj.type == "LATTICE":
        _find_lost(obj)
    for pinned in pinned_objects(obj):
        groups = pinned.vertex_groups
        pins = [pin for pin in settings.pins if pinned_object(pin) == pinned]
        used = {pin.group for pin in pins}
        followed = _Followed(groups, used, all(pin.group_count == len(groups) for pin in pins))
        if pinned == obj:
            used.add(settings.stiffness_group)
            followed.unchanged = settings.group_count == len(groups)
        for pin in pins:
            _sync_pin(pin, followed)
            if pinned != obj and pin.group_count != len(groups):
                pin.group_count = len(groups)
        if pinned == obj:
            _sync_stiffness(obj, followed)


def _find_lost(lattice: bpy.types.Object) -> None:
    """Pins whose object has been joined to another one that the lattice deforms go on there, by their group.

    What has been deleted is let go: Blender keeps an object as long as anything points to it.
    """
    for pin in lattice.planar.pins:
        if pin.lattice_point >= 0 or (pin.object is not None and pin.object.users_scene):
            continue
        found = [
            obj
            for obj in bpy.data.objects
            if obj.type == "MESH"
            and pin.group in obj.vertex_groups
            and obj.users_scene
            and of_lattice(obj, lattice)
        ]
        if len(found) == 1 or pin.object is not None:
            with _keeping_target(pin):
                pin.object = found[0] if len(found) == 1 else None
            pin.group_count = 0


@dataclass
class _Followed:
    """Finds the vertex groups of one object, though they have been renamed."""

    groups: bpy.types.VertexGroups
    used: set[str]
    unchanged: bool  # as many as there were

    def of(self, name: str, index: int) -> bpy.types.VertexGroup | None:
        """What has been known by this name and index."""
        group = self.groups.get(name)
        if group is None and name and self.unchanged and 0 <= index < len(self.groups):
            renamed = self.groups[index]
            if renamed.name not in self.used:
                self.used.add(renamed.name)
                group = renamed
        return group


def _sync_pin(pin: bpy.types.PropertyGroup, followed: _Followed) -> None:
    group = followed.of(pin.group, pin.group_index)
    if group is not None and group.name != pin.group:
        if pin.name == pin.group or DEFAULT_NAME.fullmatch(pin.name):
            pin.name = group.name
        give_group(pin, group.name)
    index = -1 if group is None else group.index
    if pin.group_index != index:
        pin.group_index = index


def _sync_stiffness(obj: bpy.types.Object, followed: _Followed) -> None:
    settings = obj.planar
    group = followed.of(settings.stiffness_group, settings.stiffness_index)
    if group is not None and group.name != settings.stiffness_group:
        settings.stiffness_group = group.name
    index = -1 if group is None else group.index
    if settings.stiffness_index != index:
        settings.stiffness_index = index
    if settings.group_count != len(followed.groups):
        settings.group_count = len(followed.groups)


def has_pins(obj: bpy.types.Object | None) -> bool:
    """Whether an object is a mesh or a lattice with pins.

    One that never had settings does not get them by being asked.
    """
    if obj is None or obj.type not in {"MESH", "LATTICE"} or not obj.is_property_set("planar"):
        return False
    return len(obj.planar.pins) > 0


def pinned_object(pin: bpy.types.PropertyGroup) -> bpy.types.Object | None:
    """The object whose vertex group a pin holds, or None."""
    obj: bpy.types.Object = pin.id_data
    if obj.type == "MESH":
        return obj
    pinned: bpy.types.Object | None = pin.object
    return pinned


def pinned_objects(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """The objects whose vertex groups the pins of an object hold: a mesh itself, what a lattice deforms."""
    if obj.type == "MESH":
        return [obj]
    return list(
        dict.fromkeys(pinned for pin in obj.planar.pins if (pinned := pinned_object(pin)) is not None)
    )


def is_joint(pin: bpy.types.PropertyGroup) -> bool:
    """Whether what is in the list is no pin, but holds two parts together; see joint_list.py."""
    return pin.kind in JOINTS


def groups_of(obj: bpy.types.Object) -> set[str]:
    """The names of the vertex groups that the pins of an object hold."""
    return {pin.group for pin in obj.planar.pins}


def model_pins(obj: bpy.types.Object, drawing: Drawing) -> list[Pin]:
    """The usable pins of an object, as bound_pins() finds them."""
    return [holder.pin for holder in bound_pins(obj, drawing, read_groups(obj))]


def read_groups(obj: bpy.types.Object) -> dict[int, dict[str, Members]]:
    """The vertex groups that the pins of an object hold, by the session_uid of whose they are."""
    return {pinned.session_uid: members(pinned, groups_of(obj)) for pinned in pinned_objects(obj)}


def bound_pins(
    obj: bpy.types.Object,
    drawing: Drawing,
    groups: Mapping[int, Mapping[str, Members]],
    before: Iterable[Holder] = (),
) -> list[Holder]:
    """The usable pins of an object: those whose group exists and has a vertex of a face in it.

    A pin's stored target is kept while the pin still is where the last posing left it, and dropped otherwise
    (the mesh was edited, reset, shows another key), so that the pin holds what is seen.

    `groups` are those of the pins, as the meshes have them, and `before` the same pins bound earlier.
    """
    settings = obj.planar
    known = {holder.pin.key: holder for holder in before}
    holders = []
    for key, pin in enumerate(settings.pins):
        if is_joint(pin):
            continue
        rows, weights = members_held(pin, drawing, groups)
        inside = (rows >= 0) & (weights > 0.0)
        if not inside.any():
            continue
        weight = pin.weight * settings.pin_weight
        model = Pin(key, pin.kind, rows[inside], weights[inside], pin.enabled, weight, pin.angle, pin.scale)
        old = known.get(key)
        holder = Holder(model, drawing.cutout) if old is None else old.holding(model, drawing.cutout)
        if is_reached(pin, drawing, holder):
            target = drawing.from_local(np.array([pin.target], dtype=np.float64))[0]
            holder = holder.holding(replace(model, target=target), drawing.cutout)
        holders.append(holder)
    return holders


def is_reached(pin: bpy.types.PropertyGroup, drawing: Drawing, holder: Holder) -> bool:
    """Whether a pin, bound by this holder, still is where a posing left it, so that its target counts."""
    if not pin.has_target:
        return False
    reached = drawing.from_local(np.array([pin.reached], dtype=np.float64))[0]
    # It was stored in float32, which far from the origin is coarser than the drawing asks for.
    rounding = 2.0**-22 * np.linalg.norm(reached)
    gap = np.linalg.norm(holder.place(drawing.positions) - reached)
    if gap > SAME_PLACE * drawing.cutout.diagonal + rounding:
        return False
    if pin.kind != "PATCH" or not drawing.cutout.flat or not pin.reached_scale or not holder.size:
        return True  # or it is of a file of before
    grown = abs(holder.fitted_scale(drawing.positions) - pin.reached_scale)
    return bool(grown <= SAME_SCALE + rounding / holder.size)


def members_held(
    pin: bpy.types.PropertyGroup, drawing: Drawing, groups: Mapping[int, Mapping[str, Members]]
) -> Members:
    """The rows of a drawing that a pin holds, -1 where it has none, and with what weights."""
    pinned = pinned_object(pin)
    if pin.lattice_point >= 0:
        return drawing.rows_held(None, np.array([pin.lattice_point], np.int32)), np.ones(1)
    found = None if pinned is None else groups.get(pinned.session_uid, {}).get(pin.group)
    if pinned is None or found is None:
        return NOBODY
    return drawing.rows_held(pinned, found[0]), found[1]


def carried(holders: Iterable[Holder], positions: Array) -> list[PinResult]:
    """Where pins are that go where the drawing, n x 2, takes them."""
    results = []
    for holder in holders:
        place, angle = holder.place(positions), holder.fitted_angle(positions)
        results.append(result_of(holder, positions, place, angle, holder.held_scale(positions)))
    return results


def store_results(
    obj: bpy.types.Object, drawing: Drawing, results: Iterable[PinResult], *, by_hand: bool = True
) -> None:
    """Keep where a posing asked its pins to be and where it left them.

    `by_hand`: and not by what they follow alone.
    """
    for result in results:
        pin = obj.planar.pins[result.key]
        parts = np.array([result.part, result.part], np.int32)
        pin.target, pin.reached = drawing.to_local(np.array([result.target, result.reached]), parts)
        pin.has_target = True
        if pin.kind == "PATCH" and drawing.cutout.flat:
            pin.angle, pin.scale, pin.reached_scale = result.angle, result.scale, result.reached_scale
    obj.planar.solved_stiffness = drawing.stiffness_stamp
    obj.planar.posed_at = bpy.context.scene.frame_current_final if by_hand else NO_FRAME
    changes.tell_pose(obj)


def posed_by_hand(obj: bpy.types.Object, frame: float) -> bool:
    """Whether what an object shows has been posed by hand at this frame, as far as its pins know."""
    return bool(abs(obj.planar.posed_at - frame) < SAME_FRAME)


class SavedResults:
    """What the pins of an object keep of posings, to be put back to the bit."""

    def __init__(self, obj: bpy.types.Object):
        names = ("target", "reached", "has_target", "has_posed", "angle", "scale", "reached_scale")
        self._pins = [{name: _value(pin, name) for name in names} for pin in obj.planar.pins]
        self._stiffness, self._posed_at = obj.planar.solved_stiffness, obj.planar.posed_at

    def restore(self, obj: bpy.types.Object) -> None:
        """Put it back, as long as the pins are those."""
        for pin, values in zip(obj.planar.pins, self._pins, strict=False):
            for name, value in values.items():
                setattr(pin, name, value)
        obj.planar.solved_stiffness, obj.planar.posed_at = self._stiffness, self._posed_at


def _value(pin: bpy.types.PropertyGroup, name: str) -> object:
    value = getattr(pin, name)
    return tuple(value) if name in {"target", "reached"} else value


def forget_targets(obj: bpy.types.Object) -> None:
    """After a reset: the pins hold the drawing where it is, unturned."""
    obj.planar.posed_at = bpy.context.scene.frame_current_final
    for pin in obj.planar.pins:
        pin.has_target, pin.has_posed = False, pin.has_posed or pin.has_target
        pin.angle, pin.scale = 0.0, 1.0


def add_at(obj: bpy.types.Object, drawing: Drawing, point: MeshPoint) -> bpy.types.PropertyGroup:
    """Add a point pin at a point of a mesh, with a vertex group of its up to three weights."""
    pinned, corners = drawing.vertices_held(drawing.cutout.triangles[point.triangle])
    held = point.weights > NEGLIGIBLE
    group = new_group(pinned)
    vertex_groups.fill(group, corners[held], point.weights[held])
    return _named(obj, append(obj, group, "POINT", owns_group=True))


def is_pinned(obj: bpy.types.Object, group: bpy.types.VertexGroup) -> bool:
    """Whether an object has a pin on a vertex group, of whatever object."""
    return any(pin.group == group.name and pinned_object(pin) == group.id_data for pin in obj.planar.pins)


def check_groups_of(pinned: bpy.types.Object) -> None:
    """Raises Refusal where an object cannot get vertex groups."""
    if any(one.library is not None or one.override_library is not None for one in (pinned, pinned.data)):
        raise Refusal(f"'{pinned.name}' is linked, and cannot get a vertex group: {MAKE_LOCAL}")


def add_on_vertices(
    obj: bpy.types.Object, vertices: list[int], kind: str, pinned: bpy.types.Object | None = None
) -> bpy.types.PropertyGroup:
    """Add a pin with a new vertex group of these vertices, of a mesh that a lattice deforms if `pinned`."""
    group = new_group(pinned or obj)
    vertex_groups.give(group, vertices, 1.0)
    return _named(obj, append(obj, group, kind, owns_group=True))


def add_on_lattice_point(obj: bpy.types.Object, index: int) -> bpy.types.PropertyGroup:
    """Add a pin on a point of a lattice; the one that is there already if there is one."""
    for key, pin in enumerate(obj.planar.pins):
        if pin.lattice_point == index:
            obj.planar.active_pin = key
            return pin
    pin = _appended(obj, "POINT")
    pin.lattice_point = index
    return _named(obj, pin)


def add_on_group(obj: bpy.types.Object, group: bpy.types.VertexGroup, kind: str) -> bpy.types.PropertyGroup:
    """Add a pin on an existing vertex group."""
    return append(obj, group, kind, owns_group=False)


def append(
    obj: bpy.types.Object, group: bpy.types.VertexGroup, kind: str, *, owns_group: bool
) -> bpy.types.PropertyGroup:
    """Add a pin of this name on a vertex group, of whatever object, to the list."""
    pin, pinned = _appended(obj, kind), group.id_data
    if pinned != obj:
        pin.object = pinned
    pin.name = pin.group = group.name
    pin.owns_group, pin.group_index = owns_group, group.index
    _count_groups(pin)
    return pin


def _appended(obj: bpy.types.Object, kind: str) -> bpy.types.PropertyGroup:
    migration.migrate(obj)
    if obj.type == "MESH":
        rest_shape.ensure(obj)
    settings = obj.planar
    pin = settings.pins.add()
    pin.kind = kind
    settings.active_pin = len(settings.pins) - 1
    return pin


def _count_groups(pin: bpy.types.PropertyGroup) -> None:
    """Keep how many groups there are, of which those of the pin's object are told from others."""
    pinned, obj = pinned_object(pin), pin.id_data
    if pinned == obj:
        obj.planar.group_count = len(obj.vertex_groups)
        return
    for other in obj.planar.pins:
        if other.object == pinned:
            other.group_count = len(pinned.vertex_groups)


def rebind(obj: bpy.types.Object, pin: bpy.types.PropertyGroup, vertices: Indices, weights: Array) -> None:
    """Make a pin hold these mesh vertices, by a new group where the one it has is not its own alone."""
    pinned = pinned_object(pin)
    assert pinned is not None  # it holds vertices
    group = pinned.vertex_groups.get(pin.group)
    if group is None or not pin.owns_group or len(_sharing(obj, pin.group, pinned)) > 1:
        group = new_group(pinned)
        give_group(pin, group.name)
        pin.owns_group, pin.group_index = True, group.index
        _count_groups(pin)
    else:
        vertex_groups.clear(group)
    vertex_groups.fill(group, vertices, weights)


def give_group(pin: bpy.types.PropertyGroup, name: str) -> None:
    """Let a pin go on as it is with what is the same vertices by another name."""
    with _keeping_target(pin):
        pin.group = name


@contextmanager
def _keeping_target(pin: bpy.types.PropertyGroup) -> Iterator[None]:
    """Whatever is set lets go of a pin's target, as other vertices would; these are the same."""
    held = pin.has_target, pin.has_posed, pin.angle, pin.scale
    yield
    pin.has_target, pin.has_posed, pin.angle, pin.scale = held


def new_group(obj: bpy.types.Object, name: str = GROUP_NAME) -> bpy.types.VertexGroup:
    """A vertex group for a pin, named as no other pin's of the file: a join makes one of equal ones."""
    taken = {name for other in bpy.data.objects if has_pins(other) for name in groups_of(other)}
    return obj.vertex_groups.new(name=free_name(name, taken | set(obj.vertex_groups.keys())))


def free_name(name: str, taken: Container[str]) -> str:
    """A name, with a number behind it as Blender has it where it is taken."""
    base = re.sub(r"\.\d{3,}$", "", name)
    numbers = itertools.chain([name], (f"{base}.{number:03d}" for number in itertools.count(1)))
    return next(free for free in numbers if free not in taken)


def hold_as_patch(obj: bpy.types.Object, index: int, vertices: list[int]) -> None:
    """Let a pin be a patch of these mesh vertices. A group that is not the pin's alone stays as it is."""
    pin = obj.planar.pins[index]
    pinned = pinned_object(pin)
    assert pinned is not None  # it holds vertices
    alone = pin.owns_group and len(_sharing(obj, pin.group, pinned)) == 1
    group = pinned.vertex_groups.get(pin.group) if alone else None
    if group is None:
        group = new_group(pinned)
    vertex_groups.clear(group)
    vertex_groups.give(group, vertices, 1.0)
    # Which lets go of its target: it holds the drawing as it is now.
    pin.group, pin.group_index, pin.owns_group, pin.kind = group.name, group.index, True, "PATCH"
    _count_groups(pin)


def remove(obj: bpy.types.Object, indices: Iterable[int]) -> None:
    """Remove pins, and the groups that were made for them unless another pin uses them."""
    settings = obj.planar
    sync(obj)
    for index in sorted(indices, reverse=True):
        pin = settings.pins[index]
        pinned, name, owned = pinned_object(pin), pin.group, pin.owns_group
        settings.pins.remove(index)
        if pinned is None or not owned:
            continue
        group = pinned.vertex_groups.get(name)
        if group is not None and not _sharing(obj, name, pinned):
            pinned.vertex_groups.remove(group)
    settings.active_pin = max(0, min(settings.active_pin, len(settings.pins) - 1))
    sync(obj)


def _sharing(obj: bpy.types.Object, group: str, pinned: bpy.types.Object) -> list[bpy.types.PropertyGroup]:
    """The pins of an object, and those of the object of a group, that hold this group."""
    lists = (obj, pinned) if pinned != obj and has_pins(pinned) else (obj,)
    pins = (pin for one in lists for pin in one.planar.pins)
    return [pin for pin in pins if pin.group == group and pinned_object(pin) == pinned]


def _named(obj: bpy.types.Object, pin: bpy.types.PropertyGroup) -> bpy.types.PropertyGroup:
    """With the first name that is free in the list; poses are carried from drawing to drawing by it."""
    pin.name = free_name(GROUP_NAME, {other.name for other in obj.planar.pins if other != pin})
    return pin
