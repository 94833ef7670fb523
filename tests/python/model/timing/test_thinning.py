# SPDX-License-Identifier: GPL-3.0-or-later
"""Which poses of a row are kept, with straight blends as what is found between them."""

import numpy as np
import pytest

from planar_deform.model.plane.frame import Array
from planar_deform.model.timing.thinning import Thinned, thin

SHAPE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])


def moved(path: Array) -> list[Array]:
    """A shape for each point of a path (k x 2): the third vertex goes along it, the others stay."""
    shapes = np.tile(SHAPE, (len(path), 1, 1))
    shapes[:, 2] += path
    return list(shapes)


def blends(shapes: list[Array]):
    def between(kept: list[int], number: int) -> list[Array]:
        first, last = kept[number : number + 2]
        shares = np.arange(1, last - first) / (last - first)
        return [(1.0 - share) * shapes[first] + share * shapes[last] for share in shares]

    return between


def blended(shapes: list[Array], kept: list[int]) -> Array:
    """All shapes as they are found from those kept."""
    between = blends(shapes)
    found = [
        shape for number, first in enumerate(kept[:-1]) for shape in (shapes[first], *between(kept, number))
    ]
    return np.array([*found, shapes[-1]])


def run(path: Array, tolerance: float, fixed: set[int] | None = None) -> Thinned:
    shapes = moved(path)
    return thin(shapes, fixed or set(), blends(shapes), tolerance, lambda _: None)


def zigzag() -> Array:
    return np.stack([np.arange(13.0), [0, 1, 2, 3, 4, 3, 2, 1, 0, 1, 2, 3, 4]], axis=1)


def test_corners_of_a_zigzag_are_all_that_is_kept() -> None:
    result = run(zigzag(), 1e-9)
    assert result.kept == [0, 4, 8, 12]
    assert result.furthest < 1e-12


def test_what_is_left_out_is_within_the_tolerance_and_the_furthest_is_told() -> None:
    path = np.stack([np.arange(60.0), 5.0 * np.sin(np.arange(60.0) / 9.0)], axis=1)
    counts = []
    for tolerance in (0.01, 0.1, 1.0):
        result = run(path, tolerance)
        shapes = moved(path)
        errors = np.linalg.norm(blended(shapes, result.kept) - shapes, axis=2).max(axis=1)
        assert 0.0 < result.furthest <= tolerance
        assert result.furthest == pytest.approx(errors.max(), rel=1e-12)
        assert result.kept[0] == 0
        assert result.kept[-1] == 59
        counts.append(len(result.kept))
    assert 60 > counts[0] > counts[1] > counts[2] >= 4


def test_fixed_ones_are_kept() -> None:
    straight = np.stack([np.arange(9.0), np.zeros(9)], axis=1)
    assert run(straight, 1e-9).kept == [0, 8]
    assert run(straight, 1e-9, {3, 4}).kept == [0, 3, 4, 8]


def test_nothing_to_leave_out() -> None:
    assert run(zigzag()[3:5], 1e-9) == Thinned([0, 1], 0.0)


@pytest.mark.parametrize("reach", [0, 1])
def test_stretches_are_solved_again_only_where_keys_near_them_are_new(reach: int) -> None:
    path = np.stack([np.arange(200.0), 5.0 * np.sin(np.arange(200.0) / 9.0)], axis=1)
    path[:100, 1] = 0.0
    shapes = moved(path)
    between, seen = blends(shapes), []

    def watched(kept: list[int], number: int) -> list[Array]:
        seen.append((*kept[max(0, number - reach) : number + 2 + reach], -1, *kept[number : number + 2]))
        return between(kept, number)

    result = thin(shapes, set(), watched, 0.05, lambda _: None, reach=reach)
    assert result.kept == run(path, 0.05).kept
    assert len(seen) == len(set(seen)), "none twice between the same keys"


def test_none_is_kept_that_later_ones_have_made_needless() -> None:
    path = np.stack([np.arange(60.0), 5.0 * np.sin(np.arange(60.0) / 9.0) + 0.1 * np.arange(60.0)], axis=1)
    shapes = moved(path)
    for tolerance in (0.02, 0.05, 0.1, 0.2, 0.5, 1.0):
        kept = run(path, tolerance).kept
        for key in kept[1:-1]:
            without = blended(shapes, [index for index in kept if index != key])
            assert np.linalg.norm(without - shapes, axis=2).max() > tolerance, (tolerance, key)


def test_the_share_grows_and_raising_ends_it() -> None:
    shapes, shares = moved(zigzag()), []
    thin(shapes, set(), blends(shapes), 1e-9, shares.append)
    assert shares == sorted(shares)
    assert 0.0 <= shares[0] < shares[-1] < 1.0

    def stop(share: float) -> None:
        raise InterruptedError

    with pytest.raises(InterruptedError):
        thin(shapes, set(), blends(shapes), 1e-9, stop)
