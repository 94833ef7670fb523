# SPDX-License-Identifier: GPL-3.0-or-later
"""Long sessions with drawings that carry each other: nothing is lost, and a frame stays what it is."""

import contextlib
import random

import bpy
import numpy as np
import pytest
from carry_scenes import body, choose, lantern, seen, strip
from follow_scenes import empty
from support import activate, coordinates

STEPS = 30
SAME = 1e-5
NAMES = ("Body", "Arm", "Lantern")


def some(draw):
    return bpy.data.objects[draw.choice(NAMES)]


def keyed_shapes():
    """Of the poses of all drawings, by the frames that they are keyed at."""
    found = {}
    for name in NAMES:
        obj = bpy.data.objects[name]
        keys = obj.data.shape_keys
        for pose in obj.planar.poses if keys is not None else ():
            block = next(block for block in keys.key_blocks if abs(block.frame - pose.at) < 0.05)
            found[name, pose.name] = coordinates(block.data).tobytes()
    return found


def attach(draw):
    carrier, carried = draw.sample([bpy.data.objects[name] for name in (*NAMES, "Prop")], 2)
    if carrier.type != "MESH":
        carrier, carried = carried, carrier
    activate(carrier)
    carried.select_set(True)
    choose_some(draw, carried)
    with contextlib.suppress(RuntimeError):  # of a circle
        bpy.ops.planar.attach_to(whole=draw.random() < 0.2)


def choose_some(draw, obj):
    if obj.type == "MESH":
        choose(obj, *draw.sample(range(2), draw.randint(0, 2)))


def detach(draw):
    obj = some(draw)
    activate(obj)
    choose_some(draw, obj)
    bpy.ops.planar.detach_from()


def drag(draw):
    activate(some(draw))
    offset = draw.uniform(-0.2, 0.2), draw.uniform(-0.2, 0.2)
    bpy.ops.planar.drag_pins(pin=draw.randrange(2), offset=offset)


def key(draw):
    activate(some(draw))
    bpy.ops.planar.key_pose()


def go(draw):
    bpy.context.scene.frame_set(draw.randint(1, 17))


def live(draw):
    obj = some(draw)
    obj.planar.live = not obj.planar.live


def move(draw):
    some(draw).location.x += draw.uniform(-0.2, 0.2)


def bake(draw):
    obj = some(draw)
    if any(pin.follow is not None for pin in obj.planar.pins):
        activate(obj)
        bpy.ops.planar.bake_pins(frame_start=3, frame_end=9, frame_step=3)


def rest(draw):
    obj = some(draw)
    if not obj.planar.poses:
        activate(obj)
        bpy.ops.planar.set_rest_to_current()


def undo(draw):
    bpy.ops.ed.undo_push(message="Step")
    before = {name: coordinates(bpy.data.objects[name].data.vertices) for name in NAMES}
    drag(draw)
    bpy.ops.ed.undo_push(message="Drag")
    bpy.ops.ed.undo()
    for name, shape in before.items():
        np.testing.assert_array_equal(coordinates(bpy.data.objects[name].data.vertices), shape)


WRITING = {key, bake, drag, rest, undo}  # poses may become others


@pytest.mark.parametrize("seed", range(4))
def test_a_session(seed, capfd):
    body()
    strip("Arm", 1.6, 0.1, width=1.6, height=0.3, depth=-0.01, pins="PATCH")
    lantern()
    empty((1.9, 0.1, 0.2), "Prop")
    draw = random.Random(seed)
    steps = [attach, detach, drag, key, go, live, move, bake, rest, undo]
    for step in [attach, attach, *draw.choices(steps, [4, 1, 5, 2, 5, 1, 2, 1, 1, 1], k=STEPS)]:
        before = keyed_shapes()
        step(draw)
        bpy.context.view_layer.update()
        if step not in WRITING:
            assert keyed_shapes() == before, step.__name__
        shapes = [seen(bpy.data.objects[name]) for name in NAMES]
        assert all(np.isfinite(shape).all() for shape in shapes), step.__name__
        assert np.isfinite(np.array(bpy.data.objects["Prop"].matrix_world)).all()
        assert max(np.abs(shape).max() for shape in shapes) < 50.0, step.__name__
        assert "Traceback" not in capfd.readouterr().err, step.__name__
    shown = {}
    frames = (1, 9, 17, 5, 9, 1)
    for frame in frames:
        bpy.context.scene.frame_set(frame)
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        now = [seen(bpy.data.objects[name]) for name in NAMES]
        for one, other in zip(now, shown.setdefault(frame, now), strict=True):
            np.testing.assert_allclose(one, other, atol=SAME)
