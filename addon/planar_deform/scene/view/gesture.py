# SPDX-License-Identifier: GPL-3.0-or-later
"""What the mouse draws in a view while it chooses: a box, a circle. Kept for the overlay that shows it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import bpy

from ..storage import redraw

Strip = tuple[tuple[float, float], ...]  # corners of a line, in the region's pixels


@dataclass(frozen=True)
class Gesture:
    """Lines in one region."""

    region: int  # its address, as a region has no other identity
    strips: tuple[Strip, ...]


_now: Gesture | None = None


def now(region: bpy.types.Region) -> Gesture | None:
    """What a region shows."""
    return _now if _now is not None and _now.region == region.as_pointer() else None


def show(region: bpy.types.Region, strips: Iterable[Sequence[tuple[float, float]]]) -> None:
    """Show these lines there, and no others anywhere."""
    global _now
    _now = Gesture(region.as_pointer(), tuple(tuple(strip) for strip in strips))
    region.tag_redraw()


def clear() -> None:
    """Show none."""
    global _now
    _now = None
    redraw.views()
