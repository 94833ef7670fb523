# SPDX-License-Identifier: GPL-3.0-or-later
"""The affine map that took a whole shape to what it is now: an applied transform, a moved origin."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .frame import Array, Array32, Mask, frame_across, mapped

ROUNDING = 16 * 2.0**-23  # of the largest coordinate: what float32 arithmetic may have left
FLAT = 1e-5  # of the largest extent: what is thinner has no extent in that direction
ROUNDS = 12  # of leaving out what fits worst
STARTS = 24  # from a few points each, where those rounds find nothing
SAMPLE = 400  # points among which is looked


@dataclass(frozen=True)
class Affine:
    """x -> linear x + offset, of points (3,)."""

    linear: Array  # 3 x 3
    offset: Array  # (3,)

    def of(self, points: Array | Array32) -> Array:
        """Where it takes k x 3 points."""
        moved: Array = mapped(np.asarray(points, np.float64), self.linear) + self.offset
        return moved

    def turns_over(self, shape: Array32) -> bool:
        """Whether the plane of a flat shape (n x 3) is seen mirrored afterwards, along the object's axes."""
        before, after = _plane_axes(shape), _plane_axes(self.of(shape))
        return bool(np.linalg.det(after @ self.linear @ before.T) < 0.0)


def affine_between(before: Array32, after: Array32) -> Affine | None:
    """The map that took n x 3 coordinates to what they are now; None where there is none, or nothing moved.

    It has to explain more than half of them, to rounding, and all that have not moved: what else was edited
    is left out, but an edit of a part of the shape is no map of the whole.
    """
    start, end = before.astype(np.float64), after.astype(np.float64)
    stays = (before == after).all(axis=1)
    if stays.all() or not (np.isfinite(start).all() and np.isfinite(end).all()):
        return None
    if stays.any() and _directions(start[stays]) == _directions(start):
        return None  # only what does nothing leaves all these where they were
    for found in _candidates(start, end):
        explained = _misses(found, start, end)[1]
        if 2 * np.count_nonzero(explained) > len(start) and explained[stays].all():
            return _fitted(start[explained], end[explained]) or found
    return None


def _candidates(start: Array, end: Array) -> Iterator[Affine]:
    """Maps of all the points, of those that fit best, and of a few; looked for among SAMPLE of them."""
    draw = np.random.default_rng(0)
    found = _fitted(start, end)
    if found is None:
        return
    yield found
    if len(start) > SAMPLE:
        sample = draw.choice(len(start), SAMPLE, replace=False)
        start, end = start[sample], end[sample]
    for _ in range(ROUNDS):
        misses = _misses(found, start, end)[0]
        best = misses <= np.median(misses)
        found = _fitted(start[best], end[best])
        if found is None:
            break
        yield from _promising(found, start, end)
    for _ in range(STARTS):
        chosen = draw.choice(len(start), min(6, len(start)), replace=False)
        found = _fitted(start[chosen], end[chosen])
        if found is not None:
            yield from _promising(found, start, end)


def _promising(found: Affine, start: Array, end: Array) -> Iterator[Affine]:
    """The map of what a map explains of a sample, if that is enough to look at all the points."""
    explained = _misses(found, start, end)[1]
    if 5 * np.count_nonzero(explained) > 2 * len(start):
        yield _fitted(start[explained], end[explained]) or found


def _misses(found: Affine, start: Array, end: Array) -> tuple[Array, Mask]:
    misses = np.abs(found.of(start) - end).max(axis=1)
    reach = mapped(np.abs(start), np.abs(found.linear)) + np.abs(found.offset)
    return misses, misses <= ROUNDING * max(reach.max(), np.abs(end).max())


def _fitted(start: Array, end: Array) -> Affine | None:
    """The least squares map of k x 3 points; across a plane lengths become what they become along it."""
    centre, goal = start.mean(axis=0), end.mean(axis=0)
    arms = start - centre
    extents, axes = np.linalg.eigh(mapped(arms.T, arms.T))
    spread = extents > FLAT**2 * extents[-1]
    if not spread[1] or extents[-1] <= 0.0:
        return None  # on a line
    images = mapped((end - goal).T, arms.T) @ axes[:, spread] / extents[spread]
    linear = images @ axes[:, spread].T
    if not spread[0]:
        across = np.cross(linear @ axes[:, 1], linear @ axes[:, 2])
        size = np.sqrt(np.linalg.norm(across))
        if size > 0.0:
            linear += np.outer(across / size, np.cross(axes[:, 1], axes[:, 2]))
    return Affine(linear, goal - linear @ centre)


def _directions(points: Array) -> int:
    """In how many directions k x 3 points extend."""
    arms = points - points.mean(axis=0)
    extents = np.linalg.eigvalsh(mapped(arms.T, arms.T))
    return int(np.count_nonzero(extents > FLAT**2 * max(extents[-1], np.finfo(float).tiny)))


def _plane_axes(points: Array | Array32) -> Array:
    """The axes (2 x 3) along which a flat shape is seen, see frame_across()."""
    arms = points - points.mean(axis=0)
    frame = frame_across(np.linalg.svd(arms.T @ arms)[2][2].astype(np.float64), np.eye(3))
    return np.stack([frame.u, frame.v])
