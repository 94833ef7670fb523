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


def hidden_refusal(context: bpy.types.Context, obj: bpy.types.Object | None = None) -> str | None:
    """Why pins of an object, by default the active one, cannot be used in the view at hand: it is hidden."""
    obj = obj or context.object
    if obj is None or obj.visible_get():  # asks for the view at hand by itself
        return None
    space = context.space_data
    local = isinstance(space, bpy.types.SpaceView3D) and space.local_view is not None
    if local and not obj.local_view_get(space):
        return f"'{obj.name}' is not in this view: leave its Local View with View > Local View first"
    return f"'{obj.name}' is hidden: show it by its eye in the Outliner first"


def refuse_hidden(context: bpy.types.Context, obj: bpy.types.Object | None = None) -> None:
    """Raises Refusal where hidden_refusal() gives a reason."""
    reason = hidden_refusal(context, obj)
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
) -> PinPlace | None:
    """The pin that the mouse is on, of several the nearest; None if it is on none."""
    shown = list(pins)
    nearest = nearest_within(region, view, (pin.place for pin in shown), mouse, REACH)
    return None if nearest is None else shown[nearest]


def pins_within(
    region: bpy.types.Region,
    view: bpy.types.RegionView3D,
    pins: Iterable[PinPlace],
    corner: Sequence[float],
    opposite: Sequence[float],
) -> list[PinPlace]:
    """The pins that are seen in a box."""
    low, high = np.minimum(corner, opposite), np.maximum(corner, opposite)
    seen = ((pin, location_3d_to_region_2d(region, view, Vector(pin.place))) for pin in pins)
    return [
        pin
        for pin, place in seen
        if place is not None and bool(np.all((low <= np.array(place)) & (np.array(place) <= high)))
    ]


def ring_about(pins: Iterable[PinPlace]) -> Ring | None:
    """The ring about the selected ones of pins that hold drawings; None where there are none."""
    listed = [(place, pin) for place in pins if (pin := pin_at(place)) is not None]
    chosen = [(place, pin) for place, pin in listed if pin.select and pin.enabled and not is_joint(pin)]
    if len(chosen) > 1:
        return Ring(np.mean([place.target for place, _ in chosen], axis=0))
    return Ring(chosen[0][0].target, chosen[0][0], chosen[0][1].kind == "PATCH") if chosen else None


def pin_at(place: PinPlace) -> bpy.types.PropertyGroup | None:
    """The pin that is there, in the list of its object; None where that is another one by now."""
    obj = bpy.data.objects.get(place.owner)
    return obj.planar.pins[place.key] if obj is not None and place.key < len(obj.planar.pins) else None


def on_ring(
    region: bpy.types.Region, view: bpy.types.RegionView3D, ring: Ring, mouse: Sequence[float]
) -> bool:
    """Whether the mouse is on the ring."""
    scale: float = bpy.context.preferences.system.ui_scale
    return abs(pixels_to(region, view, ring.centre, mouse) - RING * scale) <= NEAR_RING * scale
