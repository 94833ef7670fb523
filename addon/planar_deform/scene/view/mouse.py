# SPDX-License-Identifier: GPL-3.0-or-later
"""The mouse in a 3D view: the ray through it, the pin and the ring under it. It is given in region pixels."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector

from ...errors import Refusal
from ...model.input import view_ray
from ...model.plane.frame import Array
from ..pins.pin_list import is_joint
from .snapshot import PinPlace

# Pixels at a UI scale of 1.
REACH = 12.0  # from the middle of a pin, within which the mouse is on it
RING = 36.0  # radius of the ring about what can be turned
NEAR_RING = 6.0  # within which the mouse is on the ring, unless it is on a pin


@dataclass(frozen=True)
class Ring:
    """What is turned together, or one pin that can be made a patch of another size."""

    centre: Array  # (3,) in the world, about which it is turned
    only: PinPlace | None = None  # the one pin, if it is one
    turns: bool = True  # a point alone does not


def ray(
    region: bpy.types.Region, view: bpy.types.RegionView3D, mouse: Sequence[float]
) -> tuple[Array, Array]:
    """Origin and unit direction (3,) in the world of what lies under the mouse."""
    window, world_to_view = np.array(view.window_matrix, float), np.array(view.view_matrix, float)
    place = 2.0 * mouse[0] / region.width - 1.0, 2.0 * mouse[1] / region.height - 1.0
    return view_ray.ray(window, world_to_view, place)


def towards(view: bpy.types.RegionView3D) -> tuple[float, float, float]:
    """The direction in the world from which a view looks."""
    x, y, z = view.view_matrix.row[2][:3]
    return (x, y, z)


def hidden_refusal(context: bpy.types.Context) -> str | None:
    """Why the active object's pins cannot be used in the view at hand, if it is hidden there."""
    obj = context.object
    if obj is None or obj.visible_get():  # asks for the view at hand by itself
        return None
    space = context.space_data
    local = isinstance(space, bpy.types.SpaceView3D) and space.local_view is not None
    if local and not obj.local_view_get(space):
        return f"'{obj.name}' is not in this view: leave its Local View with View > Local View first"
    return f"'{obj.name}' is hidden: show it by its eye in the Outliner first"


def refuse_hidden(context: bpy.types.Context) -> None:
    """Raises Refusal where the active object's pins cannot be used in the view at hand."""
    reason = hidden_refusal(context)
    if reason is not None:
        raise Refusal(reason)


def regions(area: bpy.types.Area | None) -> list[tuple[bpy.types.Region, bpy.types.RegionView3D]]:
    """The regions of an area that show its 3D view, four in a quad view, each with its view."""
    if area is None or area.type != "VIEW_3D":
        return []
    space = area.spaces.active
    views = list(space.region_quadviews) or [space.region_3d]
    shown = [region for region in area.regions if region.type == "WINDOW"]
    return list(zip(shown, views, strict=False))


def pixels_to(
    region: bpy.types.Region, view: bpy.types.RegionView3D, place: Array, mouse: Sequence[float]
) -> float:
    """How far the mouse is from a place (3,) in the world; infinite where that is behind the view."""
    seen = location_3d_to_region_2d(region, view, Vector(place))
    return math.inf if seen is None else (seen - Vector(mouse)).length


def nearest_within(
    region: bpy.types.Region,
    view: bpy.types.RegionView3D,
    places: Iterable[Array],
    mouse: Sequence[float],
    reach: float,
) -> int | None:
    """Which of places in the world is nearest to the mouse; None beyond so many pixels at a UI scale of 1."""
    distances = [(pixels_to(region, view, place, mouse), index) for index, place in enumerate(places)]
    nearest = min(distances, default=(math.inf, -1))
    return nearest[1] if nearest[0] <= reach * bpy.context.preferences.system.ui_scale else None


def pin_under(
    region: bpy.types.Region,
    view: bpy.types.RegionView3D,
    pins: Iterable[PinPlace],
    mouse: Sequence[float],
) -> int | None:
    """The index of the pin that the mouse is on, of several the nearest; None if it is on none."""
    shown = list(pins)
    nearest = nearest_within(region, view, (pin.place for pin in shown), mouse, REACH)
    return None if nearest is None else shown[nearest].key


def pins_within(
    region: bpy.types.Region,
    view: bpy.types.RegionView3D,
    pins: Iterable[PinPlace],
    corner: Sequence[float],
    opposite: Sequence[float],
) -> list[int]:
    """The indices of the pins that are seen in a box."""
    low, high = np.minimum(corner, opposite), np.maximum(corner, opposite)
    seen = {pin.key: location_3d_to_region_2d(region, view, Vector(pin.place)) for pin in pins}
    return [
        key
        for key, place in seen.items()
        if place is not None and bool(np.all((low <= np.array(place)) & (np.array(place) <= high)))
    ]


def ring_about(obj: bpy.types.Object, pins: Iterable[PinPlace]) -> Ring | None:
    """The ring about the selected pins of an object that hold it; None where there are none."""
    settings = obj.planar.pins
    chosen = [pin for pin in pins if settings[pin.key].select and settings[pin.key].enabled]
    chosen = [pin for pin in chosen if not is_joint(settings[pin.key])]
    if len(chosen) > 1:
        return Ring(np.mean([pin.target for pin in chosen], axis=0))
    return Ring(chosen[0].target, chosen[0], settings[chosen[0].key].kind == "PATCH") if chosen else None


def on_ring(
    region: bpy.types.Region, view: bpy.types.RegionView3D, ring: Ring, mouse: Sequence[float]
) -> bool:
    """Whether the mouse is on the ring."""
    scale: float = bpy.context.preferences.system.ui_scale
    return abs(pixels_to(region, view, ring.centre, mouse) - RING * scale) <= NEAR_RING * scale
