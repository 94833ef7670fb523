# SPDX-License-Identifier: GPL-3.0-or-later
"""The outline and the edges of cutouts that have just been made, shown while settings can be changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ...model.plane.connectivity import unique_edges
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
    meshes: tuple[tuple[str, int, int], ...] = ()  # an object's name, its identity and its mesh's, for each


_now: Preview | None = None


def of(cuts: Sequence[Cut], operator: str) -> Preview:
    """What there will be to see of cutouts, where their planes are still."""
    points, edges, outline, first = [], [], [], 0
    for made in cuts:
        world = np.array(made.plane.resolve().matrix_world, np.float64)
        local = places(made.plane, made.drawing).astype(np.float64)
        points.append(local @ world[:3, :3].T + world[:3, 3])
        sides = made.drawing.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        edges.append(first + unique_edges(sides))
        outline += [first + np.stack([ring, np.roll(ring, -1)], axis=1) for ring in made.drawing.rings]
        first += len(local)
    return Preview(
        np.concatenate(points).astype(np.float32),
        np.concatenate(edges).astype(np.int32),
        np.concatenate(outline).astype(np.int32),
        operator,
    )


def show(preview: Preview, objects: Sequence[bpy.types.Object]) -> None:
    """Show it from when the operator is done until anything else is, or its objects are gone."""
    global _now
    meshes = tuple((obj.name, obj.session_uid, obj.data.session_uid) for obj in objects)
    _now = replace(preview, meshes=meshes)
    redraw.views()


def now(context: bpy.types.Context) -> Preview | None:
    """What is to be drawn: nothing, once another operator has done something, or the objects are gone."""
    if _now is None or not all(_is_there(context, *mesh) for mesh in _now.meshes):
        return None
    done = context.window_manager.operators
    return _now if done and done[-1].bl_idname == _now.operator else None


def _is_there(context: bpy.types.Context, name: str, identity: int, mesh: int) -> bool:
    obj = context.view_layer.objects.get(name)
    return obj is not None and obj.session_uid == identity and obj.data.session_uid == mesh


def forget() -> None:
    """Show nothing any more."""
    global _now
    _now = None
