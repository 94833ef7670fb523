# SPDX-License-Identifier: GPL-3.0-or-later
"""The outline and the edges of cutouts that have just been made, shown while settings can be changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ...model.plane.frame import Array32, Indices
from ..storage import redraw
from .cutout_mesh import places
from .cutting import Cut


@dataclass(frozen=True, eq=False)
class Preview:
    """What there is to draw of some cutouts."""

    points: Array32  # n x 3 in the world
    edges: Indices  # e x 2
    outline: Indices  # o x 2, those of the edges that have a triangle on one side only
    operator: str  # that made them


_now: Preview | None = None


def show(context: bpy.types.Context, cuts: Sequence[Cut], operator: str) -> None:
    """Show these from when the operator is done until anything else is."""
    global _now
    points, edges, outline, first = [], [], [], 0
    for made in cuts:
        world = np.array(made.plane.resolve().matrix_world, np.float64)
        local = places(made.plane, made.drawing).astype(np.float64)
        points.append(local @ world[:3, :3].T + world[:3, 3])
        edges.append(first + _edges(made.drawing.triangles))
        outline += [first + np.stack([ring, np.roll(ring, -1)], axis=1) for ring in made.drawing.rings]
        first += len(local)
    _now = Preview(
        np.concatenate(points).astype(np.float32),
        np.concatenate(edges).astype(np.int32),
        np.concatenate(outline).astype(np.int32),
        operator,
    )
    redraw.views()


def now(context: bpy.types.Context) -> Preview | None:
    """What is to be drawn: nothing, once another operator has done something."""
    if _now is None:
        return None
    done = context.window_manager.operators
    return _now if done and done[-1].bl_idname == _now.operator else None


def forget() -> None:
    """Show nothing any more."""
    global _now
    _now = None


def _edges(triangles: Indices) -> Indices:
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    found: Indices = np.unique(sides, axis=0)
    return found
