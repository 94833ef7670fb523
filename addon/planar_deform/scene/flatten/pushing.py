# SPDX-License-Identifier: GPL-3.0-or-later
"""The shape of a flat mesh written to its surface's UV map: once, or while its pins are dragged."""

from __future__ import annotations

import bpy
import numpy as np

from ...errors import ObjectGone, Refusal
from ...model.flatten.layout import Unit, fitted_unit
from ...model.plane.cutout import diagonal_of
from ...model.plane.frame import Array, Array32
from ..objects.flat_object import FLATNESS
from ..storage import points
from ..storage.digests import digest
from ..storage.topology import corner_vertices
from . import uv_maps
from .link import AGAIN, Link, read_link


def push(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph | None = None) -> bpy.types.Object:
    """Write a flat mesh's shape, as it is shown, to its surface's active UV map, made where there is none.

    The first push fits it into the map, and later ones keep that scale. Returns the surface. Raises Refusal,
    with nothing changed. `depsgraph`: see shown_places().
    """
    link = _writable(obj)
    places = shown_places(obj, depsgraph)
    mesh = link.surface.data
    layer = uv_maps.active_or_new(mesh)
    if obj.planar.uv_scale == 0.0:
        unit = fitted_unit(places[corner_vertices(obj.data)])
        obj.planar.uv_scale, obj.planar.uv_offset = unit.scale, unit.offset
    uvs = uv_maps.read(layer)
    uvs[link.corners] = _unit(obj).of(places)[corner_vertices(obj.data)]
    uv_maps.write(mesh, layer, uvs)
    obj.planar.pushed = digest(places.tobytes())
    return link.surface


def follow(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> str | None:
    """After an update of a flat mesh with Live UV on: push its shape where that is not the last one pushed.

    Live UV goes off where that is refused; the reason.
    """
    settings = obj.planar
    surface = settings.surface
    if obj.mode != "OBJECT" or (surface is not None and surface.mode != "OBJECT"):
        return None  # until that is left
    try:
        if digest(shown_places(obj, depsgraph).tobytes()) != settings.pushed:
            push(obj, depsgraph)
    except Refusal as refusal:
        settings.live_uv = False
        return str(refusal)
    return None


def shown_places(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph | None = None) -> Array:
    """Where the vertices of a flat mesh are in its plane, n x 2, as Blender shows them. Raises Refusal.

    `depsgraph`: one that is up to date; none: it is made so.
    """
    places = _shown(obj, depsgraph).astype(np.float64)
    if not np.isfinite(places).all():
        raise Refusal(f"'{obj.name}' has vertices with coordinates that are not numbers: delete them")
    if float(np.ptp(places[:, 1])) > FLATNESS * diagonal_of(places):
        raise Refusal(
            f"'{obj.name}' does not lie in its own XZ plane any more, as applying a rotation does it: undo "
            f"that, or {AGAIN}"
        )
    return places[:, [0, 2]]


def _shown(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph | None) -> Array32:
    if obj.data.shape_keys is None and not len(obj.modifiers):
        return points.read(obj)
    if depsgraph is None:
        bpy.context.view_layer.update()
        depsgraph = bpy.context.evaluated_depsgraph_get()
    evaluated = obj.evaluated_get(depsgraph)
    if len(evaluated.data.vertices) != len(obj.data.vertices):
        raise Refusal(
            f"Modifiers of '{obj.name}' make new vertices, which the surface does not have: turn them off"
        )
    return points.read(evaluated)


def _writable(obj: bpy.types.Object) -> Link:
    link = read_link(obj)
    reason = uv_maps.refusal(link.surface)
    if reason is not None:
        raise Refusal(reason)
    return link


def _unit(obj: bpy.types.Object) -> Unit:
    x, y = obj.planar.uv_offset
    return Unit(obj.planar.uv_scale, (x, y))


class Following:
    """A surface's UV map, which follows the shape of its flat mesh until it is kept or taken back.

    Holds no reference to Blender's data.
    """

    def __init__(self, obj: bpy.types.Object):
        """Begin with a flat mesh. Raises Refusal, with nothing changed."""
        link = _writable(obj)
        layer = link.surface.data.uv_layers.active
        if layer is None or obj.planar.uv_scale == 0.0:
            raise Refusal(f"Nothing of '{obj.name}' is in a UV map yet: use Push to UV Map first")
        self._mesh_uid, self._map = link.surface.data.session_uid, layer.name
        self._before = uv_maps.read(layer)
        self._corners, self._vertices = link.corners, corner_vertices(obj.data)
        shown_places(obj)
        self._wrote = False

    def follow(self, obj: bpy.types.Object) -> None:
        """Write the shape that the flat mesh shows by now. Raises Refusal and ObjectGone."""
        uvs = self._before.copy()
        uvs[self._corners] = _unit(obj).of(shown_places(obj))[self._vertices]
        self._write(obj, uvs)
        self._wrote = True

    def take_back(self, obj: bpy.types.Object) -> None:
        """Give the map what it had, to the bit. Raises ObjectGone."""
        if self._wrote:
            self._write(obj, self._before)
            self._wrote = False

    def _write(self, obj: bpy.types.Object, uvs: Array32) -> None:
        surface = obj.planar.surface
        mesh = None if surface is None else surface.data
        layer = None if mesh is None or mesh.session_uid != self._mesh_uid else mesh.uv_layers.get(self._map)
        if layer is None or len(layer.uv) != len(uvs):
            raise ObjectGone("The surface or its UV map is gone")
        uv_maps.write(mesh, layer, uvs)


def following(obj: bpy.types.Object) -> Following | None:
    """What follows a flat mesh that has Live UV on; None where nothing has to. Raises Refusal."""
    return Following(obj) if obj.planar.live_uv else None
