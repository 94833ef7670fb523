# SPDX-License-Identifier: GPL-3.0-or-later
"""Where layers hang together: found where they do in both poses, and nowhere else."""

import bpy
import numpy as np
import pytest
from support import PLANES, evaluated, grid, make_object

from planar_deform.scene.inbetweens import joints
from planar_deform.scene.objects.any_object import begin_shape


def rotated(points, centre, degrees):
    angle = np.radians(degrees)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return (points - centre) @ turn.T + centre


SHOULDER, WRIST = np.array([0.9, 0.5]), np.array([1.7, 0.5])


@pytest.fixture
def figure():
    """A body 1 x 2, an upper arm from its shoulder, a hand that overlaps the arm's end."""
    body = grid(20, 40, width=1.0, height=2.0, origin=(0.0, -1.0))[0][:, :2]
    arm = grid(20, 4, width=1.0, height=0.2, origin=(0.8, 0.4))[0][:, :2]
    hand = grid(6, 6, width=0.3, height=0.3, origin=(1.6, 0.35))[0][:, :2]
    parts = np.repeat([0, 1, 2], [len(body), len(arm), len(hand)])
    return np.concatenate([body, arm, hand]), parts


def swung(rest, parts, arm=0.0, hand=0.0, step=(0.0, 0.0)):
    posed = rest.copy()
    posed[parts > 0] = rotated(posed[parts > 0], SHOULDER, arm)
    wrist = rotated(WRIST, SHOULDER, arm)
    posed[parts == 2] = rotated(posed[parts == 2], wrist, hand)
    return posed + step


def test_a_limb_is_carried_at_its_joint(figure):
    rest, parts = figure
    before, after = swung(rest, parts, 80, -60), swung(rest, parts, -70, 90, step=(1.0, 0.3))
    found = joints.find(rest, before, after, parts, planted=set())
    assert parts[found].tolist() == [[0, 1], [1, 2]]
    # Vertices are 0.05 apart, a joint need not be one.
    assert np.allclose(rest[found[0]], SHOULDER, atol=0.04)
    assert np.allclose(rest[found[1]], WRIST, atol=0.04)


def test_a_planted_limb_carries_the_body(figure):
    rest, parts = figure
    before, after = swung(rest, parts, 80, -60), swung(rest, parts, -70, 90)
    found = joints.find(rest, before, after, parts, planted={2})
    assert parts[found].tolist() == [[2, 1], [1, 0]]


def test_two_planted_parts_both_stand(figure):
    rest, parts = figure
    found = joints.find(rest, swung(rest, parts, 80), swung(rest, parts, -70), parts, planted={0, 2})
    assert parts[found[:, 1]].tolist() == [1]


def test_layers_that_part_are_not_joined(figure):
    rest, parts = figure
    after = rest.copy()
    after[parts == 1] += (0.0, 0.4)  # the arm slides up; the hand stays and is beside it
    assert joints.find(rest, rest, after, parts, planted=set()).shape == (0, 2)


def test_one_part_has_no_joints(figure):
    rest, parts = figure
    body = parts == 0
    assert len(joints.find(rest[body], rest[body], rest[body] + 1.0, parts[body], planted=set())) == 0


def test_in_betweens_keep_layers_together(figure):
    rest, parts = figure
    sheets = [grid(20, 40)[1], grid(20, 4)[1], grid(6, 6)[1]]
    starts = [np.flatnonzero(parts == part)[0] for part in range(3)]
    faces = np.concatenate([faces + start for faces, start in zip(sheets, starts, strict=True)])
    points = np.column_stack([rest, -0.1 * parts])
    obj = make_object(points @ PLANES["XZ"].T, faces.tolist())
    for frame, posed in (1, swung(rest, parts, 80, -60)), (25, swung(rest, parts, -70, 90, step=(1.0, 0.3))):
        bpy.context.scene.frame_set(frame)
        drawing = begin_shape(bpy.context)
        drawing.write(posed)
        bpy.ops.planar.key_pose()
    bpy.ops.planar.generate_inbetweens()
    assert obj.planar.poses[0].generated == 23

    shoulder, wrist = (np.flatnonzero(np.hypot(*(rest - place).T) < 1e-6) for place in (SHOULDER, WRIST))
    for frame in range(1, 26):
        bpy.context.scene.frame_set(frame)
        shown = evaluated(obj)
        for a, b in (shoulder, wrist):  # of two parts, in one place
            assert np.hypot(*(shown[a] - shown[b])[[0, 2]]) < 0.01
