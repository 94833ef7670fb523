# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that EEVEE blends face by face, in the order of the mesh: depths do not count in them."""

from __future__ import annotations

import bpy

from ...errors import Refusal
from ..objects.flat_object import MAKE_LOCAL


def blended(obj: bpy.types.Object) -> list[bpy.types.Material]:
    """Those of an object."""
    found = (slot.material for slot in obj.material_slots if slot.material is not None)
    return [material for material in dict.fromkeys(found) if material.surface_render_method == "BLENDED"]


def refusal(obj: bpy.types.Object | None) -> str | None:
    """Why none can be dithered, and what to do; None when some can."""
    if obj is None or not blended(obj):
        return "No material of the active object is blended"
    linked = next((material for material in blended(obj) if material.library is not None), None)
    return None if linked is None else f"Material '{linked.name}' is linked from a library: {MAKE_LOCAL}"


def dither(obj: bpy.types.Object) -> int:
    """Let EEVEE dither them, by which depths count; how many there were. Raises Refusal."""
    reason = refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    found = blended(obj)
    for material in found:
        material.surface_render_method = "DITHERED"
    return len(found)
