# SPDX-License-Identifier: GPL-3.0-or-later
"""Where pins are on the rest shape, so that they stay there when the mesh is subdivided, thinned, extended.

A pin is a vertex group, and edits of the mesh give new vertices weights in it. The mesh therefore keeps the
place of each group, and how many vertices, edges and corners it had then: as long as these are the same, the
group says where the pin is; once they are not, the place does, and the group is made to hold it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array, Array32, Indices
from ...model.posing import joints
from ...model.posing.pins import Holder, Pin
from ...model.posing.rebinding import FULL, STILL_THERE, rebound
from ..objects import rest_shape
from ..objects.cutout_object import SAME_PLACE, CutoutObject, pose_refusal, read_cutout
from ..storage.vertex_groups import Members, members
from . import pin_list

ROUNDING = 2.0**-20  # of a place's distance from the origin: it is stored in float32


def follow(obj: bpy.types.Object) -> None:
    """Make pins hold their places where the mesh has become another one, and keep where they are."""
    mesh = obj.data
    counts = len(mesh.vertices), len(mesh.edges), len(mesh.loops)
    edited = len(mesh.planar_seen.places) > 0 and tuple(mesh.planar_seen.counts) != counts
    groups = members(obj, pin_list.groups_of(obj))
    if edited:
        if pose_refusal(obj) is not None:
            return  # the places are kept until they can be held
        try:
            drawing = read_cutout(obj)
        except Refusal:
            return
        if _hold(obj, drawing, groups):
            groups = members(obj, pin_list.groups_of(obj))
    if tuple(mesh.planar_seen.counts) != counts:
        mesh.planar_seen.counts = counts
    rest = rest_shape.basis_or_stored(obj)
    if rest is not None:
        keep(mesh.planar_seen.places, groups, rest, rest_shape.owners_of(mesh))


def _hold(obj: bpy.types.Object, drawing: CutoutObject, groups: Mapping[str, Members]) -> bool:
    """Make the groups of pins that would have moved hold their places; whether there were any."""
    places = {place.name: place for place in obj.data.planar_seen.places}
    changed = False
    for key, pin in enumerate(obj.planar.pins):
        if pin.group not in places or pin.group not in groups:
            continue
        vertices, weights = groups[pin.group]
        rows = drawing.rows_of(vertices)
        inside = (rows >= 0) & (weights > 0.0)
        kept = places[pin.group]
        place = drawing.rest_places(np.array([kept.place]))[0]
        parts = (
            joints.two_parts(rows[inside], weights[inside], drawing.parts) if pin.kind == "HINGE" else None
        )
        if parts is not None:
            changed |= _hold_hinge(drawing, pin, parts, place, (rows[inside], weights[inside]))
            continue
        model = Pin(key, "POINT" if pin.kind == "POINT" else "PATCH", rows[inside], weights[inside])
        whole = pin.owns_group and kept.even
        found = rebound(drawing.cutout, model, place, SAME_PLACE, known=drawing.known, whole=whole)
        if found is not None:
            pin_list.rebind(obj, pin, drawing.vertex_indices[found[0]], found[1])
            model = replace(model, vertices=found[0], weights=found[1])
            changed = True
        if pin.has_target and len(model.vertices):
            _keep_target(drawing, pin, Holder(model, drawing.cutout))
    return changed


def _hold_hinge(
    drawing: CutoutObject, pin: bpy.types.PropertyGroup, parts: tuple[int, int], place: Array, group: Members
) -> bool:
    """Make a hinge hold its place in both parts, where its group does not; whether that was so."""
    cutout, (rows, weights) = drawing.cutout, group
    for part in parts:
        mine = cutout.parts[rows] == part
        holder = Holder(Pin(0, "POINT", rows[mine], weights[mine]), cutout)
        if np.linalg.norm(holder.place(cutout.rest) - place) > SAME_PLACE * cutout.diagonal:
            break
    else:
        return False
    rows, weights = joints.hinge_binding(cutout, parts, place)
    pin_list.rebind(pin.id_data, pin, drawing.vertex_indices[rows], weights)
    return True


def _keep_target(drawing: CutoutObject, pin: bpy.types.PropertyGroup, holder: Holder) -> None:
    """A pin that is where it was left is where it is now left: new vertices bend a face of the shown shape.

    The centre of a patch may have become another one, to which its target belongs.
    """
    place = holder.place(drawing.positions)
    moved = place - drawing.from_local(np.array([pin.reached], np.float64))[0]
    near, far = SAME_PLACE * drawing.cutout.diagonal, STILL_THERE * drawing.cutout.diagonal
    if near < np.linalg.norm(moved) <= far:
        part = np.array([holder.part], np.int32)
        if pin.kind == "PATCH":
            target = drawing.from_local(np.array([pin.target], np.float64))[0] + moved
            pin.target = drawing.to_local(target[None, :], part)[0]
        pin.reached = drawing.to_local(place[None, :], part)[0]


def keep(
    places: bpy.types.bpy_prop_collection,
    groups: Mapping[str, Members],
    rest: Array32,
    owners: Indices | None = None,
) -> None:
    """Keep where the groups are. What has not moved is not written, so that nothing seems to have changed.

    `rest`: positions count x 3. `owners` (count,): 0 for those of new vertices, which are none.
    """
    for name, (vertices, weights) in groups.items():
        rows, shares = vertices[weights > 0.0], weights[weights > 0.0]
        if not len(rows) or (owners is not None and (owners[rows] == 0).any()):
            continue
        place = (shares / shares.sum()) @ rest[rows].astype(np.float64)
        kept = places.get(name)
        if kept is None:
            kept = places.add()
            kept.name = name
        elif np.abs(np.array(kept.place) - place).max() <= ROUNDING * np.abs(place).max():
            continue
        kept.place = place
        kept.even = bool(shares.min() >= shares.max() * FULL)
    for index in reversed(range(len(places))):
        if not len(groups.get(places[index].name, ((),))[0]):
            places.remove(index)
