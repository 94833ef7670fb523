# SPDX-License-Identifier: GPL-3.0-or-later
"""Controls: objects, bones and places of meshes that pins follow, each with the offset at which it was set.

A pin is a matrix for this: its place, and for a patch how it is turned in the plane of its drawing. The
offset is that matrix in the space of the control.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array
from ..objects import pose_store
from ..sequence import pose_state
from ..sequence.pose_blocks import played_value
from ..storage import changes
from . import followed_mesh
from .pin_list import has_pins, is_joint

_given = False


@contextlib.contextmanager
def given() -> Iterator[None]:
    """What pins follow is set together with its offset, and not chosen anew."""
    global _given
    before, _given = _given, True
    try:
        yield
    finally:
        _given = before


def is_given() -> bool:
    """Whether the offset comes with what is to be followed."""
    return _given


def follows_any(obj: bpy.types.Object) -> bool:
    """Whether any pin of an object follows something."""
    return any(pin.follow is not None for pin in obj.planar.pins)


def stamp(obj: bpy.types.Object, frame: float, depsgraph: bpy.types.Depsgraph) -> str:
    """By what the pins that are on and follow something go where, seen from the object; empty: none does.

    Of an object with poses, what these show at the frame belongs to it. Raises Refusal.
    """
    goals = {
        number: goal_of(pin, depsgraph)
        for number, pin in enumerate(obj.planar.pins)
        if pin.enabled and pin.follow is not None
    }
    if not goals:
        return ""
    inverse = np.linalg.pinv(matrix_of(obj, depsgraph))  # what is flat is refused elsewhere
    local = np.einsum("ij,kjl->kil", inverse, np.stack(list(goals.values())))[:, :3]
    shown = played_value(obj.data.shape_keys, frame) if pose_state.is_ours(obj) else ""
    return f"{list(goals)}{local.astype(np.float32).tobytes().hex()}{shown}"


def matrix_of(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Array:
    """Where an object is in the world (4 x 4)."""
    return np.array(obj.evaluated_get(depsgraph).matrix_world, np.float64)


def goal_of(pin: bpy.types.PropertyGroup, depsgraph: bpy.types.Depsgraph) -> Array:
    """Where a pin, which follows something, is to be in the world (4 x 4). Raises Refusal."""
    goal: Array = control_matrix(pin, depsgraph) @ np.array(pin.follow_offset, np.float64).reshape(4, 4)
    return goal


def control_matrix(pin: bpy.types.PropertyGroup, depsgraph: bpy.types.Depsgraph) -> Array:
    """Where what a pin follows is in the world (4 x 4). Raises Refusal."""
    if not _is_up_to_date(pin.follow, depsgraph):
        raise Refusal(_absence(pin, depsgraph))
    control = pin.follow.evaluated_get(depsgraph)
    matrix = control.matrix_world
    if pin.follow_bone:
        bone = None if control.pose is None else control.pose.bones.get(pin.follow_bone)
        if bone is None:
            raise Refusal(
                f"'{pin.follow.name}' has no bone '{pin.follow_bone}': choose another one for pin "
                f"'{pin.name}'"
            )
        matrix = matrix @ bone.matrix
    found = np.array(matrix, np.float64)
    if np.isfinite(found).all() and pin.follow_group and pin.follow.type == "MESH":
        found = followed_mesh.motion_of(pin.follow, pin.follow_group, found, depsgraph) @ found
    if not np.isfinite(found).all():
        raise Refusal(f"'{pin.follow.name}', which pin '{pin.name}' follows, is nowhere: see its transform")
    return found


@contextlib.contextmanager
def beside(carrier: bpy.types.Object) -> Iterator[None]:
    """The rest shape of a mesh changes, or its groups: what follows places of it stays where it is."""
    following = [
        (obj.name, key)
        for obj in bpy.data.objects
        for key, pin in enumerate(obj.planar.pins if has_pins(obj) else ())
        if pin.follow == carrier and pin.follow_group
    ]
    if not following:
        yield
        return
    depsgraph, goals = bpy.context.evaluated_depsgraph_get(), {}
    for name, key in following:
        with contextlib.suppress(Refusal):  # it follows nothing at present
            goals[name, key] = goal_of(bpy.data.objects[name].planar.pins[key], depsgraph)
    changes.tell(carrier)  # what has been read of it for this
    yield
    changes.tell(carrier)
    followed_mesh.wrote(carrier, pose_store.shown_by(carrier))
    try:
        for (name, key), goal in goals.items():
            pin = bpy.data.objects[name].planar.pins[key]
            with contextlib.suppress(Refusal):  # told when it is to go somewhere
                pin.follow_offset = (np.linalg.pinv(control_matrix(pin, depsgraph)) @ goal).ravel()
    finally:
        followed_mesh.evaluated()


def _is_up_to_date(control: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bool:
    """Whether Blender evaluates an object: not so where it is disabled, of which it keeps an old state.

    A deleted one stays as long as a pin points to it.
    """
    hidden = _disabling(depsgraph)
    return not getattr(control, hidden) and _reaches(
        depsgraph.view_layer.layer_collection, control.name, hidden
    )


def _disabling(depsgraph: bpy.types.Depsgraph) -> str:
    return "hide_render" if depsgraph.mode == "RENDER" else "hide_viewport"


def _reaches(layer: bpy.types.LayerCollection, name: str, hidden: str) -> bool:
    """Whether an object is in a collection, or one in it, that is not disabled."""
    if layer.exclude or getattr(layer.collection, hidden):
        return False
    return name in layer.collection.objects or any(_reaches(child, name, hidden) for child in layer.children)


def _absence(pin: bpy.types.PropertyGroup, depsgraph: bpy.types.Depsgraph) -> str:
    what = f"'{pin.follow.name}', which pin '{pin.name}' follows,"
    if pin.follow.name not in depsgraph.scene.objects:
        return f"{what} is not in the scene: bring it back, or choose another one"
    where = "renders" if depsgraph.mode == "RENDER" else "the viewport"
    return (
        f"{what} is disabled in {where}, or its collection is: enable it, or choose another "
        "one. It may be hidden with H"
    )


def chosen(obj: bpy.types.Object) -> list[int]:
    """The indices of the selected pins, of all if none is selected; not of joints."""
    pins = [(index, pin.select) for index, pin in enumerate(obj.planar.pins) if not is_joint(pin)]
    selected = [index for index, select in pins if select]
    return selected or [index for index, _ in pins]
