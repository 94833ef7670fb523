# SPDX-License-Identifier: GPL-3.0-or-later
"""A character of several parts, attached, with depths, followed and in-betweened at once."""

import contextlib
import random

import bpy
import numpy as np
import pytest
from figures import ARM, BODY, HAND, HEAD, drag, gaps, pin_at, pinned, shown
from support import activate, coordinates, evaluated

from planar_deform.errors import Refusal

SAME = 2e-6  # of a figure half a unit high
APART = 1e-3  # of the diagonal, that joints may be open
LEAP = 12  # frames


def walker():
    """A figure with joints: its chest stands, its hand is a pin, its wrist is in front."""
    obj = pinned(BODY, ARM, HAND, HEAD)
    pin_at(obj, (4.5, 3.2), "Hand")
    pin_at(obj, (2.9, 3.2), "Elbow")
    pin(obj, "Elbow").enabled = False
    select(obj, "Hand")
    assert bpy.ops.planar.set_depth(depth=2.0) == {"FINISHED"}
    return obj


def pin(obj, name):
    return obj.planar.pins[name]


def select(obj, *names):
    activate(obj)
    for one in obj.planar.pins:
        one.select = one.name in names


def controlled(obj, name):
    """An Empty that the pin follows, keyed to swing."""
    select(obj, name)
    assert bpy.ops.planar.add_controls() == {"FINISHED"}
    control = pin(obj, name).follow
    start = control.location.copy()
    for frame, offset in ((1, (0.0, 0.0)), (LEAP, (-0.04, 0.1)), (2 * LEAP, (0.03, -0.08))):
        control.location = start
        control.location.x += offset[0]
        control.location.z += offset[1]
        control.keyframe_insert("location", frame=frame)
    activate(obj)
    return control


def film(obj, frames):
    shapes = {}
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        shapes[frame] = evaluated(obj)
    return shapes


def test_frames_of_a_jointed_figure_do_not_depend_on_the_way_to_them():
    obj = walker()
    controlled(obj, "Hand")
    depth = pin(obj, "Hand").depth
    forward = film(obj, range(1, 2 * LEAP + 1))
    assert np.abs(forward[1] - forward[LEAP]).max() > 0.5
    for frame, shape in film(obj, (2 * LEAP, 3, LEAP, 20, 1, 7)).items():
        np.testing.assert_allclose(shape, forward[frame], atol=SAME / 0.1)
        assert max(gaps(obj).values()) < APART
        assert pin(obj, "Hand").depth == pytest.approx(depth, abs=1e-3)


def test_in_betweens_hold_joints_standing_pins_and_blend_depths():
    obj = walker()
    chest = pin(obj, "Chest")
    bpy.context.scene.frame_set(1)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    bpy.context.scene.frame_set(1 + LEAP)
    drag(obj, "Hand", (-0.1, 0.2))
    select(obj, "Hand")
    assert bpy.ops.planar.set_depth(depth=-2.0) == {"FINISHED"}
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    depths = []
    rows = [v.index for v in obj.data.vertices if any(g.group == chest.group_index for g in v.groups)]
    stood = evaluated(obj)[rows]
    for frame in range(1, LEAP + 2):
        bpy.context.scene.frame_set(frame)
        assert max(gaps(obj).values()) < APART
        _, drawing = shown(obj)
        moved = (evaluated(obj)[rows] - stood)[:, :2]
        assert np.abs(moved).max() < 2e-4 * 10.0 * drawing.cutout.diagonal
        depths.append(pin(obj, "Hand").depth)
    np.testing.assert_allclose(depths, np.linspace(2.0, -2.0, LEAP + 1), atol=0.01)


# ---- long sessions


def _drag(obj, draw):
    names = [one.name for one in obj.planar.pins if one.kind in {"POINT", "PATCH"} and one.enabled]
    drag(obj, draw.choice(names), (draw.uniform(-0.05, 0.05), draw.uniform(-0.05, 0.05)))


def _key(obj, _draw):
    bpy.ops.planar.key_pose()


def _go(_obj, draw):
    bpy.context.scene.frame_set(draw.randint(1, 2 * LEAP))


def _depth(obj, draw):
    select(obj, draw.choice(("Hand", "Chest")))
    bpy.ops.planar.set_depth(depth=draw.uniform(-3.0, 3.0))


def _attach(obj, _draw):
    if bpy.ops.planar.detach() != {"FINISHED"}:
        bpy.ops.planar.attach()


def _follow(obj, draw):
    hand = pin(obj, "Hand")
    hand.follow = None if hand.follow is not None else bpy.data.objects["Hand"]


def _live(obj, _draw):
    obj.planar.live = not obj.planar.live


def _generate(obj, _draw):
    if len(obj.planar.poses) > 1:
        bpy.ops.planar.generate_inbetweens()


def _retime(obj, draw):
    if len(obj.planar.poses):
        pose = draw.choice(obj.planar.poses)
        pose.frame = draw.randint(1, 3 * LEAP)


def _bake(obj, draw):
    if pin(obj, "Hand").follow is not None:
        first = draw.randint(1, LEAP)
        bpy.ops.planar.bake_pins(frame_start=first, frame_end=first + 4, frame_step=2)


def _undo(obj, _draw):
    bpy.ops.ed.undo_push(message="Step")
    before = evaluated(obj)
    drag(obj, "Hand", (0.02, 0.03))
    bpy.ops.ed.undo_push(message="Drag")
    bpy.ops.ed.undo()
    after = evaluated(bpy.data.objects["Figure"])
    np.testing.assert_allclose(after, before, atol=SAME / 0.1)


STEPS = {_drag: 5, _key: 3, _go: 5, _depth: 3, _attach: 1, _follow: 1, _live: 2, _generate: 1, _retime: 2}
STEPS |= {_bake: 1, _undo: 1}


@pytest.mark.parametrize("seed", range(3))
def test_a_session_loses_nothing(seed, tmp_path):
    obj = walker()
    controlled(obj, "Hand")
    draw = random.Random(seed)
    for number, step in enumerate(draw.choices([*STEPS], [*STEPS.values()], k=30)):
        obj = bpy.data.objects["Figure"]
        activate(obj)
        pins, poses = len(obj.planar.pins), len(obj.planar.poses)
        with contextlib.suppress(Refusal):  # which is said to the user; nothing is to be lost by it
            step(obj, draw)
        bpy.context.view_layer.update()
        obj = bpy.data.objects["Figure"]
        assert np.isfinite(evaluated(obj)).all(), step.__name__
        assert np.isfinite(coordinates(obj.data.vertices)).all(), step.__name__
        if step is not _attach:
            assert len(obj.planar.pins) == pins, step.__name__
        if step not in {_key, _bake, _drag, _depth}:
            assert len(obj.planar.poses) == poses, step.__name__
        if not obj.planar.poses and step is not _go:
            assert max(gaps(obj).values(), default=0.0) < APART, f"{number}: {step.__name__}"
    frame = bpy.context.scene.frame_current
    obj.planar.live = False
    shapes = film(obj, (1, 5, LEAP, frame))
    depths = [one.depth for one in obj.planar.pins if one.kind in {"POINT", "PATCH"}]
    path = str(tmp_path / "session.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Figure"]
    activate(obj)
    for at, shape in film(obj, (1, 5, LEAP, frame)).items():
        np.testing.assert_allclose(shape, shapes[at], atol=1e-5)
    assert [one.depth for one in obj.planar.pins if one.kind in {"POINT", "PATCH"}] == pytest.approx(depths)
