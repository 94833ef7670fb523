# SPDX-License-Identifier: GPL-3.0-or-later
"""What is shown of an object: where its pins and edges are in the world, and how distorted it is.

Reading a mesh takes milliseconds, so each object is read once, and what was read is kept until Blender says
that this object's shape has changed, whatever else does. Then, and when its transform, a pin or a setting is
another one, only what depends on that is made anew: see _State, CutoutReading and CutoutObject. While a drag
is on, the drag itself tells where everything of its object is.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.plane.frame import Array, Indices
from ...model.posing.depths import told_depth
from ...model.posing.pins import Holder
from ...model.posing.posing import PinResult
from ..lattice.posed import PosedObject, posing_refusal, read_posed
from ..lattice.rig import RigState, rig_state
from ..objects import cutout_object
from ..objects.cutout_object import CutoutObject
from ..pins import joint_list, pin_list
from ..pins.taking_part import with_pins
from ..storage import changes
from ..storage.topology import edge_vertices

CAPACITY = 32  # objects; what is kept of one of 10k vertices takes some 5 MB
NO_EDGES: Indices = np.empty((0, 2), np.int32)


@dataclass(frozen=True)
class PinPlace:
    """A pin that can be drawn."""

    owner: str  # the name of the object in whose list it is
    key: int  # its index there
    place: Array  # (3,) in the world
    target: Array  # (3,) where it was asked to be; equal to place when it is there
    turned: Array  # (3,) the direction in the world that was u at rest, turned with the pin
    angle: float  # radians a patch is turned from rest
    scale: float  # what it has grown by


@dataclass(frozen=True, eq=False)
class Snapshot:
    """What there is to draw of one object; another one whenever that is. What nobody asks for is not made."""

    pins: tuple[PinPlace, ...] = ()
    edges: Indices = field(default_factory=lambda: NO_EDGES)  # of the mesh
    shape: tuple[PosedObject, Array] | None = None  # what is posed and its positions
    holders: tuple[Holder, ...] = ()  # the pins; of a cutout that no drag moves
    refusal: str | None = None  # why the object cannot be posed, and what to do; then there is nothing else

    def pin(self, key: int) -> PinPlace | None:
        """The pin with this index, None if it has no place (its group is missing or empty)."""
        return next((pin for pin in self.pins if pin.key == key), None)

    @cached_property
    def points(self) -> Array:
        """World positions of the cutout's vertices, n x 3."""
        if self.shape is None:
            return np.empty((0, 3))
        drawing, positions = self.shape
        return drawing.to_world(positions, drawing.cutout.parts)

    @cached_property
    def depths(self) -> dict[int, float]:
        """The depths of the pins by their indices; those of a cutout have some."""
        if self.shape is None or not isinstance(self.shape[0], CutoutObject):
            return {}
        return {holder.pin.key: told_depth(holder, self.shape[0].depths) for holder in self.holders}

    @property
    def triangles(self) -> Indices:
        """As they are solved, m x 3 indices into the points."""
        return np.empty((0, 3), np.int32) if self.shape is None else self.shape[0].faces

    @cached_property
    def distortion(self) -> native.Distortion | None:
        """Of the shown shape; None where that is no flat one."""
        if self.shape is None or not self.shape[0].cutout.flat:
            return None
        drawing, positions = self.shape
        if isinstance(drawing, CutoutObject) and positions is drawing.positions:
            return drawing.distortion
        return native.distortion(drawing.cutout.rest[:, :2], positions[:, :2], drawing.faces)

    @cached_property
    def worst(self) -> tuple[float, float]:
        """The largest distortion of any triangle: area and angle."""
        assert self.distortion is not None
        return float(self.distortion.triangle_area.max()), float(self.distortion.triangle_angle.max())


