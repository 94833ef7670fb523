# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the pins of a lattice are while its points move."""

from __future__ import annotations

import bpy
import numpy as np

from ...errors import Refusal
from ...model.lattice.pin_places import PinPlaces
from ..objects.lattice_object import LatticeObject
from ..pins import pin_list
from .posed_lattice import PosedLattice
from .rig import read_rig


def pinned_places(obj: bpy.types.Object, drawing: LatticeObject) -> PinPlaces | None:
    """Of the enabled pins that hold something; None without any, and in space."""
    if not drawing.elements or not pin_list.has_pins(obj):
        return None
    try:
        rig = read_rig(obj, drawn=True)  # panels ask, too
    except Refusal:
        return None  # it deforms nothing that pins can hold at present
    if len(rig.points_at_rest) != len(drawing.rest):
        return None  # pins see two layers in space, as where the lattice has a vertex group
    posed = PosedLattice(obj, rig, unkeyed=True, facing=None)
    pins = [pin for pin in pin_list.model_pins(obj, posed) if pin.enabled]
    if not pins:
        return None
    count = len(rig.rest)
    starts, columns, values = rig.weights
    shares = np.zeros((len(pins), len(drawing.rest)))
    places = np.empty((len(pins), 2))
    for number, pin in enumerate(pins):
        weights = pin.weights / pin.weights.sum()
        places[number] = weights @ posed.cutout.rest[pin.vertices, :2]
        for row, weight in zip(pin.vertices.tolist(), weights.tolist(), strict=True):
            if row >= count:
                shares[number, row - count] += weight
            else:
                entries = slice(starts[row], starts[row + 1])
                np.add.at(shares[number], columns[entries], weight * values[entries])
    return PinPlaces([pin.key for pin in pins], places - shares @ drawing.rest, shares)
