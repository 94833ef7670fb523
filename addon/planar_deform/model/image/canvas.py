# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a drawing lies in its image once that has another size: it was given more canvas, or trimmed.

A mesh's UV map tells places as shares of the canvas, so that a drawing on a larger one would shrink.
"""

from __future__ import annotations

import numpy as np

from ..plane.frame import Array, Mask
from .art import Alpha
from .silhouette import covered

SAMPLES = 512  # along the longer side, in which places are looked for
# Of the best: as good. An outline stays away from its drawing, so that there are many such places, all around
# the right one.
AS_GOOD = 0.998

Size = tuple[int, int]  # width, height


def moved(ends: Array, old: Size, alpha: Alpha) -> tuple[int, int] | None:
    """The pixel of an image in which the lower left corner of its old canvas, of a size, lies by now.

    `ends`: the outline of the drawing as it was, in shares of that canvas: edges k x 2 x 2, the inside on the
    left. None where the drawing takes the same share of the canvas as before, in more or fewer pixels, or is
    not to be found.
    """
    new = (alpha.shape[1], alpha.shape[0])
    step = -(-max(*old, *new) // SAMPLES)
    art = _shrunk(alpha > 0, step)
    was, start = _drawn(ends * np.array(old) / step)
    overlaps = _overlaps(was, art)
    stretched, corner = _drawn(ends * np.array(new) / step)
    row, column = np.array(stretched.shape) - 1 + corner[::-1]
    same = _overlaps(stretched, art)
    unmoved = same[row, column] if 0 <= row < same.shape[0] and 0 <= column < same.shape[1] else 0.0
    if _likeness(overlaps.max(), was, art) <= _likeness(unmoved, stretched, art):
        return None
    good = overlaps >= AS_GOOD * overlaps.max()
    rows, columns = np.nonzero(good)
    places = np.stack([columns, rows], axis=1) - np.array(was.shape[::-1]) + 1 - start
    middle = places.mean(axis=0) * step
    kept = set(map(tuple, places.tolist()))
    found = []
    for axis in range(2):
        # Where programs put a canvas, if that is as good.
        grown = new[axis] - old[axis]
        usual = min((0, grown // 2, grown - grown // 2, grown), key=lambda at: abs(at - middle[axis]))
        near = middle.copy()
        near[axis] = usual
        fits = tuple(np.rint(near / step).astype(int).tolist()) in kept
        found.append(usual if fits else round(float(middle[axis])))
    return found[0], found[1]


def _shrunk(art: Mask, step: int) -> Array:
    """Each sample is the share that is art of so many pixels a side."""
    height, width = (-(-side // step) for side in art.shape)
    padded = np.zeros((height * step, width * step), bool)
    padded[: art.shape[0], : art.shape[1]] = art
    shares: Array = padded.reshape(height, step, width, step).mean(axis=(1, 3), dtype=np.float64)
    return shares


def _drawn(ends: Array) -> tuple[Mask, Array]:
    """The samples within an outline, and the place of the first one."""
    start = np.floor(ends.min(axis=(0, 1)))
    width, height = (np.ceil(ends.max(axis=(0, 1))) - start).astype(int) + 1
    return covered(ends - start, height, width), start.astype(int)


def _overlaps(mask: Mask, art: Array) -> Array:
    """What they have in common wherever a mask lies: in the first place, its last sample on the first one."""
    shape = [a + b - 1 for a, b in zip(mask.shape, art.shape, strict=True)]
    spectrum = np.fft.rfft2(art, shape) * np.fft.rfft2(mask[::-1, ::-1].astype(np.float64), shape)
    common: Array = np.fft.irfft2(spectrum, shape)
    return common


def _likeness(common: float, mask: Mask, art: Array) -> float:
    """What they have in common as a share of what is in either."""
    return common / (float(mask.sum()) + float(art.sum()) - common)
