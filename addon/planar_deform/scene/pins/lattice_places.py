# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the pins of lattices are on a mesh that these deform, so that edits of it leave them there.

As in places.py, but the mesh need be neither flat nor known otherwise: its places are those of the mesh
itself, or of its Basis.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import bpy
import numpy as np

from ...model.plane.cutout import Cutout, diagonal_of
from ...model.plane.frame import Array32
from ...model.posing.pins import Pin
from ...model.posing.rebinding import STILL_THERE, rebound
from ..objects import rest_shape
from ..objects.cutout_object import SAME_PLACE
from ..objects.triangulation import faces_of
from ..storage.vertex_groups import Members, members
from . import pin_list, places


def follow(obj: bpy.types.Object, lattices: Iterable[bpy.types.Object]) -> None:
    """After an update of a mesh: pins hold their places where it has become another one."""
    mesh = obj.data
    if mesh.library is not None or mesh.override_library is not None or not len(mesh.polygons):
        return
    pins = [
        (lattice, key)
        for lattice in lattices
        for key, pin in enumerate(lattice.planar.pins)
        if pin_list.pinned_object(pin) == obj
    ]
    seen = mesh.planar_seen
    counts = len(mesh.vertices), len(mesh.edges), len(mesh.loops)
    groups = members(obj, {lattice.planar.pins[key].group for lattice, key in pins})
    shape = rest_shape.reference(obj)
    if len(seen.lattice_places) and tuple(seen.lattice_counts) != counts:
        if not np.isfinite(shape).all():
            return  # the places are kept until they can be held
        if _hold(obj, pins, groups, shape):
            groups = members(obj, {lattice.planar.pins[key].group for lattice, key in pins})
    if tuple(seen.lattice_counts) != counts:
        seen.lattice_counts = counts
    places.keep(seen.lattice_places, groups, shape)


def _hold(
    obj: bpy.types.Object,
    pins: Iterable[tuple[bpy.types.Object, int]],
    groups: Mapping[str, Members],
    shape: Array32,
) -> bool:
    """Make the groups of pins that would have moved hold their places; whether there were any."""
    faces = faces_of(obj.data, shape)
    rest = shape[faces.vertices].astype(np.float64)
    cutout = Cutout(rest, faces.triangles, faces.parts, diagonal_of(rest), flat=False)
    rows_of = np.full(len(shape), -1, np.int32)
    rows_of[faces.vertices] = np.arange(len(faces.vertices), dtype=np.int32)
    kept = {place.name: place for place in obj.data.planar_seen.lattice_places}
    changed = False
    for lattice, key in pins:
        pin = lattice.planar.pins[key]
        if pin.group not in kept or pin.group not in groups:
            continue
        place, (vertices, weights) = kept[pin.group], groups[pin.group]
        inside = (rows_of[vertices] >= 0) & (weights > 0.0)
        model = Pin(key, pin.kind, rows_of[vertices][inside], weights[inside])
        where, whole = np.array(place.place, np.float64), pin.owns_group and place.even
        found = rebound(cutout, model, where, SAME_PLACE, whole=whole, farthest=STILL_THERE)
        if found is not None:
            pin_list.rebind(lattice, pin, faces.vertices[found[0]], found[1])
            changed = True
    return changed
