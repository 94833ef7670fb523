# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings that are each other's other side, as two arms are, and poses mirrored from one to the other."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ... import native
from ..plane.cutout import Cutout
from ..plane.frame import Array, Indices, PlaneFrame
from .depths import depth_of
from .pins import Holder
from .pins_led import Led, PinsLed
from .posing import PinResult, result_of, start_of, start_scale_of
from .side_names import flipped
from .symmetry import counterparts

Named = Sequence[tuple[str, Holder]]  # pins with their names


def opposites(drawings: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """Which of drawings are each other's other side, by the names of drawings and of their pins.

    By their own names (Arm.L, Arm.R), else where the pins of two tell of sides that only the other one has.
    """
    found = {name: flipped(name) for name in drawings if flipped(name) in drawings and flipped(name) != name}
    left = [name for name in drawings if name not in found]
    wanted = {name: _wanted(drawings[name]) for name in left}
    others = {
        name: [other for other in left if other != name and wanted[name] & set(drawings[other])]
        for name in left
    }
    for name in left:
        if len(others[name]) == 1 and others[others[name][0]] == [name]:
            found[name] = others[name][0]
    return found


def _wanted(pins: Sequence[str]) -> set[str]:
    """The names of pins on the other side that a drawing does not have itself."""
    return {flipped(pin) for pin in pins if flipped(pin) != pin} - set(pins)


@dataclass(frozen=True)
class Reflection:
    """How the plane of one drawing sees in a mirror what is in that of another one."""

    ways: Array  # 2 x 2: takes ways in the other plane to this one
    side: float  # takes turns

    @staticmethod
    def of(frame: PlaneFrame, source: PlaneFrame, across: Array) -> Reflection:
        """In a mirror whose unit normal in the world is `across` (3,)."""
        axes = np.stack([source.u, source.v])
        seen = axes - 2.0 * np.outer(axes @ across, across)
        ways = np.ascontiguousarray(frame.flatten(seen).T)
        return Reflection(ways, -1.0 if float(frame.n @ source.n) > 0.0 else 1.0)


@dataclass(frozen=True)
class Side:
    """A drawing that is one of the two."""

    cutout: Cutout
    positions: Array  # n x 2, the pose
    depths: Array  # n
    edges: Indices  # e x 2
    pins: Named


def partners(pins: Named, source: Named) -> dict[int, int]:
    """The pins (by their places in the list) with those opposite: of flipped names, else of the same."""
    names = [name for name, _ in source]
    found = {}
    for index, (name, holder) in enumerate(pins):
        for wanted in (flipped(name), name):
            if names.count(wanted) == 1 and source[names.index(wanted)][1].pin.kind == holder.pin.kind:
                found[index] = names.index(wanted)
                break
    return found


def mirrored(side: Side, source: Side, reflection: Reflection, tolerance: float) -> Mirrored:
    """The pose of the other side, vertex by vertex. `tolerance` as in symmetry.counterparts().

    Raises NotSymmetricError where the two are not each other's mirror images at rest.
    """
    there = counterparts(
        (side.cutout.rest, side.edges), (source.cutout.rest @ reflection.ways.T, source.edges), tolerance
    )
    ways = source.positions[there] - source.cutout.rest[there]
    positions = side.cutout.rest + ways @ reflection.ways.T
    results = []
    for index, partner in partners(side.pins, source.pins).items():
        holder, other = side.pins[index][1], source.pins[partner][1]
        if other.pin.target is not None:
            led = _led(holder, other, side, source, reflection)
            results.append(result_of(holder, positions, led.target, led.angle, led.scale))
    return Mirrored(positions, results, source.depths[there])


@dataclass(frozen=True)
class Mirrored:
    """A pose, with what its pins were asked for."""

    positions: Array
    results: list[PinResult]
    depths: Array


class OtherSide(PinsLed):
    """Takes each pin from rest as its partner of the other side went, seen in the mirror."""

    def __init__(
        self, side: Side, source: Side, reflection: Reflection, make_poser: Callable[..., native.Poser]
    ):
        """Raises ValueError where no pin that is on has a partner."""
        self._side, self._source = side, source
        self._partners = partners(side.pins, source.pins)
        led = {}
        for index, partner in self._partners.items():
            holder, other = side.pins[index][1], source.pins[partner][1]
            if holder.pin.enabled:
                led[holder.pin.key] = _led(holder, other, side, source, reflection)
        self.pairs = len(led)
        holders = [holder for _, holder in side.pins]
        super().__init__(side.cutout, side.positions, holders, led, make_poser)

    def asked_depths(self) -> dict[int, float]:
        """What depths the pins have, by their keys."""
        pairs = self._partners.items()
        return {
            self._side.pins[index][1].pin.key: depth_of(self._source.pins[partner][1], self._source.depths)
            for index, partner in pairs
        }


def _led(holder: Holder, other: Holder, side: Side, source: Side, reflection: Reflection) -> Led:
    place, angle = start_of(other, source.positions)
    way = reflection.ways @ (place - other.place(source.cutout.rest))
    pin = replace(holder.pin, target=None, angle=0.0, scale=1.0)
    target = holder.place(side.cutout.rest) + way
    return Led(pin, target, reflection.side * angle, start_scale_of(other, source.positions))
