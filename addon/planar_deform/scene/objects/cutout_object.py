# SPDX-License-Identifier: GPL-3.0-or-later
"""From a Blender object to a cutout the model can pose, and back."""

from __future__ import annotations

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.plane.cutout import Cutout, diagonal_of, make_cutout, signed_areas
from ...model.plane.frame import Array, Indices, Mask, PlaneFrame, mapped, plane_frame
from ...model.plane.locate import MeshPoint, nearest_point
from ...model.plane.rest import completed, copied_along_edges, copied_parts, fitted
from ..sequence import pose_state
from ..storage import shape_keys
from . import rest_shape, stiffness, triangulation
from .flat_object import FlatObject, data_refusal, is_flat, part_means, settle
from .pose_store import OwnTarget

EDGE_ON = float(np.sin(np.radians(5.0)))  # views flatter than this to the plane cannot be drawn in
SAME_PLACE = 1e-5  # of the diagonal: distances below are no distance


def pose_refusal(obj: bpy.types.Object | None, mode: str = "OBJECT") -> str | None:
    """Why this object cannot be posed in a mode, and what to do; None if nothing speaks against it.

    Cheap enough for polls; read_cutout() finds the rest.
    """
    if obj is None:
        return "No active object: select a flat mesh"
    if obj.type == "CURVE":
        return (
            f"'{obj.name}' is a curve, and pins need faces: pose it in Edit Mode and use Key Pose, or make "
            "it a mesh with Object > Convert > Mesh"
        )
    if obj.type != "MESH":
        return f"'{obj.name}' is not a mesh: convert it with Object > Convert > Mesh"
    reason = data_refusal(obj, mode)
    if reason is not None:
        return reason
    if not obj.data.polygons:
        return f"'{obj.name}' has no faces, which pins need: pose it in Edit Mode and use Key Pose"
    return pose_state.refusal(obj) if pose_state.has_blocks(obj) else shape_keys.refusal(obj)


def begin(context: bpy.types.Context, *, unkeyed: bool = False) -> SceneCutout:
    """The active object read at the start of an action, its transforms up to date. Raises Refusal.

    A drag that still is on, as during a script, ends with what it shows.

    `unkeyed`: what the action writes is shown, and never becomes a keyed pose by itself.
    """
    settle(context)
    return read_cutout(context.object, unkeyed=unkeyed)


def read_cutout(obj: bpy.types.Object | None, *, unkeyed: bool = False, mode: str = "OBJECT") -> SceneCutout:
    """The object's cutout, standing in the shape it shows. Raises Refusal; changes nothing."""
    reason = pose_refusal(obj, mode)
    if reason is not None:
        raise Refusal(reason)
    assert obj is not None
    return SceneCutout(obj, unkeyed)


