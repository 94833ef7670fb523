# SPDX-License-Identifier: GPL-3.0-or-later
"""With relative shape keys the active key is posed, and what is solved is the shape shown."""

import bpy
import numpy as np
import pytest
from support import activate, add_end_pins, bar, coordinates, evaluated, measured, pose


def key_points(obj, name):
    return coordinates(obj.data.shape_keys.key_blocks[name].data)


def add_key(obj, name, value=1.0, seed=None, relative=None, group=None):
    """A key that moves every vertex a little in the plane."""
    if obj.data.shape_keys is None:
        obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name=name, from_mix=False)
    key.value = value
    points = coordinates(key.data)
    if seed is not None:
        points[:, :2] += np.random.default_rng(seed).uniform(-0.02, 0.02, (len(points), 2))
        key.data.foreach_set("co", points.ravel())
    if relative is not None:
        key.relative_key = obj.data.shape_keys.key_blocks[relative]
    if group is not None:
        key.vertex_group = group
    obj.active_shape_key_index = len(obj.data.shape_keys.key_blocks) - 1
    return key


def activate_key(obj, name):
    obj.active_shape_key_index = obj.data.shape_keys.key_blocks.find(name)


def refusal(obj):
    from planar_deform.errors import Refusal
    from planar_deform.scene.objects.cutout_object import begin

    activate(obj)
    with pytest.raises(Refusal) as caught:
        begin(bpy.context)
    return str(caught.value)


def assert_shown_is_solved(obj):
    """The shape read is what Blender evaluates."""
    from planar_deform.scene.objects.cutout_object import begin

    activate(obj)
    drawing = begin(bpy.context)
    shown = evaluated(obj)[drawing.vertex_indices]
    assert np.abs(drawing.positions - drawing.from_local(shown.astype(float))).max() < 1e-6


def test_an_active_basis_gets_a_key_named_pose():
    obj = bar()
    obj.shape_key_add(name="Basis")
    add_end_pins(obj)
    basis = key_points(obj, "Basis")
    pose(obj, offset=(0.0, 0.5))
    keys = obj.data.shape_keys
    assert [key.name for key in keys.key_blocks] == ["Basis", "Pose"]
    assert obj.active_shape_key.name == "Pose"
    assert obj.active_shape_key.value == 1.0
    assert np.array_equal(key_points(obj, "Basis"), basis)
    assert np.array_equal(coordinates(obj.data.vertices), basis)
    assert np.abs(evaluated(obj) - basis).max() > 0.3
    pose(obj, offset=(0.1, 0.0))  # the second posing goes into the same key
    assert len(keys.key_blocks) == 2


def test_a_pose_key_starts_from_the_basis_not_from_the_mesh():
    obj = bar()
    obj.shape_key_add(name="Basis")
    add_end_pins(obj)
    obj.data.vertices.foreach_set("co", (coordinates(obj.data.vertices) * 3).ravel())
    basis = key_points(obj, "Basis")
    from planar_deform.scene.objects.cutout_object import begin

    activate(obj)
    drawing = begin(bpy.context)
    drawing.write(drawing.positions)
    assert np.array_equal(key_points(obj, "Pose"), basis)


def test_restore_takes_the_new_pose_key_away_again():
    from planar_deform.scene.objects.cutout_object import begin

    obj = bar()
    obj.shape_key_add(name="Basis")
    add_key(obj, "Smile", 0.5, seed=1)
    activate_key(obj, "Basis")
    before = {key.name: coordinates(key.data) for key in obj.data.shape_keys.key_blocks}
    shown = evaluated(obj)
    drawing = begin(bpy.context)
    drawing.write(drawing.positions + 0.2)
    assert "Pose" in obj.data.shape_keys.key_blocks
    drawing.write(drawing.positions + 0.4)
    drawing.restore()
    after = {key.name: coordinates(key.data) for key in obj.data.shape_keys.key_blocks}
    assert after.keys() == before.keys()
    assert all(np.array_equal(after[name], before[name]) for name in before)
    assert obj.active_shape_key.name == "Basis"
    assert np.array_equal(evaluated(obj), shown)


