# SPDX-License-Identifier: GPL-3.0-or-later
"""A drawn character as a Blender object: its layers as PNGs, of which the add-on makes cutouts."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
from PIL import Image

from drawing import Layer

DRAWINGS = Path(__file__).resolve().parents[1] / "out" / "drawings"
EDGE = 8  # pixels around a drawing


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
    """The character as an object standing in the XZ plane, seen from -Y (front view); it is the active one.

    Each layer is a connected part at y = its depth, and a PNG in out/drawings, in the .blend as well. All
    layers of a character lie equally far apart.
    """
    layers = sorted(layers, key=lambda layer: -layer.depth)
    bounds = canvas(layers, pixels_per_unit)
    paths = [
        paint(f"{name} {layer.name}" if layers[1:] else name, layer, bounds, pixels_per_unit)
        for layer in layers
    ]
    bpy.ops.planar.cutout_from_image(
        directory=str(DRAWINGS),
        files=[{"name": path.name} for path in paths],
        density="EDGE",
        edge=spacing * pixels_per_unit,
        layers="PARTS",
        offset=layers[0].depth - layers[1].depth if layers[1:] else 0.0,
        factor=pixels_per_unit,
    )
    obj = bpy.context.object
    obj.name = obj.data.name = name
    for material in obj.data.materials:
        next(node for node in material.node_tree.nodes if node.type == "TEX_IMAGE").image.pack()
    left, bottom, right, top = bounds
    obj.location = (0.5 * (left + right), layers[0].depth, 0.5 * (bottom + top))
    bpy.ops.object.transform_apply(
        location=True, rotation=True
    )  # a vertex is where its layer's drawing has it
    return obj


def canvas(layers: Sequence[Layer], scale: float) -> tuple[float, float, float, float]:
    """What all layers are painted on (left, bottom, right, top), in whole pixels."""
    sides = np.array([layer.silhouette.bounds for layer in layers])
    low, high = sides[:, :2].min(axis=0) * scale - EDGE, sides[:, 2:].max(axis=0) * scale + EDGE
    left, bottom, right, top = (np.concatenate([np.floor(low), np.ceil(high)]) / scale).tolist()
    return left, bottom, right, top


def paint(name: str, layer: Layer, bounds: tuple[float, float, float, float], scale: float) -> Path:
    """A layer's PNG."""
    DRAWINGS.mkdir(parents=True, exist_ok=True)
    path = DRAWINGS / f"{name}.png"
    layer.paint(bounds, scale).save(path)
    return path


def layer_vertices(obj: bpy.types.Object, layer: Layer) -> np.ndarray:
    """The indices of a layer's vertices: those at its depth."""
    points = np.empty(3 * len(obj.data.vertices), np.float32)
    obj.data.vertices.foreach_get("co", points)
    return np.flatnonzero(np.abs(points.reshape(-1, 3)[:, 1] - layer.depth) < 1e-4)


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
