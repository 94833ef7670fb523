# SPDX-License-Identifier: GPL-3.0-or-later
"""What flat objects of all kinds have in common: their transform, their plane, and how shapes are written."""

from __future__ import annotations

from functools import cached_property

import bpy
import numpy as np

from ...errors import ObjectGone, Refusal
from ...model.plane.cutout import diagonal_of
from ...model.plane.frame import Array, Array32, Indices, PlaneFrame, inverse, mapped, part_means
from ...model.posing import solving
from ..storage import migration, points, shape_keys
from . import mesh_edits
from .pose_store import PoseStore

FLATNESS = 1e-3  # of the diagonal: how far a part may leave its plane
MAKE_LOCAL = "make it local with Object > Relations > Make Local > Selected Objects and Data"


def data_refusal(obj: bpy.types.Object, mode: str) -> str | None:
    """Why an object's mesh or curve cannot be changed in a mode, and what to do; None when it can."""
    data = obj.data
    if obj.override_library is not None or data.override_library is not None:
        return (  # its data are linked, as a rule: that alone would not tell the reason
            f"'{obj.name}' is a library override, whose shape is kept in the library's file alone: pose it "
            f"there, or {MAKE_LOCAL}, which ends the override"
        )
    if obj.library is not None or data.library is not None:
        return f"'{obj.name}' is linked from a library: pose it in that file, or {MAKE_LOCAL}"
    newer = migration.refusal(obj)
    if newer is not None:
        return newer
    if obj.mode != mode:
        return "Posing works in Object Mode: leave the current mode first"
    if data.users - data.use_fake_user > 1:
        kind = obj.type.lower()
        return f"The {kind} is shared: make it single-user with Object > Relations > Make Single User"
    return None


def make_current(context: bpy.types.Context, obj: bpy.types.Object | None = None) -> None:
    """Before an object is read, by default the active one: end a drag that still is on, update transforms.

    The drag ends with what it shows. What has been done to its mesh as a whole is taken into account, too.
    """
    solving.interrupt()
    context.view_layer.update()
    obj = obj or context.object
    if obj is not None:
        mesh_edits.catch_up(obj)


