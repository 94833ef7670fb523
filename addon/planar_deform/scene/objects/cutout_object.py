# SPDX-License-Identifier: GPL-3.0-or-later
"""From a Blender object to a cutout the model can pose, and back."""

from __future__ import annotations

from collections import OrderedDict
from copy import copy
from dataclasses import dataclass
from functools import cached_property

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.latest import make_room
from ...model.plane.cutout import Cutout, diagonal_of, make_cutout, signed_areas
from ...model.plane.frame import (
    Array,
    Array32,
    Indices,
    Mask,
    PlaneFrame,
    mapped,
    part_means,
)
from ...model.plane.locate import MeshPoint, nearest_point
from ...model.plane.rest import completed, copied_along_edges, fitted
from ...model.posing import solver_cache
from ...model.posing.joints import Ties
from ...model.posing.pins import Holder
from ...model.work import Progress
from ..sequence import pose_state
from ..storage import shape_keys
from . import rest_shape, stiffness
from .cutout_reading import CutoutReading, RestOnFaces, read
from .flat_frame import flat_frame, not_flat, plane_of
from .flat_object import (
    FLATNESS,
    FlatObject,
    data_refusal,
    linear_of,
    make_current,
    origin_of,
    unevenness,
)
from .pose_store import OwnStore
from .relief import Relief, level, relief

EDGE_ON = float(np.sin(np.radians(5.0)))  # views flatter than this to the plane cannot be drawn in
SAME_PLACE = 1e-5  # of the diagonal: distances below are no distance
MOST_SIDES = 10_000  # triangles that tell, spread over a dense drawing, whether it has been turned over
UNEVEN = 0.05  # of the diagonal: beyond this no depths explain how far points are from a plane
ROOM = 1_600_000  # vertices together; what is kept of 100k takes some 30 MB


_latest: OrderedDict[int, CutoutObject] = OrderedDict()  # by session_uid, what was read last at the end


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
    if obj.type == "LATTICE":
        return f"'{obj.name}' is a lattice: select one of the meshes that it deforms"
    if obj.type not in {"MESH", "FONT", "SURFACE", "META"}:
        return f"'{obj.name}' has no faces to pin: select a flat mesh"
    if obj.type != "MESH":
        return f"'{obj.name}' is not a mesh: convert it with Object > Convert > Mesh"
    reason = data_refusal(obj, mode)
    if reason is not None:
        return reason
    if not obj.data.polygons:
        return f"'{obj.name}' has no faces, which pins need: pose it in Edit Mode and use Key Pose"
    return pose_state.refusal(obj) if pose_state.has_blocks(obj) else shape_keys.refusal(obj)


def begin(context: bpy.types.Context, *, unkeyed: bool = False) -> CutoutObject:
    """The active object read at the start of a posing, its transforms up to date. Raises Refusal.

    A drag that still is on, as during a script, ends with what it shows.

    `unkeyed`: what the posing writes is shown, and never becomes a keyed pose by itself.
    """
    make_current(context)
    return read_cutout(context.object, unkeyed=unkeyed)


def read_cutout(obj: bpy.types.Object | None, *, unkeyed: bool = False, mode: str = "OBJECT") -> CutoutObject:
    """The object's cutout, standing in the shape it shows. Raises Refusal; changes nothing."""
    reason = pose_refusal(obj, mode)
    if reason is not None:
        raise Refusal(reason)
    assert obj is not None
    return made_of(obj, unkeyed=unkeyed)


def made_of(obj: bpy.types.Object, *, unkeyed: bool = False) -> CutoutObject:
    """The cutout of a mesh that nothing speaks against. Raises Refusal; changes nothing.

    What follows from what is still as it was when the mesh was last read, to the bit, is not made again.
    """
    before = _latest.pop(obj.session_uid, None)
    reading = read(obj, unkeyed=unkeyed, before=None if before is None else before.reading)
    drawing = _latest[obj.session_uid] = CutoutObject(obj, reading, before)
    make_room(_latest, ROOM, lambda kept: kept.count)
    return drawing


