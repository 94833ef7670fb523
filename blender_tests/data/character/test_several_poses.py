# SPDX-License-Identifier: GPL-3.0-or-later
"""Several objects keyed, filled, copied and mirrored as one: all of them change, or none."""

import bpy
import numpy as np
import pytest
from several import (
    choose,
    drag,
    figure,
    frames,
    go_to,
    key,
    keyed,
    limb,
    named,
    select,
    state,
    tip,
    two_poses,
)
from support import evaluated

ALL = ("Body", "Arm.L", "Arm.R")


# ---- poses


def test_all_are_keyed_filled_emptied_and_cleared_as_one():
    objects = two_poses()
    assert [frames(obj) for obj in objects] == [[1, 9]] * 3
    before = [state(obj) for obj in objects]
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert [obj.planar.poses[0].generated for obj in objects] == [7, 7, 7]
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    assert [state(obj) for obj in objects] == before
    assert bpy.ops.planar.step_poses(step=2) == {"FINISHED"}
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert [len(obj.planar.poses) for obj in objects] == [0, 0, 0]


def test_only_those_are_filled_that_can_be_and_the_others_are_told(capfd):
    objects = two_poses()
    single = limb("Hat", 9.0)
    choose(*objects, single)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert [obj.planar.poses[0].generated for obj in objects] == [7, 7, 7]
    assert "'Hat' is left out: Key two poses first" in capfd.readouterr().out
    choose(single)
    assert not bpy.ops.planar.generate_inbetweens.poll()


def test_a_body_that_stands_still_keeps_no_arm_from_being_filled(capfd):
    objects = figure()
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    go_to(9)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    with pytest.raises(RuntimeError, match="All poses are alike"):
        bpy.ops.planar.generate_inbetweens()
    capfd.readouterr()
    select("")
    assert bpy.ops.planar.drag_pins(object="Arm.L", pin=1, offset=(0.0, 0.4)) == {"FINISHED"}
    choose(*objects)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert "'Body': All poses are alike" in capfd.readouterr().out
    assert [sum(pose.generated for pose in obj.planar.poses) for obj in objects] == [0, 7, 0]


def test_settings_of_each_decide_on_its_way_unless_told():
    objects = two_poses()
    objects[1].planar.anchor_path = "ARC"
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert [obj.planar.anchor_path for obj in objects] == ["STRAIGHT", "ARC", "STRAIGHT"]
    assert bpy.ops.planar.generate_inbetweens(path="ARC") == {"FINISHED"}
    assert [obj.planar.anchor_path for obj in objects] == ["ARC", "ARC", "ARC"]


def test_a_pose_moved_in_the_list_takes_those_of_its_frame_along():
    objects = two_poses()
    objects[2].planar.poses[1].frame = 20  # of an object that is not active, alone
    assert [frames(obj) for obj in objects] == [[1, 9], [1, 9], [1, 20]]
    objects[0].planar.poses[1].frame = 12
    assert [frames(obj) for obj in objects] == [[1, 12], [1, 12], [1, 20]]
    objects[0].planar.poses[0].frame = 30  # past others
    assert [sorted(frames(obj)) for obj in objects] == [[12, 30], [12, 30], [20, 30]]
    go_to(16)
    assert bpy.ops.planar.retime_pose(pose=1) == {"FINISHED"}
    assert [sorted(frames(obj)) for obj in objects] == [[12, 16], [12, 16], [16, 20]]


def test_a_frame_that_is_taken_in_one_moves_none(capfd):
    objects = two_poses()
    choose(objects[2])
    key(14, (0.1, 0.0))
    choose(*objects)
    before = [state(obj) for obj in objects]
    objects[0].planar.poses[1].frame = 14
    assert [state(obj) for obj in objects] == before
    go_to(14)
    before = [state(obj) for obj in objects]
    with pytest.raises(RuntimeError, match=r"'Arm\.R': Frame 14 has a key"):
        bpy.ops.planar.retime_pose(pose=1)
    assert [state(obj) for obj in objects] == before


def test_poses_of_a_frame_are_deleted_updated_and_duplicated_together(capfd):
    objects = two_poses()
    choose(objects[2])
    objects[2].planar.poses[1].frame = 20
    choose(*objects)
    go_to(15)
    assert bpy.ops.planar.duplicate_pose(pose=1) == {"FINISHED"}
    assert [len(obj.planar.poses) for obj in objects] == [3, 3, 2]
    assert "'Arm.R' is left out: it has no pose there" in capfd.readouterr().out
    assert bpy.ops.planar.jump_to_pose(pose=0) == {"FINISHED"}
    assert bpy.context.scene.frame_current == 1
    drag((0.0, 0.1))
    shapes = [evaluated(obj) for obj in objects]
    go_to(9)
    assert bpy.ops.planar.delete_pose(pose=0) == {"FINISHED"}
    assert [frames(obj) for obj in objects] == [[9, 15], [9, 15], [20]]
    go_to(1)
    assert not np.array_equal(evaluated(objects[0]), shapes[0])


