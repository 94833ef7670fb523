# SPDX-License-Identifier: GPL-3.0-or-later
"""What follows the user: pins their vertex groups, the active pose the frame."""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from ..model.posing import solver_cache
from .pins.pin_list import sync
from .sequence import pose_edit, pose_state

CLASSES = ()


@persistent
def follow_edits(scene, depsgraph):
    """After each update: pins and stiffness follow the groups of their object."""
    for update in depsgraph.updates:
        obj = update.id.original
        if not isinstance(obj, bpy.types.Object) or obj.type != "MESH":
            continue
        if not obj.planar.pins and not obj.planar.stiffness_group:
            continue
        if obj.library is None and obj.mode in {"OBJECT", "WEIGHT_PAINT"}:
            sync(obj)


@persistent
def activate_shown_pose(scene, depsgraph):
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
    ):
        return
    if obj.library is None and obj.data.library is None:
        pose = pose_state.pose_at(obj, scene.frame_current_final)
        if pose is not None and pose != obj.planar.active_pose:
            pose_edit.activate(obj, pose)


@persistent
def forget_solvers(*_):
    """Another file: its objects are others, whatever their identities."""
    solver_cache.clear()


HANDLERS = {
    "depsgraph_update_post": follow_edits,
    "frame_change_post": activate_shown_pose,
    "load_pre": forget_solvers,
}
