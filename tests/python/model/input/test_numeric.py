# SPDX-License-Identifier: GPL-3.0-or-later
"""Typed numbers."""

import pytest

from planar_deform.model.input.numeric import KEYS, Numeric


def typed(keys: list[str], fields: int = 2) -> Numeric:
    numeric = Numeric(("",) * fields)
    for key in keys:
        numeric = numeric.typed(KEYS[key])
    return numeric


@pytest.mark.parametrize(
    ("keys", "values"),
    [
        (["ONE", "PERIOD", "FIVE"], (1.5, 0.0)),
        (["NUMPAD_1", "NUMPAD_PERIOD", "NUMPAD_5"], (1.5, 0.0)),
        (["PERIOD", "TWO"], (0.2, 0.0)),
        (["MINUS", "TWO"], (-2.0, 0.0)),
        (["TWO", "MINUS"], (-2.0, 0.0)),
        (["TWO", "MINUS", "MINUS"], (2.0, 0.0)),
        (["ONE", "PERIOD", "PERIOD", "FIVE"], (1.5, 0.0)),
        (["MINUS"], (0.0, 0.0)),
        (["ONE", "TAB", "TWO"], (1.0, 2.0)),
        (["ONE", "COMMA", "TWO", "COMMA", "THREE"], (13.0, 2.0)),
        (["ONE", "TWO", "BACK_SPACE"], (1.0, 0.0)),
        (["ONE", "TAB", "BACK_SPACE", "FOUR"], (14.0, 0.0)),
    ],
)
def test_keys_make_numbers(keys: list[str], values: tuple[float, float]) -> None:
    assert typed(keys).values == values


def test_nothing_typed_leaves_the_mouse_in_charge() -> None:
    assert not typed([]).active
    assert typed(["ONE"]).active
    assert typed(["MINUS"]).active, "the sign alone is a number under way"
    assert not typed(["ONE", "BACK_SPACE"]).active


def test_the_cursor_stands_in_the_current_field() -> None:
    numeric = typed(["ONE", "TAB", "TWO"])
    assert (numeric.shown(0), numeric.shown(1)) == ("1", "2|")
