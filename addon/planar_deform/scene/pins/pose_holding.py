# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the pose that is shown is one that the pins hold, or was made by others, or by hand."""

from __future__ import annotations

from collections.abc import Callable

import bpy

from ... import native
from .pin_list import is_joint

# Of a triangle: 2 is undistorted. What is less distorted is hardly seen to go.
DISTORTED = 2.02


def unheld(obj: bpy.types.Object, distortion: Callable[[], native.Distortion | None]) -> str | None:
    """What the next drag does to a pose that no pin of the object has made; None where that is nothing.

    `distortion`: of the shape that is shown, None where that is no flat one; it is asked for only where it
    counts. All methods but AKVF give the shape that belongs to the pins: whatever none of them holds goes
    back to rest.
    """
    enabled = [pin for pin in obj.planar.pins if pin.enabled and not is_joint(pin)]
    if obj.planar.method == "AKVF" or not enabled:
        return None
    if any(pin.has_target or (pin.has_posed and len(obj.planar.poses)) for pin in enabled):
        return None
    found = distortion()
    if found is None or max(found.triangle_area.max(), found.triangle_angle.max()) <= DISTORTED:
        return None
    remedy = "Pin all that is to stay" + (", or use Set as Rest" if obj.type == "MESH" else "")
    return f"These pins have not made the pose: a drag takes what they do not hold back to rest. {remedy}"
