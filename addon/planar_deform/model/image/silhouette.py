# SPDX-License-Identifier: GPL-3.0-or-later
"""The outline of a flat mesh filled with an even mesh, as an image's art is.

The mesh is drawn as an image that is shrunk by just what native.cutout() stays away from art, so that the
outline ends where it was, however often this is done. Parts as thin as that are kept, too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ... import native
from ..plane.cutout import signed_areas
from ..plane.frame import Array, Indices, Mask
from ..work import Progress
from .filling import Filling, Piece

SAMPLES = 1000  # along the longer side: native.cutout() works on up to 1024
FEWEST = 96  # of a small part
FEWEST_EDGES = 3.0  # along it
PER_EDGE = 66.0  # samples: finer ones tell nothing of an outline that so long edges follow
AWAY = 2.0  # samples: what native.cutout() stays away from art at least
# Of an edge, where that is more: its straight lines leave the outline by nearly as much. With more, tips grow
# and close the notches beside them; with less, 500 vertices are not enough for any character.
SIMPLER = 1.0 / 11.0
GAP = 1.0  # samples: notches narrower than twice this are closed
PAD = 6  # samples around
ROUNDED = 0.5  # of the way that the image is shrunk: what a right angle, or a wider one, may lose
STEP = 0.5  # samples between the points of the outline from which distances are measured
ATTEMPTS = 3
NEAR_WISH, NEAR_ENOUGH = 0.1, 0.25  # of the wished vertices: to try no more, and to say nothing
COVERED = 0.85  # of its triangles' areas: what covers less lies over itself
EVEN = 1.155  # area of the two triangles that an inner vertex has, in squared edges


class Overlap(Exception):  # noqa: N818 - a reason, as a Refusal is
    """A part lies over itself, so that its outline is not that of its triangles."""


@dataclass(frozen=True)
class Wish:
    """How fine a mesh is to be. Lengths are the plane's."""

    vertices: int = 1500
    edge: float | None = None  # counts instead
    grown: float = 0.0  # how far the outline goes out: then it may be simpler
    finest: float = 6.0
    fill: bool = False  # holes


def refilled(rest: Array, triangles: Indices, parts: Indices, wish: Wish, progress: Progress) -> Filling:
    """Even meshes with the outlines that the parts (n,) of a mesh have at rest, n x 2.

    `triangles` m x 3 are counter-clockwise. Raises Overlap, native.Cancelled and native.SolveError.
    """
    sizes = np.abs(signed_areas(rest, triangles))
    edge = wish.edge or float(np.sqrt(EVEN * sizes.sum() / wish.vertices))
    of_part = parts[triangles[:, 0]]
    pieces = [triangles[of_part == part] for part in range(int(parts.max()) + 1)]
    attempts = 1 if wish.edge is not None else ATTEMPTS
    best: list[tuple[Array, Indices]] = []
    for attempt in range(attempts):
        found = []
        for number, piece in enumerate(pieces):
            begun = (attempt + number / len(pieces)) / attempts
            if not progress(begun):
                raise native.Cancelled
            found.append(_filled(rest, piece, edge, wish))
        count = sum(len(points) for points, _ in found)
        if not best or _off(count, wish) < _off(sum(len(points) for points, _ in best), wish):
            best = found
        if wish.edge is not None or _off(count, wish) < np.log(1.0 + NEAR_WISH):
            break
        edge *= float(np.sqrt(count / wish.vertices))
    pieces_found = [Piece(points, cells, np.array([part])) for part, (points, cells) in enumerate(best)]
    return Filling(pieces_found, _said(sum(len(points) for points, _ in best), wish))


def _off(count: int, wish: Wish) -> float:
    return abs(float(np.log(count / wish.vertices)))


def _said(count: int, wish: Wish) -> tuple[str, ...]:
    if wish.edge is not None or _off(count, wish) <= np.log(1.0 + NEAR_ENOUGH):
        return ()
    return (
        (f"this outline needs {count} vertices; with a margin it may be simpler",)
        if count > wish.vertices
        else (f"this outline has room for {count} vertices",)
    )


