# SPDX-License-Identifier: GPL-3.0-or-later
"""What pins pose: a cutout, or a lattice with all that it deforms."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...errors import Refusal
from ..objects import cutout_object
from ..objects.cutout_object import CutoutObject
from ..objects.flat_object import make_current
from ..objects.lattice_object import lattice_refusal
from .posed_lattice import PosedLattice
from .rig import read_rig

PosedObject = CutoutObject | PosedLattice


def posing_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why this object cannot be posed by pins, and what to do; None if nothing speaks against it.

    Cheap enough for polls; begin_posing() finds the rest.
    """
    if obj is None or obj.type != "LATTICE":
        return cutout_object.pose_refusal(obj)
    return lattice_refusal(obj)


def begin_posing(
    context: bpy.types.Context,
    obj: bpy.types.Object | None = None,
    *,
    unkeyed: bool = False,
    facing: Sequence[float] | None = None,
) -> PosedObject:
    """An object read at the start of a posing, by default the active one. Raises Refusal.

    A drag that still is on, as during a script, ends with what it shows.

    `unkeyed`: what the posing writes is shown, and never becomes a keyed pose by itself. `facing`: see
    PosedLattice.
    """
    make_current(context, obj)
    return read_posed(obj or context.object, unkeyed=unkeyed, facing=facing)


def read_posed(
    obj: bpy.types.Object | None,
    *,
    unkeyed: bool = False,
    facing: Sequence[float] | None = None,
    drawn: bool = False,
) -> PosedObject:
    """An object that pins pose, as it is shown. Raises Refusal; changes nothing.

    `drawn`: it is read where things are drawn, see lattice/reaching.py.
    """
    reason = posing_refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    assert obj is not None
    if obj.type == "LATTICE":
        return PosedLattice(obj, read_rig(obj, drawn=drawn), unkeyed=unkeyed, facing=facing)
    return cutout_object.made_of(obj, unkeyed=unkeyed)
