# SPDX-License-Identifier: GPL-3.0-or-later
"""What pins are turned and spread about by keys: what Blender's Pivot Point says."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from . import snapshot


def chosen(context: bpy.types.Context) -> Sequence[float] | None:
    """The 3D cursor or the place of the active pin or joint, in the world; None: the centre of the pins.

    The active one counts whether it is selected or not: a hip's joint, about which a leg's pins turn.
    """
    kind = context.scene.tool_settings.transform_pivot_point
    if kind == "CURSOR":
        return tuple(context.scene.cursor.location)
    if kind == "ACTIVE_ELEMENT":
        shown = snapshot.of_active(context)
        mark = None if shown is None else shown.pin(context.object.planar.active_pin)
        return None if mark is None else tuple(mark.place)
    return None