class SceneCutout(FlatObject):
    """A mesh object as a cutout. Indices are those of the cutout: vertices of faces, in the mesh's order."""

    cutout: Cutout
    stiffness_stamp: str  # of the painting that the cutout's stiffness comes from

    def __init__(self, obj: bpy.types.Object, unkeyed: bool):
        super().__init__(obj, unkeyed)
        mesh = obj.data
        self._in_mesh = isinstance(self._target, OwnTarget)

        stored = rest_shape.basis_or_stored(obj)
        owners = None if not self._in_mesh or stored is None else rest_shape.owners_of(mesh)
        self._rest_before, self._rest_after, self._rest_written = (stored, owners), None, False
        if stored is None:  # no pin yet, or the shape keys that held it are gone
            stored = self._rest_after = self._target.begin
        faces = triangulation.faces_of(mesh, stored)
        triangles, parts = faces.triangles, faces.parts
        shown = self._take_points(obj, faces.vertices, parts)
        world = mapped(shown, self._linear)
        self._take_frame(_flat_frame(shown, world, triangles, parts, self._linear, "Its faces do"), world)
        rest = self._rest_positions(stored, owners, shown, triangles, parts)
        painted = stiffness.painted(obj)
        self.stiffness_stamp = stiffness.stamp(painted)
        painted = None if painted is None else painted[self.vertex_indices]
        self.cutout = make_cutout(rest, triangles, parts, painted)

    # -- reading

    @property
    def rest(self) -> Array:
        """The rest shape, n x 2."""
        return self.cutout.rest

    @property
    def elements(self) -> native.Elements:
        """What joins the points: triangles."""
        return {"triangles": self.cutout.triangles}

    @property
    def diagonal(self) -> float:
        """Of the rest shape's bounding box."""
        return self.cutout.diagonal

    def plane_from_ray(self, origin: Array, direction: Array, part: int = 0) -> Array | None:
        """Where a world ray meets the plane of a part (2,); None edge-on (within 5 degrees) or behind it."""
        slope = float(direction @ self.frame.n)
        if abs(slope) < EDGE_ON * float(np.linalg.norm(direction)):
            return None
        distance = (self._depths[part] - float((origin - self._origin) @ self.frame.n)) / slope
        if distance < 0.0:
            return None
        return self.from_world((origin + distance * direction)[None, :])[0]

    def pick(self, origin: Array, direction: Array) -> MeshPoint | None:
        """The point of the shown mesh that a world ray meets first; None where it misses or is edge-on."""
        slope = float(direction @ self.frame.n)
        part_of = self.cutout.parts[self.cutout.triangles[:, 0]]
        for part in np.argsort((self._depths - float((origin - self._origin) @ self.frame.n)) * slope):
            place = self.plane_from_ray(origin, direction, int(part))
            if place is None:
                continue
            among = np.flatnonzero(part_of == part).astype(np.int32)
            found = nearest_point(self.positions, self.cutout.triangles, place, among)
            if found is not None and found.distance == 0.0:
                return found
        return None

    def nearest(self, place: Array, within: float) -> MeshPoint | None:
        """The point of the shown mesh nearest to a world position (3,) in its plane; None beyond `within`.

        Of several parts that are that near, the one whose depth is nearest to the position's.
        """
        flat = self.from_world(place[None, :])[0]
        depths = np.abs(self._depths - float((place - self._origin) @ self.frame.n))
        part_of = self.cutout.parts[self.cutout.triangles[:, 0]]
        for part in np.argsort(depths):
            among = np.flatnonzero(part_of == part).astype(np.int32)
            found = nearest_point(self.positions, self.cutout.triangles, flat, among)
            if found is not None and found.distance <= within:
                return found
        return None

    # -- writing

    def rest_coordinates(self) -> np.ndarray:
        """The mesh's coordinates, count x 3 float32 and object-local, at rest."""
        rest = self._rest_before[0] if self._rest_after is None else self._rest_after
        assert rest is not None
        return rest

    def write_rest(self) -> None:
        """Take the pose away, to the bit: what is posed, or the posed key's difference, goes back to rest."""
        rest = self._target.rest(self.resolve(), self.rest_coordinates())
        if rest is not None:
            coordinates = self._target.begin.copy()
            coordinates[self.vertex_indices] = rest[self.vertex_indices]
            self._store(coordinates)

    def restore(self) -> None:
        """Put everything back as it was when this was read, to the bit."""
        super().restore()
        if self._rest_written:
            rest_shape.put_back(self.resolve().data, *self._rest_before)
            self._rest_written = False

    def _store(self, shape: np.ndarray) -> None:
        if self._in_mesh and self._rest_after is not None and not self._rest_written:
            rest_shape.write(self.resolve().data, self._rest_after)
            self._rest_written = True
        super()._store(shape)

    # -- rest

    def _rest_positions(
        self, stored: np.ndarray, owners: np.ndarray | None, shown: Array, triangles: Indices, parts: Indices
    ) -> Array:
        """The rest shape n x 2; completed where edits left vertices without one, and kept for writing."""
        used = self.vertex_indices
        rest32 = stored[used]
        rest = rest32.astype(np.float64)
        known = np.isfinite(rest).all(axis=1)
        known &= ~copied_along_edges(rest32, shown, triangles, SAME_PLACE * diagonal_of(shown))
        if owners is not None:
            self._take_in_parts(rest, owners[used], shown, parts, known)
        changed = not known.all() or not np.array_equal(rest, rest32)
        if not known.any():
            rest, known = shown.copy(), np.ones(len(used), bool)
        world = mapped(rest, self._linear)
        frame = _flat_frame(rest, world, triangles, parts, self._linear, "Its rest shape does", known)
        flat = frame.flatten(world)
        # Rest and pose are seen from the same side, however the mesh has been turned over in between.
        whole = known[triangles].all(axis=1)
        shown_sides = np.sign(signed_areas(self.positions, triangles[whole]))
        if (signed_areas(flat, triangles[whole]) * shown_sides).sum() < 0.0:
            frame = frame.mirrored()
            flat = frame.flatten(world)
        if not known.all():
            depths = frame.depth(world)
            flat = completed(np.where(known[:, None], flat, 0.0), self.positions, triangles, known)
            counts = np.bincount(parts, weights=known)
            sums = np.bincount(parts[known], weights=depths[known], minlength=len(counts))
            own = part_means(frame.depth(mapped(shown, self._linear)), parts)
            depth = np.where(counts > 0, sums / np.maximum(counts, 1), own)[parts]
            placed = mapped(frame.lift(flat) + np.outer(depth, frame.n), self._inverse)
            rest[~known] = placed[~known]
        if changed and self._in_mesh:
            self._rest_after = stored.copy()
            self._rest_after[used] = rest
        return flat

    def _take_in_parts(
        self, rest: Array, owners: np.ndarray, shown: Array, parts: Indices, known: np.ndarray
    ) -> None:
        """Bring the rest of joined and duplicated parts to where they are; what has no owner is not known."""
        known &= owners != 0
        # New and joined vertices come last, so the first one is the mesh's own, even if it has no rest yet.
        foreign = np.unique(parts[(owners != owners[0]) & known])
        copies = copied_parts(rest, parts)
        for part in {*foreign.tolist(), *copies}:
            rows = np.flatnonzero((parts == part) & known)
            if len(rows) >= 3:
                rest[rows] = fitted(rest[rows], shown[rows], scaled=part in foreign)
            else:
                known[rows] = False


def _flat_frame(
    points: Array,
    world: Array,
    triangles: Indices,
    parts: Indices,
    linear: Array,
    subject: str,
    known: Mask | None = None,
) -> PlaneFrame:
    """The frame of points whose parts lie in parallel planes. Raises Refusal where they do not."""
    if known is None:
        known = np.ones(len(points), bool)
    chosen = triangles[known[triangles].all(axis=1)]
    frame = plane_frame(points, chosen, linear)
    if frame is None:
        raise Refusal(f"{subject} not cover any area: give the drawing some, or use Set Rest to Current")
    if not is_flat(frame, world, parts, known):
        raise Refusal(
            f"{subject} not lie in parallel planes: flatten the mesh (scale it to 0 along its normal), "
            "then use Set Rest to Current"
        )
    return frame