def forget() -> None:
    """Keep none."""
    _latest.clear()


@dataclass(frozen=True, eq=False)
class _FlatRest:
    """The rest shape of a cutout in its plane, as far as it is known."""

    stored: RestOnFaces | None  # what it is; None where edits of the mesh have a say in it
    world: Array  # n x 3 in world-linear space
    frame: PlaneFrame
    flat: Array  # n x 2
    sides: Indices  # triangles whose corners are all known, MOST_SIDES of them at most
    areas: Array  # of these


class CutoutObject(FlatObject):
    """A mesh object as a cutout. Indices are those of the cutout: vertices of faces, in the mesh's order."""

    cutout: Cutout
    reading: CutoutReading
    known: Mask  # n, vertices that have a rest of their own; others were added by an edit
    stiffness_stamp: str  # of the painting that the cutout's stiffness comes from
    _turned_over: bool
    _distortion: native.Distortion | None = None  # of the shape shown, once it has been asked for

    def __init__(
        self, obj: bpy.types.Object, reading: CutoutReading, before: CutoutObject | None = None
    ) -> None:
        """Of what has been read of an object. `before`: made of it earlier; what still holds is kept."""
        super().__init__(obj, reading.store)
        if before is not None and not np.array_equal(before._linear, self._linear):
            before = None
        self._in_mesh = isinstance(self._store, OwnStore)
        self.reading, self._rest_written = reading, False
        # Stored with the first pose where there is no pin yet, or the shape keys that held it are gone.
        self._rest_after = reading.rest.shape if reading.stored is None else None
        faces = reading.rest.faces
        triangles, parts = faces.triangles, faces.parts
        shown = self._take_points(obj, faces.vertices, parts)
        stays = before is not None and self._shows_as(before)
        if before is not None and stays:
            self.frame, self.positions, self._heights = before.frame, before.positions, before._heights
        else:
            stays, world = False, mapped(shown, self._linear)
            plane = plane_of(shown, world, triangles, parts, self._linear, "Its faces do", UNEVEN)
        rest, known = self._known_rest(shown)
        self.known = known.copy()
        self._rest = self._flat_rest(rest, known, shown, before)
        if not stays:
            self._take_frame(self._frame_shown(plane, world), world)
        # Rest and pose are seen from the same side, however the mesh has been turned over in between.
        if before is not None and stays and self._rest is before._rest:
            self._turned_over = before._turned_over
        else:
            shown_sides = np.sign(signed_areas(self.positions, self._rest.sides))
            self._turned_over = bool((self._rest.areas * shown_sides).sum() < 0.0)
        if before is not None and self._has_cutout_of(before):
            self.cutout, self.stiffness_stamp = before.cutout, before.stiffness_stamp
            self._distortion = before._distortion if stays else None
            return
        positions = self._rest_positions(rest, known, shown)
        self.stiffness_stamp = stiffness.stamp(reading.painted)
        painted = None if reading.painted is None else reading.painted[self.vertex_indices]
        self.cutout = make_cutout(positions, triangles, parts, painted, reading.cage)

    def carried(self, obj: bpy.types.Object) -> CutoutObject:
        """The same cutout where its object, whose mesh is what it was, is by now. Raises Refusal."""
        origin = origin_of(obj)
        if not np.array_equal(self._linear, linear_of(obj)) or not np.isfinite(origin).all():
            return CutoutObject(obj, self.reading, self)
        carried = copy(self)
        carried.object_name, carried._origin = obj.name, origin
        return carried

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

    @cached_property
    def depths(self) -> Array:
        """How far each point (n,) is in front of its place at rest; below 0: behind it."""
        return self._depths_of(self._store.shown)

    def depths_of(self, shape: Array32) -> Array:
        """The same of any shape of the object, see storage/points.py."""
        return self._depths_of(shape.astype(np.float64))

    @property
    def distortion(self) -> native.Distortion:
        """Of the shape shown."""
        if self._distortion is None:
            self._distortion = native.distortion(self.rest, self.positions, self.faces)
        return self._distortion

    def rest_places(self, places: Array | Array32) -> Array:
        """Where object-local positions (k x 3) of the rest shape are in `rest` (k x 2)."""
        frame = self._rest.frame.mirrored() if self._turned_over else self._rest.frame
        return frame.flatten(mapped(places.astype(np.float64), self._linear))

    def rows_held(self, _pinned: bpy.types.Object | None, numbers: Indices) -> Indices:
        """As rows_of(): the vertices that pins hold are the object's own."""
        return self.rows_of(numbers)

    def vertices_held(self, rows: Indices) -> tuple[bpy.types.Object, Indices]:
        """Whose vertices rows are, and which."""
        return self.resolve(), self.vertex_indices[rows]

    @property
    def meshes(self) -> list[bpy.types.Object]:
        """The objects whose vertices pins can hold."""
        return [self.resolve()]

    @property
    def faces(self) -> Indices:
        """The triangles, m x 3."""
        return self.cutout.triangles

    def poser(
        self,
        method: native.Method,
        positions: Array,
        ties: Ties | None = None,
        *,
        progress: Progress | None = None,
    ) -> native.Poser:
        """A solver that stands at these positions, with joints if any. May be called in another thread."""
        return solver_cache.poser_for(
            self.session_uid, self.cutout, method, positions, ties, progress=progress
        )

    def plane_from_ray(self, origin: Array, direction: Array, pin: Holder | None = None) -> Array | None:
        """Where a world ray meets the plane in which a pin is moved, or the first part's (2,).

        None edge-on (within 5 degrees), and where that is behind it.
        """
        return self._part_from_ray(origin, direction, 0 if pin is None else pin.part)

    def _part_from_ray(self, origin: Array, direction: Array, part: int) -> Array | None:
        slope = float(direction @ self.frame.n)
        if abs(slope) < EDGE_ON * float(np.linalg.norm(direction)):
            return None
        distance = (self._heights[part] - float((origin - self._origin) @ self.frame.n)) / slope
        if distance < 0.0:
            return None
        place: Array = self.from_world((origin + distance * direction)[None, :])[0]
        return place

    def pick(self, origin: Array, direction: Array) -> MeshPoint | None:
        """The point of the shown mesh that a world ray meets first; None where it misses or is edge-on."""
        slope = float(direction @ self.frame.n)
        part_of = self.cutout.parts[self.cutout.triangles[:, 0]]
        for part in np.argsort((self._heights - float((origin - self._origin) @ self.frame.n)) * slope):
            place = self._part_from_ray(origin, direction, int(part))
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
        depths = np.abs(self._heights - float((place - self._origin) @ self.frame.n))
        part_of = self.cutout.parts[self.cutout.triangles[:, 0]]
        for part in np.argsort(depths):
            among = np.flatnonzero(part_of == part).astype(np.int32)
            found = nearest_point(self.positions, self.cutout.triangles, flat, among)
            if found is not None and found.distance <= within:
                return found
        return None

    def under(self, place: Array, within: float) -> MeshPoint:
        """As nearest(); where no part is that near, the point of all that is nearest."""
        found = self.nearest(place, within)
        if found is None:
            flat, triangles = self.from_world(place[None, :])[0], self.cutout.triangles
            every = np.arange(len(triangles), dtype=np.int32)
            found = nearest_point(self.positions, triangles, flat, every)
        assert found is not None  # it has faces
        return found

    @property
    def heights(self) -> Array:
        """Of each part, across the plane."""
        return self._heights

    def parts_by_height(self, part: int) -> list[int]:
        """The other parts, those first that are nearest across the plane."""
        order = np.argsort(np.abs(self._heights - self._heights[part]), kind="stable")
        return [other for other in order.tolist() if other != part]

    # -- writing

    def rest_coordinates(self) -> Array32:
        """The mesh's coordinates, count x 3 float32 and object-local, at rest."""
        rest = self.reading.stored if self._rest_after is None else self._rest_after
        assert rest is not None
        return rest

    def write_rest(self) -> None:
        """Take the pose away, to the bit: what is posed, or the posed key's difference, goes back to rest."""
        rest = self._store.rest(self.resolve(), self.rest_coordinates())
        if rest is not None:
            coordinates = self._store.begin.copy()
            coordinates[self.vertex_indices] = rest[self.vertex_indices]
            self._put(coordinates)

    def restore(self) -> None:
        """Put everything back as it was when this was read, to the bit."""
        super().restore()
        if self._in_mesh:
            rest_shape.see(self.resolve().data, self._store.begin)
        if self._rest_written:
            rest_shape.put_back(self.resolve().data, self.reading.stored, self.reading.owners)
            self._rest_written = False

    def keep_rest(self) -> None:
        """Store the rest shape where it is not, or where it had to be completed: posing does so by itself."""
        if self._in_mesh and self._rest_after is not None and not self._rest_written:
            rest_shape.write(self.resolve().data, self._rest_after)
            self._rest_written = True

    def _put(self, shape: Array32) -> None:
        self.keep_rest()
        super()._put(shape)
        if self._in_mesh:  # so that what is posed is not taken for an edit of the mesh
            rest_shape.see(self.resolve().data, shape)

    # -- depth

    def coordinates_with(self, positions: Array, depths: Array) -> Array32:
        """As coordinates(), with the points at n depths. Raises Refusal beyond what Blender can store."""
        return self._with_depths(self.coordinates(positions), depths, np.ones_like(self._share))

    def write_with(self, positions: Array, depths: Array) -> None:
        """As write(), with the points at n depths; one that has its own keeps its bits. Raises Refusal."""
        placed = self._placed(self._store.begin, self.positions, positions, self._share)
        self._put(self._with_depths(placed, depths, self._share))

    def _with_depths(self, shape: Array32, depths: Array, share: Array) -> Array32:
        raised = (depths - self.depths) * self._relief.unit
        result, old = shape.copy(), shape[self._used, :3]
        placed = (old + np.outer(raised, self._inverse @ self.frame.n) / share).astype(np.float32)
        result[self._used, :3] = np.where((raised != 0.0)[:, None], placed, old)
        return result

    @cached_property
    def _relief(self) -> Relief:
        # An object that is mirrored shows the fronts of its faces on the other side of its frame.
        front = float(np.sign(self._rest.areas.sum()) * np.sign(np.linalg.det(self._linear)))
        heights = self._rest.frame.depth(self._rest.world)
        diagonal = diagonal_of(self._rest.flat[self.known])
        return relief(heights, self.known, self.parts, front=front, diagonal=diagonal)

    def _depths_of(self, shape: Array) -> Array:
        return self._relief.depths(self.frame.depth(mapped(shape[self._used, :3], self._linear)))

    def _frame_shown(self, plane: PlaneFrame, world: Array) -> PlaneFrame:
        """The frame of n x 3 points in world-linear space that this plane fits best: without their depths.

        Those would tilt it, so it is that of the rest shape where depths alone tell the two apart. Raises
        Refusal where the points lie in no parallel planes otherwise.
        """
        size = diagonal_of(world)
        if self._relief.is_of_depths(self._rest.frame.depth(world), size):
            return self._rest.frame
        if unevenness(plane, world, self.parts) > FLATNESS * size:
            raise Refusal(not_flat("Its faces do"))
        return plane

    # -- rest

    def _known_rest(self, shown: Array) -> tuple[Array, Mask]:
        """The rest n x 3, and where it is known (n): edits of the mesh leave vertices without one."""
        stored, owners = self.reading.rest, self.reading.owners
        rest = stored.coordinates.astype(np.float64)
        known = np.ones(len(rest), bool) if np.isfinite(rest).all() else np.isfinite(rest).all(axis=1)
        known &= ~copied_along_edges(stored.coincident_edges, shown, SAME_PLACE * diagonal_of(shown))
        if owners is not None:
            self._take_in_parts(rest, owners[self.vertex_indices], stored.copied_parts, shown, known)
        return rest, known

    def _take_in_parts(
        self, rest: Array, owners: Indices, copies: list[int], shown: Array, known: Mask
    ) -> None:
        """Bring the rest of joined and duplicated parts to where they are; what has no owner is not known."""
        known &= owners != 0
        # New and joined vertices come last, so the first one is the mesh's own, even if it has no rest yet.
        foreign = np.unique(self.parts[(owners != owners[0]) & known])
        own = rest[(owners == owners[0]) & known]
        for part in {*foreign.tolist(), *copies}:
            rows = np.flatnonzero((self.parts == part) & known)
            if len(rows) >= 3:
                rest[rows] = fitted(rest[rows], level(shown[rows], own), scaled=part in foreign)
            else:
                known[rows] = False

    def _flat_rest(self, rest: Array, known: Mask, shown: Array, before: CutoutObject | None) -> _FlatRest:
        """The rest in its plane; where nothing of it is known, it becomes what is shown."""
        stored = self.reading.rest if known.all() else None
        if stored is not None and not np.array_equal(rest, stored.coordinates):
            stored = None
        if stored is not None and before is not None and before._rest.stored is stored:
            return before._rest
        if not known.any():
            rest[:], known[:] = shown, True
        triangles = self.reading.rest.faces.triangles
        world = mapped(rest, self._linear)
        frame = flat_frame(rest, world, triangles, self.parts, self._linear, "Its rest shape does", known)
        flat = frame.flatten(world)
        if not known.all():
            triangles = triangles[known[triangles].all(axis=1)]
        sides = triangles[:: 1 + len(triangles) // MOST_SIDES]
        return _FlatRest(stored, world, frame, flat, sides, signed_areas(flat, sides))

    def _has_cutout_of(self, before: CutoutObject) -> bool:
        """Whether that has the same rest, faces and stiffness, to the bit, and is solved alike."""
        return (
            self._rest.stored is not None
            and self._rest is before._rest
            and self._turned_over == before._turned_over
            and self.reading.painted is before.reading.painted
            and self.reading.cage == before.reading.cage
        )

    def _shows_as(self, before: CutoutObject) -> bool:
        """Whether that has the same shape and faces, to the bit."""
        mine, other = self.reading, before.reading
        return mine.shown is other.shown and mine.rest.faces is other.rest.faces

    def _rest_positions(self, rest: Array, known: Mask, shown: Array) -> Array:
        """The rest shape n x 2; completed where it is not known, and then kept for writing."""
        parts, frame, flat = self.parts, self._rest.frame, self._rest.flat
        if self._turned_over:
            frame = frame.mirrored()
            flat = frame.flatten(self._rest.world)
        if not known.all():
            depths = frame.depth(self._rest.world)
            flat = np.where(known[:, None], flat, 0.0)
            flat = completed(flat, self.positions, self.reading.rest.faces.triangles, known)
            counts = np.bincount(parts, weights=known)
            sums = np.bincount(parts[known], weights=depths[known], minlength=len(counts))
            own = part_means(frame.depth(mapped(shown, self._linear)), parts)
            depth = np.where(counts > 0, sums / np.maximum(counts, 1), own)[parts]
            placed = mapped(frame.lift(flat) + np.outer(depth, frame.n), self._inverse)
            rest[~known] = placed[~known]
        if self._rest.stored is None and self._in_mesh:
            self._rest_after = self.reading.rest.shape.copy()
            self._rest_after[self.vertex_indices] = rest
        return flat
