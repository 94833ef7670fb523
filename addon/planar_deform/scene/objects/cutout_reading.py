# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender has of a cutout, before its transform counts: shape, rest, faces and weights."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import bpy
import numpy as np

from ...model.plane.frame import Array, Array32, Indices
from ...model.plane.rest import coincident_edges, copied_parts
from ..storage.cage import cage_of
from . import rest_shape, stiffness, triangulation
from .pose_store import PoseStore, store_of
from .triangulation import Faces


@dataclass(frozen=True, eq=False)
class RestOnFaces:
    """A rest shape with the faces that lie in it, and what follows from these alone."""

    shape: Array32  # count x 3, object-local
    faces: Faces

    @cached_property
    def coordinates(self) -> Array32:
        """Of the vertices of faces, n x 3."""
        return self.shape[self.faces.vertices]

    @cached_property
    def coincident_edges(self) -> Indices:
        """Edges whose two ends rest in one place, k x 2."""
        return coincident_edges(self.coordinates, self.faces.triangles)

    @cached_property
    def copied_parts(self) -> list[int]:
        """The parts that rest where earlier ones do."""
        return copied_parts(self.coordinates, self.faces.parts)


@dataclass(frozen=True, eq=False)
class CutoutReading:
    """All that a cutout is made of but the object's transform. Holds no reference to Blender's data.

    What is as it was in the reading before is the very same, so that all that follows from it may be kept.
    """

    store: PoseStore
    shown: Array  # count x 3, the shape that the store shows
    stored: Array32 | None  # the rest shape that the mesh holds, count x 3
    owners: Indices | None  # of each vertex's stored rest (count,)
    rest: RestOnFaces  # that one or, where there is none, the shape that would be posed
    painted: Array | None  # the stiffness painted on each vertex (count,)
    cage: int | None  # see storage/cage.py


def read(
    obj: bpy.types.Object, *, unkeyed: bool = False, before: CutoutReading | None = None
) -> CutoutReading:
    """Read a mesh that can be posed. Raises Refusal; changes nothing."""
    mesh = obj.data
    store = store_of(obj, unkeyed)
    stored = rest_shape.basis_or_stored(obj)
    owners = None if stored is None or mesh.shape_keys is not None else rest_shape.owners_of(mesh)
    shape = store.begin if stored is None else stored
    rest = RestOnFaces(shape, triangulation.faces_of(mesh, shape))
    painted = stiffness.painted(obj)
    shown = store.shown
    if before is not None:
        if np.array_equal(shown, before.shown):
            shown = before.shown
        if rest.faces is before.rest.faces and np.array_equal(shape, before.rest.shape):
            rest = before.rest
        if painted is not None and before.painted is not None and np.array_equal(painted, before.painted):
            painted = before.painted
    return CutoutReading(store, shown, stored, owners, rest, painted, cage_of(obj))
