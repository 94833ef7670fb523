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
from ...model.posing.held_pins import Guide, GuidedMotion, HeldPin, PinnedOptions, pinned
from ...model.posing.joint_points import Cut, JointPoints
from ...model.posing.pin_path import PinPath
from ...model.timing.order_of_time import Entry
from ...model.work import Progress
from ..objects.any_object import AnyObject
from . import joints

PLANTED = 1e-3  # of the diagonal: a pin that has moved less between two poses stands still
_SAMPLED = 0.1  # of the share of the work: sampling, after solving
_SAMPLED_WITH_PINS = 0.7
_AT_ONCE = 8  # frames that are sampled between two looks at whether to go on


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


@dataclass(frozen=True)
class _Holds:
    """What holds a drawing on its way between two keys."""

    anchor: Indices | None  # the vertices whose mean moves on the path
    joints: Indices  # of the parts
    flags: list[bool]  # of each pin, whether it is held: it stands, or has a path


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
    held: list[HeldPin]  # the enabled pins; the vertices of `places` are behind the drawing's
    places: PinPlaces | None  # of a lattice's pins
    hung: JointPoints | None  # of a drawing's joints
    path: str  # "STRAIGHT" | "ARC"
    smooth: bool
    # Of each transition, by the pins' keys; none at all while they are not known.
    pin_paths: list[dict[int, PinPath]] = field(default_factory=list)
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
            pin_paths=[
                self.pin_paths[before] if self.pin_paths and after == before + 1 else {}
                for before, after in itertools.pairwise(chosen)
            ],
            counts=[0] * len(turns),
        )

    def motion(
        self, first: int = 0, last: int | None = None, progress: Progress | None = None
    ) -> native.Inbetweens | GuidedMotion | LedMotion | Cut | Blend:
        """The way through keys `first` to `last`, at their `times`. Raises SolveError, Cancelled."""
        last = len(self.keys) - 1 if last is None else last
        times = self.times[first : last + 1]
        if not self.elements:
            return Blend(np.stack(self.keys[first : last + 1]), times)
        holds = [self._holds(transition) for transition in range(first, last)]
        flags = [hold.flags for hold in holds]
        pins: PinnedOptions = pinned(self.held, flags) if np.any(flags) else {}
        free = native.Inbetweens(
            np.stack([self._with_points(key) for key in self.keys[first : last + 1]]),
            **self.elements,
            rest=self._with_points(self.rest),
            key_times=times,
            turns=np.array(self.turns[first:last], np.int32)[:, None],
            anchor=[hold.anchor for hold in holds],
            anchor_path="arc" if self.path == "ARC" else "straight",
            joints=[hold.joints for hold in holds],
            smooth=self.smooth,
            cage=self.cage,
            progress=progress,
            **pins,
        )
        guides = {number: self._guides(first + number) for number in range(last - first)} if pins else {}
        guided = any(guides.values())
        motion = GuidedMotion(free, times, guides, self.held) if guided else free
        if self.places is None:
            return motion if self.hung is None else Cut(motion, len(self.rest))
        leading = [hold.anchor - len(self.rest) for hold in holds if hold.anchor is not None]  # all of them
        return LedMotion(motion, self.places, times, leading, [np.flatnonzero(hold.flags) for hold in holds])

    def ends(self, transition: int) -> tuple[Array, Array]:
        """The shapes before and behind a transition, with the places."""
        before, after = self.keys[transition : transition + 2]
        return self._with_places(before), self._with_places(after)

    @property
    def near(self) -> float:
        """How far apart what stands may be in two poses."""
        return PLANTED * self.drawing.diagonal

    def _with_places(self, shape: Array) -> Array:
        return shape if self.places is None else self.places.extended(shape)

    def _with_points(self, shape: Array) -> Array:
        """A shape with the places of a lattice's pins, or the points of joints, behind it."""
        behind = self.places or self.hung
        return shape if behind is None else behind.extended(shape)

    def solve(self, progress: Progress | None = None) -> list[Array]:
        """The generated positions, n x 2 each, in order. Raises SolveError and Cancelled."""
        found: list[Array] = []
        runs = self._runs()
        sampled = _SAMPLED_WITH_PINS if self.held else _SAMPLED
        for number, (first, last) in enumerate(runs):

            def told(share: float, number: int = number) -> bool:
                return progress is None or progress((number + share) / len(runs))

            def solved(share: float, number: int = number) -> bool:
                return told((1.0 - sampled) * share, number)

            motion = self.motion(first, last, solved)
            times = np.concatenate([self._sample_times(transition) for transition in range(first, last)])
            for done in range(0, len(times), _AT_ONCE):
                found += list(motion.at(times[done : done + _AT_ONCE]))
                if not told(1.0 - sampled * max(0.0, 1.0 - (done + _AT_ONCE) / len(times))):
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

    def _holds(self, transition: int) -> _Holds:
        """What holds the drawing in a transition.

        Pins that stand still hold their parts; those parts that have none go by all their pins.
        """
        before, after = self.ends(transition)
        parts_of = self._parts
        stands = [pin.stands(before, after, self.near) for pin in self.held]
        held = [(rows, still) for pin, still in zip(self.held, stands, strict=True) for rows in pin.vertices]
        parts = {int(parts_of[rows[0]]) for rows, still in held if still}
        chosen = [rows for rows, still in held if still or int(parts_of[rows[0]]) not in parts]
        anchor = np.unique(np.concatenate(chosen)).astype(np.int32) if chosen else None
        given = [] if self.hung is None else self.hung.given(len(self.rest))
        found = joints.find(self._with_places(self.rest), before, after, parts_of, parts, given)
        guided = self._paths(transition)
        return _Holds(
            anchor, found, [still or pin.key in guided for pin, still in zip(self.held, stands, strict=True)]
        )

    def _paths(self, transition: int) -> dict[int, PinPath]:
        return self.pin_paths[transition] if self.pin_paths else {}

    def _guides(self, transition: int) -> list[Guide]:
        """The pins that are to go on paths in a transition."""
        rest, (before, after) = self._with_places(self.rest), self.ends(transition)
        guides, row = [], 0
        for pin in self.held:
            count = len(pin.triangles)
            path = self._paths(transition).get(pin.key)
            if path is not None:
                rows = np.arange(row, row + count, dtype=np.int32)
                turn = pin.turn(rest, self._parts, before, after)
                guides.append(Guide(path, rows, pin.middle(before), pin.middle(after), turn))
            row += count
        return guides

    @property
    def _parts(self) -> Indices:
        """Of all vertices, those of the places too; all of a lattice is one part."""
        if self.places is None:
            return self.drawing.parts
        return np.zeros(len(self.rest) + len(self.places.offsets), np.int32)

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
