# SPDX-License-Identifier: GPL-3.0-or-later
"""What is to be generated between the poses of a sequence, and how it is solved."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ... import native
from ...model.lattice.pin_places import LedMotion, PinPlaces
from ...model.plane.frame import Array, Array32, Indices
from ...model.timing.order_of_time import Entry
from ...model.work import Progress
from ..objects.any_object import AnyObject
from . import joints

PLANTED = 1e-3  # of the diagonal: a pin that has moved less between two poses stands still
_SAMPLED = 0.1  # of the share of the work: sampling, after solving


@dataclass(frozen=True)
class Blend:
    """The straight way of points that nothing joins."""

    keys: Array  # K x n x 2
    times: list[float]

    def at(self, times: Sequence[float] | Array, *, overshoot: bool = False) -> Array:
        """Positions f x n x 2; before the first key and behind the last one these, or with `overshoot` on."""
        found = []
        for time in times:
            key = int(np.clip(np.searchsorted(self.times, time, "right") - 1, 0, len(self.times) - 2))
            start, end = self.times[key : key + 2]
            share = (time - start) / (end - start)
            share = share if overshoot else min(max(share, 0.0), 1.0)
            found.append(self.keys[key] + share * (self.keys[key + 1] - self.keys[key]))
        return np.stack(found)


@dataclass
class Plan:
    """What is to be generated: plain data, so that it can be solved in a thread."""

    drawing: AnyObject
    shapes: list[Array32]  # of the poses in the order of time, as stored
    keys: list[Array]  # the same n x 2
    rest: Array  # n x 2
    elements: native.Elements
    times: list[float]  # of the keys: frames, without those over which a pose is held
    counts: list[int]  # of each transition k -> k + 1: how many to generate
    turns: list[int]
    held: list[Indices]  # vertices of each pin in each part; those of `places` are behind the drawing's
    places: PinPlaces | None  # of a lattice's pins
    path: str  # "STRAIGHT" | "ARC"
    smooth: bool
    cage: int | None = None  # see storage/cage.py
    depths_held: bool = False  # depths are those of the pose before until the next one
    # For write(): the order of the blocks, which of them is the first key, the transitions whose generated
    # shapes stay, and what there was.
    entries: list[Entry] = field(default_factory=list)
    first: int = 0
    kept: set[int] = field(default_factory=set)
    starts: list[float] = field(default_factory=list)
    dropped: list[float] = field(default_factory=list)

    def among(self, chosen: Sequence[int]) -> Plan:
        """The way through some of the keys alone, for motion()."""
        turns = [sum(self.turns[before:after]) for before, after in itertools.pairwise(chosen)]
        return replace(
            self,
            shapes=[self.shapes[key] for key in chosen],
            keys=[self.keys[key] for key in chosen],
            times=[self.times[key] for key in chosen],
            turns=turns,
            counts=[0] * len(turns),
        )

    def motion(
        self, first: int = 0, last: int | None = None, progress: Progress | None = None
    ) -> native.Inbetweens | LedMotion | Blend:
        """The way through keys `first` to `last`, at their `times`. Raises SolveError, Cancelled."""
        last = len(self.keys) - 1 if last is None else last
        if not self.elements:
            return Blend(np.stack(self.keys[first : last + 1]), self.times[first : last + 1])
        anchors, joined = zip(*(self._holds(transition) for transition in range(first, last)), strict=True)
        motion = native.Inbetweens(
            np.stack([self._with_places(key) for key in self.keys[first : last + 1]]),
            **self.elements,
            rest=self._with_places(self.rest),
            key_times=self.times[first : last + 1],
            turns=np.array(self.turns[first:last], np.int32)[:, None],
            anchor=anchors,
            anchor_path="arc" if self.path == "ARC" else "straight",
            joints=joined,
            smooth=self.smooth,
            cage=self.cage,
            progress=progress,
        )
        if self.places is None:
            return motion
        leading = [anchor - len(self.rest) for anchor in anchors]
        return LedMotion(motion, self.places, self.times[first : last + 1], leading)

    def _with_places(self, shape: Array) -> Array:
        return shape if self.places is None else self.places.extended(shape)

    def solve(self, progress: Progress | None = None) -> list[Array]:
        """The generated positions, n x 2 each, in order. Raises SolveError and Cancelled."""
        found: list[Array] = []
        runs = self._runs()
        for number, (first, last) in enumerate(runs):

            def solved(share: float, number: int = number) -> bool:
                return progress is None or progress((number + (1.0 - _SAMPLED) * share) / len(runs))

            motion = self.motion(first, last, solved)
            for transition in range(first, last):
                if self.counts[transition]:
                    found += list(motion.at(self._sample_times(transition)))
                share = (transition + 1 - first) / (last - first)
                if progress is not None and not progress((number + share) / len(runs)):
                    raise native.Cancelled
        return found

    def coordinates(self, transition: int, share: float, positions: Array) -> Array32:
        """The shape that shows n x 2 positions at this share of a transition; below 0 and above 1, too.

        What the plane does not tell goes from one pose to the other in proportion; depths that are held jump.
        Raises Refusal beyond what Blender can store.
        """
        before, after = self.shapes[transition], self.shapes[transition + 1]
        blended = before * np.float32(1.0 - share) + after * np.float32(share)
        if self.depths_held:
            rows = self.drawing.vertex_indices
            blended[rows, :3] = (before if share < 1.0 else after)[rows, :3]
        return self.drawing.moved(blended, positions)

    def _holds(self, transition: int) -> tuple[Indices | None, Indices]:
        """The vertices whose mean moves on the path, and the joints of the parts, in a transition.

        Pins that stand still hold their parts; those parts that have none go by all their pins.
        """
        before, after = (self._with_places(key) for key in self.keys[transition : transition + 2])
        parts_of = self.drawing.parts
        if self.places is not None:  # all of a lattice is one part
            parts_of = np.zeros(len(before), np.int32)
        gaps = [np.linalg.norm(before[rows].mean(axis=0) - after[rows].mean(axis=0)) for rows in self.held]
        near = PLANTED * self.drawing.diagonal
        planted = [rows for rows, gap in zip(self.held, gaps, strict=True) if gap <= near]
        parts = {int(parts_of[rows[0]]) for rows in planted}
        chosen = planted + [rows for rows in self.held if int(parts_of[rows[0]]) not in parts]
        anchor = np.unique(np.concatenate(chosen)).astype(np.int32) if chosen else None
        return anchor, joints.find(self._with_places(self.rest), before, after, parts_of, parts)

    def _sample_times(self, transition: int) -> Array:
        count = self.counts[transition]
        before, after = self.times[transition : transition + 2]
        return np.asarray(before + (after - before) * np.arange(1, count + 1) / (count + 1))

    def _runs(self) -> list[tuple[int, int]]:
        """First and last keys of transitions in a row that are to be solved, with what decides on them."""
        around = 1 if self.smooth else 0
        runs: list[tuple[int, int]] = []
        for transition, count in enumerate(self.counts):
            if count:
                first = max(0, transition - around)
                last = min(len(self.counts), transition + 1 + around)
                if runs and first <= runs[-1][1]:
                    first = runs.pop()[0]
                runs.append((first, last))
        return runs
