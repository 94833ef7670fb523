# SPDX-License-Identifier: GPL-3.0-or-later
"""A pose solved from the rest shape, with pins led to places that are given."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from ... import native
from ..plane.cutout import Cutout
from ..plane.frame import Array
from .pins import Holder, Pin, rotation
from .posing import RAMP_SAMPLES, PinResult, Posing, Sample, result_of


@dataclass(frozen=True)
class Led:
    """A pin, or a place of the drawing where there is none, and where it is led."""

    pin: Pin
    target: Array  # (2,)
    angle: float
    scale: float


class PinsLed(Posing):
    """Takes the parts that pins hold from rest to where these are led; the other parts stay.

    `holders` are the pins that can be used, `positions` n x 2 the pose, and `led` what is led, by the keys of
    the pins, which are negative for places.
    """

    def __init__(
        self,
        cutout: Cutout,
        positions: Array,
        holders: Sequence[Holder],
        led: Mapping[int, Led],
        make_poser: Callable[..., native.Poser],
    ):
        if not led:
            raise ValueError("pins: none is enabled")
        self._usable, self._led = holders, led
        used = [one.pin for one in led.values()]
        moving = np.isin(cutout.parts, [cutout.parts[pin.vertices[0]] for pin in used])
        start = np.where(moving[:, None], self._nearly(cutout), positions)
        super().__init__(cutout, start, used, led, partial(make_poser, start))

    def run(self) -> None:
        """All the way, and until there is nothing left to do."""
        for step in range(1, RAMP_SAMPLES + 1):
            self.move(step / RAMP_SAMPLES, 0.0, 0.0)
        self.settle()

    def results(self) -> list[PinResult]:
        """Of the pins that are on: those that nothing was asked of hold what there is."""
        results = []
        for holder in self._usable:
            if holder.pin.enabled:
                place = holder.place(self.positions)
                led = self._led.get(holder.pin.key)
                target = place if led is None else led.target
                angle = holder.fitted_angle(self.positions) if led is None else led.angle
                scale = holder.held_scale(self.positions) if led is None else led.scale
                results.append(result_of(holder, self.positions, target, angle, scale))
        return results

    def _aim(self, holder: Holder, start: tuple[Array, float], sample: Sample) -> tuple[Array, float]:
        led = self._led[holder.pin.key]
        place, turned = start
        share = sample[0]
        return place + share * (led.target - place), turned + share * (led.angle - turned)

    def _grown(self, holder: Holder, begun: float, sample: Sample) -> float:
        return begun + sample[0] * (self._led[holder.pin.key].scale - begun)

    def _nearly(self, cutout: Cutout) -> Array:
        """The rest shape as one piece where the pins are to be: the way from there is short."""
        led = self._led.values()
        rest = np.array([Holder(one.pin, cutout).place(cutout.rest) for one in led])
        targets = np.array([one.target for one in led])
        arms, goals = ((places - places.mean(axis=0)) @ [1.0, 1j] for places in (rest, targets))
        turn = float(np.angle((np.conj(arms) * goals).sum()))
        placed: Array = targets.mean(axis=0) + (cutout.rest - rest.mean(axis=0)) @ rotation(turn).T
        return placed
