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
    between: Callable[[list[int]], Sequence[Array]],
    tolerance: float,
    progress: Progress,
) -> Thinned | None:
    """Keep few of the shapes (n x 2 each), so that the others are found again between them.

    The first, the last and the fixed ones are kept. `between(kept)` tells what is then found in the place of
    each shape. Where that is farther off than the tolerance at any vertex, the worst shape of the stretch is
    kept, too: this is how Ramer and Douglas and Peucker simplify a line. None if `progress` says to stop.
    """
    kept = sorted({0, len(shapes) - 1} | fixed)
    while True:
        found = between(kept)
        pairs = zip(found, shapes, strict=True)
        errors = np.array([np.linalg.norm(here - there, axis=1).max() for here, there in pairs])
        settled, worst = 0, []
        for first, last in itertools.pairwise(kept):
            row = first + int(errors[first : last + 1].argmax())
            if errors[row] > tolerance and row not in (first, last):
                worst.append(row)
            else:
                settled += last - first
        if not worst:
            return Thinned(kept, float(np.delete(errors, kept).max(initial=0.0)))
        kept = sorted([*kept, *worst])
        if not progress(settled / (len(shapes) - 1)):
            return None
