# SPDX-License-Identifier: GPL-3.0-or-later
"""From a lattice to what it deforms: the meshes as they reach their Lattice modifiers, and by what weights.

A vertex x of such a mesh is shown at x + a·Σ b·(P - P⁰): b are the weights of the lattice's points P at the
place of x, which are at rest at P⁰, and a is the modifier's strength through its vertex group (twice, where
the lattice has a vertex group, too). All is in the world here.
"""

from __future__ import annotations

import itertools
from collections import OrderedDict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.lattice.cells import EQUAL, Counts, layers_across
from ...model.plane.frame import Array, Array32, Indices, mapped
from ..objects.flat_object import linear_of, origin_of
from ..objects.modifiers import of_lattice
from ..objects.pose_store import store_of
from ..objects.triangulation import Faces, faces_of
from ..pins import pin_list
from ..storage import changes, points
from ..storage.vertex_groups import members
from . import reaching

CAPACITY = 4  # lattices; what is kept of one with 20k vertices takes some 10 MB
BASES: dict[str, native.LatticeBasis] = {
    "KEY_LINEAR": "LINEAR",
    "KEY_CARDINAL": "CARDINAL",
    "KEY_CATMULL_ROM": "CATMULL_ROM",
    "KEY_BSPLINE": "BSPLINE",
}
RigState = tuple[Any, ...]  # equal as long as a rig would be read the same


@dataclass(frozen=True, eq=False)
class Grid:
    """A lattice's points at rest, and how they share the space between them.

    Two equal layers are one: what a vertex takes of both is what it would take of a single one.
    """

    counts: Counts
    kinds: tuple[native.LatticeBasis, ...]
    layers: list[Indices]  # N numbers of points each: one, or both that are equal
    co: Array32  # N x 3, in the lattice's own space
    group: Array | None  # N, weights of the lattice's own vertex group

    @property
    def key(self) -> tuple[Any, ...]:
        """Equal for equal grids."""
        return (
            self.counts,
            self.kinds,
            self.co.tobytes(),
            None if self.group is None else self.group.tobytes(),
        )

    def weights(self, places: Array) -> native.LatticeWeights:
        """Those of the points at n x 3 places of the lattice's space."""
        starts = (1, self.counts[0], self.counts[0] * self.counts[1])
        origin = self.co[0].astype(np.float64)
        spacing = [
            float(self.co[start, axis] - origin[axis]) if count > 1 else 1.0
            for axis, (start, count) in enumerate(zip(starts, self.counts, strict=True))
        ]
        return native.lattice_weights(places, self.counts, self.kinds, origin=origin, spacing=spacing)


@dataclass(frozen=True, eq=False)
class Part:
    """One of the objects that a lattice deforms. The very same again as long as all of it is."""

    name: str
    session_uid: int
    key: tuple[Any, ...]
    faces: Faces
    rest: Array  # n x 3, of the vertices of faces
    weights: native.LatticeWeights  # of the lattice's points, n x N by rows, with the modifier's factors

    def rows_of(self, vertices: Indices) -> Indices:
        """Which of its rows these vertices are; -1 for those of no face, and those that do not exist."""
        rows = np.full(max(int(vertices.max(initial=-1)), int(self.faces.vertices[-1])) + 1, -1, np.int32)
        rows[self.faces.vertices] = np.arange(len(self.faces.vertices), dtype=np.int32)
        found: Indices = rows[vertices]
        return found


