# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface laid flat as a mesh of its own, which knows what of the surface each part of it is."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...model.flatten.layout import GAP, side_by_side
from ...model.flatten.patches import Patches
from ...model.plane.frame import Array, Array32, Indices
from ..objects.adding import link_beside, select_alone
from . import uv_maps
from .link import EDGE_NUMBER, set_link, write_numbers
from .surface import Surface


def add(
    context: bpy.types.Context, source: bpy.types.Object, surface: Surface, flat: Array, *, numbered: bool
) -> bpy.types.Object:
    """A new object of the flat vertices (n x 2), right of the surface; it is active in Object Mode.

    Its patches lie beside each other and face the front, as drawings do. `numbered`: with numbers on
    the edges that were cut.
    """
    patches = surface.patches
    places = side_by_side(flat, patches.patch)
    order = _corner_order(patches.sizes, surface.mirrored)
    mesh = bpy.data.meshes.new(f"{source.name} Flat")
    faces = np.split(patches.flat[order], np.cumsum(patches.sizes)[:-1])
    mesh.from_pydata(upright(places).tolist(), [], [face.tolist() for face in faces])
    _take_materials(source, mesh, patches)
    _take_uv_maps(source.data, mesh, patches.corners[order])
    obj = bpy.data.objects.new(mesh.name, mesh)
    set_link(obj, source, patches.vertices, patches.corners[order])
    if numbered:
        write_numbers(mesh, EDGE_NUMBER, _edge_numbers(mesh, patches))
    low, high = surface.places.min(axis=0), surface.places.max(axis=0)
    width = float(np.ptp(places[:, 0]))
    middle = 0.5 * (low + high)
    obj.location = (high[0] + 0.5 * width + GAP * max(width, float(high[0] - low[0])), middle[1], middle[2])
    link_beside(context, source, obj)
    select_alone(context, obj)
    return obj


def upright(places: Array) -> Array32:
    """Places of a plane (n x 2) as coordinates of a mesh that faces the front."""
    shape: Array32 = np.insert(places, 1, 0.0, axis=1).astype(np.float32)
    return shape


def _corner_order(sizes: Indices, turned: bool) -> Indices:
    """The corners of faces in order, or each face's backwards."""
    order = np.arange(int(sizes.sum()))
    if turned:
        starts = np.cumsum(sizes) - sizes
        order = np.repeat(2 * starts + sizes - 1, sizes) - order
    return order.astype(np.int32)


def _take_materials(source: bpy.types.Object, mesh: bpy.types.Mesh, patches: Patches) -> None:
    for slot in source.material_slots:
        mesh.materials.append(slot.material)
    numbers = np.empty(len(source.data.polygons), np.int32)
    source.data.polygons.foreach_get("material_index", numbers)
    mesh.polygons.foreach_set("material_index", numbers[patches.faces])


def _take_uv_maps(source: bpy.types.Mesh, mesh: bpy.types.Mesh, corners: Indices) -> None:
    for layer in source.uv_layers:
        copy = mesh.uv_layers.new(name=layer.name)
        uv_maps.write(mesh, copy, uv_maps.read(layer)[corners])
        copy.active_render = layer.active_render
    if source.uv_layers.active is not None:
        mesh.uv_layers.active_index = source.uv_layers.active_index


def _edge_numbers(mesh: bpy.types.Mesh, patches: Patches) -> Indices:
    """The number of each edge of the flat mesh, 0 for those that are no seams."""
    ends = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", ends)
    keys = _keys(ends.reshape(-1, 2), len(mesh.vertices))
    order = np.argsort(keys)
    own = _keys(patches.edges, len(mesh.vertices))
    numbers = np.zeros(len(mesh.edges), np.int32)
    numbers[order[np.searchsorted(keys, own, sorter=order)]] = patches.numbers
    return numbers


def _keys(pairs: Indices, count: int) -> NDArray[np.int64]:
    pairs = np.sort(pairs, axis=1).astype(np.int64)
    return np.asarray(pairs[:, 0] * count + pairs[:, 1])
