# SPDX-License-Identifier: GPL-3.0-or-later
"""Painted stiffness: the group, what the solver gets of it, and what it does; and the weights of pins."""

import bpy
import numpy as np
import pytest
from support import activate, add_end_pins, bar, coordinates, make_object, pose


@pytest.fixture
def obj():
    made = bar()
    add_end_pins(made)
    return made


def cutout(obj):
    from planar_deform.scene.objects.cutout_object import begin

    activate(obj)
    return begin(bpy.context).cutout


def paint(obj, weights):
    """A stiffness group with these weights of the vertices."""
    from planar_deform.scene.objects import stiffness
    from planar_deform.scene.pins import pin_list

    group = stiffness.ensure_group(obj)
    for vertex, weight in enumerate(weights):
        group.add([vertex], float(weight), "REPLACE")
    pin_list.sync(obj)


def bends(obj):
    """How far the edges along the bar's top turn from one to the next, in radians."""
    top = coordinates(obj.data.vertices)[52:65, :2].astype(float)
    angles = np.arctan2(*np.diff(top, axis=0).T[::-1])
    return np.abs(np.diff(angles))


def test_a_new_group_is_neutral_and_stiffens_nothing(obj):
    plain = obj.copy()
    plain.data = obj.data.copy()
    bpy.context.scene.collection.objects.link(plain)
    assert cutout(obj).stiffness is None
    activate(obj)
    assert bpy.ops.planar.paint_stiffness() == {"FINISHED"}
    assert bpy.context.mode == "PAINT_WEIGHT"
    group = obj.vertex_groups.active
    assert obj.planar.stiffness_group == group.name == "Stiffness"
    assert all(group.weight(vertex.index) == 0.5 for vertex in obj.data.vertices)
    bpy.ops.object.mode_set(mode="OBJECT")
    np.testing.assert_array_equal(cutout(obj).stiffness, 1.0)
    for each in (obj, plain):
        pose(each, offset=(-0.3, 0.4))
    assert np.array_equal(coordinates(obj.data.vertices), coordinates(plain.data.vertices))


def test_painting_again_opens_the_group_there_is(obj):
    paint(obj, np.linspace(0.0, 1.0, 65))
    other = obj.vertex_groups.new(name="Other")
    obj.vertex_groups.active_index = other.index
    bpy.ops.planar.paint_stiffness()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert obj.vertex_groups.active.name == "Stiffness"
    assert obj.vertex_groups["Stiffness"].weight(64) == 1.0
    assert len(obj.vertex_groups) == 4


def test_triangles_take_the_mean_of_their_vertices(obj):
    weights = np.linspace(0.0, 1.0, 65).astype(np.float32)
    paint(obj, weights)
    made = cutout(obj)
    expected = 100.0 ** (2.0 * weights.astype(float)[made.triangles].mean(axis=1) - 1.0)
    np.testing.assert_allclose(made.stiffness, expected, rtol=1e-12)


