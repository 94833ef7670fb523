# SPDX-License-Identifier: GPL-3.0-or-later
"""The state of a drag. Mouse points are powers of two apart, so that results are exact."""

import math

import pytest

from planar_deform.model.input.drag import PRECISE, Drag
from planar_deform.model.plane.axes import PlaneAxes

UPRIGHT = PlaneAxes(("X", "Z"))  # of a drawing that stands in the XZ plane, global and local
TURNED = PlaneAxes(("X", "Z"), (0.6, -0.8), (0.8, 0.6))  # the global axes, seen from a turned drawing
LYING = PlaneAxes(("X", "Y"))  # the local axes of an imported drawing


def move(
    start: tuple[float, float] = (1.0, 2.0), world: PlaneAxes = UPRIGHT, own: PlaneAxes = UPRIGHT
) -> Drag:
    return Drag.begin("MOVE", world, own, (0.0, 0.0), start)


def rotate(start: tuple[float, float] = (3.0, 1.0)) -> Drag:
    return Drag.begin("ROTATE", UPRIGHT, UPRIGHT, (1.0, 1.0), start)


def spread(start: tuple[float, float] = (3.0, 1.0)) -> Drag:
    return Drag.begin("SPREAD", UPRIGHT, UPRIGHT, (1.0, 1.0), start)


def press(drag: Drag, *keys: str) -> Drag:
    for key in keys:
        after = drag.pressed(key)
        assert after is not None, key
        drag = after
    return drag


def test_an_offset_is_where_the_mouse_is_less_where_it_began() -> None:
    assert move().sample == (0.0, 0.0, 0.0)
    assert move().moved((1.5, 1.0)).sample == (0.5, -1.0, 0.0)


def test_returning_the_mouse_returns_exactly() -> None:
    drag = move((0.1, 0.2))
    for point in ((0.7, 0.3), (1e6, -3.3), (0.1, 0.2)):
        drag = drag.moved(point)
    assert drag.sample == (0.0, 0.0, 0.0)
    turn = rotate((0.3, 0.1))
    for point in ((0.1, 7.0), (-5.0, 0.5), (0.3, 0.1)):
        turn = turn.moved(point)
    assert turn.sample == (0.0, 0.0, 0.0)


def test_shift_neither_jumps_when_pressed_nor_when_released() -> None:
    drag = move().moved((2.0, 4.0))
    precise = drag.held(shift=True, ctrl=False)
    assert precise.sample == drag.sample
    finer = precise.moved((4.0, 4.0))
    assert finer.sample == pytest.approx((1.0 + 2.0 * PRECISE, 2.0, 0.0))
    coarse = finer.held(shift=False, ctrl=False)
    assert coarse.sample == finer.sample
    assert coarse.moved((5.0, 4.0)).sample == pytest.approx((2.0 + 2.0 * PRECISE, 2.0, 0.0))
    turned = rotate().moved((1.0, 3.0))
    assert (
        turned.held(shift=True, ctrl=False).sample == turned.sample == pytest.approx((0.0, 0.0, math.pi / 2))
    )


def test_ctrl_snaps_and_lets_go_again() -> None:
    drag = Drag.begin("MOVE", UPRIGHT, UPRIGHT, (0.0, 0.0), (0.0, 0.0), 0.5).moved((1.3, -0.2))
    snapped = drag.held(shift=False, ctrl=True)
    assert snapped.sample == (1.5, 0.0, 0.0)
    assert snapped.moved((1.2, -0.3)).sample == (1.0, -0.5, 0.0)
    assert press(snapped, "Z").sample == (0.0, 0.0, 0.0)
    assert press(snapped, "ONE").sample == (1.0, 0.0, 0.0), "a typed number is what it is"
    assert snapped.held(shift=False, ctrl=False).sample == drag.sample
    assert drag.held(shift=True, ctrl=True).moved((2.3, -0.2)).sample == pytest.approx((1.4, -0.2, 0.0))
    turned = rotate().moved((1.0 + 2.0 * math.cos(0.3), 1.0 + 2.0 * math.sin(0.3)))
    assert turned.held(shift=False, ctrl=True).sample[2] == pytest.approx(math.radians(15.0))
    assert turned.held(shift=True, ctrl=True).sample[2] == pytest.approx(math.radians(17.0))


