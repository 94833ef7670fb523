# SPDX-License-Identifier: GPL-3.0-or-later
"""What modifiers do to the view of a cutout that is posed in its original coordinates."""

from __future__ import annotations

import bpy

DEFORMING = frozenset(
    [
        "ARMATURE",
        "CAST",
        "CLOTH",
        "CORRECTIVE_SMOOTH",
        "CURVE",
        "DISPLACE",
        "HOOK",
        "LAPLACIANDEFORM",
        "LAPLACIANSMOOTH",
        "LATTICE",
        "MESH_CACHE",
        "MESH_DEFORM",
        "MESH_SEQUENCE_CACHE",
        "NODES",
        "OCEAN",
        "SHRINKWRAP",
        "SIMPLE_DEFORM",
        "SMOOTH",
        "SOFT_BODY",
        "SURFACE_DEFORM",
        "WARP",
        "WAVE",
    ]
)


def of_lattice(obj: bpy.types.Object, lattice: bpy.types.Object) -> list[bpy.types.Modifier]:
    """The modifiers by which a lattice deforms an object."""
    lattices = (modifier for modifier in obj.modifiers if modifier.type == "LATTICE")
    return [modifier for modifier in lattices if modifier.object == lattice]


def lattices_of(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """The lattices in which an object hangs, each once; also those whose modifiers are hidden."""
    found = (modifier.object for modifier in obj.modifiers if modifier.type == "LATTICE")
    return list(dict.fromkeys(lattice for lattice in found if lattice is not None))


def shifting(obj: bpy.types.Object, below: bpy.types.Modifier | None = None) -> list[str]:
    """Names of the modifiers shown in the viewport that move vertices (or may: geometry nodes).

    `below`: only those that come after this one.
    """
    stack = list(obj.modifiers)
    if below is not None:
        stack = stack[stack.index(below) + 1 :]
    return [modifier.name for modifier in stack if modifier.show_viewport and modifier.type in DEFORMING]


def covering(obj: bpy.types.Object) -> str | None:
    """Why a pose would not be seen, and what to do: a point cache is shown instead. None if none is."""
    for modifier in obj.modifiers:
        if (
            modifier.type == "MESH_CACHE"
            and modifier.show_viewport
            and modifier.filepath
            and modifier.deform_mode == "OVERWRITE"
        ):
            return (
                f"Modifier '{modifier.name}' shows a point cache instead of the pose: "
                "hide it in the viewport, or remove it"
            )
    return None
