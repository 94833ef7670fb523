# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints: where two parts of a drawing hang together, and the pairs of points that are held in one place."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..plane.cutout import Cutout
from ..plane.frame import Array, Indices
from ..plane.locate import MeshPoint, at, nearest_point
from .pins import Holder, Pin
from .posing import PinResult
from .rebinding import NEGLIGIBLE, Binding

Kind = Literal["HINGE", "WELD"]
Points = tuple[Indices, Array]  # triangles (k,) and barycentric weights k x 3
Pair = tuple[MeshPoint, MeshPoint]
KINDS: frozenset[str] = frozenset({"HINGE", "WELD"})

ON = 1e-5  # of the diagonal: a vertex that is as near to the other part lies on it
FEWEST = 2  # pairs, which hold a turn
# The corners of the triangles in which a hinge is are drawn back, by so little of its weight, to what of the
# other part they lie on at rest, as if they were at this share of the diagonal from it. That bends nothing:
# at 1e-4 an arm bends by 2 % of the diagonal, at 1e-6 by 0.02 %. And it decides where nothing else does: a
# head stays with the chest while a hand is dragged. Without it the head turns as all together would, and is
# off by 30 degrees after 60 wide drags there and back; with it by 0.03 degrees, which do not add up.
LOOSE, LEVER = 1e-6, 0.01


@dataclass(frozen=True)
class Joint:
    """A joint that holds two parts together."""

    key: int  # its index in the object's pin list
    kind: Kind
    parts: tuple[int, int]  # of the cutout
    first: Points  # of the one part
    second: Points  # those of the other that lie there at rest
    shares: Array  # k, of each pair in how strongly it holds; the point of a hinge comes first
    enabled: bool = True
    weight: float = 1.0  # how strongly it holds

    def places(self, positions: Array, triangles: Indices) -> tuple[Array, Array]:
        """The middles (2,) of its points of the one part and the other on n x 2 positions."""
        firm = self.shares == self.shares.max()
        one, other = (
            np.einsum("kc,kcd->d", weights[firm], positions[triangles[of[firm]]]) / firm.sum()
            for of, weights in (self.first, self.second)
        )
        return one, other

    def place(self, positions: Array, triangles: Indices) -> Array:
        """Where it is (2,), between the two."""
        one, other = self.places(positions, triangles)
        middle: Array = 0.5 * (one + other)
        return middle


@dataclass(frozen=True)
class Ties:
    """The pairs of points of all joints of a drawing, as a solver takes them."""

    first: Points
    second: Points
    strength: Array  # of each pair

    @property
    def recipe(self) -> tuple[Array | Indices, ...]:
        """All that they are."""
        return (*self.first, *self.second, self.strength)


def bound(
    key: int,
    kind: Kind,
    rows: Indices,
    weights: Array,
    cutout: Cutout,
    *,
    enabled: bool = True,
    weight: float = 1.0,
) -> Joint | None:
    """The joint of a group (k vertices of the cutout and their weights, all positive).

    None while it waits: its vertices are of one part, or, of a weld, too few lie on the other part at rest.
    Of more than two parts it holds those that have most of the weight.
    """
    parts = two_parts(rows, weights, cutout.parts)
    if parts is None:
        return None
    sides = [(rows[mine], weights[mine]) for mine in (cutout.parts[rows] == part for part in parts)]
    if kind == "WELD":
        pairs = _lying(sides[0][0], sides[1][0], parts, cutout)
        if len(pairs) < FEWEST:
            return None
        return Joint(
            key, kind, parts, *_stacked(pairs), np.full(len(pairs), 1.0 / len(pairs)), enabled, weight
        )
    points = [_middle(key, *side, cutout) for side in sides]
    one, other = (cutout.triangles[point.triangle] for point in points)
    pairs = _lying(one, other, parts, cutout)
    first, second = _stacked([(points[0], points[1]), *pairs])
    arms = np.einsum("kc,kcd->kd", first[1][1:], cutout.rest[cutout.triangles[first[0][1:]]])
    lever = float(((arms - at(cutout.rest, cutout.triangles, points[0])) ** 2).sum())
    reach = (LEVER * cutout.diagonal) ** 2
    loose = LOOSE * reach / max(lever, LOOSE * reach)  # 1 where the triangles are too small to turn anything
    shares = np.append(1.0, np.full(len(pairs), loose))
    return Joint(key, kind, parts, first, second, shares, enabled, weight)


