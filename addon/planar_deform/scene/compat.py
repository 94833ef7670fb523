# SPDX-License-Identifier: GPL-3.0-or-later
"""What differs between the versions of Blender that are supported, 4.2 to 5.2."""

from __future__ import annotations

import bpy


def curves_of(animation: bpy.types.AnimData | None) -> bpy.types.bpy_prop_collection | None:
    """The F-curves of a data-block's action; None when it has none.

    From 4.4 an action holds them in slots, one for each of its users.
    """
    if animation is None or animation.action is None:
        return None
    if not hasattr(animation, "action_slot"):
        return animation.action.fcurves
    if animation.action_slot is None:
        return None
    for layer in animation.action.layers:
        for strip in layer.strips:
            bag = strip.channelbag(animation.action_slot)
            if bag is not None:
                return bag.fcurves
    return None


def make_single_user(animation: bpy.types.AnimData) -> None:
    """Give the data-block its own copy of its action if others use that, too."""
    action = animation.action
    if action.users - action.use_fake_user <= 1:
        return
    slot = animation.action_slot.identifier if hasattr(animation, "action_slot") else None
    animation.action = action.copy()
    if slot is not None:
        animation.action_slot = animation.action.slots[slot]


def brush_weight_owner(tools: bpy.types.ToolSettings) -> bpy.types.bpy_struct | None:
    """What has the `weight` that the next stroke of Weight Paint puts down; None without a brush."""
    paint = tools.weight_paint
    shared = paint.unified_paint_settings if bpy.app.version >= (5, 0, 0) else tools.unified_paint_settings
    return shared if shared.use_unified_weight else paint.brush