def test_a_changed_view_moves_nothing_by_itself() -> None:
    drag = move().moved((2.0, 4.0)).seen_from_elsewhere((-7.0, 9.0))
    assert drag.sample == (1.0, 2.0, 0.0)
    assert drag.moved((-6.0, 9.0)).sample == (2.0, 2.0, 0.0)
    turned = rotate().moved((1.0, 3.0)).seen_from_elsewhere((1.0, 0.0))
    assert turned.sample == pytest.approx((0.0, 0.0, math.pi / 2))
    assert turned.moved((2.0, 1.0)).sample == pytest.approx((0.0, 0.0, math.pi))


def test_a_lock_keeps_one_axis_first_the_global_then_the_local_then_none() -> None:
    drag = move().moved((2.0, 4.0))
    assert press(drag, "X").sample == (1.0, 0.0, 0.0)
    assert press(drag, "Z").sample == (0.0, 2.0, 0.0)
    assert press(drag, "X", "Z").sample == (0.0, 2.0, 0.0)
    assert press(drag, "X", "X").sample == (1.0, 0.0, 0.0)
    assert press(drag, "X", "X").orientation == "LOCAL"
    assert press(drag, "X", "X", "X").sample == (1.0, 2.0, 0.0)
    assert rotate().pressed("X") is None, "a turn in a plane has one axis"


def test_an_axis_that_leaves_the_plane_moves_nothing() -> None:
    for drag, free in (
        (move().moved((2.0, 4.0)), (1.0, 2.0, 0.0)),
        (spread().moved((1.0, 5.0)), (1.0, 1.0, 0.0)),
    ):
        assert press(drag, "Y").sample == (0.0, 0.0, 0.0)
        assert "along global Y, which does not lie in the drawing" in press(drag, "Y").text
        assert press(drag, "Y", "Y").sample == (0.0, 0.0, 0.0), "nor is there a local one"
        assert press(drag, "Y", "Y", "Y").sample == free
        assert press(drag, "Y", "THREE").sample == (0.0, 0.0, 0.0)


def test_locks_of_a_turned_drawing_follow_the_global_axes() -> None:
    drag = move((0.0, 0.0), TURNED).moved((2.0, 1.0))
    assert press(drag, "X").sample == pytest.approx((0.4 * 0.6, -0.4 * 0.8, 0.0))
    assert press(drag, "Z").sample == pytest.approx((2.2 * 0.8, 2.2 * 0.6, 0.0))
    assert press(drag, "Z", "Z").sample == (0.0, 1.0, 0.0)
    assert press(drag, "Z", "TWO").sample == pytest.approx((1.6, 1.2, 0.0))
    assert press(drag, "Z", "Z", "TWO").sample == (0.0, 2.0, 0.0)
    assert press(drag, "ONE", "TAB", "TWO").sample == pytest.approx((2.2, 0.4, 0.0))
    snapped = drag.held(shift=False, ctrl=True)
    assert snapped.axes.values(snapped.sample[:2]) == pytest.approx((0.0, 2.0)), "on the world's grid"


def test_locks_of_an_imported_drawing_whose_own_z_leaves_its_plane() -> None:
    drag = move(own=LYING).moved((2.0, 4.0))
    assert press(drag, "Z").sample == (0.0, 2.0, 0.0)
    assert press(drag, "Z", "Z").sample == (0.0, 0.0, 0.0), "its own Z is across it"
    assert press(drag, "Y").sample == (0.0, 0.0, 0.0), "and so is the world's Y"
    assert press(drag, "Y", "Y").sample == (0.0, 2.0, 0.0)
    assert press(drag, "Y", "Y").text == "Move Pins: Y: 2.0000   (2.0000) along local Y"
    assert press(drag, "Y", "Y", "Y").sample == (1.0, 2.0, 0.0)
    assert press(drag, "Y", "Y", "X").orientation == "GLOBAL"