class _State(NamedTuple):
    """All that a snapshot depends on. It takes some microseconds, whatever the size of the mesh."""

    changed: changes.Count | RigState
    data: int  # its session_uid
    mode: str
    groups: list[list[str]]  # all of what is pinned, of whose going Blender does not tell
    pinned: set[str]  # those of the pins
    # What is read of the mesh depends on those above alone.
    refusal: str | None
    matrix: bytes
    show_mesh: bool
    pins: tuple[tuple[object, ...], ...]

    def reads_as(self, other: _State) -> bool:
        """Whether what is read of the mesh is the same."""
        return self[:5] == other[:5]


@dataclass(frozen=True)
class _Made:
    """What a snapshot was made from; much of it will be the same in the next one."""

    drawing: CutoutObject
    holders: list[Holder]
    edges: Indices | None  # None unless they are shown


@dataclass(frozen=True)
class _Kept:
    """What is kept of one object."""

    name: str
    snapshot: Snapshot
    state: _State | None  # that it was made in; None while a drag tells what is shown
    made: _Made | None


_kept: OrderedDict[int, _Kept] = OrderedDict()  # by session_uid, the last one asked for at the end
_followed: set[int] = set()  # the objects that a drag is telling about


def of_active(context: bpy.types.Context) -> Snapshot | None:
    """The active object's snapshot; None if it has no pins. Changes no data."""
    obj = context.object
    return None if obj is None or not pin_list.has_pins(obj) else _of(obj)


def _of(obj: bpy.types.Object) -> Snapshot:
    kept = _kept.get(obj.session_uid)
    if kept is None or obj.session_uid not in _followed:
        state = _state(obj)
        if kept is None or kept.state != state or kept.name != obj.name:
            kept = _read(obj, state, kept)
            _keep(obj.session_uid, kept)
    _kept.move_to_end(obj.session_uid)
    return kept.snapshot


def in_view(context: bpy.types.Context) -> Snapshot | None:
    """The active object's snapshot, as far as the view at hand shows the object; None where it is hidden."""
    obj = context.object
    return of_active(context) if obj is not None and obj.visible_get() else None


def pins_in_view(context: bpy.types.Context) -> list[PinPlace]:
    """The pins of all objects that take part, as far as the view at hand shows these."""
    shown = (obj for obj in with_pins(context) if obj.visible_get())
    return [pin for obj in shown for pin in _of(obj).pins]


def follow(drawing: PosedObject, positions: Array, results: Iterable[PinResult]) -> None:
    """A drag is on: show this of its object until `release`, whatever Blender's updates say."""
    uid = drawing.session_uid
    kept = _kept.get(uid)
    shown = kept.snapshot if kept is not None and uid in _followed else None
    if shown is None and isinstance(drawing, CutoutObject):
        edges = _edges(drawing.resolve(), drawing)
    else:
        edges = NO_EDGES if shown is None else shown.edges
    _followed.add(uid)
    holders = () if kept is None else kept.snapshot.holders
    snapshot = Snapshot(_places(drawing, results), edges, (drawing, positions), holders)
    _keep(uid, _Kept(drawing.object_name, snapshot, None, None if kept is None else kept.made))


def following(obj: bpy.types.Object) -> bool:
    """Whether a drag of this object is on."""
    return obj.session_uid in _followed


def release() -> None:
    """No drag is on any more: what is shown is read again."""
    _followed.clear()


def forget() -> None:
    """Keep nothing: all is read again when it is next asked for."""
    _followed.clear()
    _kept.clear()


def _keep(uid: int, kept: _Kept) -> None:
    """Those that are gone make room for a newcomer, and so do the oldest of too many."""
    if uid not in _kept:
        for other, old in list(_kept.items()):
            obj = bpy.data.objects.get(old.name)
            if obj is None or obj.session_uid != other or len(_kept) >= CAPACITY:
                del _kept[other]
    _kept[uid] = kept


