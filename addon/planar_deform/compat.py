# SPDX-License-Identifier: GPL-3.0-or-later
"""What differs between the versions of Blender that are supported, 4.2 to 5.2."""

from __future__ import annotations

import contextlib
import sys
from pathlib import Path

import addon_utils
import bpy

# Of a property that is a path and may begin with "//", relative to the .blend.
BLEND_RELATIVE = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (4, 5, 0) else set()

# The handlers of bpy.app that are called when something has been appended or linked; 4.2 has none.
AFTER_IMPORT = ("blend_import_post",) if hasattr(bpy.app.handlers, "blend_import_post") else ()


def curves_of(animation: bpy.types.AnimData | None) -> bpy.types.bpy_prop_collection | None:
    """The F-curves of a data-block's action; None when it has none.

    From 4.4 an action holds them in slots, one for each of its users.
    """
    if animation is None or animation.action is None:
        return None
    return _curves_in(animation)


def curves_of_strip(strip: bpy.types.NlaStrip) -> bpy.types.bpy_prop_collection | None:
    """The F-curves that a strip of the Nonlinear Animation editor plays."""
    return None if strip.action is None else _curves_in(strip)


def _curves_in(
    user: bpy.types.AnimData | bpy.types.NlaStrip,
) -> bpy.types.bpy_prop_collection | None:
    """Those of the slot that something uses of its action."""
    if not hasattr(user, "action_slot"):
        return user.action.fcurves
    if user.action_slot is None:
        return None
    for layer in user.action.layers:
        for strip in layer.strips:
            bag = strip.channelbag(user.action_slot)
            if bag is not None:
                return bag.fcurves
    return None


def new_action(owner: bpy.types.ID, name: str) -> bpy.types.bpy_prop_collection:
    """Animate a data-block by a new action, empty so far; its F-curves, to which some can be added."""
    animation = owner.animation_data_create()
    action = bpy.data.actions.new(name)
    animation.action = action
    if not hasattr(animation, "action_slot"):
        return action.fcurves
    slot = action.slots.new(owner.id_type, owner.name)
    animation.action_slot = slot
    strip = action.layers.new("Layer").strips.new(type="KEYFRAME")
    return strip.channelbag(slot, ensure=True).fcurves


def make_single_user(animation: bpy.types.AnimData) -> None:
    """Give the data-block its own copy of its action if others use that, too."""
    action = animation.action
    if action.users - action.use_fake_user <= 1:
        return
    assign_action(animation, action.copy(), slot_of(animation))


def slot_of(animation: bpy.types.AnimData | None) -> str | None:
    """The identifier of the slot that a data-block uses in its action, from 4.4."""
    slot = getattr(animation, "action_slot", None)
    return None if slot is None else slot.identifier


def assign_action(animation: bpy.types.AnimData, action: bpy.types.Action, slot: str | None) -> None:
    """Give a data-block an action, and of it the slot of this identifier."""
    animation.action = action
    if slot is not None:
        animation.action_slot = action.slots[slot]


def brush_weight_owner(tools: bpy.types.ToolSettings) -> bpy.types.bpy_struct | None:
    """What has the `weight` that the next stroke of Weight Paint puts down; None without a brush."""
    paint = tools.weight_paint
    shared = paint.unified_paint_settings if bpy.app.version >= (5, 0, 0) else tools.unified_paint_settings
    return shared if shared.use_unified_weight else paint.brush


def uv_pins(mesh: bpy.types.Mesh) -> bpy.types.bpy_prop_collection:
    """What tells for each corner whether it is pinned in the active UV map, to be written.

    In newer versions a map has none until it is asked for, and references to maps are no good after that.
    """
    layer = mesh.uv_layers.active
    return layer.pin_ensure().data if hasattr(layer, "pin_ensure") else layer.pin


def unpack_wheels(package: str) -> bool:
    """Have Blender unpack the wheels of its extensions again, those that are missing; false if it cannot.

    It does so when its cache tells of changes alone, and the cache does not tell of wheels that failed to be
    unpacked.
    """
    if not package.startswith("bl_ext.") or not hasattr(addon_utils, "extensions_refresh"):
        return False
    folder = Path(bpy.utils.user_resource("EXTENSIONS"))
    with contextlib.suppress(OSError):
        (folder / ".cache" / "compat.dat").unlink()
    for name in [name for name in sys.modules if name.split(".")[0] == "planar_native"]:
        del sys.modules[name]
    addon_utils.extensions_refresh(addon_modules_pending=[package])
    return True
