# SPDX-License-Identifier: GPL-3.0-or-later
"""Long sessions that pose, key, fill and undo a character of several objects: all of them, or some."""

import contextlib
import random

import bpy
import numpy as np
import pytest
from several import choose, figure, frames, named, select, state
from support import evaluated

ALL = ("Body", "Arm.L", "Arm.R")
VERBS = ("key_pose", "generate_inbetweens", "remove_inbetweens", "copy_pose", "paste_pose", "mirror_pose")


def _drag(draw):
    select(*draw.sample(("Root", "Tip"), k=draw.randint(1, 2)))
    bpy.ops.planar.drag_pins(offset=(draw.uniform(-0.2, 0.2), draw.uniform(-0.2, 0.2)))


def _turn(draw):
    select("Tip")
    bpy.ops.planar.rotate_pins(angle=draw.uniform(-0.3, 0.3))


def _press(draw):
    one = draw.choice(bpy.context.selected_objects)
    offset = (draw.uniform(-0.1, 0.1), draw.uniform(-0.1, 0.1))
    bpy.ops.planar.drag_pins(object=one.name, pin=1, extend=draw.random() < 0.5, offset=offset)


def _go(draw):
    bpy.context.scene.frame_set(draw.randint(1, 20))


def _verb(draw):
    getattr(bpy.ops.planar, draw.choice(VERBS))()


def _retime(draw):
    poses = bpy.context.object.planar.poses
    if len(poses):
        draw.choice(poses).frame = draw.randint(1, 30)


def _breakdown(draw):
    bpy.ops.planar.breakdown(percent=draw.uniform(0.0, 100.0))


def _auto(_draw):
    tools = bpy.context.scene.tool_settings
    tools.use_keyframe_insert_auto = not tools.use_keyframe_insert_auto


def _undo(draw):
    chosen = [obj.name for obj in bpy.context.selected_objects]
    active = bpy.context.object.name
    bpy.ops.ed.undo_push(message="Step")
    before = [state(obj) for obj in named(*ALL)]
    _drag(draw)
    bpy.ops.ed.undo_push(message="Drag")
    bpy.ops.ed.undo()
    assert [state(obj) for obj in named(*ALL)] == before
    assert {obj.name for obj in bpy.context.selected_objects} == set(chosen)
    assert bpy.context.object.name == active


STEPS = {_drag: 5, _turn: 2, _press: 2, _go: 4, _verb: 8, _retime: 2, _breakdown: 2, _auto: 1, _undo: 1}


@pytest.mark.parametrize("seed", range(3))
def test_a_session_loses_nothing_and_leaves_alone_what_takes_no_part(seed, tmp_path):
    figure()
    draw = random.Random(seed)
    for number, step in enumerate(draw.choices([*STEPS], [*STEPS.values()], k=30)):
        chosen = ALL if draw.random() < 0.6 else tuple(draw.sample(ALL, k=draw.randint(1, 2)))
        objects = choose(*named(*chosen))
        others = [obj for obj in named(*ALL) if obj not in objects]
        names, told = [obj.name for obj in others], f"{number}: {step.__name__} of {chosen}"
        before = [state(obj) for obj in others]
        with contextlib.suppress(RuntimeError):  # refusals, which change nothing
            step(draw)
        if step is not _go:  # which all objects play
            assert [state(obj) for obj in named(*names)] == before, told
        for obj in named(*ALL):
            assert np.isfinite(evaluated(obj)).all(), told
            assert len(obj.planar.pins) == 2, told
            assert len(set(frames(obj))) == len(obj.planar.poses), told
    shapes = {}
    for frame in (1, 7, 20):
        bpy.context.scene.frame_set(frame)
        shapes[frame] = [evaluated(obj) for obj in named(*ALL)]
    path = str(tmp_path / "session.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    for frame, expected in shapes.items():
        bpy.context.scene.frame_set(frame)
        for obj, shape in zip(named(*ALL), expected, strict=True):
            assert np.array_equal(evaluated(obj), shape)
