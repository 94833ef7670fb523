# SPDX-License-Identifier: GPL-3.0-or-later
"""Digests of shapes are made once, and again when a shape of that object has changed."""

import bpy
from sequences import go_to, key
from support import bar


def test_only_the_objects_own_edits_make_them_anew():
    from planar_deform.scene.sequence.pose_blocks import FIRST, block_at
    from planar_deform.scene.storage import digests, points

    first, second = bar(name="First"), bar(name="Second")
    for obj in (first, second):
        key(obj, 1, 1)
        key(obj, 11, 2)
    read = []

    def found(obj):
        def bits():
            read.append(obj.name)
            return points.bits(obj, block_at(obj.data.shape_keys, FIRST))

        return digests.of_block(obj, FIRST, bits)

    before = found(first)
    assert found(second) == before, "the same shapes"
    go_to(6)
    found(first)
    block_at(second.data.shape_keys, FIRST).data[0].co.x = 0.25
    bpy.context.view_layer.update()
    assert found(first) == before
    assert found(second) != before
    assert read == ["First", "Second", "Second"]
    bpy.ops.ed.undo_push(message="Start")
    found(bpy.data.objects["First"])
    bpy.ops.ed.undo_push(message="Nothing")
    bpy.ops.ed.undo()
    assert found(bpy.data.objects["First"]) == before
    assert read[3:] == ["First"], "after an undo nothing is taken for granted"


def test_few_objects_have_theirs_kept():
    from planar_deform.scene.storage import digests

    for index in range(digests.CAPACITY + 3):
        digests.of_block(bar(name=f"Cutout {index}"), 0.0, lambda: b"")
    assert len(digests._known) <= digests.CAPACITY
