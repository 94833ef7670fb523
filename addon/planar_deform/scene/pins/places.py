# SPDX-License-Identifier: GPL-3.0-or-later
"""Where pins are on the rest shape, so that they stay there when the mesh is subdivided, decimated or extended.

A pin is a vertex group, and edits of the mesh give new vertices weights in it. The mesh therefore keeps the
place of each group, and how many vertices, edges and corners it had then: as long as these are the same, the
group says where the pin is; once they are not, the place does, and the group is made to hold it.
"""

from __future__ import annotations

from collections.abc import Mapping

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array
from ...model.plane.locate import at
from ...model.posing.pins import Holder, Pin
from ...model.posing.rebinding import Binding, patch_binding, point_binding
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
    _keep(obj, groups)


def _hold(obj: bpy.types.Object, drawing: CutoutObject, groups: Mapping[str, Members]) -> bool:
    """Make the groups of pins that would have moved hold their places; whether there were any."""
    places = {place.name: np.array(place.place) for place in obj.data.planar_seen.places}
    changed = False
    for key, pin in enumerate(obj.planar.pins):
        if pin.group not in places or pin.group not in groups:
            continue
        vertices, weights = groups[pin.group]
        rows = drawing.rows_of(vertices)
        inside = (rows >= 0) & (weights > 0.0)
        model = Pin(key, pin.kind, rows[inside], weights[inside])
        place = drawing.rest_place(places[pin.group])
        found = _binding(drawing, model, place, pin.owns_group)
        if found is not None:
            pin_list.rebind(obj, pin, drawing.vertex_indices[found[0]], found[1])
            changed = True
    return changed


def _binding(drawing: CutoutObject, pin: Pin, place: Array, owned: bool) -> Binding | None:
    """What holds the place of a pin; None where its group does, or nothing can."""
    cutout, rows = drawing.cutout, pin.vertices
    near = SAME_PLACE * cutout.diagonal
    if pin.kind == "PATCH" and len(rows):
        partial = (pin.weights < pin.weights.max() * (1.0 - 1e-3)).any()
        here = Holder(pin, cutout).place(cutout.rest)
        moved = np.linalg.norm(here - place) > near
        return patch_binding(cutout, place, pin) if owned and (partial or moved) else None
    found = point_binding(cutout, place, rows)
    if found is None:
        return None
    point, binding = found
    if pin.kind == "PATCH":  # all of it is gone: what is there now
        return binding[0], np.ones(len(binding[0]))
    if len(rows):
        here = Holder(pin, cutout).place(cutout.rest)
        if np.linalg.norm(here - at(cutout.rest, cutout.triangles, point)) <= near:
            return None
    return binding


def _keep(obj: bpy.types.Object, groups: Mapping[str, Members]) -> None:
    """Keep where the groups are. What has not moved is not written, so that nothing seems to have changed."""
    rest = rest_shape.basis_or_stored(obj)
    if rest is None:
        return
    owners = rest_shape.owners_of(obj.data)
    places = obj.data.planar_seen.places
    for name, (vertices, weights) in groups.items():
        rows, shares = vertices[weights > 0.0], weights[weights > 0.0]
        if not len(rows) or (owners is not None and (owners[rows] == 0).any()):
            continue  # new vertices have no rest as yet
        place = (shares / shares.sum()) @ rest[rows].astype(np.float64)
        kept = places.get(name)
        if kept is None:
            kept = places.add()
            kept.name = name
        elif np.abs(np.array(kept.place) - place).max() <= ROUNDING * np.abs(place).max():
            continue
        kept.place = place
    for index in reversed(range(len(places))):
        if not len(groups.get(places[index].name, ((),))[0]):
            places.remove(index)