def two_parts(rows: Indices, weights: Array, parts: Indices) -> tuple[int, int] | None:
    """The two parts, in order, that have most of a group's weight; None where it is all in one."""
    shares = np.bincount(parts[rows], weights=weights)
    if np.count_nonzero(shares) < 2:
        return None
    one, other = sorted(np.argsort(-shares, kind="stable")[:2].tolist())
    return one, other


def ties_of(joints: Iterable[Joint]) -> Ties | None:
    """The pairs of all joints that are on; None if there are none."""
    used = [joint for joint in joints if joint.enabled]
    if not used:
        return None
    first, second = (
        (np.concatenate([of for of, _ in sides]), np.concatenate([weights for _, weights in sides]))
        for sides in ([joint.first for joint in used], [joint.second for joint in used])
    )
    return Ties(first, second, np.concatenate([joint.weight * joint.shares for joint in used]))


def hanging_on(parts: Collection[int], joints: Iterable[Joint]) -> set[int]:
    """The parts that hang together with any of these, by joints that are on; these among them."""
    found, pairs = set(parts), [set(joint.parts) for joint in joints if joint.enabled]
    while grown := [pair for pair in pairs if pair & found and not pair <= found]:
        found.update(*grown)
    return found


def carried(joints: Iterable[Joint], positions: Array, triangles: Indices) -> list[PinResult]:
    """Where joints are on n x 2 positions."""
    found = []
    for joint in joints:
        place = joint.place(positions, triangles)
        found.append(PinResult(joint.key, joint.parts[0], place, place, 0.0, 1.0, 1.0))
    return found


def hinge_binding(cutout: Cutout, parts: Iterable[int], place: Array) -> Binding:
    """What holds a place (2,) at rest in each of two parts, the one as much as the other."""
    vertices, shares = [], []
    for part in parts:
        point = point_on(cutout, part, place)
        held = point.weights > NEGLIGIBLE
        vertices.append(cutout.triangles[point.triangle][held])
        shares.append(point.weights[held])
    return np.concatenate(vertices), np.concatenate(shares)


def point_on(cutout: Cutout, part: int, place: Array) -> MeshPoint:
    """The point of a part at a place (2,) at rest, or nearest to it; looked for once in a cutout."""
    asked = b"on" + part.to_bytes(4, "little") + place.tobytes()
    if asked not in cutout.found:
        among = np.flatnonzero(cutout.parts[cutout.triangles[:, 0]] == part).astype(np.int32)
        point = nearest_point(cutout.rest, cutout.triangles, place, among)
        assert point is not None  # every part has triangles
        cutout.found[asked] = point
    return cutout.found[asked]


def _middle(key: int, rows: Indices, weights: Array, cutout: Cutout) -> MeshPoint:
    """The point of a group of one part."""
    (triangle,), (inside,) = Holder(Pin(key, "POINT", rows, weights), cutout).handle_vertices()
    return MeshPoint(int(triangle), inside)


def _lying(rows: Indices, others: Indices, parts: tuple[int, int], cutout: Cutout) -> list[Pair]:
    """Those vertices of two parts that lie on the other one at rest, each with the point of that."""
    found: list[Pair] = []
    for row, part in [
        *((row, parts[1]) for row in rows.tolist()),
        *((row, parts[0]) for row in others.tolist()),
    ]:
        point = point_on(cutout, part, cutout.rest[row])
        if point.distance <= ON * cutout.diagonal:
            corner = int(cutout.first_corners[row])
            vertex = MeshPoint(corner // 3, np.eye(3)[corner % 3])
            found.append((vertex, point) if part == parts[1] else (point, vertex))
    return found


def _stacked(pairs: list[Pair]) -> tuple[Points, Points]:
    """The points of the one part and those of the other."""
    first, second = (
        (np.array([point.triangle for point in side], np.int32), np.array([point.weights for point in side]))
        for side in zip(*pairs, strict=True)
    )
    return first, second