def test_each_keeps_its_own_curve_and_timing():
    objects = two_poses()
    curve = keyed(objects[1])
    actions = {obj.data.shape_keys.animation_data.action.name for obj in objects}
    assert len(actions) == 3
    choose(objects[0])
    objects[0].planar.poses[1].frame = 25
    assert keyed(objects[1]) == curve


@pytest.mark.parametrize("ease", [0.0, 25.0, 60.0, 110.0])
def test_a_breakdown_is_of_all_at_the_same_share(ease):
    objects = two_poses()
    go_to(5)
    assert bpy.ops.planar.breakdown(percent=ease, overshoot=True) == {"FINISHED"}
    assert [frames(obj) for obj in objects] == [[1, 5, 9]] * 3
    first, second, third = (evaluated(obj) for obj in objects)
    assert np.abs(first - second).max() < 1e-5
    assert np.abs(first - third).max() < 1e-5
    assert all(keys[1][-1] == "BREAKDOWN" for keys in map(keyed, objects))


def test_recording_keys_all_that_were_dragged():
    from planar_deform.operators.drag import pack_path

    objects = figure()
    still = limb("Still", 9.0)
    select(objects=[still])
    choose(*objects, still)
    for pin in still.planar.pins:
        pin.select = False
    path = pack_path([(0.05 * step, 0.1 * step, 0.0) for step in range(6)])
    assert bpy.ops.planar.record_pins(path=path, frame=1, smoothing=0.0) == {"FINISHED"}
    assert [frames(obj) for obj in objects] == [[1, 2, 3, 4, 5, 6]] * 3
    assert len(still.planar.poses) == 0
    go_to(1)
    before = [tip(obj) for obj in objects]
    go_to(6)
    for obj, start in zip(objects, before, strict=True):
        assert tip(obj) - start == pytest.approx([0.25, 0.0, 0.5], abs=0.02)


# ---- copied, pasted, mirrored


def test_poses_go_by_name_then_to_what_is_built_alike():
    objects = figure()
    for obj, offset in zip(objects, ((0.1, 0.3), (0.2, -0.2), (-0.1, 0.4)), strict=True):
        choose(obj)
        drag(offset)
    choose(*objects)
    shapes = [evaluated(obj) for obj in objects]
    assert bpy.ops.planar.copy_pose() == {"FINISHED"}
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert all(np.abs(evaluated(o) - s).max() > 0.1 for o, s in zip(objects, shapes, strict=True))
    assert bpy.ops.planar.paste_pose() == {"FINISHED"}
    for obj, shape in zip(objects, shapes, strict=True):
        assert np.abs(evaluated(obj) - shape).max() < 1e-6
    bpy.ops.object.duplicate()
    twins = named("Body.001", "Arm.L.001", "Arm.R.001")
    bpy.ops.planar.reset_to_rest()
    assert bpy.ops.planar.paste_pose() == {"FINISHED"}
    for obj, shape in zip(twins, shapes, strict=True):
        assert np.abs(evaluated(obj) - shape).max() < 1e-6


def test_a_single_pose_goes_to_all_that_are_built_alike(capfd):
    objects = figure()
    other = limb("Other", 9.0, nx=6)
    choose(objects[0])
    drag((0.1, 0.3))
    shape = evaluated(objects[0])
    assert bpy.ops.planar.copy_pose() == {"FINISHED"}
    choose(*objects[1:], other)
    assert bpy.ops.planar.paste_pose() == {"FINISHED"}
    for obj in objects[1:]:
        assert np.abs(evaluated(obj) - shape).max() < 1e-6
    assert "'Other' is left out: The copied pose is of another mesh" in capfd.readouterr().out
    choose(other)
    with pytest.raises(RuntimeError, match="The copied pose is of another mesh: this one has"):
        bpy.ops.planar.paste_pose()


def test_a_left_and_a_right_arm_exchange_their_poses():
    body, left, right = figure()
    right.scale.x = -1.0  # the mirror image of the left one
    right.location.x = -3.0
    choose(left)
    drag((0.2, 0.5))
    choose(body, left, right)
    reached = tip(left)
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    assert tip(right) == pytest.approx(reached * [-1.0, 1.0, 1.0], abs=1e-5)
    assert tip(left) == pytest.approx([5.0, 0.0, 0.5], abs=1e-5), "what the right one did: nothing"
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    assert tip(left) == pytest.approx(reached, abs=1e-5)


