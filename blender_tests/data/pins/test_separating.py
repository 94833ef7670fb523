# SPDX-License-Identifier: GPL-3.0-or-later
"""What is separated from a drawing has the pins that are on it; joined again it is as it was."""

import bpy
import pytest
from figures import drag, gaps, pin_at, pinned
from support import activate, in_edit_mode


def character():
    """A figure of four layers with three hinges, a patch on the chest, and a hand that is dragged."""
    obj = pinned()
    pin_at(obj, (2.5, 2.6), "Hand")
    drag(obj, "Hand", (0.05, 0.3))
    obj.planar.pins["Hand"].weight = 2.0
    return obj


def separated(obj, way):
    if way == "edit mode":
        in_edit_mode(obj, lambda: bpy.ops.mesh.separate(type="LOOSE"), select=lambda _vertex: True)
    else:
        activate(obj)
        for index in range(4):
            obj.data.materials.append(bpy.data.materials.new(str(index)))
        parts = [part.index(True) for part in _parts_of_faces(obj)]
        for face, part in zip(obj.data.polygons, parts, strict=True):
            face.material_index = part
        bpy.context.view_layer.update()
        assert bpy.ops.mesh.separate(type="MATERIAL") == {"FINISHED"}
    bpy.context.view_layer.update()
    return [other for other in bpy.data.objects if other.type == "MESH"]


def _parts_of_faces(obj):
    heights = sorted({round(vertex.co.z, 5) for vertex in obj.data.vertices})
    return [
        [round(obj.data.vertices[face.vertices[0]].co.z, 5) == height for height in heights]
        for face in obj.data.polygons
    ]


def listed(obj):
    """The pins by name, with kinds, groups and weights."""
    return sorted((pin.name, pin.kind, pin.group, round(pin.weight, 3)) for pin in obj.planar.pins)


def held(obj, group):
    index = obj.vertex_groups[group].index
    return any(one.group == index for vertex in obj.data.vertices for one in vertex.groups)


@pytest.mark.parametrize("way", ["edit mode", "by material"])
def test_each_piece_has_the_pins_that_are_on_it(way):
    whole = listed(obj := character())
    pieces = separated(obj, way)
    assert len(pieces) == 4
    for piece in pieces:
        assert all(held(piece, pin.group) for pin in piece.planar.pins)
        assert {pin.group for pin in piece.planar.pins} == {group.name for group in piece.vertex_groups}
    names = [pin.name for piece in pieces for pin in piece.planar.pins if pin.kind in {"POINT", "PATCH"}]
    assert sorted(names) == ["Chest", "Hand"]
    hand = next(piece for piece in pieces if "Hand" in piece.planar.pins)
    activate(hand)
    bpy.ops.planar.select_pins(action="ALL")
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.0)) == {"FINISHED"}

    activate(pieces[-1])
    for piece in pieces:
        piece.select_set(True)
    assert bpy.ops.object.join() == {"FINISHED"}
    bpy.context.view_layer.update()
    again = bpy.context.object
    assert listed(again) == whole
    assert len(gaps(again)) == 3, "all joints hold two parts again"


@pytest.mark.parametrize("way", ["edit mode", "by material"])
def test_undo_brings_all_pins_back(way):
    obj = character()
    name, whole = obj.name, listed(obj)
    bpy.ops.ed.undo_push(message="Whole")
    separated(obj, way)
    bpy.ops.ed.undo_push(message="Separated")
    bpy.ops.ed.undo()
    bpy.context.view_layer.update()
    assert len([one for one in bpy.data.objects if one.type == "MESH"]) == 1
    assert listed(bpy.data.objects[name]) == whole
    bpy.ops.ed.redo()
    bpy.context.view_layer.update()
    pieces = [one for one in bpy.data.objects if one.type == "MESH"]
    assert len(pieces) == 4
    assert all(held(piece, pin.group) for piece in pieces for pin in piece.planar.pins)


def test_pins_of_a_duplicate_wait_where_their_vertices_are_deleted():
    obj = character()
    activate(obj)
    bpy.ops.object.duplicate()
    copy = bpy.context.object
    hand = copy.vertex_groups[copy.planar.pins["Hand"].group].index
    rows = [one.index for one in copy.data.vertices if any(group.group == hand for group in one.groups)]
    in_edit_mode(copy, lambda: bpy.ops.mesh.delete(type="VERT"), select=lambda vertex: vertex.index in rows)
    assert len(copy.planar.pins) == len(obj.planar.pins)
