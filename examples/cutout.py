# SPDX-License-Identifier: GPL-3.0-or-later
"""A drawn character as a Blender object: one texture for all its layers, one even triangle mesh per layer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import mathutils
import numpy as np
import shapely
from mathutils.geometry import delaunay_2d_cdt
from PIL import Image
from shapely.geometry import MultiPolygon, Polygon

from drawing import LINE_WIDTH, Layer

MARGIN = 1.5 * LINE_WIDTH  # of mesh around the ink, so that no line is cut when an outline becomes a polygon
ROUNDING = 0.03  # gaps and notches in an outline narrower than twice this are filled
SMOOTHING_ROUNDS = 6
PADDING = 4  # pixels between layers in the texture


@dataclass(frozen=True)
class LayerMesh:
    """A triangulated layer: points n x 2 in the drawing's units, triangles m x 3 (counterclockwise)."""

    layer: Layer
    points: np.ndarray
    triangles: np.ndarray


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


def smallest_angle(points: np.ndarray, triangles: np.ndarray) -> float:
    """The smallest angle of any triangle in degrees: 60 is perfect, below ~15 is a sliver."""
    corners = points[triangles]
    smallest = 180.0
    for i in range(3):
        a = corners[:, (i + 1) % 3] - corners[:, i]
        b = corners[:, (i + 2) % 3] - corners[:, i]
        cosine = (a * b).sum(axis=1) / (np.hypot(*a.T) * np.hypot(*b.T))
        smallest = min(smallest, float(np.degrees(np.arccos(np.clip(cosine, -1, 1))).min()))
    return smallest


def build(name: str, layers: Sequence[Layer], spacing: float, pixels_per_unit: float) -> bpy.types.Object:
    """The character as an object standing in the XZ plane, seen from -Y (front view), its picture packed.

    Each layer is a connected part at y = its depth.
    """
    meshes = [LayerMesh(layer, *triangulate(silhouette(layer), spacing)) for layer in layers]
    sheet, offsets = _texture(meshes, pixels_per_unit)

    points = np.concatenate([np.insert(m.points, 1, m.layer.depth, axis=1) for m in meshes])
    pixels = np.concatenate(
        [m.points * pixels_per_unit + offset for m, offset in zip(meshes, offsets, strict=True)]
    )
    starts = np.cumsum([0] + [len(m.points) for m in meshes])
    triangles = np.concatenate([m.triangles + start for m, start in zip(meshes, starts[:-1], strict=True)])

    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), [], triangles.tolist())
    uv = pixels / np.array(sheet.size)
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", uv[triangles.ravel()].astype(np.float32).ravel())
    mesh.materials.append(material(name, sheet))
    mesh.update()
    return bpy.data.objects.new(name, mesh)


def layer_vertices(obj: bpy.types.Object, layer: Layer) -> np.ndarray:
    """The indices of a layer's vertices: those at its depth."""
    points = np.empty(3 * len(obj.data.vertices), np.float32)
    obj.data.vertices.foreach_get("co", points)
    return np.flatnonzero(np.abs(points.reshape(-1, 3)[:, 1] - layer.depth) < 1e-4)


def _texture(meshes: Sequence[LayerMesh], scale: float) -> tuple[Image.Image, list[np.ndarray]]:
    """All layers side by side in an image; per layer the pixel (from lower left) of the drawing's origin."""
    pictures, origins = [], []
    for m in meshes:
        left, bottom = m.points.min(axis=0)
        right, top = m.points.max(axis=0)
        pictures.append(m.layer.paint((left, bottom, right, top), scale))
        origins.append((left, bottom))
    width = sum(p.width for p in pictures) + PADDING * (len(pictures) + 1)
    height = max(p.height for p in pictures) + 2 * PADDING
    sheet = Image.new("RGBA", (width, height))
    offsets = []
    x = PADDING
    for picture, origin in zip(pictures, origins, strict=True):
        sheet.paste(picture, (x, height - PADDING - picture.height))
        offsets.append(np.array([x, PADDING]) - scale * np.array(origin))
        x += picture.width + PADDING
    return sheet, offsets


def material(name: str, sheet: Image.Image) -> bpy.types.Material:
    """A picture that shines by itself, so that it is rendered in its own colours; clear where it is clear."""
    image = bpy.data.images.new(f"{name} Texture", *sheet.size, alpha=True)
    pixels = np.asarray(sheet, np.float32)[::-1] / 255
    image.pixels.foreach_set(np.ascontiguousarray(pixels).ravel())
    image.pack()

    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    emission = nodes.new("ShaderNodeEmission")
    clear = nodes.new("ShaderNodeBsdfTransparent")
    mix = nodes.new("ShaderNodeMixShader")
    output = nodes.new("ShaderNodeOutputMaterial")
    links.new(texture.outputs["Color"], emission.inputs["Color"])
    links.new(texture.outputs["Alpha"], mix.inputs["Fac"])
    links.new(clear.outputs[0], mix.inputs[1])
    links.new(emission.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], output.inputs["Surface"])
    for x, node in enumerate((texture, clear, emission, mix, output)):
        node.location = (220 * x, 0)
    nodes.active = texture  # what Solid shading shows with "Texture" as its colour
    return material
