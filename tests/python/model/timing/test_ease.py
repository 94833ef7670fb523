# SPDX-License-Identifier: GPL-3.0-or-later
"""What the ease of new keys means."""

import pytest

from planar_deform.model.timing.ease import EASES, KeyEase, meaning

BLENDERS = KeyEase("BEZIER", handles="VECTOR")


@pytest.mark.parametrize("ease", [ease for ease, *_ in EASES])
def test_the_objects_ease_comes_first(ease):
    told = meaning([ease, "HOLD"], BLENDERS)
    assert told == (KeyEase("CONSTANT") if ease == "PREFERENCES" else meaning([ease], BLENDERS))


def test_without_one_it_is_that_of_blenders_preferences():
    assert meaning(["PREFERENCES", ""], BLENDERS) == BLENDERS


def test_each_ease_is_another_one():
    assert len({meaning([ease], BLENDERS) for ease, *_ in EASES}) == len(EASES)
