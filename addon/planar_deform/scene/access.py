# SPDX-License-Identifier: GPL-3.0-or-later
"""From a Blender object to a cutout the model can pose, and back."""

from __future__ import annotations

import bpy
import numpy as np

from ..model import solving
from ..model.cutout import Cutout, diagonal_of, make_cutout, signed_areas
from ..model.frame import Array, Indices, PlaneFrame, mapped, plane_frame
from ..model.locate import MeshPoint, nearest_point
from ..model.rest import completed, copied_along_edges, copied_parts, fitted
from . import rest as rest_store
from . import sequence, shape_keys, stiffness, triangulation
from .errors import ObjectGone, Refusal
from .targets import MeshTarget, target_of

FLATNESS = 1e-3  # of the diagonal: how far a part may leave its plane
EDGE_ON = float(np.sin(np.radians(5.0)))  # views flatter than this to the plane cannot be drawn in
SAME_PLACE = 1e-5  # of the diagonal: distances below are no distance

__all__ = ["ObjectGone", "Refusal", "SceneCutout", "begin", "pose_refusal", "read_cutout"]


def pose_refusal(obj: bpy.types.Object | None, mode: str = "OBJECT") -> str | None:
    """Why this object cannot be posed in a mode, and what to do; None if nothing speaks against it.

    Cheap enough for polls; read_cutout() finds the rest.
    """
    if obj is None:
        return "No active object: select a flat mesh"
    if obj.type != "MESH":
        return f"'{obj.name}' is not a mesh: convert it with Object > Convert > Mesh"
    mesh = obj.data
    if obj.library is not None or mesh.library is not None:
        return f"'{obj.name}' is linked from a library: make it local with Object > Relations > Make Local"
    if obj.override_library is not None or mesh.override_library is not None:
        return f"'{obj.name}' is a library override: make it local with Object > Relations > Make Local"
    if obj.mode != mode:
        return "Posing works in Object Mode: leave the current mode first"
    if mesh.users - mesh.use_fake_user > 1:
        return "The mesh is shared: make it single-user with Object > Relations > Make Single User"
    if not mesh.polygons:
        return f"'{obj.name}' has no faces: a cutout needs some"
    return sequence.refusal(obj) if sequence.has_blocks(obj) else shape_keys.refusal(obj)


def begin(context: bpy.types.Context, *, unkeyed: bool = False) -> SceneCutout:
    """The active object read at the start of an action, its transforms up to date. Raises Refusal.

    A drag that still is on, as during a script, ends with what it shows.

    `unkeyed`: what the action writes is shown, and never becomes a keyed pose by itself.
    """
    solving.interrupt()
    context.view_layer.update()
    return read_cutout(context.object, unkeyed=unkeyed)


def read_cutout(obj: bpy.types.Object | None, *, unkeyed: bool = False, mode: str = "OBJECT") -> SceneCutout:
    """The object's cutout, standing in the shape it shows. Raises Refusal; changes nothing."""
    reason = pose_refusal(obj, mode)
    if reason is not None:
        raise Refusal(reason)
    assert obj is not None
    return SceneCutout(obj, unkeyed)


