# SPDX-License-Identifier: GPL-3.0-or-later
"""Lattices as drawings whose shapes are keyed: their points, joined by the cells of the grid."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from ... import native
from ...model.lattice.cells import Counts, axis_across, cells_across, halves, layers_across
from ...model.plane.cutout import diagonal_of
from ...model.plane.frame import Array, Array32, Indices, frame_across, mapped
from ..sequence import pose_state
from ..storage import points, shape_keys
from .flat_object import FlatObject, data_refusal
from .pose_store import store_of


def lattice_refusal(obj: bpy.types.Object) -> str | None:
    """Why shapes of a lattice cannot be keyed, and what to do; None when they can. Cheap enough for polls."""
    reason = data_refusal(obj, "OBJECT")
    if reason is not None:
        return reason
    return pose_state.refusal(obj) if pose_state.has_blocks(obj) else shape_keys.refusal(obj)


def in_space(obj: bpy.types.Object, *, polled: bool = False) -> bool:
    """Whether an object is a lattice whose shapes lie in no plane.

    `polled`: of two layers, which all shapes have to show alike, only the active shape is looked at. Another
    one may be in space all the same.
    """
    if obj.type != "LATTICE":
        return False
    return axis_across(counts_of(obj), [_active_shape(obj)] if polled else _shapes(obj)) is None


def space_refusal(obj: bpy.types.Object, *, polled: bool = False) -> str | None:
    """Why nothing can be solved between shapes of an object, if it is a lattice in space; None if it can.

    `polled`: see in_space().
    """
    if not in_space(obj, polled=polled):
        return None
    return (
        f"'{obj.name}' is a lattice in space, between whose poses Blender blends: key more poses, as with "
        "Breakdown, or use a lattice with one point in one axis"
    )


class LatticeObject(FlatObject):
    """A lattice as points of a plane; what is across that goes from pose to pose in proportion.

    Points of a flat lattice are joined by its cells. Of two equal layers these are the points of the first
    one, and the others follow. Nothing joins the points of a lattice in space.
    """

    rest: Array  # n x 2
    diagonal: float  # of the rest shape's bounding box
    cells: Indices  # m x 4; none in space
    elements: native.Elements  # the cells as triangles; none in space

    def __init__(self, obj: bpy.types.Object, unkeyed: bool):
        super().__init__(obj, store_of(obj, unkeyed))
        axis = axis_across(counts_of(obj), _shapes(obj))
        layers = [np.arange(self.count, dtype=np.int32)]
        self.cells, self.elements = np.empty((0, 4), np.int32), {}
        if axis is not None:
            counts = counts_of(obj)
            layers = layers_across(counts, axis)
            u, v, w = (1 if along == axis else count for along, count in enumerate(counts))
            self.cells = cells_across((u, v, w), axis)
            self.elements = {"triangles": halves(self.cells)}
        self._followers = layers[1:]
        parts = np.zeros(len(layers[0]), np.int32)
        shown = mapped(self._take_points(obj, layers[0], parts), self._linear)
        self._take_frame(frame_across(np.eye(3)[2 if axis is None else axis], self._linear), shown)
        self._rest_shape = points.read_regular(obj)
        self.rest = self.flattened(self._rest_shape)
        self.diagonal = diagonal_of(self.rest)

    def rest_coordinates(self) -> Array32:
        """The regular lattice, a shape as in storage/points.py."""
        return self._rest_shape

    def _placed(self, begin: Array32, start: Array, positions: Array, share: Array) -> Array32:
        shape = super()._placed(begin, start, positions, share)
        for layer in self._followers:
            shape[layer, :3] += shape[self.vertex_indices, :3] - begin[self.vertex_indices, :3]
        return shape


def counts_of(obj: bpy.types.Object) -> Counts:
    """How many points a lattice has along each of its axes."""
    return obj.data.points_u, obj.data.points_v, obj.data.points_w


def _active_shape(obj: bpy.types.Object) -> Array32:
    return points.read(obj) if obj.active_shape_key is None else points.read_block(obj, obj.active_shape_key)


def _shapes(obj: bpy.types.Object) -> Iterator[Array32]:
    """Those that the object has. Read when they are asked for."""
    keys = obj.data.shape_keys
    if keys is None:
        yield points.read(obj)
        return
    for block in keys.key_blocks:
        yield points.read_block(obj, block)
