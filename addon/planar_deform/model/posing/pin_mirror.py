# SPDX-License-Identifier: GPL-3.0-or-later
"""A pose turned to the other side by its pins, for drawings that are not symmetric vertex by vertex."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ... import native
from ..plane.cutout import Cutout
from ..plane.frame import Array
from ..plane.locate import nearest_point
from .depths import depth_of
from .pins import Holder, Kind, Pin
from .pins_led import Led, PinsLed
from .posing import start_of, start_scale_of
from .side_names import flipped
from .symmetry import Symmetry, nearest

NEAR = 0.05  # of the diagonal: how far a pin, or the drawing, may be from where its partner is expected


class PinMirror(PinsLed):
    """Takes each pin from rest to where its partner on the other side was, seen in the mirror.

    Partners are pins whose names tell so, as Hand.L and Hand.R, else those that rest in each other's mirror
    image. What a pin does that has no partner is done by the drawing where that would be. Where there is no
    drawing, the pin does by itself what it did, mirrored. Displacements from rest are mirrored, not places:
    the two sides need not be equal.

    `pins` are all that can be used, by name, and `positions` n x 2 the pose. `axis` as in Symmetry.
    """

    def __init__(
        self,
        cutout: Cutout,
        positions: Array,
        pins: Sequence[tuple[str, Holder]],
        axis: int,
        make_poser: Callable[..., native.Poser],
    ):
        self._pins = [holder for _, holder in pins]
        self._places = [holder.place(cutout.rest) for holder in self._pins]
        self._partners, self._symmetry = paired(cutout, pins, axis)
        partners = self._partners
        self.pairs = sum(index < partner for index, partner in partners.items())
        self._found: dict[int, Led] = {}
        for index, holder in enumerate(self._pins):
            if holder.pin.enabled:
                self._hold(cutout, positions, index, partners)
        super().__init__(cutout, positions, self._pins, self._found, make_poser)

    def asked_depths(self, depths: Array) -> dict[int, float]:
        """What depths pins have in the mirror, by their keys, where the drawing has n depths."""
        return {
            self._pins[partner].pin.key: depth_of(self._pins[index], depths)
            for index, partner in self._partners.items()
        }

    def _hold(self, cutout: Cutout, positions: Array, index: int, partners: dict[int, int]) -> None:
        """What a pin does, done by its partner."""
        holder = self._pins[index]
        place, angle = start_of(holder, positions)
        mirrored = self._symmetry.reflected(place) - self._symmetry.reflected(self._places[index])
        partner = partners.get(index)
        if partner is not None:
            pin, rest = self._pins[partner].pin, self._places[partner]
        else:
            found = self._opposite(cutout, index)
            pin, rest = (holder.pin, self._places[index]) if found is None else found
        pin = replace(pin, enabled=True, target=None, angle=0.0, scale=1.0)
        scale = start_scale_of(holder, positions)
        self._found[pin.key] = Led(pin, rest + mirrored, -angle, scale)

    def _opposite(self, cutout: Cutout, index: int) -> tuple[Pin, Array] | None:
        """The drawing where the mirror image of a pin rests, as a pin; None where there is none."""
        holder = self._pins[index]
        image = self._symmetry.reflected(self._places[index])
        every = np.arange(len(cutout.triangles), dtype=np.int32)
        found = nearest_point(cutout.rest, cutout.triangles, image, every)
        if found is None or found.distance > NEAR * cutout.diagonal:
            return None
        if holder.pin.kind == "PATCH":
            images = self._symmetry.reflected(cutout.rest[holder.pin.vertices])
            vertices = np.unique(nearest(cutout.rest, images)[0])
            pin = replace(holder.pin, vertices=vertices, weights=np.ones(len(vertices)))
        else:
            pin = replace(holder.pin, vertices=cutout.triangles[found.triangle], weights=found.weights)
        pin = replace(pin, key=-1 - index)  # no pin of the list
        return pin, Holder(pin, cutout).place(cutout.rest)


def paired(cutout: Cutout, pins: Sequence[tuple[str, Holder]], axis: int) -> tuple[dict[int, int], Symmetry]:
    """The partner of each pin that has one, by their places in the list, and the mirror. `axis` as there."""
    places = [holder.place(cutout.rest) for _, holder in pins]
    partners = _by_name([name for name, _ in pins])
    symmetry = _mirror(cutout, axis, [(places[a], places[b]) for a, b in partners.items()])
    _add_by_place(partners, [holder.pin.kind for _, holder in pins], places, symmetry, NEAR * cutout.diagonal)
    return partners, symmetry


def _add_by_place(
    partners: dict[int, int],
    kinds: Sequence[Kind],
    places: Sequence[Array],
    symmetry: Symmetry,
    near: float,
) -> None:
    """Pair those without a partner that rest where another one's mirror image does, or their own."""
    left = [index for index in range(len(places)) if index not in partners]
    gaps = np.full((len(left), len(left)), np.inf)
    for row, index in enumerate(left):
        image = symmetry.reflected(places[index])
        for column, other in enumerate(left):
            if kinds[other] == kinds[index]:
                gaps[row, column] = np.linalg.norm(places[other] - image)
        gaps[row, row] /= 2.0  # what is off the mirror line is twice as far from its own image
    for row, index in enumerate(left):
        column = int(np.argmin(gaps[row]))
        if gaps[row, column] <= near and np.argmin(gaps[column]) == row:
            partners[index] = left[column]


def _by_name(names: Sequence[str]) -> dict[int, int]:
    """The partners of those whose names tell, by their places in the list."""
    partners = {}
    for index, name in enumerate(names):
        other = flipped(name)
        if other != name and names.count(name) == names.count(other) == 1:
            partners[index] = names.index(other)
    return partners


def _mirror(cutout: Cutout, axis: int, pairs: Sequence[tuple[Array, Array]]) -> Symmetry:
    """The mirror in the middle of the pairs of places, else of the drawing."""
    rest = cutout.rest[:, axis]
    line = float(rest.min() + rest.max()) / 2.0
    if pairs:
        line = float(np.mean([(first[axis] + second[axis]) / 2.0 for first, second in pairs]))
    return Symmetry(axis, line, np.arange(len(rest), dtype=np.int32))
