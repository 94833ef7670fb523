# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins that in-betweens hold on their way from pose to pose."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypedDict

import numpy as np

from ... import native
from ..plane.frame import Array, Indices, Mask
from .pin_path import PinPath, turn_of

NEAR = 0.05  # of the diagonal: what of the drawing tells how much it turns at a pin


@dataclass(frozen=True, eq=False)
class HeldPin:
    """A pin by what it holds of a drawing."""

    key: int  # its index in the object's pin list
    triangles: Indices  # (k,) of its handles: points in triangles
    corners: Indices  # k x 3, vertices of these
    weights: Array  # k x 3, barycentric
    parts: Indices  # (k,) of the handles
    vertices: list[Indices]  # of its group, for each part

    def places(self, positions: Array) -> Array:
        """Its handles (k x 2) on n x 2 positions."""
        places: Array = np.einsum("kc,kcd->kd", self.weights, positions[self.corners])
        return places

    def middle(self, positions: Array) -> Array:
        """Where it is (2,) on n x 2 positions."""
        middle: Array = self.places(positions).mean(axis=0)
        return middle

    def stands(self, before: Array, after: Array, near: float) -> bool:
        """Whether it is in the same place in both shapes, but for a gap. One on several parts is, in each."""
        ways = self.places(after) - self.places(before)
        gaps = [np.linalg.norm(ways[self.parts == part].mean(axis=0)) for part in np.unique(self.parts)]
        return bool(max(gaps) <= near)

    def turn(self, rest: Array, parts: Indices, before: Array, after: Array) -> float:
        """How far (radians) the drawing turns at it, the shorter way round."""
        near = NEAR * float(np.hypot(*np.ptp(rest, axis=0)))
        about = np.hypot(*(rest - self.middle(rest)).T) <= near
        rows = np.union1d(np.flatnonzero(about & np.isin(parts, self.parts)), self.corners)
        return turn_of(before[rows], after[rows])


class PinnedOptions(TypedDict, total=False):
    """As native.Inbetweens takes pins."""

    pins: tuple[Indices, Array]
    pin_groups: Indices
    pinned: Mask


@dataclass(frozen=True, eq=False)
class Guide:
    """The path of a pin from one key to the next."""

    path: PinPath
    handles: Indices  # its rows, of all handles
    start: Array  # (2,)
    end: Array
    turn: float


@dataclass(frozen=True, eq=False)
class GuidedMotion:
    """A motion whose pins go on paths."""

    motion: native.Inbetweens
    times: Sequence[float]  # of the keys
    guides: Mapping[int, Sequence[Guide]]  # by the transition
    handles: Sequence[HeldPin]

    def at(self, times: Sequence[float] | Array, *, overshoot: bool = False) -> Array:
        """Positions f x n x 2. Beyond the poses all pins go on as they do by themselves."""
        asked = np.asarray(times, float)
        paths = np.full((len(asked), sum(len(pin.triangles) for pin in self.handles), 2), np.nan)
        for transition, guides in self.guides.items():
            before, after = self.times[transition : transition + 2]
            rows = np.flatnonzero((asked > before) & (asked < after))
            if not len(rows):
                continue
            shares = (asked[rows] - before) / (after - before)
            for guide in guides:
                ways = guide.path.at(guide.start, guide.end, guide.turn, shares)
                paths[np.ix_(rows, guide.handles)] = ways[:, None]
            patches = [guide for guide in guides if len(guide.handles) > 1]
            if patches:  # which turn on their path as they do without it
                free = self.motion.at(asked[rows])
                places = np.concatenate(
                    [[pin.places(shape) for shape in free] for pin in self.handles], axis=1
                )
                for guide in patches:
                    arms = places[:, guide.handles]
                    paths[np.ix_(rows, guide.handles)] += arms - arms.mean(axis=1, keepdims=True)
        guided = np.isfinite(paths).any()
        return self.motion.at(times, overshoot=overshoot, pin_paths=paths if guided else None)


def pinned(pins: Sequence[HeldPin], held: Sequence[Sequence[bool]]) -> PinnedOptions:
    """Pins, and which of them are held in each transition."""
    counts = [len(pin.triangles) for pin in pins]
    flags: Mask = np.repeat(np.array(held, bool), counts, axis=1)
    groups = np.repeat(np.arange(len(pins), dtype=np.int32), counts)
    handles = np.concatenate([pin.triangles for pin in pins]), np.concatenate([pin.weights for pin in pins])
    return {"pins": handles, "pin_groups": groups, "pinned": flags}