class SceneCutout:
    """A mesh object as a cutout. Indices are those of the cutout: vertices of faces, in the mesh's order.

    Holds no reference to Blender's data, which dies with every undo: each method finds the object again by
    name and identity, and raises ObjectGone where it or its mesh is another one by now.
    """

    cutout: Cutout
    positions: Array  # n x 2, the shape shown
    frame: PlaneFrame  # of the shape shown, in world-linear space
    vertex_indices: Indices  # n, of each cutout vertex in the mesh
    stiffness_stamp: str  # of the painting that the cutout's stiffness comes from

    def __init__(self, obj: bpy.types.Object, unkeyed: bool):
        mesh = obj.data
        self.object_name, self.session_uid = obj.name, obj.session_uid
        self._mesh_uid, self._count, self._mode = mesh.session_uid, len(mesh.vertices), obj.mode
        self._linear = np.array(obj.matrix_world.to_3x3(), dtype=np.float64)
        self._origin = np.array(obj.matrix_world.translation, dtype=np.float64)
        if not (np.isfinite(self._linear).all() and np.isfinite(self._origin).all()):
            raise Refusal(
                f"The transform of '{obj.name}' is not made of numbers: clear it with Object > Clear"
            )
        stretches = np.linalg.svd(self._linear, compute_uv=False)
        if not stretches[-1] > 1e-6 * stretches[0]:
            raise Refusal(f"'{obj.name}' has a scale of zero: give it a scale in every axis")
        self._inverse = np.linalg.inv(self._linear)

        self._target = target_of(obj, unkeyed)
        shown, share = self._target.shown, self._target.share
        self._in_mesh = isinstance(self._target, MeshTarget)

        stored = rest_store.basis_or_stored(obj)
        owners = None if not self._in_mesh or stored is None else rest_store.owners_of(mesh)
        self._rest_before, self._rest_after, self._rest_written = (stored, owners), None, False
        if stored is None:  # no pin yet, or the shape keys that held it are gone
            stored = self._rest_after = self._target.begin
        faces = triangulation.faces_of(mesh, stored)
        triangles, parts, used = faces.triangles, faces.parts, faces.vertices
        self.vertex_indices = used
        if not np.isfinite(shown[used]).all():
            raise Refusal(f"'{obj.name}' has vertices with coordinates that are not numbers: delete them")
        shape_keys.check_share(obj, share[used])
        self._share = share[used]

        shown = shown[used]
        world = mapped(shown, self._linear)
        self.frame = _flat_frame(shown, world, triangles, parts, self._linear, "Its faces do")
        self.positions = self.frame.flatten(world)
        self._depths = _part_means(self.frame.depth(world), parts)
        rest = self._rest_positions(stored, owners, shown, triangles, parts)
        painted = stiffness.painted(obj)
        self.stiffness_stamp = stiffness.stamp(painted)
        self.cutout = make_cutout(rest, triangles, parts, None if painted is None else painted[used])

    # -- reading

    def to_world(self, points: Array, parts: Indices | None = None) -> Array:
        """World positions k x 3 of k x 2 points of the plane, as deep as their parts (k,), else the first."""
        depths = self._depths[np.zeros(len(points), np.int32) if parts is None else parts]
        return self.frame.lift(points) + np.outer(depths, self.frame.n) + self._origin

    def to_local(self, points: Array, parts: Indices | None = None) -> Array:
        """Object-local positions k x 3 of k x 2 points of the plane."""
        return mapped(self.to_world(points, parts) - self._origin, self._inverse)

    def from_local(self, points: Array) -> Array:
        """Plane coordinates k x 2 of k x 3 object-local points."""
        return self.frame.flatten(mapped(points, self._linear))

    def from_world(self, points: Array) -> Array:
        """Plane coordinates k x 2 of k x 3 world points."""
        return self.frame.flatten(points - self._origin)

    def flattened(self, shape: np.ndarray) -> Array:
        """Plane coordinates n x 2 of any shape of the object, see scene/points.py."""
        return self.from_local(shape[self.vertex_indices, :3].astype(np.float64))

    @property
    def rest(self) -> Array:
        """The rest shape, n x 2."""
        return self.cutout.rest

    @property
    def elements(self) -> dict[str, Indices]:
        """What joins the points, as the native functions take it: {"triangles": m x 3}."""
        return {"triangles": self.cutout.triangles}

    @property
    def parts(self) -> Indices:
        """The connected part (n,) of each point."""
        return self.cutout.parts

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

    def write(self, positions: Array) -> None:
        """Show n x 2 positions: in the mesh, through the posed shape key, or in the pose sequence.

        A vertex that is where it was keeps its bits. Positions of a drag are always told from the start.
        Raises Refusal, with nothing changed, beyond what Blender can store.
        """
        self._store(self._placed(self._target.begin, positions, self._share))

    def coordinates(self, positions: Array) -> np.ndarray:
        """The mesh's coordinates, count x 3 float32 and object-local, in which it shows n x 2 positions.

        Raises Refusal beyond what Blender can store.
        """
        return self._placed(self._target.shown.astype(np.float32), positions, np.ones_like(self._share))

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
        obj = self.resolve()
        self._target.restore(obj)
        obj.data.update()
        if self._rest_written:
            rest_store.put_back(obj.data, *self._rest_before)
            self._rest_written = False

    def _placed(self, begin: np.ndarray, positions: Array, share: Array) -> np.ndarray:
        moved = np.flatnonzero(np.any(positions != self.positions, axis=1))
        offsets = mapped(self.frame.lift(positions[moved] - self.positions[moved]), self._inverse)
        offsets /= share[moved]
        rows = self.vertex_indices[moved]
        coordinates = begin.copy()
        with np.errstate(over="ignore"):
            coordinates[rows] = begin[rows] + offsets  # float64 until it is stored
        if not np.isfinite(coordinates[rows]).all():
            raise Refusal("That is farther than Blender's coordinates reach: move the pins less")
        return coordinates

    def _store(self, coordinates: np.ndarray) -> None:
        obj = self.resolve()
        if self._in_mesh and self._rest_after is not None and not self._rest_written:
            rest_store.write(obj.data, self._rest_after)
            self._rest_written = True
        self._target.store(obj, coordinates)
        obj.data.update()

    def resolve(self) -> bpy.types.Object:
        """The object that was read. Raises ObjectGone if it, its mesh or its mode is another one by now."""
        obj = bpy.data.objects.get(self.object_name)
        if obj is None or obj.session_uid != self.session_uid:
            raise ObjectGone(f"'{self.object_name}' is gone")
        mesh = obj.data
        if (mesh.session_uid, len(mesh.vertices), obj.mode) != (self._mesh_uid, self._count, self._mode):
            raise ObjectGone(f"The mesh of '{self.object_name}' has changed")
        if not self._target.is_there(obj):
            raise ObjectGone(f"The shape keys of '{self.object_name}' have changed")
        return obj

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
            own = _part_means(frame.depth(mapped(shown, self._linear)), parts)
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
    known: np.ndarray | None = None,
) -> PlaneFrame:
    """The frame of points whose parts lie in parallel planes. Raises Refusal where they do not."""
    if known is None:
        known = np.ones(len(points), bool)
    chosen = triangles[known[triangles].all(axis=1)]
    frame = plane_frame(points, chosen, linear)
    if frame is None:
        raise Refusal(f"{subject} not cover any area: give the drawing some, or use Set Rest to Current")
    depths = frame.depth(world)[known]
    low = np.full(int(parts.max()) + 1, np.inf)
    high = -low
    np.minimum.at(low, parts[known], depths)
    np.maximum.at(high, parts[known], depths)
    if np.max(high - low) > FLATNESS * diagonal_of(world[known]):
        raise Refusal(
            f"{subject} not lie in parallel planes: flatten the mesh (scale it to 0 along its normal), "
            "then use Set Rest to Current"
        )
    return frame


def _part_means(values: Array, parts: Indices) -> Array:
    return np.asarray(np.bincount(parts, weights=values) / np.bincount(parts), dtype=np.float64)
