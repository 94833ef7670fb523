# SPDX-License-Identifier: GPL-3.0-or-later
"""The affine map that took a whole shape to what it is now: an applied transform, a moved origin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .frame import Array, Array32, Mask, frame_across, mapped

ROUNDING = 16 * 2.0**-23  # of the largest coordinate: what float32 arithmetic may have left
FLAT = 1e-5  # of the largest extent: what is thinner has no extent in that direction
ROUNDS = 12  # of leaving out what fits worst
STARTS = 24  # from a few vertices each, where those rounds find nothing


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
    chosen = np.ones(len(start), bool)
    for _ in range(ROUNDS):
        misses, found = _try(start, end, chosen, stays)
        if found is not None:
            return found
        if misses is None:
            return None
        better = misses <= np.median(misses)
        if np.array_equal(better, chosen):
            break
        chosen = better
    draw = np.random.default_rng(0)
    for _ in range(STARTS if len(start) > 8 else 0):
        chosen = np.zeros(len(start), bool)
        chosen[draw.choice(len(start), 6, replace=False)] = True
        found = _try(start, end, chosen, stays)[1]
        if found is not None:
            return found
    return None


def _try(start: Array, end: Array, chosen: Mask, stays: Mask) -> tuple[Array | None, Affine | None]:
    """How far the map of the chosen points misses each, and the map of all that it explains if that will do."""
    found = _fitted(start[chosen], end[chosen])
    if found is None:
        return None, None
    misses, explained = _misses(found, start, end)
    if 2 * np.count_nonzero(explained) <= len(start) or not explained[stays].all():
        return misses, None
    best = _fitted(start[explained], end[explained])
    return misses, found if best is None else best


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
