# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole objects carried by a drawing: by Blender's own parenting to three vertices, with which they turn.

They keep their size and shape, and go along in any Blender, in every render and export.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.cutout import Cutout, make_cutout
from ...model.plane.locate import MeshPoint
from ...model.posing import attaching
from ...model.posing.mesh_place import place_binding, spanning
from ..objects import vertex_parents
from ..objects.cutout_object import CutoutObject, pose_refusal, read_cutout
from ..pins import dependencies


@dataclass(frozen=True)
class Hung:
    """An object that is to hang on three vertices of a drawing."""

    obj: bpy.types.Object
    vertices: list[int]


def checked(obj: bpy.types.Object, drawing: CutoutObject) -> Hung:
    """The vertices of a drawing by which it is to carry an object. Raises Refusal; changes nothing."""
    carrier = drawing.resolve()
    if obj.library is not None or obj.override_library is not None:
        raise Refusal(f"'{obj.name}' is linked, and cannot be parented: make it local first")
    reason = dependencies.refusal(obj, carrier, on_mesh=True, whole=True)
    if reason is not None:
        raise Refusal(reason)
    rows, _ = place_binding(drawing.cutout, _place(obj, drawing))
    chosen = rows[list(spanning(drawing.cutout.rest[rows]))]  # of a triangle at least
    return Hung(obj, drawing.vertex_indices[chosen].tolist())


def hang(hung: Hung, carrier: bpy.types.Object) -> None:
    """Parent an object to these vertices; it stays where it is."""
    vertex_parents.hang(hung.obj, carrier, hung.vertices, vertex_parents.above(hung.obj))


def take_down(obj: bpy.types.Object) -> None:
    """Let an object hang on nothing, where it is."""
    place = obj.matrix_world.copy()
    obj.parent = None
    obj.matrix_world = place


def _place(obj: bpy.types.Object, drawing: CutoutObject) -> MeshPoint:
    """Where on a drawing an object hangs: for another drawing where the two lie on each other, as their joint
    would be, else at the point nearest to its origin. Of parts there, on the nearest across the plane.
    """
    place = np.array(obj.matrix_world.translation, np.float64)
    if pose_refusal(obj) is None:
        with contextlib.suppress(Refusal):
            carried = read_cutout(obj)
            shared = attaching.hanging_place(_together(drawing, carried), drawing.parts.max() + 1)
            if shared is not None:
                middle = carried.to_world(carried.positions, carried.parts).mean(axis=0)
                place = middle + drawing.frame.lift(shared - drawing.from_world(middle[None, :]))[0]
    return drawing.under(place, 0.0)


def _together(carrier: CutoutObject, carried: CutoutObject) -> Cutout:
    """Both drawings, as they are shown, in the plane of the first, with its parts before the other's."""
    beside = carrier.from_world(carried.to_world(carried.positions, carried.parts))
    return make_cutout(
        np.concatenate([carrier.positions, beside]),
        np.concatenate([carrier.cutout.triangles, carried.cutout.triangles + len(carrier.positions)]),
        np.concatenate([carrier.parts, carried.parts + carrier.parts.max() + 1]),
    )
