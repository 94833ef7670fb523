# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines to test on: meshes of edges, and poly curves, in any plane."""

import bpy
import numpy as np
from support import PLANES, activate, make_object

RING = [(np.cos(a) * 1.5, np.sin(a), 0.0) for a in np.linspace(0, 2 * np.pi, 12, endpoint=False)]
WAVE = [(0.3 * i, 0.2 * (-1) ** i, 0.0) for i in range(8)]


def chain(count, start=0, closed=False):
    return [(start + i, start + (i + 1) % count) for i in range(count if closed else count - 1)]


LINES = {
    "closed line": (RING, chain(12, closed=True)),
    "open line": (WAVE, chain(8)),
    "lines in parallel planes": (
        RING + [(x + 3, y, 0.5) for x, y, _ in WAVE],
        chain(12, closed=True) + chain(8, 12),
    ),
    "edge soup": (
        RING + WAVE[1:] + [(7, 7, 7)],
        [*chain(12, closed=True), (0, 6), (3, 12), *chain(7, 12)],
    ),
}


def lines(kind, plane="XY", name="Cutout"):
    """A mesh of edges, or a curve of the same points."""
    turn = PLANES[plane].T
    if kind.endswith("curve"):
        curve = bpy.data.curves.new(name, "CURVE")
        curve.dimensions = kind[:2]
        curve.fill_mode = "FULL" if kind[:2] == "3D" else "NONE"  # else it is shown filled, by other vertices
        for points, closed in ((RING, True), (WAVE, False)):
            spline = curve.splines.new("POLY")
            spline.points.add(len(points) - 1)
            spline.use_cyclic_u = closed
            for i, (point, co) in enumerate(zip(spline.points, np.array(points) @ turn, strict=True)):
                point.co, point.radius, point.tilt, point.weight = (*co, 1.0), 1.0 + 0.1 * i, 0.05 * i, 0.3
        obj = bpy.data.objects.new(name, curve)
        bpy.context.scene.collection.objects.link(obj)
        activate(obj)
        return obj
    points, edges = LINES[kind]
    return make_object(np.array(points) @ turn, [], edges, name=name)


MESHES = ("closed line", "open line", "lines in parallel planes", "edge soup")
CURVES = ("2D curve", "3D curve")
# A 2D curve has no depth, so it lies in its object's XY plane.
PLACED = [
    (kind, plane) for kind in MESHES + CURVES for plane in PLANES if kind != "2D curve" or plane == "XY"
]


def edges_of(kind):
    """The lines of one of these objects, e x 2 points."""
    if kind.endswith("curve"):
        kind = "lines in parallel planes"  # has the same two lines
    return np.array(LINES[kind][1])