def _filled(rest: Array, triangles: Indices, edge: float, wish: Wish) -> tuple[Array, Indices]:
    """One part: points k x 2 and triangles."""
    edges = contour(triangles)
    low = rest[triangles].min(axis=(0, 1))
    extent = float((rest[triangles].max(axis=(0, 1)) - low).max())
    edge = min(edge, extent / FEWEST_EDGES)
    samples = float(np.clip(PER_EDGE * extent / edge, FEWEST, SAMPLES))
    scale = samples / extent
    pad = PAD + int(np.ceil(SIMPLER * edge * scale + wish.grown * scale))
    ends = (rest[edges] - low) * scale + pad
    away = max(AWAY, SIMPLER * edge * scale)
    alpha = shrunk(ends, away)
    found = native.cutout(
        alpha.astype(np.uint8) * 255,
        edge=edge * scale,
        margin=away + wish.grown * scale,
        rounding=GAP,
        holes="FILL" if wish.fill else "KEEP",
        smallest=0.0,
        finest=wish.finest,
    )
    points = (found.points - pad) / scale + low
    area = float(np.abs(signed_areas(rest, triangles)).sum())
    if float(signed_areas(points, found.triangles).sum()) < COVERED * area:
        raise Overlap
    return points, found.triangles


def shrunk(ends: Array, away: float = AWAY) -> Mask:
    """The samples of an image within an outline and `away` from it, and those that keep thin parts and tips.

    `ends`: the edges of the outline, k x 2 x 2 in samples from the lower left corner, the inside on the left.
    """
    width, height = np.ceil(ends.max(axis=(0, 1))).astype(int) + PAD + int(away)
    inside, distances = covered(ends, height, width), _distances(ends, height, width, away)
    if not inside.any():  # thinner than a sample
        inside = distances <= 1.0
    core = inside & (distances > away)
    lost = inside & ~_grown(core, (1.0 + ROUNDED) * away + 1.0)
    return core | lost


def contour(triangles: Indices) -> Indices:
    """The edges k x 2 round counter-clockwise triangles: what has a triangle on either side cancels."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    ends, inverse = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    net = np.bincount(inverse.ravel(), weights=np.where(edges[:, 0] < edges[:, 1], 1.0, -1.0))
    directed = np.where((net > 0.0)[:, None], ends, ends[:, ::-1])
    return np.repeat(directed, np.abs(net).astype(int), axis=0).astype(np.int32)


def covered(ends: Array, height: int, width: int) -> Mask:
    """The samples round which an outline, see shrunk(), goes counter-clockwise."""
    (ax, ay), (bx, by) = ends[:, 0].T, ends[:, 1].T
    first = np.ceil(np.minimum(ay, by) - 0.5).astype(int)
    counts = np.ceil(np.maximum(ay, by) - 0.5).astype(int) - first
    edge = np.repeat(np.arange(len(ends)), counts)
    row = first[edge] + np.arange(len(edge)) - (np.cumsum(counts) - counts)[edge]
    x = ax[edge] + (row + 0.5 - ay[edge]) / (by - ay)[edge] * (bx - ax)[edge]
    turns = np.zeros((height, width), np.int32)
    np.add.at(turns, (row, np.ceil(x - 0.5).astype(int)), np.where(ay > by, 1, -1)[edge])
    return np.asarray(np.cumsum(turns, axis=1) > 0)


def _distances(ends: Array, height: int, width: int, away: float) -> Array:
    """The distance of each sample to the outline, exact to STEP/16 up to `away`, infinite beyond."""
    sides = ends[:, 1] - ends[:, 0]
    counts = np.maximum(np.ceil(np.linalg.norm(sides, axis=1) / STEP).astype(int), 1)
    edge = np.repeat(np.arange(len(ends)), counts)
    share = (np.arange(len(edge)) - (np.cumsum(counts) - counts)[edge]) / counts[edge]
    points = ends[edge, 0] + share[:, None] * sides[edge]
    cells = np.floor(points).astype(int)
    result = np.full((height, width), np.inf)
    for dx, dy in _disc(away + 1.0):
        column, row = cells[:, 0] + dx, cells[:, 1] + dy
        gap = np.hypot(column + 0.5 - points[:, 0], row + 0.5 - points[:, 1])
        np.minimum.at(result, (row, column), gap)
    return result


def _grown(mask: Mask, radius: float) -> Mask:
    """The samples within a distance of those of a mask, which leaves PAD free around it."""
    result = mask.copy()
    for dx, dy in _disc(radius):
        result |= np.roll(mask, (dy, dx), axis=(0, 1))
    return result


def _disc(radius: float) -> list[tuple[int, int]]:
    reach = range(-int(radius), int(radius) + 1)
    return [(x, y) for x in reach for y in reach if x * x + y * y <= radius * radius]
