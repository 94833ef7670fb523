# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the layers of a cutout hang together, so that in-betweens carry one along with the other.

Layers are parts of a mesh that share no vertex. Nothing but the drawing tells that an arm hangs on a body: a
point of the arm lies on one of the body at rest, and does so in both poses between which frames are made.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from mathutils.kdtree import KDTree

from ...model.plane.frame import Array, Indices

# Of the diagonal of the rest's box: how far apart two vertices of a joint may get. Shoulders of drawn
# characters stay within 0.6 %; layers that only overlap are 2 % and more off in one pose or another.
LOOSENESS = 0.01

Shapes = tuple[Array, Array, Array]  # at rest, before, after


# The two parts of a joint, and its vertices.
Given = tuple[tuple[int, int], tuple[int, int]]


def find(
    rest: Array, before: Array, after: Array, parts: Indices, planted: set[int], given: Sequence[Given] = ()
) -> Indices:
    """The joints that hold from one pose to the next: rows (vertex of the carrier, vertex of the carried).

    All shapes are n x 2; `parts` numbers the part of each vertex. `planted` parts stand on their own and are
    never carried. Every part is carried at most once, and no two carry each other: where several joints offer
    themselves, the tightest do, and before these what is `given`. Of parts that hang together the one with
    most vertices carries the others.
    """
    members = [np.flatnonzero(parts == part) for part in range(parts.max(initial=-1) + 1)]
    shapes = (rest, before, after)
    limit = LOOSENESS * float(np.hypot(*np.ptp(rest, axis=0)))
    found = sorted(
        joint
        for one, other in _neighbours(shapes, members, limit)
        if (joint := _tightest(shapes, members[one], members[other], limit)) is not None
    )

    tree = {part: {part} for part in range(len(members))}  # the parts that hang together with each
    chosen: dict[int, list[tuple[int, int, int]]] = {part: [] for part in tree}  # with the part carried then
    offered = [((int(parts[a]), int(parts[b])), (a, b)) for _, a, b in found]
    for (first, second), (a, b) in (*given, *offered):
        one, other = tree[first], tree[second]
        if one is not other and not (one & planted and other & planted):
            one |= other
            tree.update(dict.fromkeys(other, one))
            chosen[first].append((a, b, second))
            chosen[second].append((b, a, first))

    joints: list[tuple[int, int]] = []
    reached: set[int] = set()
    for root in sorted(tree, key=lambda part: (part not in planted, -len(members[part]))):
        waiting = [] if root in reached else [root]
        while waiting:
            part = waiting.pop()
            reached.add(part)
            onward = [joint for joint in chosen[part] if joint[2] not in reached]
            joints += [(a, b) for a, b, _ in onward]
            waiting += [carried for _, _, carried in onward]
    return np.array(joints, int).reshape(-1, 2)


def _neighbours(shapes: Shapes, members: list[Indices], limit: float) -> list[tuple[int, int]]:
    """The pairs of parts whose boxes come within the limit in all shapes. A lone vertex is no part."""
    large = np.array([part for part, vertices in enumerate(members) if len(vertices) > 1], int)
    near = np.triu(np.ones((len(large), len(large)), bool), 1)
    for shape in shapes:
        low = np.array([shape[members[part]].min(axis=0) for part in large]).reshape(-1, 2)
        high = np.array([shape[members[part]].max(axis=0) for part in large]).reshape(-1, 2)
        meets = (low[:, None] - limit <= high[None]).all(axis=2)
        near &= meets & meets.T
    return [(int(large[one]), int(large[other])) for one, other in np.argwhere(near)]


def _tightest(shapes: Shapes, one: Indices, other: Indices, limit: float) -> tuple[float, int, int] | None:
    """The pair of vertices of two parts that gets least apart, and how far; None beyond the limit."""
    for shape in shapes:
        low, high = shape[one].min(axis=0) - limit, shape[one].max(axis=0) + limit
        other = other[((shape[other] >= low) & (shape[other] <= high)).all(axis=1)]
    if not len(other):
        return None
    rest = shapes[0]
    tree = KDTree(len(one))
    for index, (x, y) in zip(one.tolist(), rest[one].tolist(), strict=True):
        tree.insert((x, y, 0.0), index)
    tree.balance()
    nearest = np.array([tree.find((x, y, 0.0))[1] for x, y in rest[other].tolist()])
    apart = np.max([np.hypot(*(shape[other] - shape[nearest]).T) for shape in shapes], axis=0)
    best = int(apart.argmin())
    return (float(apart[best]), int(nearest[best]), int(other[best])) if apart[best] <= limit else None
