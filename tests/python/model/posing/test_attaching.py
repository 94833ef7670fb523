# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that lie on each other, and where joints hang them together: rectangles, of which all is known."""

import numpy as np
import pytest
from cutouts import rectangles

from planar_deform.model.posing.attaching import attachments, overlaps

# left, bottom, right, top
BODY = (0.0, 0.0, 2.0, 4.0)
ARM = (1.4, 3.0, 5.0, 3.4)  # 0.6 of its length lies on the body
HAND = (4.6, 2.9, 5.6, 3.5)
HEAD = (0.6, 3.6, 1.4, 5.0)
EYE = (0.9, 4.4, 1.0, 4.5)


def found(*boxes, joined=(), depths=None):
    return attachments(rectangles(*boxes), depths, joined)


def test_overlaps_have_their_area_and_how_deep_they_are():
    (overlap,) = overlaps(rectangles(BODY, ARM))
    assert overlap.parts == (0, 1)
    assert overlap.area == pytest.approx(0.6 * 0.4, rel=1e-6)
    assert overlap.depths.max() == pytest.approx(0.2, rel=0.05)
    assert (overlap.places >= (1.4, 3.0)).all()
    assert (overlap.places <= (2.0, 3.4)).all()


def test_parts_that_only_touch_or_lie_in_a_hole_do_not_overlap():
    assert overlaps(rectangles(BODY, (2.0, 0.0, 3.0, 4.0))) == []
    assert overlaps(rectangles(BODY, (2.5, 0.0, 3.0, 4.0))) == []


def test_a_limb_turns_about_its_root():
    (joint,) = found(BODY, ARM)
    assert (joint.carrier, joint.carried, joint.rigid) == (0, 1, False)
    # Half its width from its end, on its axis.
    np.testing.assert_allclose(joint.place, (1.6, 3.2), atol=0.05)


def test_a_limb_far_across_the_body_still_turns_about_its_root():
    (joint,) = found(BODY, (0.1, 3.0, 3.0, 3.4))
    np.testing.assert_allclose(joint.place, (0.3, 3.2), atol=0.06)


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 2, 1, 0), (2, 0, 3, 1)])
def test_a_character_is_a_tree_whose_root_is_its_largest_part(order):
    boxes = [BODY, ARM, HAND, HEAD]
    numbers = {old: new for new, old in enumerate(order)}
    joints = found(*(boxes[old] for old in order))
    pairs = {(joint.carrier, joint.carried) for joint in joints}
    assert pairs == {(numbers[a], numbers[b]) for a, b in ((0, 1), (1, 2), (0, 3))}


def test_of_several_the_one_that_is_shared_most_carries():
    # The hand lies on the body, too, but more of it on the arm; there is no circle.
    arm, hand = (1.8, 1.0, 2.2, 3.6), (1.7, 0.6, 2.3, 1.4)
    joints = found(BODY, arm, hand, (1.75, 0.5, 2.25, 0.8))
    assert len(joints) == 3
    assert len({joint.carried for joint in joints}) == 3


def test_a_limb_hangs_on_the_layer_next_to_it_and_not_on_what_it_happens_to_lie_before():
    arm, tail = (1.4, 3.0, 4.2, 3.4), (1.5, 1.0, 5.0, 3.15)
    cutout = rectangles(BODY, arm, tail)
    shared = {overlap.parts: overlap.area for overlap in overlaps(cutout)}
    assert shared[0, 1] < shared[1, 2]
    flat = attachments(cutout)
    assert {tuple(sorted((joint.carrier, joint.carried))) for joint in flat} == {(0, 2), (1, 2)}
    layered = attachments(cutout, np.array([0.0, 1.0, -1.0]))  # the body between arm and tail
    assert {tuple(sorted((joint.carrier, joint.carried))) for joint in layered} == {(0, 1), (0, 2)}


def test_two_legs_before_one_another_hang_on_the_body_and_on_each_other_only_without_it():
    near, far = (0.6, -3.0, 1.1, 0.5), (0.75, -3.0, 1.25, 0.5)
    cutout = rectangles(BODY, near, far)
    shared = {overlap.parts: overlap.area for overlap in overlaps(cutout)}
    assert shared[1, 2] > 4 * shared[0, 2]
    for depths in (None, np.array([1.0, 0.0, -1.0])):
        joints = attachments(cutout, depths)
        assert {(joint.carrier, joint.carried) for joint in joints} == {(0, 1), (0, 2)}
        for joint in joints:
            leg = (near, far)[joint.carried - 1]
            np.testing.assert_allclose(joint.place, (0.5 * (leg[0] + leg[2]), 0.25), atol=0.06)
    assert [(joint.carrier, joint.carried) for joint in found(near, far)] == [(0, 1)]


def test_a_small_part_that_lies_wholly_on_another_does_not_turn():
    joints = {joint.carried: joint for joint in found(BODY, HEAD, EYE)}
    assert (joints[2].carrier, joints[2].rigid) == (1, True)
    np.testing.assert_allclose(joints[2].place, (0.95, 4.45), atol=0.02)
    assert not joints[1].rigid


def test_what_hangs_together_already_gets_nothing():
    assert found(BODY, ARM, joined=[(0, 1)]) == []
    (joint,) = found(BODY, ARM, HAND, joined=[(1, 0)])
    assert (joint.carrier, joint.carried) == (1, 2)
    assert found((0.0, 0.0, 1.0, 1.0)) == []


def test_size_and_place_do_not_count():
    boxes = [BODY, ARM, HAND, HEAD]
    near = found(*boxes)
    far = found(*[tuple(1e-3 * side + 7.0 for side in box) for box in boxes])
    assert [(a.carrier, a.carried) for a in near] == [(b.carrier, b.carried) for b in far]
    np.testing.assert_allclose([1e-3 * a.place + 7.0 for a in near], [b.place for b in far], atol=1e-4)
