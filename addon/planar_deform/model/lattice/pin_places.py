# SPDX-License-Identifier: GPL-3.0-or-later
"""Where pins on what a flat lattice deforms are, told by its points: in-betweens let them stand.

For the solver each pin is one more point, joined to the corners of the cell in which it rests. It is solved
as if the grid were a mesh, of which the pin's true place is a little off: the lattice is led by that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ... import native
from ..plane.frame import Array, Indices
from ..posing.held_pins import GuidedMotion

LEAST_SHARE = 1e-3  # pins that follow the lattice less than this do not lead it


@dataclass(frozen=True, eq=False)
class PinPlaces:
    """Pins (k) of a lattice of N points: each is at its offset + shares · points."""

    keys: list[int]  # their indices in the object's pin list
    offsets: Array  # k x 2
    shares: Array  # k x N

    def of(self, points: Array) -> Array:
        """The places on N x 2 points, k x 2, or on f times as many."""
        places: Array = self.offsets + self.shares @ points
        return places

    def extended(self, points: Array) -> Array:
        """The points with the places behind them."""
        return np.concatenate([points, self.of(points)], axis=-2)

    def triangles(self, rest: Array, cells: Indices) -> Indices:
        """Those that join each place to the cell (m x 4 of N x 2 points at rest) whose middle is nearest."""
        middles = rest[cells].mean(axis=1)
        found = []
        for number, place in enumerate(self.of(rest), len(rest)):
            cell = cells[int(((middles - place) ** 2).sum(axis=1).argmin())]
            found.append(np.stack([np.full(4, number), cell, np.roll(cell, -1)], axis=1))
        joined: Indices = np.concatenate(found).astype(np.int32)
        return joined


@dataclass(frozen=True, eq=False)
class LedMotion:
    """The motion of the points alone, moved along so that the pins' mean is where the solver has it.

    Pins that are held are there each: the points change by as little as takes them there.
    """

    motion: native.Inbetweens | GuidedMotion  # of points and places
    places: PinPlaces
    times: Sequence[float]  # of the keys
    leading: Sequence[Indices]  # in each transition between them, pins by number
    held: Sequence[Indices]  # likewise

    def at(self, times: Sequence[float] | Array, *, overshoot: bool = False) -> Array:
        """Positions f x N x 2."""
        found = self.motion.at(times, overshoot=overshoot)
        count = self.places.shares.shape[1]
        points = found[:, :count]
        gaps = found[:, count:] - self.places.of(points)
        follows = self.places.shares.sum(axis=1)
        latest = np.searchsorted(self.times, times, "right") - 1
        for frame, transition in enumerate(np.clip(latest, 0, len(self.leading) - 1).tolist()):
            pins = self.leading[transition]
            share = follows[pins].mean()
            if share > LEAST_SHARE:
                points[frame] += gaps[frame, pins].mean(axis=0) / share
            pins = self.held[transition]
            pins = pins[follows[pins] > LEAST_SHARE]
            if len(pins):
                left = found[frame, count + pins] - self.places.of(points[frame])[pins]
                points[frame] += np.linalg.lstsq(self.places.shares[pins], left, rcond=None)[0]
        return np.ascontiguousarray(points)
