# SPDX-License-Identifier: GPL-3.0-or-later
"""Which poses of a recording are needed, when those between them can be calculated."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from .frame import Array
from .work import Progress


@dataclass(frozen=True)
class Thinned:
    """What is left of a row of poses."""

    kept: list[int]  # of the poses, in order
    furthest: float  # that any vertex of a pose that is not kept is from where it was


def thin(
    shapes: Sequence[Array],
    fixed: set[int],
    between: Callable[[list[int], int], Sequence[Array]],
    tolerance: float,
    progress: Progress,
    *,
    reach: int = 0,
) -> Thinned | None:
    """Keep few of the shapes (n x 2 each), so that the others are found again between them.

    The first, the last and the fixed ones are kept. `between(kept, k)` tells what is then found in place of
    those strictly between kept[k] and kept[k + 1]; it depends on these two, and on as many more on each side
    as `reach` tells. Where that is farther off than the tolerance at any vertex, the worst shape of the
    stretch is kept, too: this is how Ramer and Douglas and Peucker simplify a line. None if `progress` says
    to stop.
    """
    kept = sorted({0, len(shapes) - 1} | fixed)
    new = set(kept)
    errors = np.zeros(len(shapes))
    while new:
        errors[sorted(new)] = 0.0
        for number, (first, last) in enumerate(itertools.pairwise(kept)):
            around = kept[max(0, number - reach) : number + 2 + reach]
            if last - first > 1 and not new.isdisjoint(around):
                pairs = zip(between(kept, number), shapes[first + 1 : last], strict=True)
                errors[first + 1 : last] = [
                    np.linalg.norm(here - there, axis=1).max() for here, there in pairs
                ]
                if not progress(float(np.mean(errors <= tolerance))):
                    return None
        stretches = [slice(first, last) for first, last in itertools.pairwise(kept)]
        new = {
            stretch.start + int(errors[stretch].argmax())
            for stretch in stretches
            if errors[stretch].max() > tolerance
        }
        kept = sorted([*kept, *new])
    return Thinned(kept, float(errors.max()))
