# SPDX-License-Identifier: GPL-3.0-or-later
"""From a lattice and the meshes that it deforms to what the model can pose with pins, and back."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.lattice.lattice_poser import LatticePoser, LatticeShape, posed_cutout
from ...model.plane.cutout import Cutout
from ...model.plane.frame import Array, Array32, Indices, frame_across, mapped
from ...model.plane.locate import MeshPoint
from ...model.plane.space import first_met, nearest_in_space
from ...model.posing import solver_cache
from ...model.posing.pins import Holder
from ...model.work import Progress
from ..objects.cutout_object import EDGE_ON
from ..objects.flat_object import FlatObject
from ..objects.pose_store import store_of
from ..storage import points, shape_keys
from .rig import LatticeRig


class PosedLattice(FlatObject):
    """A lattice with all that it deforms, in one frame: positions are (n + N) x 3, along u, v and the normal.

    The first n are vertices of the meshes, as far as faces join them, the others the lattice's points. A flat
    lattice moves in its plane, every vertex at its own depth; any other one in planes that are seen from
    `facing`, a direction in the world.
    """

    cutout: Cutout
    stiffness_stamp = ""  # there is none

    def __init__(
        self, obj: bpy.types.Object, rig: LatticeRig, *, unkeyed: bool, facing: Sequence[float] | None
    ):
        super().__init__(obj, store_of(obj, unkeyed))
        self._share = self._store.share
        shape_keys.check_share(obj, self._share)
        self._rig = rig
        self.flat = rig.flat_axis is not None
        self.frame = frame_across(_normal(rig, self._linear, facing), self._linear)
        self._axes = np.stack([self.frame.u, self.frame.v, self.frame.n])
        self._shape = LatticeShape(
            rig.rest - self._origin, rig.triangles, rig.weights, rig.points_at_rest - self._origin
        )
        self._count = len(rig.rest)
        rest = np.concatenate([self._shape.rest, self._shape.points])
        self.positions = self._positions(self._store.shown)
        count = len(self._shape.points)
        self.cutout = posed_cutout(self._in_frame(rest), rig.triangles, rig.connected, count, flat=self.flat)

    # -- reading

    @property
    def meshes(self) -> list[bpy.types.Object]:
        """The objects whose vertices pins can hold."""
        return self._rig.meshes

    @property
    def faces(self) -> Indices:
        """The meshes' triangles, m x 3."""
        return self._shape.triangles

    def poser(
        self, _method: native.Method, positions: Array, *, progress: Progress | None = None
    ) -> LatticePoser:
        """A solver that stands at these positions. May be called in another thread."""
        shape, axes, flat = self._shape, self._axes, self.flat
        recipe = (*shape.recipe, *(axes[:2] if flat else ()))
        solver = solver_cache.kept(
            self.session_uid, recipe, lambda: LatticePoser.solver(shape, axes, flat=flat)
        )
        poser = LatticePoser(solver, shape, axes, flat=flat)
        poser.reset(positions)
        return poser

    def rows_held(self, pinned: bpy.types.Object | None, numbers: Indices) -> Indices:
        """The rows of vertices of an object, or of the lattice's points (None); -1 for what has none."""
        if pinned is None:
            rows = np.full(max(self.count, int(numbers.max(initial=-1)) + 1), -1, np.int32)
            for layer in self._rig.grid.layers:
                rows[layer] = np.arange(len(layer), dtype=np.int32) + self._count
            found: Indices = rows[numbers]
            return found
        return self._rig.rows_of(pinned, numbers)

    def vertices_held(self, rows: Indices) -> tuple[bpy.types.Object, Indices]:
        """Whose vertices rows are, and which."""
        return self._rig.vertices_of(rows)

    def to_world(self, places: Array, parts: Indices | None = None) -> Array:
        """World positions k x 3 of places in the frame."""
        return mapped(places, np.ascontiguousarray(self._axes.T)) + self._origin

    def from_local(self, places: Array) -> Array:
        """Places in the frame of positions in the lattice's own space, k x 3."""
        return self._in_frame(mapped(places, self._linear))

    def from_world(self, places: Array) -> Array:
        """Places in the frame of world positions, k x 3."""
        return self._in_frame(places - self._origin)

    def flattened(self, shape: Array32) -> Array:
        """Positions in any shape of the lattice, see storage/points.py."""
        return self._positions(shape.astype(np.float64))

    def coordinates(self, positions: Array) -> Array32:
        """The shape, see storage/points.py, in which the lattice shows positions.

        Raises Refusal beyond what Blender can store.
        """
        return self._placed(
            self._store.shown.astype(np.float32), self.positions, positions, np.ones_like(self._share)
        )

    def rest_coordinates(self) -> Array32:
        """The regular lattice, a shape as in storage/points.py."""
        return points.read_regular(self.resolve())

    def plane_from_ray(self, origin: Array, direction: Array, pin: Holder | None = None) -> Array | None:
        """Where a world ray meets the plane in which a pin is moved (2,); None edge-on or behind it."""
        start, towards = self.from_world(origin[None, :])[0], self._in_frame(direction[None, :])[0]
        if abs(towards[2]) < EDGE_ON * float(np.linalg.norm(towards)):
            return None
        depth = 0.0 if pin is None else pin.place(self.positions)[2]
        distance = (depth - start[2]) / towards[2]
        return None if distance < 0.0 else (start + distance * towards)[:2]

    def pick(self, origin: Array, direction: Array) -> MeshPoint | None:
        """The point of a mesh, as it is shown, that a world ray meets first; None where it misses."""
        start, towards = self.from_world(origin[None, :])[0], self._in_frame(direction[None, :])[0]
        return first_met(self.positions, self.faces, start, towards)

    def nearest(self, place: Array, within: float) -> MeshPoint | None:
        """The point of a mesh, as it is shown, nearest to a world position (3,); None beyond `within`."""
        every = np.arange(len(self.faces), dtype=np.int32)
        found = nearest_in_space(self.positions, self.faces, self.from_world(place[None, :])[0], every)
        return found if found is not None and found.distance <= within else None

    @property
    def lattice_points(self) -> tuple[Indices, Array]:
        """Numbers of the lattice's points, of the first one of two equal layers, and where they are."""
        return self._rig.grid.layers[0], self.to_world(self.positions[self._count :])

    # -- writing

    def write(self, positions: Array) -> None:
        """Show positions, by the lattice's points; one that is where it was keeps its bits.

        Raises Refusal, with nothing changed, beyond what Blender can store.
        """
        self._put(self._placed(self._store.begin, self.positions, positions, self._share))

    def write_rest(self) -> None:
        """Take the pose away, to the bit: the lattice is as regular as it was made."""
        rest = self._store.rest(self.resolve(), self.rest_coordinates())
        if rest is not None:
            self._put(rest)

    def _placed(self, begin: Array32, start: Array, positions: Array, share: Array) -> Array32:
        before, after = (rows[self._count :] for rows in (start, positions))
        moved = np.flatnonzero(np.any(before != after, axis=1))
        offsets = mapped(
            mapped(after[moved] - before[moved], np.ascontiguousarray(self._axes.T)), self._inverse
        )
        if self._rig.flat_axis is not None:
            offsets[:, self._rig.flat_axis] = 0.0  # but for rounding it is
        shape = begin.copy()
        for layer in self._rig.grid.layers:
            rows = layer[moved]
            with np.errstate(over="ignore"):
                shape[rows, :3] = shape[rows, :3] + offsets / share[rows]  # float64 until it is stored
        if not np.isfinite(shape).all():
            raise Refusal("That is farther than Blender's coordinates reach: move the pins less")
        return shape

    def _positions(self, shape: Array) -> Array:
        """Those of the meshes' vertices and the lattice's points in a shape of the lattice."""
        shown = mapped(shape[self._rig.grid.layers[0], :3], self._linear) + self._origin
        return self._in_frame(np.concatenate([self._rig.shown(shown), shown]) - self._origin)

    def _in_frame(self, places: Array) -> Array:
        """World-linear positions along u, v and the normal."""
        return mapped(places, self._axes)


def _normal(rig: LatticeRig, linear: Array, facing: Sequence[float] | None) -> Array:
    """Object-local, of the planes in which pins are moved."""
    if rig.flat_axis is not None:
        normal = np.eye(3)[rig.flat_axis]
    elif facing is None or not np.any(facing):
        normal = np.array([0.0, 0.0, 1.0])
    else:
        normal = linear.T @ np.array(facing, np.float64)
    unit: Array = normal / np.linalg.norm(normal)
    return unit