@dataclass(frozen=True, eq=False)
class LatticeRig:
    """All that a lattice deforms. Rows are vertices of faces, those of one object behind those of another.

    The arrays are the very same again as long as meshes, modifiers and the lattice at rest are.
    """

    grid: Grid
    parts: tuple[Part, ...]
    points_at_rest: Array  # N x 3, in the world

    @property
    def flat_axis(self) -> int | None:
        """The axis across a flat lattice; None for a lattice in space."""
        return self.grid.counts.index(1) if 1 in self.grid.counts else None

    @cached_property
    def starts(self) -> list[int]:
        """The first row of each part, and the number of all rows."""
        return [0, *np.cumsum([len(part.rest) for part in self.parts]).tolist()]

    @cached_property
    def rest(self) -> Array:
        """n x 3, as the meshes reach the modifiers."""
        return np.concatenate([part.rest for part in self.parts])

    @cached_property
    def triangles(self) -> Indices:
        """m x 3 rows."""
        shifted = [part.faces.triangles + start for part, start in zip(self.parts, self.starts, strict=False)]
        triangles: Indices = np.concatenate(shifted).astype(np.int32)
        return triangles

    @cached_property
    def connected(self) -> Indices:
        """The connected part of each row, counted from 0."""
        counts = np.cumsum([0, *(int(part.faces.parts.max()) + 1 for part in self.parts)])
        shifted = [part.faces.parts + count for part, count in zip(self.parts, counts, strict=False)]
        connected: Indices = np.concatenate(shifted).astype(np.int32)
        return connected

    @cached_property
    def weights(self) -> native.LatticeWeights:
        """Of the lattice's points, n x N by rows, with all factors of the modifiers."""
        ends = [part.weights[0][1:] for part in self.parts]
        before = np.cumsum([0, *(end[-1] for end in ends)])
        shifted = [end + start for end, start in zip(ends, before, strict=False)]
        return (
            np.concatenate([[0], *shifted]).astype(np.int32),
            np.concatenate([part.weights[1] for part in self.parts]),
            np.concatenate([part.weights[2] for part in self.parts]),
        )

    def shown(self, places: Array) -> Array:
        """Where the rows are shown, n x 3, with the lattice's points at N x 3 places in the world."""
        return self.rest + displacements(self.weights, places - self.points_at_rest)

    @property
    def meshes(self) -> list[bpy.types.Object]:
        """The objects, those that are gone left out."""
        found = (bpy.data.objects.get(part.name) for part in self.parts)
        return [obj for obj in found if obj is not None]

    def rows_of(self, obj: bpy.types.Object, vertices: Indices) -> Indices:
        """The rows of an object's vertices; -1 for those that are not deformed, and those of no face."""
        for part, start in zip(self.parts, self.starts, strict=False):
            if part.session_uid == obj.session_uid:
                rows = part.rows_of(vertices)
                return np.where(rows >= 0, rows + start, -1).astype(np.int32)
        return np.full(len(vertices), -1, np.int32)

    def vertices_of(self, rows: Indices) -> tuple[bpy.types.Object, Indices]:
        """The object whose vertices rows of one part are, and which these are."""
        index = int(np.searchsorted(self.starts, rows[0], side="right")) - 1
        part = self.parts[index]
        return bpy.data.objects[part.name], part.faces.vertices[rows - self.starts[index]]


def displacements(weights: native.LatticeWeights, of_points: Array) -> Array:
    """Those of n places, n x 3, by those of the lattice's points, N x 3."""
    starts, columns, values = weights
    moved: Array = np.add.reduceat(values[:, None] * of_points[columns], starts[:-1])  # no row is empty
    return moved


_kept: OrderedDict[int, LatticeRig] = OrderedDict()  # by session_uid of the lattice


Collections = list[bpy.types.Collection]


def deformed(
    lattice: bpy.types.Object, *, also_hidden: bool = False
) -> Iterator[tuple[bpy.types.Object, bpy.types.Modifier]]:
    """The objects of the view layer that a lattice deforms and that are not hidden, with the modifiers.

    Local views have no say in it, so that all views show the same.
    """
    layer = bpy.context.view_layer
    collections = _collections(layer)
    for obj in layer.objects:
        if obj.type != "MESH":
            continue
        for modifier in of_lattice(obj, lattice):
            if modifier.show_viewport and (also_hidden or not _is_hidden(obj, collections)):
                yield obj, modifier


def once_deformed(
    lattice: bpy.types.Object, *, also_hidden: bool = False
) -> list[tuple[bpy.types.Object, bpy.types.Modifier]]:
    """What a lattice deforms, see deformed(). Raises Refusal where that is nothing, or an object twice."""
    found = list(deformed(lattice, also_hidden=also_hidden))
    if not found:
        raise Refusal(
            f"'{lattice.name}' deforms no mesh that is shown: give one a Lattice modifier with this object"
        )
    for (one, _), (other, _) in itertools.pairwise(found):
        if one == other:
            raise Refusal(f"'{one.name}' has two modifiers of '{lattice.name}': remove one")
    return found


