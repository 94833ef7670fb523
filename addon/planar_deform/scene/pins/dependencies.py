# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves with what: objects with their parents, constraints and modifiers, pins with what they follow.

So that nothing is to follow itself, and what is followed goes first.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import bpy
import numpy as np

from ..objects import vertex_parents
from . import controls, followed_mesh, pin_list


class _Need(NamedTuple):
    """What an object needs to know of another one."""

    obj: bpy.types.Object
    shape: bool  # of its mesh, not only where it is
    reason: str  # how it hangs on that, and what to do about it


def refusal(
    obj: bpy.types.Object, control: bpy.types.Object, *, on_mesh: bool = False, whole: bool = False
) -> str | None:
    """Why the pins of an object cannot follow another one, or its mesh if `on_mesh`; and what to do.

    `whole`: it is the object itself that is to hang on that mesh.
    """
    if control == obj:
        return f"'{obj.name}' cannot follow itself: choose another object"
    seen = {(control, False), (control, True)} if on_mesh else {(control, False)}
    waiting = [*seen]
    while waiting:
        for need in _needs(*waiting.pop()):
            if need.obj == obj and (need.shape or whole):
                return need.reason
            node = (need.obj, need.shape)
            if node not in seen:
                seen.add(node)
                waiting.append(node)
    return None


def in_order(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Object]:
    """The objects, those first on whose shapes others of them depend."""
    given, found, visited = list(objects), [], set()

    def visit(obj: bpy.types.Object, shape: bool) -> None:
        if (obj, shape) in visited:
            return
        visited.add((obj, shape))
        for need in _needs(obj, shape):
            visit(need.obj, need.shape)
        if shape and obj in given:
            found.append(obj)

    for obj in given:
        visit(obj, True)
    return found


def carriers_of(obj: bpy.types.Object) -> set[bpy.types.Object]:
    """The objects whose meshes the pins of an object that are on follow."""
    return {
        pin.follow for pin in obj.planar.pins if pin.enabled and pin.follow is not None and pin.follow_group
    }


def waits(obj: bpy.types.Object) -> bool:
    """Whether a mesh that the pins of an object follow is being edited: it is followed again afterwards."""
    return any(carrier.mode == "EDIT" for carrier in carriers_of(obj))


def above(obj: bpy.types.Object) -> set[bpy.types.Object]:
    """The objects on whose shapes that of an object depends."""
    seen = {(obj, True)}
    waiting = [*seen]
    while waiting:
        for need in _needs(*waiting.pop()):
            if (need.obj, need.shape) not in seen:
                seen.add((need.obj, need.shape))
                waiting.append((need.obj, need.shape))
    return {other for other, shape in seen if shape and other != obj}


def find_lost(obj: bpy.types.Object) -> None:
    """Pins of an object go on with the mesh to which what they followed has been joined, by their group."""
    for pin in obj.planar.pins:
        if not pin.follow_group or pin.follow is None or pin.follow.users_scene:
            continue
        found = [
            other
            for other in bpy.data.objects
            if other.type == "MESH"
            and other.users_scene
            and pin.follow_group in other.vertex_groups
            and followed_mesh.are_one_place(pin.follow, other, pin.follow_group)
        ]
        if len(found) == 1 and found[0] != obj:
            before, now = (np.array(one.matrix_world, np.float64) for one in (pin.follow, found[0]))
            offset = np.array(pin.follow_offset, np.float64).reshape(4, 4)
            with controls.given():
                pin.follow = found[0]
            pin.follow_offset = (np.linalg.pinv(now) @ before @ offset).ravel()


def _needs(obj: bpy.types.Object, shape: bool) -> Iterator[_Need]:
    """What must be known before it is known where an object is, or which `shape` it has."""
    if not shape:
        yield from _of_place(obj)
        return
    if pin_list.has_pins(obj):
        yield _Need(obj, False, "")  # its pins are led as seen from itself
        for pin in obj.planar.pins:
            if pin.follow is not None:
                reason = (
                    f"'{obj.name}' follows '{pin.follow.name}' already: let go of that first, with Detach "
                    "from Drawing, or choose another object"
                )
                yield _Need(pin.follow, False, reason)
                if pin.follow_group:
                    yield _Need(pin.follow, True, reason)
    for modifier in obj.modifiers:
        other = getattr(modifier, "object", None)
        if isinstance(other, bpy.types.Object):
            reason = (
                f"Modifier '{modifier.name}' of '{obj.name}' depends on '{other.name}': remove it, or choose "
                "another object"
            )
            yield _Need(other, False, reason)
            yield _Need(other, True, reason)


def _of_place(obj: bpy.types.Object) -> Iterator[_Need]:
    if obj.parent is not None:
        name, parent = obj.name, obj.parent.name
        if vertex_parents.is_hanging(obj):
            yield _Need(
                obj.parent,
                True,
                f"'{name}' hangs on vertices of '{parent}', which its pins move: parent it to the object "
                "instead, or choose another one",
            )
        yield _Need(obj.parent, False, f"'{parent}' is the parent of '{name}': clear that first")
    for constraint in obj.constraints:
        target = getattr(constraint, "target", None)
        if target is not None:
            on_mesh = bool(getattr(constraint, "subtarget", "")) and target.type in {"MESH", "LATTICE"}
            what = "hangs on vertices of" if on_mesh else "depends on"
            reason = (
                f"Constraint '{constraint.name}' of '{obj.name}' {what} '{target.name}', which its pins "
                "move: remove it, or choose another object"
            )
            if on_mesh:
                yield _Need(target, True, reason)
            yield _Need(target, False, reason)
