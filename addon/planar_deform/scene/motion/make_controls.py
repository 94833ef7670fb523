# SPDX-License-Identifier: GPL-3.0-or-later
"""Controls for pins: new Empties at them, or the nearest bones of an armature."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
import numpy as np
from mathutils import Matrix

from ...errors import Refusal
from ...model.plane.segments import nearest_segment
from ..lattice.posed import PosedObject
from ..pins import controls
from . import carrying, follow_offset

# As the marks of pins: a disc for a point, a square, which shows its turn, for a patch.
SHAPES = {"POINT": "CIRCLE", "PATCH": "CUBE"}
SIZE = 0.02  # of the drawing's diagonal, from the middle to the rim
# An Empty's circle lies across its Y, as drawings do that stand up: x along u, z along v.
UPRIGHT = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))


def add(obj: bpy.types.Object, drawing: PosedObject, keys: Iterable[int]) -> list[bpy.types.Object]:
    """An Empty at each of these pins of an object, which follow them from now on. Raises Refusal.

    They are parented as the object is, in its collection.
    """
    placed = follow_offset.matrices(obj, drawing, keys)
    collection = next(iter(obj.users_collection), bpy.context.scene.collection)
    if collection.library is not None:
        raise Refusal(f"'{obj.name}' is in a linked collection: move it to one of this file first")
    added = []
    for key, (matrix, _) in placed.items():
        pin = obj.planar.pins[key]
        control = bpy.data.objects.new(pin.name, None)
        control.empty_display_type = SHAPES[pin.kind]
        control.empty_display_size = SIZE * drawing.cutout.diagonal
        control.show_in_front = True  # behind the body, too
        collection.objects.link(control)
        if obj.parent is not None:
            control.parent, control.parent_type = obj.parent, obj.parent_type
            control.parent_bone, control.parent_vertices = obj.parent_bone, obj.parent_vertices
            control.matrix_parent_inverse = obj.matrix_parent_inverse
        control.matrix_world = Matrix(matrix.tolist()) @ UPRIGHT
        with controls.given():
            pin.follow, pin.follow_bone, pin.follow_group = control, "", ""
        added.append(control)
    bpy.context.view_layer.update()
    follow_offset.keep(obj, placed)
    return added


def follow_bones(
    obj: bpy.types.Object, drawing: PosedObject, keys: Iterable[int], rig: bpy.types.Object
) -> None:
    """Let these pins of an object follow the bones of an armature that are nearest to them in its plane.

    Bones that deform nothing count only where no other ones are. Raises Refusal, with nothing changed.
    """
    placed = follow_offset.matrices(obj, drawing, keys)
    bones = [bone for bone in rig.pose.bones if bone.bone.use_deform] or list(rig.pose.bones)
    if not bones:
        raise Refusal(f"'{rig.name}' has no bones: choose another armature")
    matrix = rig.matrix_world
    ends = [(matrix @ bone.head, matrix @ bone.tail) for bone in bones]
    heads, tails = (
        drawing.from_world(np.array([pair[end] for pair in ends], np.float64))[:, :2] for end in (0, 1)
    )
    before = carrying.Before(obj, placed)
    with controls.given():
        for key, (at, _) in placed.items():
            place = drawing.from_world(at[None, :3, 3])[0, :2]
            pin = obj.planar.pins[key]
            pin.follow, pin.follow_group = rig, ""
            pin.follow_bone = bones[nearest_segment(place, heads, tails)].name
        try:
            follow_offset.keep(obj, placed)
        except Refusal:
            before.restore()
            raise
    before.tidy()
