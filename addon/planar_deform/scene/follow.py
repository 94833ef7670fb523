# SPDX-License-Identifier: GPL-3.0-or-later
"""What follows the user: pins their vertex groups, the active pose the frame."""

from __future__ import annotations

import bpy

from .pins.pin_list import sync
from .sequence import pose_edit, pose_state
from .storage import migration


def match_groups(obj: bpy.types.Object) -> None:
    """After an update of an object: its pins and its stiffness follow its vertex groups."""
    if obj.type != "MESH" or not obj.is_property_set("planar"):  # which the first look at it sets
        return
    if not obj.planar.pins and not obj.planar.stiffness_group:
        return
    if migration.is_newer(obj):
        return
    if obj.library is None and obj.mode in {"OBJECT", "WEIGHT_PAINT"}:
        sync(obj)


def activate_shown_pose(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """After the frame has changed: the pose keyed there becomes the active one, which Edit Mode edits.

    Not while frames pass by, in playback and in renders.
    """
    context = bpy.context
    if depsgraph.mode != "VIEWPORT" or context.scene != scene:
        return
    if any(window.screen.is_animation_playing for window in context.window_manager.windows):
        return
    obj = context.view_layer.objects.active
    if (
        obj is None
        or obj.type not in {"MESH", "CURVE"}
        or obj.mode != "OBJECT"
        or not pose_state.is_ours(obj)
        or migration.is_newer(obj)
    ):
        return
    if obj.library is None and obj.data.library is None:
        pose = pose_state.pose_at(obj, scene.frame_current_final)
        if pose is not None and pose != obj.planar.active_pose:
            pose_edit.activate(obj, pose)
