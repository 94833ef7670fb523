# SPDX-License-Identifier: GPL-3.0-or-later
"""The number of the format in which a .blend holds what is ours, and how older formats become this one.

Two numbers are stored, each with what it is of:

    Object.planar.version    pins, settings, the list of poses with all stamps and digests in it, and with it
                             the names and eval_times of the shape keys and the curve that the list is about
    Mesh.planar_version      the rest shape, which is the mesh's attributes REST and OWNER

What a mesh was when it was last seen (Mesh.planar_seen, the attribute SEEN) has none: it is made anew where
it is missing, and a version that does not know it may leave it behind.

0 is what was stored before there were numbers. Whatever is stored gets its number at once; where nothing is,
there is none. A join brings attributes without their number into a mesh that may have none: a format that
changes them has to change their names, too.

What has a higher number than VERSION is left as it is, to the bit: nobody here knows what it means.
"""

from __future__ import annotations

import bpy

VERSION = 1

REST = "planar_rest"
# Which mesh wrote a vertex's rest: 0 for vertices that an edit added with no rest of their own, another
# number for those that came by joining, whose rest is still in the space of the object they came from.
OWNER = "planar_rest_owner"
# The shape in which the mesh, or its Basis, was last seen, see objects/mesh_edits.py. Where it is missing or
# out of date, nothing is known of what was done to the mesh meanwhile, and all else is as it was.
SEEN = "planar_seen"


def refusal(obj: bpy.types.Object) -> str | None:
    """Why nothing can be done with what is stored for an object, and what to do; None when it can be read."""
    if not is_newer(obj):
        return None
    return (
        f"'{obj.name}' comes from a newer Planar Deform: update the extension in Blender's preferences. "
        "Until then it stays as it is"
    )


def is_newer(obj: bpy.types.Object) -> bool:
    """Whether an object or its mesh has a number of the future."""
    return obj.planar.version > VERSION or getattr(obj.data, "planar_version", 0) > VERSION


def migrate_all() -> None:
    """Bring all that the file itself holds to the present format; what is linked follows when it is local."""
    for obj in bpy.data.objects:
        # The first look at it sets it, and what is ours has been looked at.
        if obj.library is None and obj.override_library is None and obj.is_property_set("planar"):
            _migrate_settings(obj)
    for mesh in bpy.data.meshes:
        if mesh.library is None and mesh.override_library is None:
            _migrate_rest(mesh)


def migrate(obj: bpy.types.Object) -> None:
    """Bring what is stored for an object to the present format: it is about to store more."""
    _migrate_settings(obj)
    if isinstance(obj.data, bpy.types.Mesh):
        _migrate_rest(obj.data)


# From 0 to 1 only the number is new. Steps of later formats follow in these two, in order.


def _migrate_settings(obj: bpy.types.Object) -> None:
    if obj.planar.version < VERSION:
        obj.planar.version = VERSION


def _migrate_rest(mesh: bpy.types.Mesh) -> None:
    if mesh.planar_version < VERSION and REST in mesh.attributes:
        mesh.planar_version = VERSION
