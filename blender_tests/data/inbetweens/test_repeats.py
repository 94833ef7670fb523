# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses that repeat others, when Blender's own panel takes the shape key of one of them away."""

import bpy
import pytest
from filling import bent_bar, generate, stale
from sequences import curve_of, same, shown_at


def test_panels_and_commands_go_on_without_an_original():
    obj, poses = with_repeats()
    panels(obj)
    obj.shape_key_remove(obj.data.shape_keys.key_blocks["Pose"])
    panels(obj)
    assert same(shown_at(obj, 73), poses[1])
    generate(obj)
    panels(obj)
    assert same(shown_at(obj, 73), poses[1])
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    panels(obj)
    assert same(shown_at(obj, 73), poses[1])


@pytest.mark.parametrize("gone", ["Pose Repeat", "Pose.001", "Pose.001 Repeat"])
def test_so_they_do_without_another_one(gone):
    obj, poses = with_repeats()
    obj.shape_key_remove(obj.data.shape_keys.key_blocks[gone])
    panels(obj)
    assert same(shown_at(obj, 1), poses[1])
    generate(obj)
    panels(obj)
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    assert same(shown_at(obj, 1), poses[1])


def test_without_a_basis_the_panels_say_so():
    obj, poses = with_repeats()
    bpy.ops.ed.undo_push(message="Before")
    obj.shape_key_remove(obj.data.shape_keys.key_blocks["Basis"])
    bpy.ops.ed.undo_push(message="Delete Shape Key")
    panels(obj)
    assert same(shown_at(obj, 25), poses[25])
    for operator in ("key_pose", "generate_inbetweens", "remove_inbetweens", "drag_pins"):
        with pytest.raises(RuntimeError, match="Basis"):
            getattr(bpy.ops.planar, operator)()
    bpy.ops.ed.undo()
    obj = bpy.data.objects["Cutout"]
    generate(obj)
    assert same(shown_at(obj, 25), poses[25])


def with_repeats():
    obj, poses = bent_bar()
    points = curve_of(obj).keyframe_points
    for frame, pose in ((73, 0), (97, 1)):
        points.insert(frame, obj.planar.poses[pose].at)
    generate(obj)
    assert [pose.name for pose in obj.planar.poses][3:] == ["Pose Repeat", "Pose.001 Repeat"]
    return obj, poses


def panels(obj):
    """What the panels ask, each time they are drawn."""
    from planar_deform.scene.sequence import pose_list, pose_state
    from planar_deform.scene.view import onion, snapshot

    count = len(obj.planar.poses)
    assert all(0 <= before < count and 0 <= after < count for before, after in stale(obj))
    assert pose_list.step_of(obj) == 1
    for index in range(count):
        pose_state.frames_of(obj, index)
    pose_state.refusal(obj)
    snapshot.of_active(bpy.context)
    obj.planar.show_onion = True
    for frame in (1, 13, 30, 80):
        bpy.context.scene.frame_set(frame)
        onion.of_active(bpy.context)