def test_the_active_key_alone_is_written_and_unmoved_vertices_keep_their_bits():
    obj = bar()
    add_key(obj, "Smile", 0.7, seed=1)
    add_key(obj, "Pose", 1.0)
    add_end_pins(obj)
    before = {key.name: coordinates(key.data) for key in obj.data.shape_keys.key_blocks}
    mesh = coordinates(obj.data.vertices)
    drawing, _ = pose(obj, offset=(0.0, 0.4))
    for name in ("Basis", "Smile"):
        assert np.array_equal(key_points(obj, name), before[name])
    assert np.array_equal(coordinates(obj.data.vertices), mesh)
    drawing.restore()
    assert np.array_equal(key_points(obj, "Pose").view(np.uint32), before["Pose"].view(np.uint32))


@pytest.mark.parametrize("value", [1.0, 0.3, 2.5, -0.8])
def test_a_pose_shows_in_full_whatever_the_value_of_its_key(value):
    obj = bar()
    key = add_key(obj, "Pose", seed=4)
    key.slider_min, key.slider_max = -1.0, 3.0
    key.value = value
    add_key(obj, "Other", 0.4, seed=5)
    activate_key(obj, "Pose")
    add_end_pins(obj)
    assert_shown_is_solved(obj)
    drawing, posing = pose(obj, offset=(0.0, 0.5))
    assert np.abs(drawing.from_local(evaluated(obj).astype(float)) - posing.positions).max() < 2e-6


def test_mutes_relative_chains_and_masks_show_as_blender_evaluates_them():
    obj = bar()
    group = obj.vertex_groups.new(name="Mask")
    for row in range(30):
        group.add([row], row / 30.0, "REPLACE")
    add_key(obj, "A", 0.6, seed=1)
    add_key(obj, "Muted", 0.9, seed=2).mute = True
    add_key(obj, "OnA", 0.5, seed=3, relative="A")
    add_key(obj, "Masked", 0.8, seed=4, group="Mask")
    add_key(obj, "MissingMask", 0.3, seed=5, group="Nothing")
    add_key(obj, "OnMuted", 0.7, seed=6, relative="Muted")
    add_key(obj, "OnItself", 0.7, seed=7, relative="Basis").relative_key = obj.data.shape_keys.key_blocks[
        "OnA"
    ]
    add_key(obj, "Pose", 1.0, seed=8)
    assert_shown_is_solved(obj)


@pytest.mark.parametrize("child", [0.5, 0.9])
def test_keys_relative_to_the_posed_one_are_counted(child):
    obj = bar()
    add_key(obj, "Pose", 1.0, seed=1)
    add_key(obj, "OnPose", child, seed=2, relative="Pose")
    activate_key(obj, "Pose")
    add_end_pins(obj)
    assert_shown_is_solved(obj)
    drawing, posing = pose(obj, offset=(0.1, 0.4))
    # The share is 1 - child: the key's own float32 rounding is divided by it.
    limit = 1e-6 / (1.0 - child)
    assert np.abs(drawing.from_local(evaluated(obj).astype(float)) - posing.positions).max() < limit


def test_a_key_whose_effect_is_cancelled_by_another_is_refused():
    obj = bar()
    add_key(obj, "Pose", 1.0, seed=1)
    add_key(obj, "OnPose", 1.0, seed=2, relative="Pose")
    activate_key(obj, "Pose")
    assert "relative to it" in refusal(obj)


def test_a_mask_on_the_posed_key_is_right_where_it_lets_through_and_refused_where_not():
    obj = bar()
    group = obj.vertex_groups.new(name="Mask")
    group.add(list(range(65)), 0.5, "REPLACE")
    add_key(obj, "Pose", 1.0, seed=1, group="Mask")
    add_end_pins(obj)
    drawing, posing = pose(obj, offset=(0.0, 0.4))
    assert np.abs(drawing.from_local(evaluated(obj).astype(float)) - posing.positions).max() < 2e-6
    group.remove([7])
    assert "Mask" in refusal(obj)


def test_shape_key_lock_shows_and_poses_the_active_key_alone():
    obj = bar()
    add_key(obj, "Other", 1.0, seed=1)
    add_key(obj, "Pose", 0.0, seed=2)
    obj.show_only_shape_key = True
    add_end_pins(obj)
    assert_shown_is_solved(obj)
    drawing, posing = pose(obj, offset=(0.0, 0.4))
    assert np.abs(drawing.from_local(evaluated(obj).astype(float)) - posing.positions).max() < 1e-6
    activate_key(obj, "Basis")
    assert "Lock" in refusal(obj)


def test_shape_key_lock_with_a_mask():
    obj = bar()
    obj.vertex_groups.new(name="Mask").add(list(range(65)), 0.25, "REPLACE")
    add_key(obj, "Pose", 0.0, seed=2, group="Mask")
    obj.show_only_shape_key = True
    assert_shown_is_solved(obj)


