# SPDX-License-Identifier: GPL-3.0-or-later
"""Which poses are neighbours of a frame, and what the onion skin shows of them."""

import bpy
import numpy as np
import pytest
from sequences import curve_of, go_to, key, same, write
from support import bar, make_object


def neighbours(obj, frame):
    from planar_deform.scene.sequence.neighbours import around

    return tuple(None if found is None else (found.pose, found.frame) for found in around(obj, frame))


def onion():
    from planar_deform.scene.view.onion import of_active

    return of_active(bpy.context)


def onion_of(obj):
    with bpy.context.temp_override(object=obj):
        return onion()


def keyed_bar():
    obj = bar()
    poses = [key(obj, frame, seed) for seed, frame in enumerate((1, 25, 49))]
    obj.planar.show_onion = True
    return obj, poses


@pytest.mark.parametrize(
    ("frame", "expected"),
    [
        (0, (None, (0, 1))),
        (1, (None, (1, 25))),
        (13, ((0, 1), (1, 25))),
        (24.999, ((0, 1), (2, 49))),
        (25, ((0, 1), (2, 49))),
        (25.5, ((1, 25), (2, 49))),
        (60, ((2, 49), None)),
    ],
)
def test_the_neighbours_of_a_frame(frame, expected):
    obj, _ = keyed_bar()
    assert neighbours(obj, frame) == expected


def test_a_repeated_pose_is_a_neighbour_where_it_is_keyed_and_retiming_keys_are_none():
    obj, _ = keyed_bar()
    curve = curve_of(obj)
    curve.keyframe_points.insert(61, obj.planar.poses[0].at)
    curve.keyframe_points.insert(37, obj.planar.poses[1].at + 3.0)
    assert neighbours(obj, 40) == ((1, 25), (2, 49))
    assert neighbours(obj, 55) == ((2, 49), (0, 61))


def test_the_onion_has_the_outlines_of_the_neighbours():
    obj, poses = keyed_bar()
    go_to(13)
    seen = onion()
    assert len(seen.edges) == 2 * (12 + 4)
    assert same(seen.before, poses[0])
    assert same(seen.behind, poses[1])
    go_to(49)
    assert same(onion().before, poses[1])
    assert onion().behind is None
    obj.planar.show_onion = False
    assert onion() is None


def test_the_outline_has_holes_and_loose_edges():
    from planar_deform.scene.view.onion import outline

    ring = [(x, y, 0.0) for y in range(4) for x in range(4)]
    corners = [row * 4 + column for row in range(3) for column in range(3)]
    faces = [(i, i + 1, i + 5, i + 4) for i in corners if i != 5]
    obj = make_object([*ring, (5.0, 0.0, 0.0)], faces, edges=[(3, 16)])
    assert len(outline(obj)) == 12 + 4 + 1


def test_it_is_read_again_only_when_it_is_another_one():
    obj, _ = keyed_bar()
    go_to(13)
    seen = onion()
    go_to(20)
    assert onion() is seen
    write(obj, 7)
    assert onion() is seen, "posing elsewhere leaves the neighbours as they are"
    go_to(25)
    edited = write(obj, 8)
    go_to(13)
    assert onion() is not seen
    assert same(onion().behind, edited)


def test_it_follows_edits_and_undo():
    _, poses = keyed_bar()
    go_to(13)
    bpy.ops.ed.undo_push(message="Start")
    bpy.ops.planar.delete_pose(pose=1)
    bpy.ops.ed.undo_push(message="Delete")
    assert same(onion().behind, poses[2])
    bpy.ops.ed.undo()
    assert same(onion().behind, poses[1])


def test_two_windows_have_their_own_and_another_objects_edits_drop_neither(monkeypatch):
    from planar_deform.scene.sequence.pose_blocks import block_at
    from planar_deform.scene.view import onion as module

    objects = [keyed_bar()[0], keyed_bar()[0]]
    go_to(13)
    read, outline = [], module.outline
    monkeypatch.setattr(module, "outline", lambda obj: read.append(obj.name) or outline(obj))
    shown = [onion_of(obj) for obj in objects]
    assert len(read) == 2
    third = bar(name="Third")
    third.data.vertices[0].co.x = 0.5
    third.data.update()
    bpy.context.view_layer.update()
    assert [onion_of(obj) for obj in objects] == shown
    assert len(read) == 2
    block_at(objects[0].data.shape_keys, objects[0].planar.poses[0].at).data[0].co.x = 0.25
    bpy.context.view_layer.update()
    assert [onion_of(obj) is seen for obj, seen in zip(objects, shown, strict=True)] == [False, True]
    assert read[2:] == [objects[0].name]


def test_it_is_seen_in_edit_mode_and_on_objects_with_poses_only():
    _, poses = keyed_bar()
    bpy.ops.object.mode_set(mode="EDIT")
    assert np.array_equal(onion().before, poses[1])
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.planar.clear_poses()
    assert onion() is None
    bar(name="Other").planar.show_onion = True
    assert onion() is None
