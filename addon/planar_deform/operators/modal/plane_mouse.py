# SPDX-License-Identifier: GPL-3.0-or-later
"""The mouse over a region of a 3D view, as it moves in the plane of the pins that are dragged."""

from __future__ import annotations

import math

import bpy

from ...errors import Refusal
from ...model.input.drag import Drag, Mode, Point
from ...model.plane.axes import plane_axes
from ...scene.view.mouse import ray
from .several_posing import SeveralPosing

EDGE_ON = "The drawing is seen edge-on here: turn the view first"
SNAP_PIXELS = 5.0  # at a UI scale of 1, the least that a snapping step is wide


class PlaneMouse:
    """Where it began, and what its movement makes of a drag.

    The region and its view are told each time, as they may be gone by then: None.
    """

    def __init__(
        self,
        posing: SeveralPosing,
        region: bpy.types.Region,
        view: bpy.types.RegionView3D,
        event: bpy.types.Event,
    ):
        self._posing = posing
        self._seen_by = _matrix(view)
        self._start = self._point(region, view, event)
        beside = self._point(region, view, event, SNAP_PIXELS * bpy.context.preferences.system.ui_scale)
        self._step = 1.0
        if self._start is not None and beside is not None:  # a power of ten, as Blender's grid has them
            self._step = 10.0 ** math.ceil(math.log10(math.dist(self._start, beside)))

    def begin(self, mode: Mode) -> Drag:
        """A drag that counts from where the mouse began. Raises Refusal."""
        if self._start is None:
            raise Refusal(EDGE_ON)
        x, y = self._posing.model.pivot[:2].tolist()
        frame = self._posing.drawing.frame
        axes = plane_axes(frame, "GLOBAL"), plane_axes(frame, "LOCAL")
        return Drag.begin(mode, *axes, (x, y), self._start, self._step)

    def moved(
        self,
        region: bpy.types.Region | None,
        view: bpy.types.RegionView3D | None,
        event: bpy.types.Event,
        drag: Drag,
    ) -> Drag:
        """The drag after a movement, or after the view has turned under the mouse."""
        point = None if region is None or view is None else self._point(region, view, event)
        if point is None:  # the mouse is beyond the horizon of the plane, or over another editor
            return drag
        seen_by = _matrix(view)
        if seen_by != self._seen_by:
            self._seen_by = seen_by
            return drag.seen_from_elsewhere(point)
        return drag.moved(point)

    def _point(
        self,
        region: bpy.types.Region,
        view: bpy.types.RegionView3D,
        event: bpy.types.Event,
        aside: float = 0.0,
    ) -> Point | None:
        """Where the mouse is in the plane of the pins, or pixels beside it; None where that is edge-on."""
        mouse = (event.mouse_x - region.x + aside, event.mouse_y - region.y)
        point = self._posing.drawing.plane_from_ray(*ray(region, view, mouse), self._posing.leading)
        return None if point is None else (float(point[0]), float(point[1]))


def _matrix(view: bpy.types.RegionView3D) -> tuple[float, ...]:
    """Equal as long as the same mouse position means the same place."""
    return tuple(value for row in view.perspective_matrix for value in row)
