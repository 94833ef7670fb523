# SPDX-License-Identifier: GPL-3.0-or-later
"""In-betweens are out of date when what they were made with has changed, and the panel says what."""

import bpy
import numpy as np
import pytest
from filling import bent_bar, generate, stale
from sequences import go_to, same, shown_at
from support import PLANES, activate, add_end_pins, add_pins


def note(obj):
    from planar_deform.ui.panels import poses_panel

    bpy.context.view_layer.update()
    return poses_panel._stale_note(obj, stale(obj))


def pinned(**options):
    obj, _ = bent_bar(**options)
    add_end_pins(obj)
    generate(obj)
    assert note(obj) is None
    return obj


def switch_off(obj):
    obj.planar.pins[0].enabled = False


def remove(obj):
    bpy.ops.planar.remove_pins()


def add(obj):
    add_pins(obj, [20, 21])


def paint(obj):
    obj.vertex_groups[obj.planar.pins[0].group].add([30], 0.5, "REPLACE")


@pytest.mark.parametrize("change", [switch_off, remove, add, paint])
def test_pins(change):
    obj = pinned()
    change(obj)
    assert note(obj) == (
        "Out of date: Pose to Pose.001 (pins), Pose.001 to Pose.002 (pins). "
        "Generate In-Betweens fills them anew"
    )
    generate(obj)
    assert note(obj) is None


def test_what_does_not_matter_of_pins():
    obj = pinned()
    obj.planar.pins[0].name = "Foot"
    obj.vertex_groups[obj.planar.pins[1].group].name = "Hand"
    obj.planar.pins[0].weight = 3.0
    bpy.ops.planar.select_pins(action="ALL")
    bpy.context.view_layer.update()
    assert note(obj) is None


@pytest.mark.parametrize("plane", ["XY", "XZ"])
def test_scale(plane):
    obj = pinned(plane=plane)
    obj.scale = (2.0, 2.0, 2.0)
    obj.rotation_euler = (1.5708, 0.0, 0.3)
    assert note(obj) is None, "as large as it is, it is the same"
    normal = int(np.abs(PLANES[plane] @ [0, 0, 1]).argmax())
    obj.scale[normal] = 5.0
    assert note(obj) is None, "nor does its depth count"
    obj.scale[0] = -2.0
    assert note(obj) is None
    obj.scale[0] = 3.0
    assert "Pose to Pose.001 (scale)" in note(obj)
    generate(obj)
    assert note(obj) is None


def test_a_scale_that_is_animated_says_nothing():
    obj = pinned()
    obj.keyframe_insert("scale", frame=1)
    obj.scale[0] = 3.0
    obj.keyframe_insert("scale", frame=25)
    generate(obj)
    go_to(1)
    assert note(obj) is None


def test_timing_counts_where_the_motion_is_smooth():
    obj = pinned()
    obj.planar.poses[2].frame = 61
    assert note(obj) is None
    obj.planar.smooth = True
    generate(obj)
    assert note(obj) is None
    obj.planar.poses[2].frame = 49
    assert "(timing)" in note(obj)
    generate(obj)
    assert note(obj) is None


def test_files_of_before_are_not_out_of_date():
    obj = pinned()
    for pose in obj.planar.poses:
        pose.made_with = ""
    switch_off(obj)
    assert note(obj) is None


def test_edited_stretches_stay_as_they_are():
    obj = pinned()
    go_to(13)
    assert bpy.ops.planar.drag_pins(offset=(0.0, 0.1)) == {"FINISHED"}
    assert bpy.ops.planar.edit_sequence(keep_poses=True) == {"FINISHED"}
    edited = shown_at(obj, 13)
    switch_off(obj)
    activate(obj)
    assert note(obj) == "Out of date: Pose.001 to Pose.002 (pins). Generate In-Betweens fills them anew"
    generate(obj)
    assert same(shown_at(obj, 13), edited)
