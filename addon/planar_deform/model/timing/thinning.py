# SPDX-License-Identifier: GPL-3.0-or-later
"""Which poses of a recording are needed, when those between them can be calculated."""

from __future__ import annotations

import bisect
import itertools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..plane.frame import Array

SPLITTING = 0.8  # of the work; the rest is looking for what has become needless


@dataclass(frozen=True)
class Thinned:
    """What is left of a row of poses."""

    kept: list[int]  # of the poses, in order
    furthest: float  # that any vertex of a pose that is not kept is from where it was


def thin(
    shapes: Sequence[Array],
    fixed: set[int],
    between: Callable[[list[int], int], Iterable[Array]],
    tolerance: float,
    told: Callable[[float], None],
    *,
    reach: int = 0,
) -> Thinned:
    """Keep few of the shapes (n x 2 each), so that the others are found again between them.

    The first, the last and the fixed ones are kept. `between(kept, k)` tells what is then found in place of
    those strictly between kept[k] and kept[k + 1]; it depends on these two, and on as many more on each side
    as `reach` tells. Where that is farther off than the tolerance at any vertex, the worst shape of the
    stretch is kept, too, as Ramer and Douglas and Peucker simplify a line. In the end those go again that the
    later ones have made needless. `told` gets the share done, and may raise to stop it.
    """
    known: dict[tuple[int, ...], Array] = {}

    def errors(kept: list[int], number: int) -> Array:
        """How far each shape of a stretch is off."""
        first, last = kept[number : number + 2]
        key = (first, *kept[max(0, number - reach) : number + 2 + reach], last)
        if key not in known:
            found = between(kept, number) if last - first > 1 else ()
            pairs = zip(found, shapes[first + 1 : last], strict=True)
            known[key] = np.array([np.linalg.norm(here - there, axis=1).max() for here, there in pairs])
        return known[key]

    kept = sorted({0, len(shapes) - 1} | fixed)
    near = 0.0
    while True:
        new, settled = set(), 0
        for number, (first, last) in enumerate(itertools.pairwise(kept)):
            off = errors(kept, number)
            if off.max(initial=0.0) > tolerance:
                new.add(first + 1 + int(off.argmax()))
            else:
                settled += last - first
            near = max(near, settled / (len(shapes) - 1))
            told(SPLITTING * near)
        if not new:
            break
        kept = sorted([*kept, *new])
    for count, candidate in enumerate(kept[1:-1]):
        told(SPLITTING + (1.0 - SPLITTING) * count / len(kept))
        trial = [index for index in kept if index != candidate]
        number = bisect.bisect(trial, candidate) - 1
        changed = range(max(0, number - reach), min(len(trial) - 1, number + 1 + reach))
        if candidate not in fixed and all(errors(trial, k).max(initial=0.0) <= tolerance for k in changed):
            kept = trial
    furthest = max(errors(kept, number).max(initial=0.0) for number in range(len(kept) - 1))
    return Thinned(kept, float(furthest))