def is_known(lattice: bpy.types.Object, *, posed: bool) -> bool:
    """Whether what a lattice deforms can be read while Blender evaluates: nothing else deforms it before.

    `posed`: nor do its own shape keys count, of which the data have the present frame.
    """
    return all(
        not reaching.above(obj, modifier) and (posed or obj.data.shape_keys is None)
        for obj, modifier in deformed(lattice)
    )


def is_hidden(obj: bpy.types.Object) -> bool:
    """Whether an object takes no part in what its lattice is posed by, as it is hidden in the view layer."""
    layer = bpy.context.view_layer
    return layer.objects.get(obj.name) == obj and _is_hidden(obj, _collections(layer))


def _is_hidden(obj: bpy.types.Object, collections: tuple[Collections, Collections]) -> bool:
    if obj.hide_viewport or obj.hide_get():
        return True
    shown, hidden = collections
    return _is_in(hidden, obj) and not _is_in(shown, obj)


def _collections(layer: bpy.types.ViewLayer) -> tuple[Collections, Collections]:
    """Those of a view layer that are shown, and those that are hidden, by themselves or with others."""
    shown: Collections = []
    hidden: Collections = []
    rest = [layer.layer_collection]
    while rest:
        one = rest.pop()
        (shown if one.is_visible else hidden).append(one.collection)
        rest.extend(one.children)
    return shown, hidden


def _is_in(collections: Collections, obj: bpy.types.Object) -> bool:
    return any(collection.objects.get(obj.name) == obj for collection in collections)


def waiting(lattice: bpy.types.Object, keys: Iterable[int]) -> str | None:
    """Why pins with these numbers cannot be posed at present: they are on hidden objects. None if none is."""
    for key in sorted(keys):
        pinned = pin_list.pinned_object(lattice.planar.pins[key])
        if pinned is not None and pinned != lattice and is_hidden(pinned):
            return f"'{pinned.name}' is hidden, and its pins wait until it is shown"
    return None


def rig_state(lattice: bpy.types.Object) -> RigState:
    """All that a rig depends on. It takes some microseconds an object, whatever the size of the meshes."""
    return (
        changes.count(lattice),
        *(
            (changes.count(obj), obj.data.session_uid, obj.mode, np.array(obj.matrix_world).tobytes())
            for obj, _ in deformed(lattice)
        ),
    )


def read_rig(lattice: bpy.types.Object, *, drawn: bool = False) -> LatticeRig:
    """What a lattice deforms. Raises Refusal; changes nothing. `drawn`: see reaching.shape()."""
    grid = read_grid(lattice)
    points_at_rest = mapped(grid.co.astype(np.float64), linear_of(lattice)) + origin_of(lattice)
    before = _kept.pop(lattice.session_uid, None)
    old = {} if before is None else {part.session_uid: part for part in before.parts}
    parts: list[Part] = []
    for obj, modifier in once_deformed(lattice):
        parts.append(_read_part(lattice, grid, obj, modifier, old.get(obj.session_uid), drawn))
    rig = LatticeRig(grid, tuple(parts), points_at_rest)
    if (
        before is not None
        and len(before.parts) == len(parts)
        and all(a is b for a, b in zip(before.parts, parts, strict=True))
        and np.array_equal(before.points_at_rest, points_at_rest)
    ):
        rig = before
    _kept[lattice.session_uid] = rig
    while len(_kept) > CAPACITY:
        _kept.popitem(last=False)
    return rig


def forget() -> None:
    """Keep none."""
    _kept.clear()


