# SPDX-License-Identifier: GPL-3.0-or-later
"""The slider of a breakdown: mouse, Shift, Ctrl, overshoot, typed percentages; the nearest share."""

import numpy as np
import pytest

from planar_deform.model.input.breakdown import WIDTH, Slider, nearest_share


def typed(slider: Slider, *keys: str) -> Slider:
    for key in keys:
        after = slider.pressed(key)
        assert after is not None, key
        slider = after
    return slider


def test_it_starts_at_its_share_and_the_width_is_the_whole_way() -> None:
    slider = Slider.begin(0.3, 700.0)
    assert slider.share == 0.3
    assert slider.moved(700.0 + 0.2 * WIDTH).share == pytest.approx(0.5)
    assert slider.moved(700.0 + 0.2 * WIDTH).moved(700.0).share == 0.3
    wide = Slider.begin(0.0, 0.0, 2 * WIDTH)
    assert wide.moved(WIDTH).share == 0.5


def test_without_overshoot_it_ends_at_the_poses_and_with_it_goes_beyond() -> None:
    slider = Slider.begin(0.5, 0.0).moved(WIDTH)
    assert slider.share == 1.0
    over = typed(slider, "E")
    assert over.share == 1.5
    assert "Overshoot" in over.text
    assert over.moved(-WIDTH).share == -0.5
    assert typed(over, "E").share == 1.0
    assert Slider.begin(0.5, 0.0, overshoot=True).moved(WIDTH).share == 1.5


def test_shift_is_precise_and_does_not_jump() -> None:
    slider = Slider.begin(0.0, 0.0).moved(0.4 * WIDTH)
    precise = slider.held(shift=True, ctrl=False)
    assert precise.share == slider.share
    assert precise.moved(0.6 * WIDTH).share == pytest.approx(0.4 + 0.2 / 8)
    after = precise.moved(0.6 * WIDTH).held(shift=False, ctrl=False)
    assert after.share == pytest.approx(0.4 + 0.2 / 8)
    assert after.moved(0.7 * WIDTH).share == pytest.approx(0.5 + 0.2 / 8)


def test_ctrl_snaps_to_tenths_while_it_is_held() -> None:
    slider = Slider.begin(0.0, 0.0).moved(0.37 * WIDTH)
    snapped = slider.held(shift=False, ctrl=True)
    assert snapped.share == pytest.approx(0.4)
    assert snapped.held(shift=False, ctrl=False).share == pytest.approx(0.37)


def test_typed_percentages_rule_until_they_are_erased() -> None:
    slider = Slider.begin(0.5, 0.0).moved(30.0)
    number = typed(slider, "TWO", "FIVE", "PERIOD", "FIVE")
    assert number.share == 0.255
    assert number.moved(200.0).share == 0.255
    assert number.held(shift=False, ctrl=True).share == 0.255, "what is typed is not snapped"
    assert "25.5|" in number.text
    erased = typed(number, *["BACK_SPACE"] * 4)
    assert erased.share == slider.share


def test_a_typed_number_beyond_the_poses_says_what_it_is_taken_for() -> None:
    number = typed(Slider.begin(0.5, 0.0), "ONE", "TWO", "ZERO")
    assert number.share == 1.0
    assert "(100.0 %)" in number.text
    assert typed(number, "E").share == 1.2
    beyond = typed(number, "E", "MINUS")
    assert beyond.share == -1.0, "as far as the solver goes"
    assert "(-100.0 %)" in beyond.text


def test_other_keys_mean_nothing() -> None:
    assert Slider.begin(0.5, 0.0).pressed("X") is None
    assert Slider.begin(0.5, 0.0).pressed("BACK_SPACE") is None


def test_the_nearest_share_is_found_to_a_percent() -> None:
    def at(share: float) -> np.ndarray:
        angle = 2.5 * share
        return np.array([[0.0, 0.0], [np.cos(angle), np.sin(angle)]])

    for share in (0.0, 0.03, 0.37, 0.5, 0.98, 1.0):
        assert nearest_share(at, at(share)) == share
    assert nearest_share(at, at(1.0) + np.array([0.0, 0.05])) == pytest.approx(1.0, abs=0.03)
