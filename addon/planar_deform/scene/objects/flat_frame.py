# SPDX-License-Identifier: GPL-3.0-or-later
"""The plane in which the faces of a mesh lie, or why there is none."""

from __future__ import annotations

import numpy as np

from ...errors import Refusal
from ...model.plane.cutout import diagonal_of
from ...model.plane.frame import Array, Indices, Mask, PlaneFrame, plane_frame
from .flat_object import FLATNESS, unevenness


def flat_frame(
    points: Array,
    world: Array,
    triangles: Indices,
    parts: Indices,
    linear: Array,
    subject: str,
    known: Mask | None = None,
) -> PlaneFrame:
    """The frame of points whose parts lie in parallel planes. Raises Refusal where they do not."""
    if known is not None and not known.all():
        triangles = (np.cumsum(known) - 1)[triangles[known[triangles].all(axis=1)]]
        points, world, parts = points[known], world[known], parts[known]
    return plane_of(points, world, triangles, parts, linear, subject, FLATNESS)


def plane_of(
    points: Array,
    world: Array,
    triangles: Indices,
    parts: Indices,
    linear: Array,
    subject: str,
    flatness: float,
) -> PlaneFrame:
    """The same of all the points, which may leave their planes by a share of the diagonal. Raises Refusal."""
    frame = plane_frame(points, parts, triangles, linear)
    if frame is None:
        raise Refusal(f"{subject} not cover any area: give the drawing some, or use Set as Rest")
    if unevenness(frame, world, parts) > flatness * diagonal_of(world):
        raise Refusal(not_flat(subject))
    return frame


def not_flat(subject: str) -> str:
    """Why what is told by the subject and a verb is no cutout, and what to do."""
    return (
        f"{subject} not lie in parallel planes: flatten the mesh (scale it to 0 along its normal), "
        "then use Set as Rest"
    )
