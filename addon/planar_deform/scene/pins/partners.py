# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins that go along with their partners on the other side of a drawing, where Symmetry is on."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import bpy

from ...model.plane.cutout import Cutout
from ...model.posing.pin_mirror import paired
from ...model.posing.pins import Holder, Pin


def going_along(
    obj: bpy.types.Object, cutout: Cutout, pins: Sequence[Pin], moving: Collection[int]
) -> dict[int, int]:
    """Of each pin that goes along with one of the `moving` ones, that one, by their keys.

    `pins`: the usable ones of an object. Those that are off, or move by themselves, go along with none.
    """
    settings = obj.planar
    if not settings.use_mirror_x or not cutout.flat:
        return {}
    partners, _ = paired(cutout, [(settings.pins[pin.key].name, Holder(pin, cutout)) for pin in pins], axis=0)
    pairs = ((pins[other], pins[index].key) for index, other in partners.items())
    return {pin.key: key for pin, key in pairs if key in moving and pin.enabled and pin.key not in moving}
