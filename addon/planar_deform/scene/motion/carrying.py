# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings carried by another one: their pins follow places of its mesh, as a hand's lantern does."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array
from ...model.plane.locate import MeshPoint
from ...model.posing.mesh_place import place_binding
from ..lattice.posed import read_posed
from ..objects.cutout_object import CutoutObject, pose_refusal, read_cutout
from ..pins import controls, dependencies, followed_mesh, pin_list
from ..sequence import pose_state
from . import follow_offset

ON_MESH = 0.01  # of the diagonal: a pin that is farther from the mesh lies beside it


def is_drawing(obj: bpy.types.Object) -> bool:
    """Whether an object has a mesh that we pose, by which it is followed."""
    if obj.type != "MESH" or pose_refusal(obj) is not None or obj.library is not None:
        return False
    return pin_list.has_pins(obj) or pose_state.has_blocks(obj)


def carry(obj: bpy.types.Object, keys: Iterable[int], carrier: bpy.types.Object) -> None:
    """Let these pins of an object follow the places of a drawing that lie under them, from where they are.

    Pins beside the drawing go with the nearest one that lies on it; where none does, all of them go with the
    place that is nearest to any. What they followed before keeps its places: Before.tidy() takes these away.
    Raises Refusal, with nothing changed.
    """
    pin_list.check_groups_of(carrier)
    reason = dependencies.refusal(obj, carrier, on_mesh=True)
    if reason is not None:
        raise Refusal(reason)
    placed = follow_offset.matrices(obj, read_posed(obj, unkeyed=True), keys)
    drawing = read_cutout(carrier)
    near = ON_MESH * drawing.diagonal
    under = {key: drawing.under(matrix[:3, 3], near) for key, (matrix, _) in placed.items()}
    leaders = _leaders({key: matrix[:3, 3] for key, (matrix, _) in placed.items()}, under, drawing)
    if not drawing.known.all():
        drawing.keep_rest()  # or a layer that has just been joined has none to be followed from
    before, names = Before(obj, placed), {}
    for key in dict.fromkeys(leaders.values()):
        rows, weights = place_binding(drawing.cutout, under[key])
        names[key] = followed_mesh.new_place(carrier, (drawing.vertex_indices[rows], weights))
    with controls.given():
        for key, leader in leaders.items():
            pin = obj.planar.pins[key]
            pin.follow, pin.follow_bone, pin.follow_group = carrier, "", names[leader]
        try:
            follow_offset.keep(obj, placed)
        except Refusal:
            before.restore()
            raise


def let_go(obj: bpy.types.Object, keys: Iterable[int]) -> int:
    """Let these pins of an object follow no mesh any more; how many did."""
    going = [key for key in keys if obj.planar.pins[key].follow_group]
    before = Before(obj, going)
    for key in going:
        obj.planar.pins[key].follow, obj.planar.pins[key].follow_group = None, ""
    before.tidy()
    if going and not any(pin.follow for pin in obj.planar.pins):
        obj.planar.live = False  # its poses play again
    return len(going)


class Before:
    """What pins followed."""

    def __init__(self, obj: bpy.types.Object, keys: Iterable[int]):
        self._obj = obj
        self._kept = {key: _Kept.of(obj.planar.pins[key]) for key in keys}

    def restore(self) -> None:
        """Let them follow that again; places that have been made for something else go."""
        made = [_Kept.of(self._obj.planar.pins[key]) for key in self._kept]
        with controls.given():
            for key, kept in self._kept.items():
                pin = self._obj.planar.pins[key]
                pin.follow, pin.follow_bone, pin.follow_group = kept.follow, kept.bone, kept.group
                pin.follow_offset, pin.follow_axis = kept.offset, kept.axis
        _tidy(made)

    def tidy(self) -> None:
        """They follow something else by now: remove the places that nobody follows any more."""
        _tidy(self._kept.values())


class _Kept(NamedTuple):
    """What a pin follows."""

    follow: bpy.types.Object | None
    bone: str
    group: str
    offset: tuple[float, ...]
    axis: tuple[float, ...]

    @classmethod
    def of(cls, pin: bpy.types.PropertyGroup) -> _Kept:
        offset, axis = tuple(pin.follow_offset), tuple(pin.follow_axis)
        return cls(pin.follow, pin.follow_bone, pin.follow_group, offset, axis)


def _tidy(kept: Iterable[_Kept]) -> None:
    for one in kept:
        if one.group and one.follow is not None and one.follow.type == "MESH":
            followed_mesh.remove_unused(one.follow, {one.group})


def _leaders(places: dict[int, Array], under: dict[int, MeshPoint], drawing: CutoutObject) -> dict[int, int]:
    """By which pin's place each goes."""
    on = [key for key, point in under.items() if point.distance <= ON_MESH * drawing.diagonal]
    on = on or [min(under, key=lambda key: under[key].distance)]
    return {
        key: key if key in on else min(on, key=lambda other: float(np.linalg.norm(places[other] - place)))
        for key, place in places.items()
    }
