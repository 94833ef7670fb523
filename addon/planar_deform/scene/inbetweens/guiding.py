# SPDX-License-Identifier: GPL-3.0-or-later
"""The paths of pins read for the solver: curves as lines in the drawing's plane."""

from __future__ import annotations

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array, mapped
from ...model.posing.pin_path import PinPath, is_closed
from ..objects.any_object import AnyObject
from ..storage.curve_lines import line_of
from ..storage.pin_paths import path_of
from .plan import Plan

EDGE_ON = 1e-3  # of the length of a curve: what is shorter in the plane is no line there


def paths(obj: bpy.types.Object, plan: Plan, transition: int, pose: str) -> dict[int, PinPath]:
    """Those of the pins behind a pose, by the pins' keys. Raises Refusal where a curve cannot lead."""
    found = {}
    for held in plan.held:
        pin = obj.planar.pins[held.key]
        path = path_of(pin, pose) if pose else None
        if path is None:
            continue
        line = None
        if path.kind == "CURVE":
            if path.curve is None:
                raise Refusal(
                    f"Pin '{pin.name}' has no curve for its path from '{pose}': choose one, or another path"
                )
            line = _in_plane(plan.drawing, path.curve)
            gap = float(np.linalg.norm(np.subtract(*map(held.middle, plan.ends(transition)))))
            if is_closed(line) and gap > plan.near:
                raise Refusal(
                    f"'{path.curve.name}' ends where it begins, and pin '{pin.name}' does not from '{pose}': "
                    "open the curve"
                )
            if not is_closed(line) and gap <= plan.near:
                raise Refusal(
                    f"Pin '{pin.name}' ends where it begins from '{pose}', and '{path.curve.name}' does not: "
                    "close the curve"
                )
        found[held.key] = PinPath(path.kind, path.ease, line)
    return found


def _in_plane(drawing: AnyObject, curve: bpy.types.Object) -> Array:
    """The line of a curve in the plane of a drawing, m x 2. Raises Refusal."""
    matrix = np.array(curve.matrix_world, np.float64)
    world = mapped(line_of(curve), matrix[:3, :3]) + matrix[:3, 3]
    line = drawing.from_world(world)
    lengths = [np.linalg.norm(np.diff(points, axis=0), axis=1).sum() for points in (line, world)]
    if not lengths[0] > EDGE_ON * lengths[1]:
        raise Refusal(
            f"'{curve.name}' lies across the plane of '{drawing.resolve().name}': turn it into the plane"
        )
    return line
