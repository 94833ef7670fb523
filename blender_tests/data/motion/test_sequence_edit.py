# SPDX-License-Identifier: GPL-3.0-or-later
"""A change of one frame spread over a sequence."""

import bpy
import numpy as np
import pytest
from sequences import curve_of, filled, go_to, key, same, shown_at, stored
from support import PLANES, activate, add_end_pins, bar, evaluated, pose


def change(obj, frame, offset=(0.1, 0.25)):
    """Pose at a frame, which changes what is shown there and nothing else; before and after."""
    go_to(frame)
    before = evaluated(obj)
    pose(obj, offset=offset)
    after = evaluated(obj)
    assert np.abs(after - before).max() > 0.1
    return before, after


def shapes(obj, frames=range(1, 26)):
    return {frame: shown_at(obj, frame) for frame in frames}


def lengths(obj, shape):
    edges = np.array([edge.vertices[:] for edge in obj.data.edges])
    ends = shape.astype(float)[edges]
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)


@pytest.mark.parametrize("plane", PLANES)
def test_the_change_is_shown_at_its_frame_and_goes_on_to_all_others(plane):
    from planar_deform.scene.sequence import pose_state, stretches

    obj = filled(plane=plane)
    before = shapes(obj)
    was, wanted = change(obj, 7)
    assert bpy.ops.planar.edit_sequence() == {"FINISHED"}
    assert not pose_state.unkeyed(obj)
    assert evaluated(obj) == pytest.approx(wanted, abs=2e-7)
    after = shapes(obj)
    assert after[7] == pytest.approx(wanted, abs=2e-7)
    # Every other frame keeps its motion: each edge changes its length as it does in the edited frame.
    ratio = lengths(obj, wanted) / lengths(obj, was)
    for frame in (1, 4, 13, 20, 25):
        assert np.abs(after[frame] - before[frame]).max() > 0.05
        assert lengths(obj, after[frame]) / lengths(obj, before[frame]) == pytest.approx(ratio, abs=0.05)
    assert stretches.stale(obj) == []
    assert [item.edited for item in obj.planar.poses] == [True, True, False]


def test_poses_that_are_kept_keep_their_bits_and_so_does_what_lies_behind_them():
    from planar_deform.scene.sequence import stretches

    obj = filled()
    before = shapes(obj)
    _, wanted = change(obj, 7)
    assert bpy.ops.planar.edit_sequence(keep_poses=True) == {"FINISHED"}
    after = shapes(obj)
    assert after[7] == pytest.approx(wanted, abs=2e-7)
    for frame in (1, *range(13, 26)):
        assert same(after[frame], before[frame]), frame
    gone = [np.abs(after[frame] - before[frame]).max() for frame in range(1, 14)]
    assert np.all(np.diff(gone[:7]) > 0.0), "it grows to the frame,"
    assert np.all(np.diff(gone[6:]) < 0.0), "and fades behind it"
    assert stretches.stale(obj) == []
    assert [item.edited for item in obj.planar.poses] == [True, False, False]


@pytest.mark.parametrize("keep", [False, True])
def test_between_two_blocks_the_change_is_shown_as_well(keep):
    obj = filled()
    curve = curve_of(obj)
    for point in curve.keyframe_points:
        point.interpolation = "BEZIER"
    curve.update()
    for frame in (6, 8.5):
        _, wanted = change(obj, frame)
        assert bpy.ops.planar.edit_sequence(keep_poses=keep) == {"FINISHED"}
        assert evaluated(obj) == pytest.approx(wanted, abs=3e-7)
        assert shown_at(obj, frame) == pytest.approx(wanted, abs=3e-7)


def test_beside_a_kept_pose():
    """The first frame behind a pose shows a blend with it, when the curve eases out of it."""
    obj = filled()
    curve = curve_of(obj)
    curve.keyframe_points[0].interpolation = "BEZIER"
    curve.update()
    go_to(2)
    before = stored(obj)
    _, wanted = change(obj, 2, offset=(0.0, 0.2))
    with pytest.raises(RuntimeError, match="kept poses.*Keep Poses"):
        bpy.ops.planar.edit_sequence(keep_poses=True)
    assert bpy.ops.planar.edit_sequence() == {"FINISHED"}
    assert evaluated(obj) == pytest.approx(wanted, abs=3e-7)
    assert stored(obj) != before
    curve.keyframe_points[0].interpolation = "LINEAR"
    curve.update()
    _, wanted = change(obj, 1.75)
    assert bpy.ops.planar.edit_sequence(keep_poses=True) == {"FINISHED"}
    assert evaluated(obj) == pytest.approx(wanted, abs=3e-7)


def test_without_inbetweens_poses_take_the_change():
    obj = bar()
    add_end_pins(obj)
    for frame, seed in ((1, 1), (11, 2), (21, 3)):
        key(obj, frame, seed)
    _, wanted = change(obj, 4)
    with pytest.raises(RuntimeError, match="Generate In-Betweens"):
        bpy.ops.planar.edit_sequence(keep_poses=True)
    assert bpy.ops.planar.edit_sequence() == {"FINISHED"}
    assert evaluated(obj) == pytest.approx(wanted, abs=3e-7)


def test_what_was_not_changed_is_refused_with_what_to_do():
    obj = filled()
    go_to(7)
    before = stored(obj)
    with pytest.raises(RuntimeError, match="pose the drawing first"):
        bpy.ops.planar.edit_sequence()
    go_to(13)
    pose(obj, offset=(0.1, 0.0))
    before = stored(obj)
    with pytest.raises(RuntimeError, match="keyed at this frame.*beside it"):
        bpy.ops.planar.edit_sequence()
    assert stored(obj) == before
    change(obj, 7)
    obj.data.shape_keys.key_blocks[-3].lock_shape = True
    before = stored(obj)
    with pytest.raises(RuntimeError, match="locked"):
        bpy.ops.planar.edit_sequence()
    assert stored(obj) == before
    plain = bar(name="Plain")
    activate(plain)
    with pytest.raises(RuntimeError, match="Key Pose first"):
        bpy.ops.planar.edit_sequence()


def test_poses_whose_keys_are_gone_are_refused():
    obj = filled()
    obj.data.shape_keys.animation_data_clear()
    change(obj, 7)
    before = stored(obj)
    with pytest.raises(RuntimeError, match="Key Pose at two frames"):
        bpy.ops.planar.edit_sequence()
    with pytest.raises(RuntimeError, match="Key two poses"):
        bpy.ops.planar.thin_poses()
    assert stored(obj) == before


def test_closed_while_it_is_written_everything_is_as_it_was():
    from planar_deform.scene.motion.sequence_edit import SequenceEdit

    obj = filled()
    change(obj, 7)
    before = stored(obj)
    for steps in (1, 10, 24):
        edit = SequenceEdit(bpy.context, False)
        writing = edit.write(edit.solve(lambda share: True))
        for _ in range(steps):
            next(writing)
        assert stored(obj) != before
        writing.close()
        assert stored(obj) == before


def test_one_undo_step():
    obj = filled()
    change(obj, 7)
    bpy.ops.ed.undo_push(message="Pose")
    before = stored(obj)
    bpy.ops.planar.edit_sequence()
    bpy.ops.ed.undo_push(message="Edit")
    after = stored(bpy.data.objects["Cutout"])
    bpy.ops.ed.undo()
    assert stored(bpy.data.objects["Cutout"]) == before
    bpy.ops.ed.redo()
    assert stored(bpy.data.objects["Cutout"]) == after
