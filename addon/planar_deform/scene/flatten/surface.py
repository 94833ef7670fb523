# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface as it is laid flat: its faces cut along their seams, and its vertices where they are seen."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import bmesh
import bpy
import numpy as np

from ...errors import Refusal
from ...model.flatten.flattening import Flat, Held, PatchError, Settings, flatten
from ...model.flatten.patches import Corners, Patches, cut
from ...model.plane.frame import Array, Indices, mapped
from ...model.work import Progress
from ..objects.adding import select_alone
from ..objects.flat_object import linear_of, origin_of
from ..storage import migration, points
from ..storage.topology import corner_edges, corner_vertices, edge_vertices


def refusal(context: bpy.types.Context) -> str | None:
    """Why the active object cannot be laid flat, and what to do; None if nothing speaks against it."""
    obj = context.object
    if obj is None or obj.type != "MESH":
        return "The active object is no mesh: select a surface"
    if obj.mode not in {"OBJECT", "EDIT"}:
        return "Surfaces are laid flat in Object Mode and in Edit Mode: leave this mode first"
    if not obj.data.polygons and obj.mode == "OBJECT":
        return f"'{obj.name}' has no faces: select a surface"
    return migration.refusal(obj)


@contextmanager
def in_object_mode(context: bpy.types.Context) -> Iterator[None]:
    """Meanwhile Blender shows what a mesh in Edit Mode holds; afterwards it is there again, as it was."""
    edited = list(context.objects_in_mode) if context.mode == "EDIT_MESH" else []
    if not edited:
        yield
        return
    active = context.object
    bpy.ops.object.mode_set(mode="OBJECT")
    selected = list(context.selected_objects)
    try:
        yield
    finally:
        select_alone(context, active)
        for obj in edited:
            obj.select_set(True)
        bpy.ops.object.mode_set(mode="EDIT")
        for obj in edited:
            obj.select_set(False)
        for obj in selected:
            obj.select_set(True)


def corners_of(mesh: bpy.types.Mesh) -> Corners:
    """The faces of a mesh by their corners."""
    sizes = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", sizes)
    return Corners(sizes, corner_vertices(mesh), corner_edges(mesh))


def triangles_of(mesh: bpy.types.Mesh) -> Indices:
    """All faces of a mesh in triangles of its corners, t x 3, as Blender cuts them."""
    mesh.calc_loop_triangles()
    triangles = np.empty(len(mesh.loop_triangles) * 3, np.int32)
    mesh.loop_triangles.foreach_get("loops", triangles)
    return triangles.reshape(-1, 3)


def active_edge(obj: bpy.types.Object) -> int:
    """The edge of a mesh in Edit Mode that was selected last; -1 where that was no edge."""
    if obj.mode != "EDIT":
        return -1
    active = bmesh.from_edit_mesh(obj.data).select_history.active
    return active.index if isinstance(active, bmesh.types.BMEdge) else -1


def places_of(obj: bpy.types.Object) -> Array:
    """The mesh's vertices in the world, count x 3, without shape keys and modifiers. Raises Refusal."""
    places = points.read(obj).astype(np.float64)
    if not np.isfinite(places).all():
        raise Refusal(f"'{obj.name}' has vertices with coordinates that are not numbers: delete them")
    return mapped(places, linear_of(obj)) + origin_of(obj)


def is_mirrored(obj: bpy.types.Object) -> bool:
    """Whether its transform turns the sides of its faces over."""
    return bool(np.linalg.det(linear_of(obj)) < 0.0)


@dataclass(frozen=True)
class Surface:
    """What is to be laid flat, without any of Blender's data."""

    name: str
    patches: Patches
    places: Array  # n x 3, of the flat vertices on the surface
    mirrored: bool

    def flattened(self, settings: Settings, progress: Progress, held: Held | None = None) -> Flat:
        """All patches laid flat, seen from outside. Raises Refusal, and native.Cancelled."""
        try:
            return flatten(self.places, self.patches, settings, progress, held)
        except PatchError as error:
            count, number = self.patches.count, error.patch + 1
            which = f"patch {number} of {count} (with face {self.patches.face_in(error.patch)})"
            raise Refusal(
                f"'{self.name}' cannot be laid flat, {which}: {error}. Cut it with Edge > Mark Seam"
            ) from error


def read(obj: bpy.types.Object, *, selected: bool) -> Surface:
    """The surface of an object in Object Mode, or of its selected faces alone. Raises Refusal."""
    mesh = obj.data
    corners = corners_of(mesh)
    chosen = np.ones(len(mesh.polygons), bool)
    if selected:
        mesh.polygons.foreach_get("select", chosen)
    if not chosen.any():
        raise Refusal("No faces are selected: select those to lay flat")
    seams = np.empty(len(mesh.edges), bool)
    mesh.edges.foreach_get("use_seam", seams)
    try:
        patches = cut(corners, chosen, seams, triangles_of(mesh))
    except ValueError as error:
        raise Refusal(f"'{obj.name}' cannot be laid flat: {error}") from error
    return of_patches(obj, patches)


def of_patches(obj: bpy.types.Object, patches: Patches) -> Surface:
    """The surface of an object that has been cut. Raises Refusal."""
    mirrored = is_mirrored(obj)
    if mirrored:
        patches = patches.turned()
    return Surface(obj.name, patches, places_of(obj)[patches.vertices], mirrored)


def fixed_edge(mesh: bpy.types.Mesh, edge: int) -> tuple[int, int] | None:
    """The ends of an edge; None for -1. Raises Refusal where there is none."""
    if edge < 0:
        return None
    ends: Sequence[int] = edge_vertices(mesh)[edge].tolist() if edge < len(mesh.edges) else ()
    if not ends:
        raise Refusal(f"There is no edge {edge}: the mesh has {len(mesh.edges)}")
    return (ends[0], ends[1])
