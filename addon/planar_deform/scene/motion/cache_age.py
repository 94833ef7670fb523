# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a point cache still is what the poses show."""

from __future__ import annotations

import bpy
import numpy as np

from ..sequence import pose_state
from ..sequence.pose_blocks import eval_times, shown_curve
from ..sequence.stretches import Stamps
from ..storage.digests import digest
from . import point_cache


def stamp(obj: bpy.types.Object, frames: range) -> str:
    """What the poses show at these frames, in short: of each the two shapes and how they are blended."""
    keys, curve, stamps = obj.data.shape_keys, shown_curve(obj.data.shape_keys), Stamps(obj)
    times = np.full(len(frames), keys.eval_time)
    if curve is not None:
        times[:] = [curve.evaluate(frame) for frame in frames]
    blocks = np.round(eval_times(keys), 2)
    times = np.clip(times, blocks[0], blocks[-1])
    upper = np.searchsorted(blocks, times)
    lower = np.where(blocks[upper] == times, upper, upper - 1)
    span = np.where(upper > lower, blocks[upper] - blocks[lower], 1.0)
    shares = np.round((times - blocks[lower]) / span, 4)
    names = {int(block): stamps.digest(blocks[block]) for block in np.union1d(lower, upper)}
    shown = (f"{names[a]} {names[b]} {share}" for a, b, share in zip(lower, upper, shares, strict=True))
    return f"{frames.start} {frames.stop} {frames.step} {digest(' '.join(shown).encode())}"


def is_out_of_date(obj: bpy.types.Object) -> bool:
    """Whether the object has a cache, and poses that show something else by now."""
    kept = obj.planar.cache_stamp
    if not kept or not pose_state.is_ours(obj) or point_cache.modifier_of(obj) is None:
        return False
    start, stop, step, _ = kept.split()
    return bool(stamp(obj, range(int(start), int(stop), int(step))) != kept)
