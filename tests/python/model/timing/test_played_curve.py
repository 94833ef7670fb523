# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of the curve on the way to generated shapes and back."""

import numpy as np
import pytest

from planar_deform.model.timing.played_curve import Rows, moved, offsets, remember

PLAIN = 1024.0 + 8.0 * np.arange(4)
FILLED = np.array([1024.0, 1216.0, 1224.0, 9000.0])


def rows(seed=0, count=40):
    """Keys at poses and between them, with handles of any values, as float32 keeps them."""
    random = np.random.default_rng(seed)
    values = np.where(
        random.random(count) < 0.5, random.choice(PLAIN, count), random.uniform(1020, 1055, count)
    )
    frames = np.sort(random.uniform(-20, 300, count))

    def side(by):
        return np.stack([frames + by, values + random.uniform(-12, 12, count)], axis=1).astype(np.float32)

    types = random.integers(0, 5, (count, 2)).astype(np.int32)
    amplitude = random.uniform(0, 3, count).astype(np.float32)
    keys = np.stack([frames, values], axis=1).astype(np.float32)
    return Rows(keys, side(-3.3), side(3.7), types, amplitude)


def filled(before, plain=PLAIN, shown=FILLED):
    """The keys when generated shapes have come in between, and what is remembered."""
    was = offsets(before, plain, plain, "")
    was.exact[:] = True
    values = moved(plain[was.pose][:, None] + was.values, plain, shown)
    after = before.at(values, np.zeros_like(before.types), before.amplitude * np.float32(7.0))
    return after, remember(after, was)


def test_values_between_blocks_move_in_proportion_and_beyond_them_with_the_ends():
    assert moved(np.array([1020.0, 1024.0, 1028.0, 1036.0, 1060.0]), PLAIN, FILLED).tolist() == [
        *[1020.0, 1024.0, 1120.0, 1220.0, 9012.0]
    ]


@pytest.mark.parametrize("seed", range(4))
def test_what_is_remembered_comes_back_to_the_bit(seed):
    before = rows(seed)
    after, remembered = filled(before)
    was = offsets(after, FILLED, PLAIN, remembered)
    assert was.exact.all()
    back = (PLAIN[was.pose][:, None] + was.values).astype(np.float32)
    assert back.tobytes() == before.values.astype(np.float32).tobytes()
    assert np.array_equal(was.types, before.types)
    assert was.amplitude.tobytes() == before.amplitude.tobytes()
    assert was.sides.tobytes() == np.stack([before.left[:, 0], before.right[:, 0]], axis=1).tobytes()
    # Without it, float32 has lost some bits of what is far up, and only those.
    lost = offsets(after, FILLED, PLAIN, "")
    assert not lost.exact.any()
    assert np.abs(lost.values - was.values).max() < 1e-3
    assert not np.array_equal((PLAIN[lost.pose][:, None] + lost.values).astype(np.float32), back)


def test_what_the_user_has_changed_since_is_what_he_made_it():
    before = rows()
    after, remembered = filled(before)
    after.left[3, 1] += 5.0
    after.right[4, 0] += 1.0
    after.keys[5] += (2.0, 8.0)
    after.types[6, 0] = 3
    after.amplitude[7] = 1.0
    was = offsets(after, FILLED, PLAIN, remembered)
    changed = np.zeros((len(before.keys), 3), bool)
    changed[3, 1] = changed[4, 2] = True
    changed[5] = changed[6, 1] = changed[7, 0] = True
    assert np.array_equal(was.exact, ~changed)
    value = moved(after.left[3:4, 1].astype(float), FILLED, PLAIN)[0]
    assert was.values[3, 1] == pytest.approx(value - PLAIN[was.pose[3]])


def test_keys_belong_to_the_pose_at_or_below_them():
    keys = np.array(
        [[0, 1000.0], [1, 1024.0], [2, 1031.9], [3, 1031.99], [4, 1032.0], [5, 2000.0]], np.float32
    )
    rows = Rows(keys, keys, keys, np.zeros((6, 2), np.int32), np.zeros(6, np.float32))
    was = offsets(rows, PLAIN, PLAIN, "")
    assert was.pose.tolist() == [0, 0, 0, 1, 1, 3]
    assert was.values[:, 0].tolist() == pytest.approx([-24.0, 0.0, 7.9, -0.01, 0.0, 952.0], abs=1e-3)


def test_what_an_older_version_remembered_says_nothing():
    before = rows()
    after, remembered = filled(before)
    assert not offsets(after, FILLED, PLAIN, remembered[1:]).exact.any()