def test_unlike_sides_are_mirrored_by_pins_named_so_on_two_objects(capfd):
    body = limb("Body")
    one, two = limb("One", 3.0), limb("Two", -3.0, nx=11)
    for obj, letter in ((one, "L"), (two, "R")):
        for pin in obj.planar.pins:
            pin.name += f".{letter}"
    choose(one)
    select("Tip.L")
    drag((-0.2, 0.5))
    choose(body, one, two)
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    assert "'Two': Mirrored from 'One' by 2 of its pins" in capfd.readouterr().out
    assert tip(two) == pytest.approx([-1.0 + 0.2, 0.0, 0.5 + 0.5], abs=0.01)
    assert two.planar.pins["Tip.R"].has_target


def test_drawings_without_another_side_are_mirrored_by_themselves():
    body, *_ = figure()
    choose(body)
    drag((0.2, 0.5))
    shape = evaluated(body)
    choose(body, bpy.data.objects["Arm.L"])
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    mirrored = shape.reshape(5, 9, 3)[:, ::-1] * [-1, 1, 1] + [2, 0, 0]
    assert evaluated(body) == pytest.approx(mirrored.reshape(-1, 3), abs=1e-5)


# ---- all or none


def _fail_in_the_third(monkeypatch, target, name):
    """Let something raise for Arm.R alone, when it is almost done."""
    from planar_deform.errors import Refusal

    real = getattr(target, name)

    def broken(obj, *told, **options):
        if obj.name == "Arm.R":
            steps = real(obj, *told, **options)
            for share in steps:
                if share >= 1.0:
                    steps.throw(Refusal("it broke"))
                yield share
        yield from real(obj, *told, **options)

    monkeypatch.setattr(target, name, broken)


@pytest.mark.parametrize(
    ("verb", "options"),
    [
        ("key_pose", {}),
        ("generate_inbetweens", {}),
        ("remove_inbetweens", {}),
        ("breakdown", {}),
        ("delete_pose", {"pose": 0}),
        ("duplicate_pose", {"pose": 0}),
        ("retime_pose", {"pose": 0, "frame": 20.0}),
        ("record_pins", {}),
    ],
)
def test_a_failure_in_the_third_takes_all_back_to_the_bit(monkeypatch, verb, options):
    from planar_deform.operators.drag import pack_path
    from planar_deform.scene.inbetweens import writing
    from planar_deform.scene.sequence import playback, pose_edit, pose_insertion, pose_list

    objects = two_poses()
    key(13, (0.2, -0.2))
    if verb == "remove_inbetweens":
        assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    go_to(5 if verb in {"breakdown", "duplicate_pose"} else 9)
    if verb == "record_pins":
        options = {"path": pack_path([(0.05 * step, 0.0, 0.0) for step in range(4)]), "frame": 9}
    before = [state(obj) for obj in objects]
    with monkeypatch.context() as patched:
        for module in (writing.playback, pose_edit.playback, pose_list, pose_insertion):
            _fail_in_the_third(patched, module, "relay")
        with pytest.raises(RuntimeError, match=r"'Arm\.R': it broke|it broke"):
            getattr(bpy.ops.planar, verb)(**options)
    assert playback.relay is not None
    assert [state(obj) for obj in objects] == before
    assert getattr(bpy.ops.planar, verb)(**options) == {"FINISHED"}
    assert [state(obj) for obj in objects] != before


@pytest.mark.parametrize("verb", ["paste_pose", "mirror_pose", "reset_to_rest", "reset_selected_pins"])
@pytest.mark.parametrize("posed", ["plain", "keyed"])
def test_a_pose_that_cannot_be_shown_by_the_third_is_shown_by_none(monkeypatch, verb, posed):
    from planar_deform.errors import Refusal
    from planar_deform.scene.objects.cutout_object import CutoutObject

    objects = figure()
    drag((0.1, 0.4))
    assert bpy.ops.planar.copy_pose() == {"FINISHED"}
    if posed == "keyed":
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
    drag((0.2, -0.3))
    real = CutoutObject._put

    def put(self, shape):
        real(self, shape)
        if self.object_name == "Arm.R" and not restoring:
            restoring.append(1)
            raise Refusal("it broke")

    restoring = []
    before = [state(obj) for obj in objects]
    with monkeypatch.context() as patched:
        patched.setattr(CutoutObject, "_put", put)
        with pytest.raises(RuntimeError, match=r"'Arm\.R': it broke"):
            getattr(bpy.ops.planar, verb)()
    assert [state(obj) for obj in objects] == before


# ---- files


def test_a_saved_character_is_the_same_and_goes_on_as_one(tmp_path):
    objects = two_poses()
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    go_to(5)
    shapes = {obj.name: evaluated(obj) for obj in objects}
    path = str(tmp_path / "character.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    objects = choose(*named(*ALL))
    for obj in objects:
        assert np.array_equal(evaluated(obj), shapes[obj.name])
    go_to(9)
    drag((0.1, 0.1))
    assert [frames(obj) for obj in objects] == [[1, 9]] * 3