def test_refusals_name_the_remedy():
    obj = bar()
    key = add_key(obj, "Pose", 1.0, seed=1)
    key.mute = True
    assert "muted" in refusal(obj)
    key.mute = False
    key.value = 0.0
    assert "raise its value" in refusal(obj)
    key.value = 1.0
    key.lock_shape = True
    assert "lock" in refusal(obj)
    key.lock_shape = False
    obj.data.shape_keys.use_relative = False
    assert "Relative" in refusal(obj)
    assert not bpy.ops.planar.add_pin.poll()


def test_the_basis_is_the_rest_and_no_attribute_is_made():
    from planar_deform.scene.objects.cutout_object import begin

    obj = bar()
    add_key(obj, "Pose", 1.0, seed=3)
    add_end_pins(obj)
    pose(obj, offset=(0.0, 0.5))
    assert "planar_rest" not in obj.data.attributes
    drawing = begin(bpy.context)
    assert drawing.cutout.rest == pytest.approx(drawing.from_local(key_points(obj, "Basis").astype(float)))


def test_reset_takes_the_posed_keys_difference_away_and_nothing_else():
    obj = bar()
    add_key(obj, "Smile", 0.5, seed=1)
    add_key(obj, "Pose", 1.0)
    smiling = evaluated(obj)
    add_end_pins(obj)
    pose(obj, offset=(0.0, 0.5))
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert np.array_equal(key_points(obj, "Pose"), key_points(obj, "Basis"))
    assert np.abs(evaluated(obj) - smiling).max() < 1e-6


def test_reset_with_an_active_basis_makes_no_key():
    obj = bar()
    obj.shape_key_add(name="Basis")
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert len(obj.data.shape_keys.key_blocks) == 1


@pytest.mark.parametrize("lock", [False, True])
def test_set_rest_to_current_keeps_what_is_shown(lock):
    obj = bar()
    add_key(obj, "Smile", 0.5, seed=1)
    add_key(obj, "OnSmile", 0.4, seed=2, relative="Smile")
    add_key(obj, "Pose", 0.6, seed=3)
    add_key(obj, "OnPose", 0.3, seed=4, relative="Pose")
    activate_key(obj, "Pose")
    obj.show_only_shape_key = lock
    add_end_pins(obj)
    pose(obj, offset=(0.0, 0.4))
    shown = evaluated(obj)
    basis = key_points(obj, "Basis")
    assert bpy.ops.planar.set_rest_to_current() == {"FINISHED"}
    assert np.abs(evaluated(obj) - shown).max() < 1e-6
    assert np.abs(key_points(obj, "Basis") - basis).max() > 0.1
    assert np.abs(key_points(obj, "Pose") - key_points(obj, "Basis")).max() < 1e-6
    assert np.array_equal(coordinates(obj.data.vertices), key_points(obj, "Basis"))


def test_vertices_extruded_in_the_posed_key_are_solved_with_a_rest_of_their_own():
    """Blender leaves their Basis on the vertices they came from; the Basis is the user's and stays."""
    obj = bar()
    add_key(obj, "Pose", 1.0)
    add_end_pins(obj)
    pose(obj, offset=(0.0, 0.4))
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    for row in range(5):
        obj.data.vertices[12 + 13 * row].select = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": (0.3, 0.0, 0.0)})
    bpy.ops.object.mode_set(mode="OBJECT")
    basis = key_points(obj, "Basis")
    drawing, _ = pose(obj, offset=(0.0, 0.1))
    new = drawing.cutout.rest[65:]
    assert np.linalg.norm(new - drawing.cutout.rest[[12 + 13 * row for row in range(5)]], axis=1).min() > 0.2
    assert measured(obj).flipped == 0
    assert np.array_equal(key_points(obj, "Basis"), basis)


def test_keys_relative_to_each_other_in_a_circle_cannot_become_the_rest():
    obj = bar()
    first = add_key(obj, "First", 0.5, seed=1)
    add_key(obj, "Second", 0.5, seed=2, relative="First")
    first.relative_key = obj.data.shape_keys.key_blocks["Second"]
    before = {key.name: coordinates(key.data) for key in obj.data.shape_keys.key_blocks}
    with pytest.raises(RuntimeError, match="relative to the Basis"):
        bpy.ops.planar.set_rest_to_current()
    assert all(np.array_equal(key_points(obj, name), points) for name, points in before.items())
