# SPDX-License-Identifier: GPL-3.0-or-later
"""What of an image is art: its alpha, or what lies inside of a plain border."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ... import native
from ..plane.frame import Array32

Alpha = NDArray[np.uint8]  # h x w, rows from the bottom; 255 is opaque

OPAQUE = 255


@dataclass(frozen=True)
class Art:
    """An image's alpha, and what is to be told of how it was found."""

    alpha: Alpha
    said: str | None = None


def art_of(pixels: Array32, *, uses_alpha: bool = True, has_alpha: bool = True) -> Art:
    """The art of an image of h x w x channels pixels, rows from the bottom. Takes no Blender data.

    Not `uses_alpha`: the image is shown as if it were opaque. Not `has_alpha`: Blender has filled in
    the last of four channels.
    """
    height, width, channels = pixels.shape
    if channels == 4 and uses_alpha:
        alpha = np.rint(np.clip(np.nan_to_num(pixels[..., 3]), 0.0, 1.0) * OPAQUE).astype(np.uint8)
        if alpha.min() < OPAQUE:
            return Art(alpha)
    why = "it is opaque" if channels == 4 and uses_alpha and has_alpha else "it has no alpha"
    colours = pixels[..., :3] if channels >= 3 else np.repeat(pixels[..., :1], 3, axis=2)
    keyed = native.key_colour(np.nan_to_num(colours))
    if keyed.keyed:
        return Art((keyed.alpha * OPAQUE).astype(np.uint8), f"{why}: cut out by the colour of its border")
    whole = np.full((height, width), OPAQUE, np.uint8)
    return Art(whole, f"{why}, so all of it is the cutout. {keyed.said}")


def united(frames: Iterable[Art]) -> Art:
    """The art of a sequence: whatever is art in one of its frames, which have one size."""
    frames = list(frames)
    alpha = frames[0].alpha.copy()
    for frame in frames[1:]:
        np.maximum(alpha, frame.alpha, out=alpha)
    return Art(alpha, next((frame.said for frame in frames if frame.said is not None), None))
