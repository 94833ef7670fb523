# SPDX-License-Identifier: GPL-3.0-or-later
"""The progress of a curve between the poses that it plays, kept when the poses' eval_times change.

From key to key a curve goes a share of the way at each time. With the poses elsewhere, these shares are the
same if whatever is between two keys is carried along in proportion: the handles that shape the way, each by
the change of value on its own side of the key, and how far the way swings. Beyond the two keys that is where
the curve then is, in what is next door.
"""

from __future__ import annotations

import numpy as np

from ..plane.frame import Array, Mask
from .played_curve import SAME_EVAL_TIME, Rows

# Of the way from key to key: handles nearer to where they should be change no progress that could be seen.
NEAR = 2e-4


def carried(old: Array, known: Mask, fallback: Array) -> Array:
    """New values of keys whose values were `old`, both k in order of time.

    The known ones' are those of `fallback`, and so are those of others that are not between known ones
    around them; what is between them stays there, in proportion.
    """
    new = np.array(fallback)
    anchors = np.flatnonzero(known)
    for first, last in zip(anchors[:-1].tolist(), anchors[1:].tolist(), strict=True):
        change = old[last] - old[first]
        if abs(change) < SAME_EVAL_TIME:
            continue
        share = (old[first + 1 : last] - old[first]) / change
        between = new[first] + share * (new[last] - new[first])
        inside = (share >= 0.0) & (share <= 1.0)
        new[first + 1 : last][inside] = between[inside]
    return new


def kept(rows: Rows, known: Mask, fallback: Array) -> Rows:
    """The keys where they are to be: their progress is what it is in `rows`.

    `fallback` (k x 3) has the new values of the known keys, and those of handles beside which the value of a
    key is that of the next.
    """
    old, new = rows.values, carried(rows.values[:, 0], known, fallback[:, 0])
    if len(old) < 2:
        return rows.at(fallback, rows.types.copy(), rows.amplitude.copy())
    change = np.diff(old[:, 0])
    told = np.abs(change) >= SAME_EVAL_TIME
    ratio = np.where(told, np.diff(new) / np.where(told, change, 1.0), 1.0)
    # Before the first and behind the last key as on their other side, so that handles in line stay in line.
    handles = fallback[:, 1:].copy()
    for side, sure, by in (
        (0, np.concatenate([told[:1], told]), np.concatenate([ratio[:1], ratio])),
        (1, np.concatenate([told, told[-1:]]), np.concatenate([ratio, ratio[-1:]])),
    ):
        carried_by = new + by * (old[:, 1 + side] - old[:, 0])
        handles[sure, side] = carried_by[sure]
    amplitude = rows.amplitude.copy()
    amplitude[:-1] *= np.abs(ratio)
    return rows.at(np.column_stack([new, handles]), rows.types.copy(), amplitude)


def off(found: Rows, wanted: Rows, bezier: Mask) -> Mask:
    """Which keys have a handle that is not where it should be, and tells the way to its neighbour.

    `bezier`: behind which keys handles tell the way.
    """
    frames, values = wanted.keys.T
    near = np.abs(np.stack([np.diff(frames), np.diff(values)], axis=1)) * NEAR
    near += 4.0 * np.spacing(np.abs(wanted.keys[1:]))  # float32 is coarse far up
    result = np.zeros(len(frames), bool)
    result[1:] |= (np.abs(found.left - wanted.left)[1:] > near).any(axis=1) & bezier[:-1]
    result[:-1] |= (np.abs(found.right - wanted.right)[:-1] > near).any(axis=1) & bezier[:-1]
    return result
