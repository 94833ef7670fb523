# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies in front where a drawing lies on itself: depths of pins, spread over their parts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ... import native
from ..plane.cutout import Cutout
from ..plane.frame import Array, Indices, is_of
from . import solver_cache
from .pins import Holder

# Of the diagonal, how far a depth of 1 raises the drawing out of its plane. Cycles, Workbench and EEVEE
# (dithered) draw that clean, and nobody sees it from the side.
DEPTH = 5e-4
DEEPEST = 10.0  # the largest depth, to either side
NONE = 1e-3  # depths that are as small are rounding
HELD = 1e-6  # of a pin's weight: corners with less do not hold it


def depth_of(holder: Holder, depths: Array) -> float:
    """The depth of a pin where the points have n depths."""
    return float(holder.place(depths[:, None])[0])


def told_depth(holder: Holder, depths: Array) -> float:
    """The same without rounding: 0 where it is nothing else."""
    depth = depth_of(holder, depths)
    return depth if abs(depth) >= NONE else 0.0


def spread(
    key: int, cutout: Cutout, holders: Sequence[Holder], asked: Mapping[int, float], depths: Array
) -> Array:
    """The depths (n,) in which pins have those that are asked for (by key), and the other ones stay.

    `key`: of the object, for which the share of each pin in each depth is kept as long as its pins hold the
    same vertices.

    Between pins they change as gently as they can (harmonically), and nowhere beyond the pins' own. Pins that
    are off hold nothing; parts without pins stay as they are in `depths` (n,). Raises native.SolveError.
    """
    on = [holder for holder in holders if holder.pin.enabled]
    if not on:
        return depths
    rows = [_held_by(holder, cutout) for holder in on]
    wanted = np.array([asked.get(holder.pin.key, depth_of(holder, depths)) for holder in on])
    rest, triangles = cutout.rest, cutout.triangles
    shares = solver_cache.kept(
        ("depths", key), (triangles, rest, *rows), lambda: _shares(rest, triangles, rows)
    )
    among = is_of(cutout.parts, set(cutout.parts[np.concatenate(rows)].tolist()))
    return np.where(among, np.einsum("pn,p->n", shares, wanted), depths)


def _held_by(holder: Holder, cutout: Cutout) -> Indices:
    """The vertices that have the depth of a pin."""
    triangles, weights = holder.handle_vertices()
    held: Indices = np.unique(cutout.triangles[triangles][weights > HELD])
    return held


def _shares(rest: Array, triangles: Indices, rows: Sequence[Indices]) -> Array:
    """How much each of p pins, which hold these vertices, has of the depth of each of n (p x n)."""
    held, places = np.unique(np.concatenate(rows), return_inverse=True)
    pins = np.repeat(np.arange(len(rows)), [len(one) for one in rows])
    holding = np.zeros((len(rows), len(held)))
    holding[pins, places] = 1.0
    harmonic = native.Harmonic(rest, triangles, held.astype(np.int32))
    return np.stack([harmonic.spread(share) for share in holding / holding.sum(axis=0)])