def test_a_spread_follows_the_distance_from_the_pivot() -> None:
    drag = spread()
    assert drag.sample == (0.0, 0.0, 0.0)
    assert drag.moved((1.0, 5.0)).sample == (1.0, 1.0, 0.0), "twice as far, whatever the direction"
    assert drag.moved((1.5, 1.0)).sample == (-0.75, -0.75, 0.0)
    assert drag.moved((1.0, 1.0)).sample == (-1.0, -1.0, 0.0)
    assert drag.moved((1.25, 1.0)).held(shift=False, ctrl=True).sample[0] == pytest.approx(-0.9)
    precise = drag.moved((5.0, 1.0)).held(shift=True, ctrl=False)
    assert precise.sample == (1.0, 1.0, 0.0), "Shift does not jump"
    assert precise.moved((7.0, 1.0)).sample[0] == pytest.approx(1.0 + PRECISE)
    assert press(drag, "TWO", "PERIOD", "FIVE").sample == (1.5, 1.5, 0.0), "a typed number is the factor"
    assert press(drag, "TWO").text == "Spread Pins: 2|"
    assert drag.moved((1.0, 5.0)).text == "Spread Pins: 2.0000"
    near = Drag.begin("SPREAD", UPRIGHT, UPRIGHT, (1.0, 1.0), (1.0, 1.0), 0.5).moved((1.5, 1.0))
    assert near.sample == (1.0, 1.0, 0.0), "a mouse on the pivot is not thrown to infinity"


def test_a_spread_along_an_axis_leaves_the_other_as_it_is() -> None:
    drag = spread().moved((1.0, 5.0))
    assert press(drag, "X").sample == (1.0, 0.0, 0.0)
    assert press(drag, "Z").sample == (0.0, 1.0, 0.0)
    assert press(drag, "X").text == "Spread Pins: 2.0000 along global X"
    assert press(drag, "X", "X", "X").sample == (1.0, 1.0, 0.0)
    assert press(drag, "Z", "THREE").sample == (0.0, 2.0, 0.0)
    turned = Drag.begin("SPREAD", TURNED, UPRIGHT, (1.0, 1.0), (3.0, 1.0)).moved((1.0, 5.0))
    assert press(turned, "X").sample == pytest.approx((0.36, 0.64, -0.48))
    assert press(turned, "X", "X").sample == (1.0, 0.0, 0.0)


def test_turns_add_up_beyond_a_half() -> None:
    drag = rotate()
    for step in range(1, 25):  # one and a half times round
        angle = step * math.tau / 16
        drag = drag.moved((1.0 + 2.0 * math.cos(angle), 1.0 + 2.0 * math.sin(angle)))
    assert drag.sample[2] == pytest.approx(1.5 * math.tau)


def test_typed_numbers_rule_over_the_mouse() -> None:
    drag = press(move().moved((2.0, 4.0)), "THREE", "TAB", "MINUS", "ONE")
    assert drag.sample == (3.0, -1.0, 0.0)
    assert drag.moved((9.0, 9.0)).sample == (3.0, -1.0, 0.0)
    assert press(move(), "Z", "THREE").sample == (0.0, 3.0, 0.0)
    assert press(rotate(), "NINE", "ZERO").sample == (0.0, 0.0, math.pi / 2)
    assert press(drag, *["BACK_SPACE"] * 4).sample == (1.0, 2.0, 0.0), "all erased: the mouse again"
    assert move().pressed("BACK_SPACE") is None
    assert move().pressed("TAB") is None


def test_the_text_names_what_happens() -> None:
    assert move().moved((1.5, 2.0)).text == "Move Pins: X: 0.5000   Z: 0.0000   (0.5000)"
    assert press(move().moved((1.5, 2.0)), "X").text == "Move Pins: X: 0.5000   (0.5000) along global X"
    assert press(move().moved((1.5, 2.0)), "X", "X").text == "Move Pins: X: 0.5000   (0.5000) along local X"
    assert press(move(), "ONE", "TAB").text == "Move Pins: X: 1   Z: |   (1.0000)"
    assert press(rotate(), "FOUR", "FIVE").text == "Turn Pins: 45|°"