class FlatObject:
    """An object as points of a plane: those of its points that something joins, in their order.

    Holds no reference to Blender's data, which dies with every undo: each method finds the object again by
    name and identity, and raises ObjectGone where it or its data is another one by now.
    """

    object_name: str
    session_uid: int
    positions: Array  # n x 2, the shape shown
    parts: Indices  # n, the connected part of each point
    frame: PlaneFrame  # of the shape shown, in world-linear space
    vertex_indices: Indices  # n, of each point in the object
    _used: Indices | slice  # the same to index by, as short as it can be told
    count: int  # of the object's points

    def __init__(self, obj: bpy.types.Object, store: PoseStore):
        self.object_name, self.session_uid = obj.name, obj.session_uid
        self._data_uid, self.count, self._mode = obj.data.session_uid, points.count(obj), obj.mode
        self._linear, self._origin = linear_of(obj), origin_of(obj)
        if not (np.isfinite(self._linear).all() and np.isfinite(self._origin).all()):
            raise Refusal(
                f"The transform of '{obj.name}' is not made of numbers: clear it with Object > Clear"
            )
        stretches = np.linalg.svd(self._linear, compute_uv=False)
        if not stretches[-1] > 1e-6 * stretches[0]:
            raise Refusal(f"'{obj.name}' has a scale of zero: give it a scale in every axis")
        self._inverse = inverse(self._linear)
        self._store = store

    def _take_points(self, obj: bpy.types.Object, used: Indices, parts: Indices) -> Array:
        """Stand for these of the object's points; the coordinates n x 3 at which they are shown."""
        self.vertex_indices, self.parts = used, parts
        # Of a dense drawing a view costs nothing, and a copy a millisecond.
        self._used = slice(None) if len(used) == self.count else used
        shown = self._store.shown[self._used, :3]
        if not np.isfinite(shown).all():
            kind = "vertices" if obj.type == "MESH" else "points"
            raise Refusal(f"'{obj.name}' has {kind} with coordinates that are not numbers: delete them")
        self._share = self._store.share[self._used]
        shape_keys.check_share(obj, self._share)
        return shown

    def _take_frame(self, frame: PlaneFrame, world: Array) -> None:
        """Lie in this frame with the points at n x 3 positions in world-linear space."""
        self.frame, self.positions = frame, frame.flatten(world)
        self._heights = part_means(frame.depth(world), self.parts)

    # -- reading

    def rows_of(self, points: Indices) -> Indices:
        """Which of its points these of the object are, in any array; -1 for those that nothing joins."""
        return self._rows[points]

    @cached_property
    def _rows(self) -> Indices:
        rows = np.full(self.count, -1, np.int32)
        rows[self.vertex_indices] = np.arange(len(self.vertex_indices), dtype=np.int32)
        return rows

    def to_world(self, places: Array, parts: Indices | None = None) -> Array:
        """World positions k x 3 of k x 2 points of the plane, as deep as their parts (k,), else the first."""
        depths = self._heights[np.zeros(len(places), np.int32) if parts is None else parts]
        return self.frame.lift(places) + np.outer(depths, self.frame.n) + self._origin

    def to_local(self, places: Array, parts: Indices | None = None) -> Array:
        """Object-local positions k x 3 of k x 2 points of the plane."""
        return mapped(self.to_world(places, parts) - self._origin, self._inverse)

    def from_local(self, places: Array) -> Array:
        """Plane coordinates k x 2 of k x 3 object-local points."""
        return self.frame.flatten(mapped(places, self._linear))

    def from_world(self, places: Array) -> Array:
        """Plane coordinates k x 2 of k x 3 world points."""
        return self.frame.flatten(places - self._origin)

    def axis_to_world(self, axis: Array) -> Array:
        """The direction in the world (3,) of one in the object's space."""
        turned: Array = mapped(axis[None, :], self._linear)[0]
        return turned

    def axis_from_world(self, axis: Array) -> Array:
        """The same back."""
        turned: Array = mapped(axis[None, :], self._inverse)[0]
        return turned

    def flattened(self, shape: Array32) -> Array:
        """Plane coordinates n x 2 of any shape of the object, see storage/points.py. Raises Refusal."""
        places = shape[self._used, :3].astype(np.float64)
        if not np.isfinite(places).all():
            raise Refusal(
                f"A pose of '{self.object_name}' has coordinates that are not numbers: delete that pose"
            )
        return self.from_local(places)

    def coordinates(self, positions: Array) -> Array32:
        """The shape, see storage/points.py, in which the object shows n x 2 positions.

        Raises Refusal beyond what Blender can store.
        """
        shown = self._store.shown.astype(np.float32)
        return self._placed(shown, self.positions, positions, np.ones_like(self._share))

    def moved(self, shape: Array32, positions: Array) -> Array32:
        """Any shape of the object with its points of the plane taken to n x 2 positions.

        What the plane does not tell stays: depths, and points that nothing joins. Raises Refusal beyond what
        Blender can store.
        """
        return self._placed(shape, self.flattened(shape), positions, np.ones_like(self._share))

    # -- writing

    def write(self, positions: Array) -> None:
        """Show n x 2 positions: in the object itself, through the posed shape key, or in the pose sequence.

        A vertex that is where it was keeps its bits. Positions of a drag are always told from the start.
        Raises Refusal, with nothing changed, beyond what Blender can store.
        """
        self._put(self._placed(self._store.begin, self.positions, positions, self._share))

    def show(self, shape: Array32) -> None:
        """Show a shape, see storage/points.py, of an object with a pose sequence."""
        self._put(shape)

    def restore(self) -> None:
        """Put everything back as it was when this was read, to the bit."""
        obj = self.resolve()
        self._store.restore(obj)
        points.update(obj)

    def resolve(self) -> bpy.types.Object:
        """The object that was read. Raises ObjectGone if it, its data or its mode is another one by now."""
        obj = bpy.data.objects.get(self.object_name)
        if obj is None or obj.session_uid != self.session_uid:
            raise ObjectGone(f"'{self.object_name}' is gone")
        if (obj.data.session_uid, points.count(obj), obj.mode) != (self._data_uid, self.count, self._mode):
            raise ObjectGone(f"The {obj.type.lower()} of '{self.object_name}' has changed")
        if not self._store.is_there(obj):
            raise ObjectGone(f"The shape keys of '{self.object_name}' have changed")
        return obj

    def _placed(self, begin: Array32, start: Array, positions: Array, share: Array) -> Array32:
        offsets = positions - start
        moved = (offsets[:, 0] != 0.0) | (offsets[:, 1] != 0.0)
        lift = np.stack([self.frame.u, self.frame.v], axis=1)
        shape, old = begin.copy(), begin[self._used, :3]
        with np.errstate(over="ignore"):  # float64 until it is stored
            placed = (old + mapped(offsets, self._inverse @ lift) / share).astype(np.float32)
        if not np.isfinite(placed).all() and not np.isfinite(placed[moved]).all():
            raise Refusal("That is farther than Blender's coordinates reach: move the pins less")
        shape[self._used, :3] = np.where(moved[:, None], placed, old)
        return shape

    def _put(self, shape: Array32) -> None:
        obj = self.resolve()
        self._store.write(obj, shape)
        points.update(obj)


def linear_of(obj: bpy.types.Object) -> Array:
    """The linear part of the object's transform, 3 x 3."""
    return np.array(obj.matrix_world.to_3x3(), dtype=np.float64)


def origin_of(obj: bpy.types.Object) -> Array:
    """Where the object's origin is in the world (3,)."""
    return np.array(obj.matrix_world.translation, dtype=np.float64)


def is_flat(frame: PlaneFrame, world: Array, parts: Indices) -> bool:
    """Whether each part of n x 3 points in world-linear space lies across the normal."""
    return unevenness(frame, world, parts) <= FLATNESS * diagonal_of(world)


def unevenness(frame: PlaneFrame, world: Array, parts: Indices) -> float:
    """How far parts of n x 3 points in world-linear space leave their planes across the normal."""
    depths = frame.depth(world)
    return float(np.abs(depths - part_means(depths, parts)[parts]).max())