def _state(obj: bpy.types.Object) -> _State:
    settings = obj.planar
    return _State(
        changes.count(obj) if obj.type == "MESH" else rig_state(obj),
        obj.data.session_uid,
        obj.mode,
        [pinned.vertex_groups.keys() for pinned in pin_list.pinned_objects(obj)],
        pin_list.groups_of(obj),
        posing_refusal(obj),
        np.array(obj.matrix_world).tobytes(),
        settings.show_mesh,
        tuple(
            (
                *(pin.group, None if pin.object is None else pin.object.session_uid, pin.lattice_point),
                *(pin.kind, pin.angle, pin.scale, pin.has_target, tuple(pin.target), tuple(pin.reached)),
            )
            for pin in settings.pins
        ),
    )


def _read(obj: bpy.types.Object, state: _State, before: _Kept | None) -> _Kept:
    """What is shown of an object now. What still holds of what is kept is taken over."""
    if state.refusal is not None:
        return _Kept(obj.name, Snapshot(refusal=state.refusal), state, None)
    if obj.type == "LATTICE":
        return _read_lattice(obj, state)
    old = None if before is None else before.made
    holds = before is not None and before.state is not None and state.reads_as(before.state)
    current = old if holds else None  # what has been read is as it is now
    try:
        drawing = cutout_object.made_of(obj) if current is None else current.drawing.carried(obj)
    except Refusal as refusal:
        return _Kept(obj.name, Snapshot(refusal=str(refusal)), state, None)
    groups = pin_list.read_groups(obj)
    holders = pin_list.bound_pins(obj, drawing, groups, old.holders if old else ())
    joints = joint_list.bound_joints(obj, drawing, groups)
    edges = None if current is None else current.edges
    if not state.show_mesh or edges is None:
        edges = _edges(obj, drawing)
    results = [*_results(drawing, holders), *joint_list.carried(joints, drawing, drawing.positions)]
    shape = drawing, drawing.positions
    snapshot = Snapshot(_places(drawing, results), edges, shape, tuple(holders))
    made = _Made(drawing, holders, edges if state.show_mesh else None)
    return _Kept(obj.name, snapshot, state, made)


def _read_lattice(obj: bpy.types.Object, state: _State) -> _Kept:
    """What is shown of what a lattice deforms."""
    try:
        drawing = read_posed(obj, drawn=True)
    except Refusal as refusal:
        return _Kept(obj.name, Snapshot(refusal=str(refusal)), state, None)
    holders = pin_list.bound_pins(obj, drawing, pin_list.read_groups(obj))
    places = _places(drawing, _results(drawing, holders))
    return _Kept(obj.name, Snapshot(places, shape=(drawing, drawing.positions)), state, None)


def _results(drawing: PosedObject, holders: Iterable[Holder]) -> Iterator[PinResult]:
    for holder in holders:
        pin, place = holder.pin, holder.place(drawing.positions)
        target = place if pin.target is None else pin.target
        turns = pin.kind == "PATCH" and drawing.cutout.flat  # in space no angle tells it
        angle = holder.fitted_angle(drawing.positions) if turns else 0.0
        scale = holder.fitted_scale(drawing.positions) if turns else 1.0
        yield PinResult(pin.key, holder.part, target, place, angle, pin.scale, scale)


def _edges(obj: bpy.types.Object, drawing: CutoutObject) -> Indices:
    """The mesh's own edges, e x 2 in the cutout's indices, without loose ones; none unless they are shown."""
    if not obj.planar.show_mesh:
        return NO_EDGES
    edges = drawing.rows_of(edge_vertices(obj.data))
    found: Indices = edges[(edges >= 0).all(axis=1)]
    return found


def _places(drawing: PosedObject, results: Iterable[PinResult]) -> tuple[PinPlace, ...]:
    pins = []
    for result in results:
        part = np.array([result.part, result.part], np.int32)
        place, target = drawing.to_world(np.array([result.reached, result.target]), part)
        turned = drawing.frame.lift(np.array([[np.cos(result.angle), np.sin(result.angle)]]))[0]
        pins.append(
            PinPlace(
                drawing.object_name, result.key, place, target, turned, result.angle, result.reached_scale
            )
        )
    return tuple(pins)
