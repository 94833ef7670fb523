# SPDX-License-Identifier: GPL-3.0-or-later
"""Long sessions of everything that meets what pins follow: nothing is lost, and a frame stays what it is."""

import random

import bpy
import numpy as np
import pytest
from follow_scenes import HAND, empty, held, imported, swinging
from support import activate, add_pins, coordinates, evaluated

STEPS = 30
SAME = 1e-5


def drawing():
    return bpy.data.objects["Cutout"]


def keyed_shapes():
    """Of the poses, by the frames that they are keyed at, with Live off or on."""
    obj = drawing()
    keys = obj.data.shape_keys
    if keys is None:
        return {}
    blocks = {round(block.frame, 2): block for block in keys.key_blocks}
    return {pose.name: coordinates(blocks[round(pose.at, 2)].data).tobytes() for pose in obj.planar.poses}


def drag(draw):
    pin = draw.randrange(len(drawing().planar.pins))
    bpy.ops.planar.drag_pins(pin=pin, offset=(draw.uniform(-0.1, 0.1), draw.uniform(-0.1, 0.1)))


def key(_draw):
    bpy.ops.planar.key_pose()


def go(draw):
    bpy.context.scene.frame_set(draw.randint(1, 17))


def live(_draw):
    drawing().planar.live = not drawing().planar.live


def follow(draw):
    pin = draw.choice(drawing().planar.pins)
    pin.follow = None if pin.follow is not None else bpy.data.objects["Control"]


def now(_draw):
    if any(pin.follow is not None for pin in drawing().planar.pins):
        bpy.ops.planar.follow_now()


def bake(draw):
    if any(pin.follow is not None for pin in drawing().planar.pins):
        first = draw.randint(1, 12)
        bpy.ops.planar.bake_pins(frame_start=first, frame_end=first + 4, frame_step=2)


def generate(_draw):
    if len(drawing().planar.poses) > 1:
        bpy.ops.planar.generate_inbetweens()


def clear(_draw):
    if len(drawing().planar.poses):
        bpy.ops.planar.clear_poses()


def undo(_draw):
    bpy.ops.ed.undo_push(message="Step")
    drag(random.Random(1))
    bpy.ops.ed.undo_push(message="Drag")
    bpy.ops.ed.undo()


def turn(draw):
    drawing().rotation_euler[1] = draw.uniform(-0.5, 0.5)


WRITING = {key, bake, generate, clear, drag}  # poses may become others


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_session(seed):
    obj = imported()
    add_pins(obj, [26], HAND, [12], kind="PATCH")
    swinging(empty(held(obj, HAND) + np.array((0.2, -0.3, 0.1))))
    activate(obj)
    obj.planar.pins[1].follow = bpy.data.objects["Control"]
    draw = random.Random(seed)
    steps = [drag, key, go, live, follow, now, bake, generate, clear, undo, turn]
    weights = [4, 3, 6, 3, 2, 2, 1, 1, 1, 1, 1]
    for step in draw.choices(steps, weights, k=STEPS):
        before = keyed_shapes()
        activate(drawing())
        step(draw)
        bpy.context.view_layer.update()
        obj = drawing()
        assert np.isfinite(coordinates(obj.data.vertices)).all()
        if step not in WRITING:
            assert keyed_shapes() == before, step.__name__
        if obj.planar.live and obj.planar.poses:
            frame = bpy.context.scene.frame_current
            other = 18 - frame if frame != 9 else 1
            bpy.context.scene.frame_set(other)
            bpy.context.scene.frame_set(frame)
            shown = evaluated(obj)
            bpy.context.scene.frame_set(other)
            bpy.context.scene.frame_set(frame)
            np.testing.assert_allclose(evaluated(obj), shown, atol=SAME, err_msg=step.__name__)
    obj.planar.live = False
    for frame in range(1, 18):
        bpy.context.scene.frame_set(frame)
        assert np.isfinite(evaluated(obj)).all()
    curve = obj.data.shape_keys and obj.data.shape_keys.animation_data
    assert not curve or not obj.planar.poses or not _muted(obj)


def _muted(obj):
    from sequences import curve_of

    return curve_of(obj).mute
