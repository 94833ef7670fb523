# SPDX-License-Identifier: GPL-3.0-or-later
"""A pose that is carried to another drawing of the same connectivity."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..plane.connectivity import Connectivity
from ..plane.frame import Array
from .pins import Holder, Kind
from .posing import PinResult, result_of


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
