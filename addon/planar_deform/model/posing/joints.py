# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints: where two parts of a drawing hang together, and the pairs of points that are held in one place."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..plane.cutout import Cutout
from ..plane.frame import Array, Indices
from ..plane.locate import MeshPoint, nearest_point
from .pins import Holder, Pin
from .posing import PinResult
from .rebinding import NEGLIGIBLE, Binding

Kind = Literal["HINGE", "WELD"]
KINDS: frozenset[str] = frozenset({"HINGE", "WELD"})

ON = 1e-5  # of the diagonal: a vertex that is as near to the other part lies on it
FEWEST = 2  # pairs, which hold a turn
# Of a hinge's weight, by which what of its group lies on the other part is drawn back there. It bends
# nothing, and decides where nothing else does: a head stays with the chest while a hand is dragged. Without
# it the head turns as all together would, and is off by 30 degrees after 60 wide drags there and back; with
# it by 0.01 degrees.
LOOSE = 1e-4


@dataclass(frozen=True)
class Joint:
    """A joint that holds two parts together."""

    key: int  # its index in the object's pin list
    kind: Kind
    parts: tuple[int, int]  # of the cutout
    first: tuple[Indices, Array]  # triangles (k,) of the one part, and barycentric weights k x 3
    second: tuple[Indices, Array]  # those of the other that lie there at rest
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

    first: tuple[Indices, Array]
    second: tuple[Indices, Array]
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
    pairs = [
        *_lying(sides[0][0], parts[1], cutout),
        *((b, a) for a, b in _lying(sides[1][0], parts[0], cutout)),
    ]
    if kind == "WELD" and len(pairs) < FEWEST:
        return None
    one, other = (
        (
            np.array([point.triangle for point in side], np.int32),
            np.array([point.weights for point in side]).reshape(-1, 3),
        )
        for side in ([first for first, _ in pairs], [second for _, second in pairs])
    )
    shares = np.full(len(pairs), 1.0 / max(len(pairs), 1))
    if kind == "HINGE":
        points = [Holder(Pin(key, "POINT", *side), cutout).handle_vertices() for side in sides]
        one, other = (
            (np.append(point[0], soft[0]), np.concatenate([point[1], soft[1]]))
            for point, soft in zip(points, (one, other), strict=True)
        )
        shares = np.append(1.0, LOOSE * shares)
    return Joint(key, kind, parts, one, other, shares, enabled, weight)


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


def carried(joints: Iterable[Joint], positions: Array, triangles: Indices) -> list[PinResult]:
    """Where joints are on n x 2 positions."""
    found = []
    for joint in joints:
        place = joint.place(positions, triangles)
        found.append(PinResult(joint.key, joint.parts[0], place, place, 0.0))
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


def _lying(rows: Indices, part: int, cutout: Cutout) -> list[tuple[MeshPoint, MeshPoint]]:
    """Those vertices that lie on a part at rest, each with the point of that part."""
    found = []
    for row in rows.tolist():
        point = point_on(cutout, part, cutout.rest[row])
        if point.distance <= ON * cutout.diagonal:
            corner = int(cutout.first_corners[row])
            found.append((MeshPoint(corner // 3, np.eye(3)[corner % 3]), point))
    return found
