# SPDX-License-Identifier: GPL-3.0-or-later
"""The path and the timing of one pin on its way from one pose to the next."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..plane.frame import Array

# As Blender wants an enum's items.
KINDS = (
    ("STRAIGHT", "Straight", "On a straight line"),
    ("ARC", "Arc", "On the circular arc that belongs to the turn of the drawing at the pin"),
    ("CURVE", "Curve", "Along a curve object, whose ends are brought to where the pin is in the two poses"),
)
EASES = (
    ("LINEAR", "As the Pose", "The same share of its way as the rest of the drawing"),
    ("EASE", "Ease", "Slow out of the pose and slow into the next"),
    ("EASE_IN", "Ease In", "Slow out of the pose, fast into the next"),
    ("EASE_OUT", "Ease Out", "Fast out of the pose, slow into the next"),
)
_PIECES = 24  # of a Bezier segment: an arc of 90 degrees is off by 0.06 % of its radius at most
_STRAIGHT = 1e-6  # radians: an arc that is flatter is a line
CLOSED = 1e-3  # of the length of a line: its ends are one


@dataclass(frozen=True, eq=False)
class PinPath:
    """How a pin goes."""

    kind: str  # of KINDS
    ease: str  # of EASES
    line: Array | None = None  # m x 2, of a curve, from its begin to its end in the drawing's plane

    def at(self, start: Array, end: Array, turn: float, shares: Array) -> Array:
        """Where the pin is, f x 2, at shares of the way from `start` to `end`.

        `turn` is that of the drawing at the pin, for arcs. A closed curve leads only to where it began.
        """
        u = eased(self.ease, shares)
        begin, way = complex(*start), complex(*(end - start))
        if self.kind == "CURVE":
            assert self.line is not None  # planning gives curves one
            run = _evenly(self.line, u)
            if is_closed(self.line):
                place = begin + run - _begin(self.line) + u * way
            else:
                chord = complex(*(self.line[-1] - self.line[0]))
                place = begin + (run - _begin(self.line)) * (way / chord)
        elif self.kind == "ARC" and abs(turn) > _STRAIGHT:
            place = begin + way * (np.exp(1j * turn * u) - 1.0) / (np.exp(1j * turn) - 1.0)
        else:
            place = begin + u * way
        return np.stack([place.real, place.imag], axis=1)


def bezier(before: Array, points: Array, behind: Array, *, closed: bool) -> Array:
    """Points along a Bezier curve of control points and the handles before and behind them, k x 3 each."""
    begin = np.arange(len(points) if closed else len(points) - 1)
    end = (begin + 1) % max(len(points), 1)
    t = (np.arange(_PIECES) / _PIECES)[:, None]
    corners = points[begin], behind[begin], before[end], points[end]
    shares = (1.0 - t) ** 3, 3.0 * t * (1.0 - t) ** 2, 3.0 * t * t * (1.0 - t), t**3
    pieces = sum(share * corner[:, None] for share, corner in zip(shares, corners, strict=True))
    return np.concatenate([np.reshape(pieces, (-1, points.shape[1])), points[:1] if closed else points[-1:]])


def _begin(line: Array) -> complex:
    """Where a line begins."""
    return complex(*line[0])


def eased(ease: str, shares: Array) -> Array:
    """The share of the way that is done at a share of the time."""
    if ease == "EASE":
        return shares * shares * (3.0 - 2.0 * shares)
    if ease == "EASE_IN":
        return shares * shares
    late: Array = shares * (2.0 - shares) if ease == "EASE_OUT" else shares
    return late


def is_closed(line: Array) -> bool:
    """Whether a line ends where it begins."""
    length = np.hypot(*np.diff(line, axis=0).T).sum()
    return bool(np.hypot(*(line[-1] - line[0])) <= CLOSED * length)


def turn_of(before: Array, after: Array) -> float:
    """The turn (radians, the shorter way round) that takes points nearest to where they are afterwards."""
    arms = before - before.mean(axis=0), after - after.mean(axis=0)
    one, other = (points[:, 0] + 1j * points[:, 1] for points in arms)
    return float(np.angle((one.conj() * other).sum()))


def _evenly(line: Array, shares: Array) -> NDArray[np.complex128]:
    """Points of a line, complex, at shares of its length."""
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    at = shares * lengths[-1]
    found: NDArray[np.complex128] = line @ [1.0, 1.0j]
    return np.asarray(np.interp(at, lengths, found), complex)
