# SPDX-License-Identifier: GPL-3.0-or-later
"""The mouse in a 3D view: the ray through it, and the pin under it. The mouse is given in region pixels."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import bpy
import numpy as np
from bpy_extras.view3d_utils import (
    location_3d_to_region_2d,
    region_2d_to_origin_3d,
    region_2d_to_vector_3d,
)
from mathutils import Vector

from ..model.frame import Array
from .snapshot import PinPlace

REACH = 12.0  # pixels at a UI scale of 1 from the middle of a pin within which the mouse is on it


def ray(
    region: bpy.types.Region, view: bpy.types.RegionView3D, mouse: Sequence[float]
) -> tuple[Array, Array]:
    """Origin and direction (3,) in the world of what lies under the mouse."""
    origin, direction = (
        region_2d_to_origin_3d(region, view, mouse),
        region_2d_to_vector_3d(region, view, mouse),
    )
    return np.array(origin, dtype=np.float64), np.array(direction, dtype=np.float64)


def pixels_to(
    region: bpy.types.Region, view: bpy.types.RegionView3D, place: Array, mouse: Sequence[float]
) -> float:
    """How far the mouse is from a place (3,) in the world; infinite where that is behind the view."""
    seen = location_3d_to_region_2d(region, view, Vector(place))
    return math.inf if seen is None else (seen - Vector(mouse)).length


def pin_under(
    region: bpy.types.Region,
    view: bpy.types.RegionView3D,
    pins: Iterable[PinPlace],
    mouse: Sequence[float],
) -> int | None:
    """The index of the pin that the mouse is on, of several the nearest; None if it is on none."""
    reach = REACH * bpy.context.preferences.system.ui_scale
    distances = [(pixels_to(region, view, pin.place, mouse), pin.key) for pin in pins]
    nearest = min(distances, default=(math.inf, -1))
    return nearest[1] if nearest[0] <= reach else None