def test_loose_vertices_shift_nothing_and_vertices_outside_of_the_group_are_neutral():
    vertices = [(9, 9, 0), (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    obj = make_object(vertices, [(1, 2, 3), (1, 3, 4)])
    group = obj.vertex_groups.new(name="Hard")
    group.add([0, 2], 1.0, "REPLACE")
    obj.planar.stiffness_group = "Hard"
    np.testing.assert_allclose(cutout(obj).stiffness, [100.0 ** (1.0 / 3.0), 1.0], rtol=1e-12)


def test_a_stiff_half_leaves_the_bending_to_the_other(obj):
    pose(obj, offset=(-0.4, 0.6))
    even = bends(obj)
    bpy.ops.planar.reset_to_rest()
    x = coordinates(obj.data.vertices)[:, 0]
    paint(obj, np.where(x > 1.01, 1.0, 0.5))
    pose(obj, offset=(-0.4, 0.6))
    uneven = bends(obj)
    # Edge 0-1 to 11-12; the vertex in the middle is the sixth, bend 5, and half of its triangles are stiff.
    assert uneven[6:].sum() < 0.2 * even[6:].sum()
    assert uneven[:5].sum() > 1.2 * even[:5].sum()


def test_the_group_is_followed_when_it_is_renamed_and_missed_when_it_is_gone(obj):
    from planar_deform.scene.objects import stiffness
    from planar_deform.scene.pins import pin_list

    paint(obj, np.ones(65))
    obj.vertex_groups["Stiffness"].name = "Hard"
    pin_list.sync(obj)
    assert obj.planar.stiffness_group == "Hard"
    assert not stiffness.missing(obj)
    obj.vertex_groups.remove(obj.vertex_groups[0])  # a pin's group: indices shift
    pin_list.sync(obj)
    assert obj.planar.stiffness_group == "Hard"
    obj.vertex_groups["Hard"].name = "Harder"
    pin_list.sync(obj)
    assert obj.planar.stiffness_group == "Harder"
    np.testing.assert_allclose(cutout(obj).stiffness, 100.0)
    obj.vertex_groups.remove(obj.vertex_groups["Harder"])
    pin_list.sync(obj)
    assert stiffness.missing(obj)
    assert cutout(obj).stiffness is None
    assert bpy.ops.planar.paint_stiffness() == {"FINISHED"}
    assert obj.planar.stiffness_group == "Stiffness"
    assert not stiffness.missing(obj)


def test_a_cleared_setting_stays_clear(obj):
    from planar_deform.scene.objects import stiffness
    from planar_deform.scene.pins import pin_list

    paint(obj, np.ones(65))
    obj.planar.stiffness_group = ""
    pin_list.sync(obj)
    assert obj.planar.stiffness_group == ""
    assert not stiffness.missing(obj)
    assert cutout(obj).stiffness is None


def test_the_group_is_no_pin(obj):
    paint(obj, np.ones(65))
    obj.vertex_groups.new(name="Third").add([30], 1.0, "REPLACE")
    bpy.ops.planar.add_pins_from_all_groups(kind="POINT")
    assert [pin.group for pin in obj.planar.pins][2:] == ["Third"]


def test_an_action_tells_what_it_was_solved_with(obj):
    pose(obj, offset=(0.0, 0.2))
    plain = obj.planar.solved_stiffness
    paint(obj, np.full(65, 0.5))
    pose(obj, offset=(0.0, 0.2))
    assert obj.planar.solved_stiffness == plain, "neutral is as good as none"
    paint(obj, np.linspace(0.0, 1.0, 65))
    pose(obj, offset=(0.0, 0.2))
    assert obj.planar.solved_stiffness not in {"", plain}


@pytest.mark.parametrize("case", ["hidden", "edit mode", "no faces", "bent", "shared"])
def test_refusals_change_nothing(case):
    obj = bar()
    words = {
        "hidden": "hidden: show it",
        "edit mode": "Object Mode",
        "no faces": "no faces",
        "bent": "flatten the mesh",
        "shared": "single-user",
    }[case]
    if case == "hidden":
        obj.hide_set(True)
    elif case == "edit mode":
        bpy.ops.object.mode_set(mode="EDIT")
    elif case == "no faces":
        obj.data.clear_geometry()
        obj.data.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    elif case == "bent":
        obj.data.vertices[30].co.z = 1.0
    else:
        bpy.context.scene.collection.objects.link(bpy.data.objects.new("Twin", obj.data))
    mode = obj.mode
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.planar.paint_stiffness()
    assert obj.mode == mode
    assert not obj.vertex_groups
    assert obj.planar.stiffness_group == ""


def test_all_pins_together_are_weighed_by_one_factor(obj):
    assert (obj.planar.method, obj.planar.pin_weight) == ("HOLD", 1.0)
    twin = obj.copy()
    twin.data = obj.data.copy()
    bpy.context.scene.collection.objects.link(twin)
    obj.planar.pin_weight = 0.25
    for pin in twin.planar.pins:
        pin.weight = 0.25
    for each in (obj, twin):
        pose(each, offset=(-0.3, 0.4))
    assert np.array_equal(coordinates(obj.data.vertices), coordinates(twin.data.vertices))
    soft = coordinates(obj.data.vertices)
    bpy.ops.planar.reset_to_rest()
    twin.planar.pins[1].weight = 1.0
    activate(twin)
    bpy.ops.planar.reset_to_rest()
    pose(twin, offset=(-0.3, 0.4))
    assert not np.array_equal(soft, coordinates(twin.data.vertices))
