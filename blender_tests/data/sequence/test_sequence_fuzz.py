# SPDX-License-Identifier: GPL-3.0-or-later
"""Anything done to a sequence in any order: every pose is shown at its keys, and all is where it belongs."""

import bpy
import numpy as np
import pytest
from filling import bent_bar, everything, generate, remove, stale
from sequences import curve_of, go_to, key, same, shown_at
from support import activate, add_end_pins, coordinates


def bits(obj):
    """The bits of each pose by its name."""
    keys = obj.data.shape_keys
    return {pose.name: coordinates(keys.key_blocks[pose.name].data).tobytes() for pose in obj.planar.poses}


def assert_whole(obj):
    from planar_deform.scene.sequence import pose_state
    from planar_deform.scene.sequence.playback import blocks_of

    keys, poses = obj.data.shape_keys, obj.planar.poses
    blocks = blocks_of(obj)
    assert [block.name for block in blocks if block.pose is not None] == [pose.name for pose in poses]
    assert all(block.inbetween for block in blocks if block.pose is None)
    assert [round(keys.key_blocks[pose.name].frame) for pose in poses] == [pose.at for pose in poses]
    assert [block.source for block in blocks] == [1024.0 + 8.0 * index for index in range(len(blocks))]
    assert sum(pose.generated for pose in poses) == len(blocks) - len(poses)
    assert poses[-1].generated == 0
    for index in range(len(poses)):
        for frame in pose_state.frames_of(obj, index):
            assert same(shown_at(obj, frame), coordinates(keys.key_blocks[poses[index].name].data)), frame


def empty_frame(obj, random):
    taken = {round(point.co[0], 2) for point in curve_of(obj).keyframe_points}
    return next(f for f in (float(random.integers(-10, 80)) for _ in range(1000)) if f not in taken)


def do(obj, random):
    """Something at random; its name."""
    poses, points = obj.planar.poses, curve_of(obj).keyframe_points
    pose = int(random.integers(len(poses)))
    what = random.choice(
        [
            *("key", "delete", "retime", "duplicate", "generate", "remove", "update", "move", "copy"),
            *("record", "path", "rename"),
        ]
    )
    activate(obj)
    if what == "key":
        key(obj, float(random.integers(-10, 80)), int(random.integers(1000)))
    elif what == "delete" and len(poses) > 2:
        bpy.ops.planar.delete_pose(pose=pose)
    elif what == "retime":
        poses[pose].frame = empty_frame(obj, random)
    elif what == "duplicate":
        bpy.ops.planar.duplicate_pose(pose=pose, frame=empty_frame(obj, random))
    elif what == "update":
        bpy.ops.planar.update_pose(pose=pose)
    elif what == "move":  # in the Dope Sheet
        points[int(random.integers(len(points)))].co[0] = empty_frame(obj, random)
        curve_of(obj).update()
    elif what == "copy" and len(points) < 12:
        place = points[int(random.integers(len(points)))].co[1]
        points.insert(empty_frame(obj, random), place).interpolation = "LINEAR"
    elif what == "record":
        from planar_deform.scene.objects.any_object import begin_shape, key_poses

        drawing, first = begin_shape(bpy.context), int(random.integers(-10, 70))
        shapes = {first + step: drawing.positions + 0.01 * step for step in range(4)}
        key_poses(drawing, shapes, throughout=True)
    elif what == "generate" and bpy.ops.planar.generate_inbetweens.poll():
        try:
            bpy.ops.planar.generate_inbetweens(smooth=bool(random.integers(2)))
        except RuntimeError:  # poses that are all next to one another, or a single one
            return what
        assert stale(obj) == []
    elif what == "path" and pose + 1 < len(poses):
        if any(path.pose == poses[pose].name for path in obj.planar.pins[1].paths):
            bpy.ops.planar.remove_pin_path(pin=1, pose=pose)
        else:
            bpy.ops.planar.add_pin_path(pin=1, pose=pose)
            obj.planar.pins[1].paths[-1].kind = str(random.choice(["STRAIGHT", "ARC"]))
    elif what == "rename":
        poses[pose].name = str(random.choice(["Pose", "Up", "Down"]))
    elif what == "remove" and bpy.ops.planar.remove_inbetweens.poll():
        remove(obj)
    return what


@pytest.mark.parametrize("seed", range(8))
def test_anything_in_any_order(seed):
    random = np.random.default_rng(seed)
    obj, _ = bent_bar((1, 13, 25, 37))
    add_end_pins(obj)
    done = []
    for _ in range(25):
        before = bits(obj)
        done.append(do(obj, random))
        go_to(float(random.integers(-10, 80)))
        assert_whole(obj)
        after = bits(obj)
        changed = {name for name in before.keys() & after.keys() if before[name] != after[name]}
        changed = set() if done[-1] == "rename" else changed
        assert len(changed) <= {"update": 1, "key": 1, "record": 4, "generate": 9}.get(done[-1], 0), done
    generate_and_take_back(obj)


def generate_and_take_back(obj):
    if not bpy.ops.planar.generate_inbetweens.poll():
        return
    if any(pose.generated for pose in obj.planar.poses):
        remove(obj)
    go_to(0)
    before = everything(obj)
    try:
        generate(obj)
    except RuntimeError:
        return
    remove(obj)
    go_to(0)
    assert everything(obj) == before