def read_grid(lattice: bpy.types.Object) -> Grid:
    """The lattice at rest. Raises Refusal."""
    data = lattice.data
    counts: Counts = (data.points_u, data.points_v, data.points_w)
    if sum(count > 1 for count in counts) < 2:
        raise Refusal(f"'{lattice.name}' has one point in two axes: raise its Resolution in the Data tab")
    if data.use_outside:
        raise Refusal(
            f"'{lattice.name}' has Outside on, which takes its inner points away: turn it off in the Data tab"
        )
    moving = [modifier.name for modifier in lattice.modifiers if modifier.show_viewport]
    if moving:
        raise Refusal(f"Modifier '{moving[0]}' moves points of '{lattice.name}': apply it, or hide it")
    regular, group = points.read_regular(lattice), None
    layers = [np.arange(len(regular), dtype=np.int32)]
    if data.vertex_group and data.vertex_group in lattice.vertex_groups:
        index = lattice.vertex_groups[data.vertex_group].index
        shares = ([e.weight for e in point.groups if e.group == index] for point in data.points)
        group = np.array([share[0] if share else 0.0 for share in shares])
    elif counts.count(2) == 1 and 1 not in counts:
        both = layers_across(counts, counts.index(2))
        shown = store_of(lattice, unkeyed=True).shown
        first, second = (shown[layer] - regular[layer] for layer in both)
        if np.abs(first - second).max() <= EQUAL * float(np.ptp(shown, axis=0).max()):
            layers, (u, v, w) = both, (1 if count == 2 else count for count in counts)
            counts = u, v, w
    types = data.interpolation_type_u, data.interpolation_type_v, data.interpolation_type_w
    return Grid(counts, tuple(BASES[kind] for kind in types), layers, regular[layers[0]], group)


def _read_part(
    lattice: bpy.types.Object,
    grid: Grid,
    obj: bpy.types.Object,
    modifier: bpy.types.Modifier,
    before: Part | None,
    drawn: bool,
) -> Part:
    """One object, as it is; the same part as before where that still holds."""
    _check(obj, modifier)
    shape = reaching.shape(obj, modifier, drawn=drawn)
    faces = faces_of(obj.data, shape)
    factors = factors_of(obj, modifier)
    matrices = np.array(obj.matrix_world), np.array(lattice.matrix_world)
    key = (
        *(obj.data.session_uid, shape.tobytes(), grid.key),
        *(matrix.tobytes() for matrix in matrices),
        factors.tobytes() if isinstance(factors, np.ndarray) else factors,
    )
    if before is not None and before.faces is faces and before.key == key and before.name == obj.name:
        return before
    coordinates = shape[faces.vertices].astype(np.float64)
    if not np.isfinite(coordinates).all():
        raise Refusal(f"'{obj.name}' has vertices with coordinates that are not numbers: delete them")
    rest = mapped(coordinates, linear_of(obj)) + origin_of(obj)
    share = factors if isinstance(factors, float) else factors[faces.vertices]
    weights = weights_at(lattice, grid, rest, share)
    return Part(obj.name, obj.session_uid, key, faces, rest, weights)


def weights_at(
    lattice: bpy.types.Object, grid: Grid, places: Array, share: Array | float
) -> native.LatticeWeights:
    """Those of the lattice's points at n x 3 places in the world, n x N by rows; `share`: of the modifier."""
    inverse = np.linalg.inv(linear_of(lattice))
    starts, columns, values = grid.weights(mapped(places - origin_of(lattice), inverse))
    if grid.group is not None:
        share = share * share * np.add.reduceat(values * grid.group[columns], starts[:-1])
    return starts, columns, values * np.repeat(np.broadcast_to(share, len(places)), np.diff(starts))


def _check(obj: bpy.types.Object, modifier: bpy.types.Modifier) -> None:
    """Raises Refusal where what reaches the modifier is not the mesh itself."""
    if obj.mode != "OBJECT":
        raise Refusal(f"'{obj.name}' is in another mode: leave that first")
    reason = reaching.refusal(obj, modifier)
    if reason is not None:
        raise Refusal(reason)
    keys = obj.data.shape_keys
    if keys is not None and not keys.use_relative and not obj.planar.poses:
        raise Refusal(f"'{obj.name}' has absolute shape keys: turn on Relative in its Shape Keys panel")
    if not obj.data.polygons:
        raise Refusal(
            f"'{obj.name}' has no faces: remove its Lattice modifier while '{modifier.name}' is posed"
        )


def factors_of(obj: bpy.types.Object, modifier: bpy.types.Modifier) -> Array | float:
    """What a modifier multiplies the displacement of each vertex by (count,), or of all of them."""
    strength = float(modifier.strength)
    if not modifier.vertex_group or modifier.vertex_group not in obj.vertex_groups:
        return strength
    rows, shares = members(obj, [modifier.vertex_group])[modifier.vertex_group]
    weights = np.zeros(len(obj.data.vertices))
    weights[rows] = shares
    factors: Array = strength * (1.0 - weights if modifier.invert_vertex_group else weights)
    return factors
