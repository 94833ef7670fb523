# SPDX-License-Identifier: GPL-3.0-or-later
"""A pose that is carried to another drawing of the same connectivity."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from ..plane.connectivity import Connectivity
from ..plane.frame import Array
from .pins import Holder, Kind
from .posing import PinResult, result_of

_NUMBER = re.compile(r"\.\d{3,}$")


@dataclass(frozen=True)
class CopiedPin:
    """Where a pin was asked to be: from where it rests, in extents of the rest shape."""

    kind: Kind
    offset: Array  # (2,)
    angle: float
    scale: float


@dataclass(frozen=True)
class CopiedPose:
    """What a pose adds to the rest shape, in extents of the rest shape along the plane's two axes."""

    connectivity: Connectivity
    offsets: Array  # n x 2
    pins: dict[str, CopiedPin]  # by name: those that had a target
    depths: Array | None = None  # n, see depths.py; a lattice has none


def given(copied: Mapping[str, CopiedPose], drawings: Mapping[str, Connectivity]) -> dict[str, str]:
    """Which of copied poses goes to which drawings, by their names: to those that are built alike.

    A single pose goes to all of them. Of several, each goes to one: to that of its own name, else to that of
    its name but for the number behind it, as duplicates have it, else to the first one that is left.
    """
    fits = {
        name: [other for other, pose in copied.items() if built.difference(pose.connectivity) is None]
        for name, built in drawings.items()
    }
    if len(copied) == 1:
        return {name: found[0] for name, found in fits.items() if found}
    result: dict[str, str] = {}
    for alike in (_same, _same_but_for_numbers, lambda _name, _other: True):
        for name, found in fits.items():
            free = [other for other in found if other not in result.values() and alike(name, other)]
            if name not in result and free:
                result[name] = free[0]
    return result


def _same(name: str, other: str) -> bool:
    return name == other


def _same_but_for_numbers(name: str, other: str) -> bool:
    return _NUMBER.sub("", name) == _NUMBER.sub("", other)


def copied(
    connectivity: Connectivity, rest: Array, positions: Array, pins: Iterable[tuple[str, Holder]]
) -> CopiedPose:
    """The pose of a drawing (at rest n x 2) that stands at n x 2 positions, with its pins by name."""
    extents = np.ptp(rest, axis=0)
    targets = {
        name: CopiedPin(
            holder.pin.kind,
            (holder.pin.target - holder.place(rest)) / extents,
            holder.pin.angle,
            holder.pin.scale,
        )
        for name, holder in pins
        if holder.pin.target is not None
    }
    return CopiedPose(connectivity, (positions - rest) / extents, targets)


def pasted(
    pose: CopiedPose, rest: Array, pins: Iterable[tuple[str, Holder]]
) -> tuple[Array, list[PinResult]]:
    """The pose on a drawing built alike (at rest n x 2): positions, and targets of its pins by name."""
    extents = np.ptp(rest, axis=0)
    positions: Array = rest + pose.offsets * extents
    results = []
    for name, holder in pins:
        pin = pose.pins.get(name)
        if pin is not None and pin.kind == holder.pin.kind:
            target = holder.place(rest) + pin.offset * extents
            results.append(result_of(holder, positions, target, pin.angle, pin.scale))
    return positions, results
