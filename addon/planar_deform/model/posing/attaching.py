# SPDX-License-Identifier: GPL-3.0-or-later
"""Finding which parts of a drawing lie on each other at rest, and where joints hang them together."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..plane.carrying import boundary
from ..plane.cutout import Cutout, signed_areas
from ..plane.frame import Array, Indices, Mask

SAMPLES = 48  # along the longer side of the box in which two parts lie on each other
LEAST = 1e-5  # of the squared diagonal: parts that share less only touch
# A place this deep in both parts is as good as the deepest one. Of these, those farthest from what of
# the part lies free, up to this share of the depth, are at the root of the limb, half its width from its end.
DEEP, ROOT = 0.8, 0.5
# A part of which this much lies on one that is so many times as large, an eye or a button, turns on nothing.
COVERED, SMALL = 0.95, 10.0
# Parts that share this much of the larger one lie along each other, as two legs seen from the side do.
PAIR = 0.35
SAME_LAYER = 1e-4  # of the diagonal: parts that are as near in depth are of one layer


@dataclass(frozen=True)
class Overlap:
    """Where two parts lie on each other at rest."""

    parts: tuple[int, int]
    area: float
    places: Array  # k x 2, samples of it
    depths: Array  # k, how far each is from the nearest edge of either


@dataclass(frozen=True)
class Attachment:
    """A joint that is to be made."""

    carrier: int  # the part that the other hangs on
    carried: int
    place: Array  # (2,) at rest
    rigid: bool


def overlaps(cutout: Cutout) -> list[Overlap]:
    """All pairs of parts that lie on each other at rest, in the order of their parts."""
    edges = [_edges(cutout, part) for part in range(int(cutout.parts.max(initial=-1)) + 1)]
    found = []
    for one, other in itertools.combinations(range(len(edges)), 2):
        if len(edges[one]) and len(edges[other]):
            overlap = _overlap((one, other), edges[one], edges[other])
            if overlap is not None and overlap.area > LEAST * cutout.diagonal**2:
                found.append(overlap)
    return found


def attachments(
    cutout: Cutout, depths: Array | None = None, joined: Iterable[tuple[int, int]] = ()
) -> list[Attachment]:
    """What is to be joined so that all parts that lie on each other hang together, each on one other.

    Parts that lie on several hang on the one that they share most with; a layer between the two, told by the
    `depths` of the parts, counts as much as half of what they share: a hand before the tail does not hang on
    it, but on the body. Two legs that lie along each other, as seen from the side, hang on one another only
    where nothing else carries them. `joined`: parts that are already.
    """
    layers = np.zeros(int(cutout.parts.max(initial=-1)) + 1)
    if depths is not None:
        layers = np.unique(np.round(depths / (SAME_LAYER * cutout.diagonal)), return_inverse=True)[1]

    areas = _areas(cutout)

    def shared(overlap: Overlap) -> tuple[bool, float]:
        one, other = overlap.parts
        between = max(1, abs(int(layers[one]) - int(layers[other])))
        return overlap.area < PAIR * max(areas[one], areas[other]), overlap.area / between

    tree: Indices = np.arange(len(areas), dtype=np.int32)  # equal: they hang together

    def join(one: int, other: int) -> bool:
        if tree[one] == tree[other]:
            return False
        tree[tree == tree[other]] = tree[one]
        return True

    hung: dict[int, list[int]] = {part: [] for part in range(len(areas))}
    for one, other in joined:
        join(one, other)
        hung[one].append(other)
        hung[other].append(one)
    chosen = {}
    for overlap in sorted(overlaps(cutout), key=shared, reverse=True):
        one, other = overlap.parts
        if join(one, other):
            chosen[overlap.parts] = overlap
            hung[one].append(other)
            hung[other].append(one)
    found, reached = [], set()
    for root in np.argsort(-areas, kind="stable").tolist():
        waiting = [root] if root not in reached else []
        while waiting:
            carrier = waiting.pop(0)
            reached.add(carrier)
            for carried in hung[carrier]:
                if carried not in reached:
                    waiting.append(carried)
                    found_there = chosen.get((min(carrier, carried), max(carrier, carried)))
                    if found_there is not None:
                        found.append(_attachment(cutout, carrier, carried, found_there, areas))
    return found


def hanging_place(cutout: Cutout, first: int) -> Array | None:
    """Where (2,) the parts from this number on hang on those before them, as one.

    None where these do not lie on each other at rest.
    """
    across = [overlap for overlap in overlaps(cutout) if overlap.parts[0] < first <= overlap.parts[1]]
    if not across:
        return None
    most = max(across, key=lambda overlap: overlap.area)
    return _attachment(cutout, *most.parts, most, _areas(cutout)).place


def _attachment(cutout: Cutout, carrier: int, carried: int, overlap: Overlap, areas: Array) -> Attachment:
    covered = overlap.area >= COVERED * areas[carried]
    deepest = float(overlap.depths.max())
    deep = overlap.places[overlap.depths >= DEEP * deepest]
    chosen = overlap.places
    if not covered:
        free, middle = _free_middle(cutout, carried, overlap, areas), overlap.places.mean(axis=0)
        inwards = (deep - free) @ (middle - free) / np.linalg.norm(middle - free)
        chosen = deep[inwards >= inwards.max() - ROOT * deepest]
    place = deep[((deep - chosen.mean(axis=0)) ** 2).sum(axis=1).argmin()]
    return Attachment(carrier, carried, place, covered and areas[carrier] >= SMALL * areas[carried])


def _free_middle(cutout: Cutout, part: int, overlap: Overlap, areas: Array) -> Array:
    """The middle (2,) of what of a part does not lie on the other."""
    triangles = cutout.triangles[cutout.parts[cutout.triangles[:, 0]] == part]
    weights: Array = np.abs(signed_areas(cutout.rest, triangles))
    whole = weights @ cutout.rest[triangles].mean(axis=1)
    middle: Array = (whole - overlap.area * overlap.places.mean(axis=0)) / (areas[part] - overlap.area)
    return middle


def _areas(cutout: Cutout) -> Array:
    """Of each part."""
    areas = np.zeros(int(cutout.parts.max(initial=-1)) + 1)
    np.add.at(
        areas, cutout.parts[cutout.triangles[:, 0]], np.abs(signed_areas(cutout.rest, cutout.triangles))
    )
    return areas


def _edges(cutout: Cutout, part: int) -> Array:
    """The edges (e x 2 x 2) along the boundary of a part at rest: those of one triangle alone."""
    triangles = cutout.triangles[cutout.parts[cutout.triangles[:, 0]] == part]
    ends: Array = cutout.rest[boundary(triangles)[0]]
    return ends


def _overlap(parts: tuple[int, int], one: Array, other: Array) -> Overlap | None:
    low = np.maximum(one.min(axis=(0, 1)), other.min(axis=(0, 1)))
    high = np.minimum(one.max(axis=(0, 1)), other.max(axis=(0, 1)))
    if (high <= low).any():
        return None
    cell = float((high - low).max()) / SAMPLES
    counts = np.maximum(np.ceil((high - low) / cell).astype(int), 1)
    steps = (high - low) / counts
    x, y = (
        start + step * (np.arange(count) + 0.5) for start, step, count in zip(low, steps, counts, strict=True)
    )
    rows, columns = np.nonzero(_inside(one, x, y) & _inside(other, x, y))
    if not len(rows):
        return None
    places = np.stack([x[columns], y[rows]], axis=1)
    depths = np.minimum(_distances(places, one), _distances(places, other))
    return Overlap(parts, len(places) * float(steps[0] * steps[1]), places, depths)


def _inside(edges: Array, x: Array, y: Array) -> Mask:
    """Which points of a grid (rows of y, columns of x) lie within edges, those in holes do not."""
    (ax, ay), (bx, by) = edges[:, 0].T, edges[:, 1].T
    found = np.zeros((len(y), len(x)), bool)
    for row, height in enumerate(y):
        crosses = (ay <= height) != (by <= height)
        share = (height - ay[crosses]) / (by[crosses] - ay[crosses])
        at = np.sort(ax[crosses] + share * (bx[crosses] - ax[crosses]))
        found[row] = np.searchsorted(at, x) % 2 == 1
    return found


def _distances(places: Array, edges: Array) -> Array:
    """Of places (k x 2) from the nearest of edges."""
    starts, sides = edges[:, 0], edges[:, 1] - edges[:, 0]
    lengths = np.maximum((sides**2).sum(axis=1), np.finfo(float).tiny)
    nearest = np.full(len(places), np.inf)
    for start, side, length in zip(starts, sides, lengths, strict=True):
        from_start = places - start
        share = np.clip(from_start @ side / length, 0.0, 1.0)
        nearest = np.minimum(nearest, ((from_start - share[:, None] * side) ** 2).sum(axis=1))
    distances: Array = np.sqrt(nearest)
    return distances
