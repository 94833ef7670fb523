# SPDX-License-Identifier: GPL-3.0-or-later
"""Any object whose shapes over time can be keyed: a cutout with faces, an outline of lines, a lattice."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import bpy

from ...errors import Refusal
from ...model.plane.frame import Array, Array32
from ..sequence import playback, pose_edit
from ..sequence.playback import Steps
from ..storage import points
from . import cutout_object
from .cutout_object import CutoutObject
from .flat_object import make_current
from .lattice_object import LatticeObject, lattice_refusal
from .line_object import LineObject, outline_refusal

AnyObject = CutoutObject | LineObject | LatticeObject


def shape_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why shapes of this object cannot be keyed, and what to do; None if nothing speaks against it.

    Cheap enough for polls; read_shape() finds the rest.
    """
    if obj is None:
        return "No active object: select a flat mesh, a curve or a lattice"
    if obj.type not in points.TYPES:
        return f"'{obj.name}' is neither a mesh, a curve nor a lattice: convert it with Object > Convert"
    if obj.type == "LATTICE":
        return lattice_refusal(obj)
    return outline_refusal(obj) if is_outline(obj) else cutout_object.pose_refusal(obj)


def is_outline(obj: bpy.types.Object) -> bool:
    """Whether an object is made of lines alone, so that it has no pins."""
    return obj.type == "CURVE" or (obj.type == "MESH" and not obj.data.polygons)


def begin_shape(
    context: bpy.types.Context, obj: bpy.types.Object | None = None, *, unkeyed: bool = False
) -> AnyObject:
    """An object's shape at the start of a posing, by default of the active one. Raises Refusal.

    A drag that still is on, as during a script, ends with what it shows.

    `unkeyed`: what the posing writes is shown, and never becomes a keyed pose by itself.
    """
    make_current(context, obj)
    return read_shape(obj or context.object, unkeyed=unkeyed)


def read_shape(obj: bpy.types.Object | None, *, unkeyed: bool = False) -> AnyObject:
    """The object's shape, as it is shown. Raises Refusal; changes nothing."""
    reason = shape_refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    assert obj is not None
    if obj.type == "LATTICE":
        return LatticeObject(obj, unkeyed)
    return LineObject(obj, unkeyed) if is_outline(obj) else cutout_object.made_of(obj, unkeyed=unkeyed)


class Keyable(Protocol):
    """What can be keyed: any of these, and what pins pose."""

    def resolve(self) -> bpy.types.Object:
        """The object. Raises ObjectGone."""

    def coordinates(self, positions: Array) -> Array32:
        """The shape, see storage/points.py, in which the object shows positions. Raises Refusal."""

    def rest_coordinates(self) -> Array32:
        """The shape of the object at rest."""


def key_poses(drawing: Keyable, shapes: Mapping[float, Array], *, throughout: bool = False) -> None:
    """Do all of keying()."""
    playback.run(keying(drawing, shapes, throughout=throughout))


def keying(drawing: Keyable, shapes: Mapping[float, Array], *, throughout: bool = False) -> Steps:
    """Key poses: positions of the drawing by frame, as pose_edit.put_coordinates() does it, step by step.

    `drawing` is used up by this. Yields the share done, see playback.together(); closed before its end,
    everything is as it was.
    Raises Refusal and ObjectGone, with nothing changed.
    """
    obj, coordinates = drawing.resolve(), {}
    for done, (frame, positions) in enumerate(shapes.items(), 1):
        coordinates[frame] = drawing.coordinates(positions)
        yield 0.5 * done / len(shapes)
    rest = drawing.rest_coordinates()
    for share in pose_edit.put_coordinates(obj, coordinates, rest, throughout=throughout):
        yield 0.5 + 0.5 * share
