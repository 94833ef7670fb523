# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses that come from elsewhere than a posing, shown with their pins."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from ..model.plane.frame import Array
from ..model.posing.posing import PinResult
from ..scene.lattice.posed import PosedObject
from ..scene.objects.cutout_object import CutoutObject
from ..scene.objects.lattice_object import LatticeObject
from ..scene.pins import pin_list
from ..scene.sequence.playback import Steps
from .keying import auto_key
from .modal.reports import Tell


def showing(
    context: bpy.types.Context,
    drawing: PosedObject | LatticeObject,
    positions: Array,
    results: Iterable[PinResult],
    tell: Tell,
    *,
    depths: Array | None = None,
) -> Steps:
    """Show a pose, with what its pins were asked for, and auto-key it, see playback.together().

    Raises Refusal, with everything as it was, beyond what Blender can store.
    """
    obj = drawing.resolve()
    before = pin_list.SavedResults(obj)
    try:
        if depths is not None and isinstance(drawing, CutoutObject):
            drawing.write_with(positions, depths)
        else:
            drawing.write(positions)
        if not isinstance(drawing, LatticeObject):
            pin_list.store_results(obj, drawing, results)
        yield from auto_key(context, obj, tell)
        yield 1.0
    except BaseException:
        drawing.restore()
        before.restore(drawing.resolve())
        raise
