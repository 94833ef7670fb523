# SPDX-License-Identifier: GPL-3.0-or-later
"""Curve objects as lines of points."""

from __future__ import annotations

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array
from ...model.posing.pin_path import bezier


def line_of(curve: bpy.types.Object) -> Array:
    """Points (m x 3, object-local) along the first spline of a curve, its begin again if it is closed.

    Raises Refusal where it is no line.
    """
    splines = curve.data.splines
    if not len(splines):
        raise Refusal(f"'{curve.name}' has no points: draw a line, or choose another curve")
    spline = splines[0]
    if spline.type == "BEZIER":
        points = spline.bezier_points
        columns = [_coordinates(points, name, 3) for name in ("handle_left", "co", "handle_right")]
        found = bezier(*columns, closed=spline.use_cyclic_u)
    elif spline.type == "POLY":
        found = _coordinates(spline.points, "co", 4)[:, :3]
        found = np.concatenate([found, found[:1]]) if spline.use_cyclic_u else found
    else:
        raise Refusal(f"'{curve.name}' is a NURBS curve: make it a Bezier curve with Set Spline Type")
    if not np.ptp(found, axis=0).any():
        raise Refusal(f"'{curve.name}' has no length: draw a line, or choose another curve")
    return found


def _coordinates(points: bpy.types.bpy_prop_collection, name: str, size: int) -> Array:
    found = np.empty(len(points) * size, np.float32)
    points.foreach_get(name, found)
    return found.reshape(-1, size).astype(np.float64)
