# SPDX-License-Identifier: GPL-3.0-or-later
"""An even mesh of a drawn layer, from its shapes and not its pixels, for the tests of the library."""

from __future__ import annotations

import bpy  # noqa: F401 - it brings mathutils
import mathutils
import numpy as np
import shapely
from mathutils.geometry import delaunay_2d_cdt
from shapely.geometry import MultiPolygon, Polygon

from drawing import LINE_WIDTH, Layer

MARGIN = 1.5 * LINE_WIDTH  # of mesh around the ink, so that no line is cut when an outline becomes a polygon
ROUNDING = 0.03  # gaps and notches in an outline narrower than twice this are filled
SMOOTHING_ROUNDS = 6


def silhouette(layer: Layer) -> Polygon:
    """What the layer's mesh fills: painted shapes and a margin; tiny notches are closed, holes stay."""
    closed = layer.silhouette.buffer(MARGIN + ROUNDING).buffer(-ROUNDING)
    if isinstance(closed, MultiPolygon):
        raise ValueError(f"layer {layer.name!r} falls into {len(closed.geoms)} pieces; make a layer of each")
    return closed


def triangulate(outline: Polygon, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Fills a polygon (holes allowed) with triangles of nearly equal sides.

    Points at even steps along the rings and a hexagonal grid inside, joined by Blender's constrained
    Delaunay triangulation; the grid's points then move to the mean of their neighbours and are joined anew,
    a few times.
    """
    rings = [_even_ring(ring, spacing) for ring in (outline.exterior, *outline.interiors)]
    boundary = np.concatenate(rings)
    edges = []
    first = 0
    for ring in rings:
        edges += [(first + i, first + (i + 1) % len(ring)) for i in range(len(ring))]
        first += len(ring)
    area = Polygon(rings[0], rings[1:])

    interior = _hexagonal_points(area.buffer(-0.65 * spacing), spacing)
    for _ in range(SMOOTHING_ROUNDS):
        points = np.concatenate([boundary, interior])
        interior = _neighbour_means(points, _join(points, edges, area))[len(boundary) :]
    points = np.concatenate([boundary, interior])
    return points, _join(points, edges, area)


def _even_ring(ring: shapely.LinearRing, spacing: float) -> np.ndarray:
    count = max(8, round(ring.length / spacing))
    return shapely.get_coordinates(
        shapely.line_interpolate_point(ring, np.arange(count) / count, normalized=True)
    )


def _hexagonal_points(area: Polygon, spacing: float) -> np.ndarray:
    left, bottom, right, top = area.bounds
    rows = []
    for j, z in enumerate(np.arange(bottom, top, spacing * np.sqrt(0.75))):
        x = np.arange(left + (j % 2) * 0.5 * spacing, right, spacing)
        rows.append(np.column_stack([x, np.full_like(x, z)]))
    points = np.concatenate(rows)
    return points[shapely.contains_xy(area, points)]


def _join(points: np.ndarray, edges: list[tuple[int, int]], area: Polygon) -> np.ndarray:
    """Constrained Delaunay triangles of the points inside the area."""
    vectors = [mathutils.Vector(point) for point in points]
    _, _, faces, origins, _, _ = delaunay_2d_cdt(vectors, edges, [], 1, 1e-6)
    original = np.array([origin[0] for origin in origins])
    if len(original) != len(points):
        raise ValueError("the outline crosses itself or has coinciding points; use a wider margin or spacing")
    triangles = original[np.array(faces)]
    # Type 1 keeps what lies inside any closed loop of constraints: holes must be taken out again.
    return triangles[shapely.contains_xy(area, points[triangles].mean(axis=1))]


def _neighbour_means(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    total = np.zeros_like(points)
    count = np.zeros(len(points))
    for a, b in ((0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)):
        np.add.at(total, triangles[:, a], points[triangles[:, b]])
        np.add.at(count, triangles[:, a], 1)
    return total / np.maximum(count, 1)[:, None]
