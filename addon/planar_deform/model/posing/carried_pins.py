# SPDX-License-Identifier: GPL-3.0-or-later
"""What pins and other groups of vertices hold on a mesh that takes another one's place."""

from __future__ import annotations

import numpy as np

from ..plane.carrying import Carrying
from ..plane.cutout import Cutout
from ..plane.frame import Array, Indices
from .pins import Holder
from .rebinding import NEGLIGIBLE, Binding, point_binding

# Of a vertex's share in those that a patch holds: from there on it is one of them. With the second, where the
# patch has no triangles of its own, or they are too small.
SHARES = (0.98, 0.5)
FEWEST = 3  # vertices, which hold a turn as well


def group_carried(
    carrying: Carrying, count: int, rows: Indices, weights: Array, beside: float = 0.0
) -> Binding:
    """The vertices of the new mesh, and their weights, that a group of the old one's (of `count`) has become.

    `beside`: what the weight of a vertex counts that is in no group.
    """
    members, values = np.zeros(count), np.full(count, beside)
    members[rows], values[rows] = 1.0, weights
    shares = carrying.within
    inside = np.einsum("kc,kc->k", shares, members[carrying.corners]) > NEGLIGIBLE
    blended = np.einsum("kc,kc->k", shares, values[carrying.corners])
    return np.flatnonzero(inside).astype(np.int32), np.clip(blended[inside], 0.0, 1.0)


def patch_carried(carrying: Carrying, count: int, rows: Indices, weights: Array) -> Binding:
    """The same of a patch, whose vertices, all of them with a weight, are held alike: its region stays."""
    members, values = np.zeros(count), np.zeros(count)
    members[rows], values[rows] = 1.0, weights
    inside = np.einsum("kc,kc->k", carrying.within, members[carrying.corners])
    blended = np.einsum("kc,kc->k", carrying.within, values[carrying.corners])
    enough = (held for held in (np.flatnonzero(inside >= share) for share in SHARES) if len(held) >= FEWEST)
    held = next(enough, np.flatnonzero(inside >= SHARES[-1])).astype(np.int32)
    return held, blended[held] / inside[held]


def nearest_binding(new: Cutout, holder: Holder, near: Indices) -> Binding:
    """What holds the place of a pin at rest on the new mesh, or the point nearest to it.

    `near`: vertices of the parts it may be in, if there are any.
    """
    return nearest_binding_at(new, holder.place(holder.cutout.rest), near)


def nearest_binding_at(new: Cutout, place: Array, near: Indices) -> Binding:
    """The same of a place (2 or 3,)."""
    found = point_binding(new, place, near) or point_binding(
        new, place, np.arange(len(new.rest), dtype=np.int32)
    )
    assert found is not None  # the mesh has triangles
    return found[1]
