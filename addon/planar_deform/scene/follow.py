# SPDX-License-Identifier: GPL-3.0-or-later
"""What follows the user: pins their vertex groups, the active pose the frame."""

from __future__ import annotations

import bpy

from .flatten import pushing
from .objects import lattice_edits
from .pins import following, lattice_places
from .pins.pin_list import has_pins, sync
from .sequence import pose_edit, pose_state
from .storage import migration, points
from .storage.migration import OWNER
from .telling import tell
from .view import snapshot


def match(obj: bpy.types.Object) -> None:
    """After an update of an object: what we keep of it follows.

    While Blender moves it, and while a drag is on, nothing does.
    """
    if obj.type == "LATTICE":
        _match_lattice_itself(obj)
    else:
        _match_mesh(obj)


def match_uv_map(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> None:
    """After an update or a change of the frame: with Live UV on the surface's map follows its flat mesh.

    A drag takes it along by itself.
    """
    if obj.type != "MESH" or obj.library is not None or not obj.is_property_set("planar"):
        return
    if not obj.planar.live_uv or migration.is_newer(obj) or snapshot.following(obj):
        return
    told = pushing.follow(obj, depsgraph)
    if told is not None:
        tell(told, title="Live UV Off")


def _match_lattice_itself(obj: bpy.types.Object) -> None:
    """Its transform is not applied to its points."""
    if any(_transforms(window) for window in bpy.context.window_manager.windows):
        return
    told = lattice_edits.follow(obj)
    if told is not None:
        tell(told, title="Transform Kept")


def _transforms(window: bpy.types.Window) -> bool:
    """Whether Blender's own moving, turning or scaling is on, which may move an origin alone."""
    return any(operator.bl_idname.startswith("TRANSFORM_OT") for operator in window.modal_operators)


def _match_mesh(obj: bpy.types.Object) -> None:
    """The pins of an object and its stiffness follow its mesh and its vertex groups."""
    if obj.type != "MESH" or obj.library is not None or obj.mode not in {"OBJECT", "WEIGHT_PAINT"}:
        return
    lattices = [
        modifier.object
        for modifier in obj.modifiers
        if modifier.type == "LATTICE" and has_pins(modifier.object) and _match_lattice(modifier.object)
    ]
    if lattices and obj.mode == "OBJECT":
        lattice_places.follow(obj, lattices)
    if not obj.is_property_set("planar") and OWNER not in obj.data.attributes:
        return  # the first look at its settings sets them
    if migration.is_newer(obj) or snapshot.following(obj):
        return
    if obj.planar.stiffness_group and not obj.planar.pins:
        sync(obj)
    for lost in following.follow(obj):
        tell(lost, title="Joined")


def _match_lattice(lattice: bpy.types.Object) -> bool:
    """The pins of a lattice follow the vertex groups of what it deforms; whether they can."""
    if lattice.library is not None or migration.is_newer(lattice) or snapshot.following(lattice):
        return False
    sync(lattice)
    return True


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
        or obj.type not in points.TYPES
        or obj.mode != "OBJECT"
        or not pose_state.is_ours(obj)
        or migration.is_newer(obj)
    ):
        return
    if obj.library is None and obj.data.library is None:
        pose = pose_state.pose_at(obj, scene.frame_current_final)
        if pose is not None and pose != obj.planar.active_pose:
            pose_edit.activate(obj, pose)
