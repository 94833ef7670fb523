# SPDX-License-Identifier: GPL-3.0-or-later
"""What hangs on the vertices of a mesh by their numbers, so that they cannot become others."""

from __future__ import annotations

import bpy
import numpy as np

from ..flatten.link import is_flat_mesh
from ..objects.cutout_object import pose_refusal
from ..sequence import pose_state
from ..storage.topology import corner_edges, corner_vertices

BOUND = frozenset(("SURFACE_DEFORM", "MESH_DEFORM", "LAPLACIANDEFORM"))
CACHES = frozenset(("MESH_CACHE", "MESH_SEQUENCE_CACHE"))


def refusal(obj: bpy.types.Object | None) -> str | None:
    """Why an object cannot be given another mesh, and what to do; None when it can. Cheap: for polls."""
    reason = pose_refusal(obj)
    if obj is None or reason is not None:
        return reason
    if obj.data.shape_keys is not None and not pose_state.is_ours(obj):
        return (
            f"'{obj.name}' has shape keys of its own, which would not fit a new mesh: "
            "work on a copy of the object, with Apply All in the Shape Keys panel's menu"
        )
    return _by_links(obj) or _by_own_modifiers(obj)


def thorough_refusal(obj: bpy.types.Object) -> str | None:
    """The same where more has to be looked at: the whole mesh, and all other objects."""
    mesh = obj.data
    loose_edges = len(mesh.edges) > len(np.unique(corner_edges(mesh)))
    if loose_edges or len(mesh.vertices) > len(np.unique(corner_vertices(mesh))):
        return (
            f"'{obj.name}' has vertices or edges without faces, which a new mesh would not have: delete them "
            "in Edit Mode with Mesh > Clean Up > Delete Loose"
        )
    for other in bpy.data.objects:
        reason = _by_other(obj, other)
        if reason is not None:
            return reason
    return None


def _by_links(obj: bpy.types.Object) -> str | None:
    if is_flat_mesh(obj):
        return (
            f"'{obj.name}' is a surface laid flat, whose vertices are the surface's: give the surface more "
            "vertices, and lay it flat again"
        )
    return None


def _by_own_modifiers(obj: bpy.types.Object) -> str | None:
    for modifier in obj.modifiers:
        kind = modifier.type
        bound = kind in BOUND and getattr(modifier, "is_bound", getattr(modifier, "is_bind", False))
        if kind == "CORRECTIVE_SMOOTH" and modifier.is_bind:
            bound = True
        if bound:
            return f"Modifier '{modifier.name}' is bound to the vertices: unbind it, and bind it again later"
        if kind in CACHES:
            return (
                f"Modifier '{modifier.name}' plays a file made of these vertices: remove it, and bake again "
                "afterwards"
            )
        if kind == "HOOK" and not modifier.vertex_group:
            return f"Modifier '{modifier.name}' hooks single vertices: give it a vertex group"
        if kind == "MULTIRES" and modifier.total_levels:
            return f"Modifier '{modifier.name}' has sculpted levels of these faces: apply or remove it"
        if kind in {"CLOTH", "SOFT_BODY"} and modifier.point_cache.is_baked:
            return f"The simulation of modifier '{modifier.name}' is baked: delete the bake"
    return None


def _by_other(obj: bpy.types.Object, other: bpy.types.Object) -> str | None:
    if other.is_property_set("planar") and other.planar.surface == obj and is_flat_mesh(other):
        return (
            f"'{other.name}' was laid flat from '{obj.name}', and knows it by its vertices: delete it, and "
            "lay the new mesh flat"
        )
    for modifier in other.modifiers:
        if modifier.type == "SURFACE_DEFORM" and modifier.target == obj and modifier.is_bound:
            return f"Modifier '{modifier.name}' of '{other.name}' is bound to '{obj.name}': unbind it"
        if modifier.type == "MESH_DEFORM" and modifier.object == obj and modifier.is_bound:
            return f"Modifier '{modifier.name}' of '{other.name}' is bound to '{obj.name}': unbind it"
    return None
