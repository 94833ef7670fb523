# SPDX-License-Identifier: GPL-3.0-or-later
"""UV maps of meshes in Object Mode, read, written, and packed by Blender."""

from __future__ import annotations

import bpy
import numpy as np

from ... import compat
from ...errors import Refusal
from ...model.flatten.flattening import Flat, Held
from ...model.flatten.patches import Patches
from ...model.plane.frame import Array, Array32, Mask
from ..objects.adding import select_alone
from ..objects.flat_object import MAKE_LOCAL

MARGIN = 0.005  # between packed islands, of the map


def refusal(obj: bpy.types.Object) -> str | None:
    """Why the UV maps of an object's mesh cannot be changed, and what to do; None when they can."""
    if obj.data.library is not None or obj.data.override_library is not None:
        return f"The mesh of '{obj.name}' is linked from a library: {MAKE_LOCAL}"
    return None


def read(layer: bpy.types.MeshUVLoopLayer) -> Array32:
    """The map, corners x 2."""
    uvs = np.empty(2 * len(layer.uv), np.float32)
    layer.uv.foreach_get("vector", uvs)
    return uvs.reshape(-1, 2)


def write(mesh: bpy.types.Mesh, layer: bpy.types.MeshUVLoopLayer, uvs: Array32) -> None:
    """Give a map all its values, corners x 2."""
    # Through `layer.uv` Blender would write to the maps of copies of the mesh as well.
    values = mesh.attributes[layer.name].data
    values.foreach_set("vector", np.ascontiguousarray(uvs, dtype=np.float32).ravel())
    mesh.update()


def active_or_new(mesh: bpy.types.Mesh) -> bpy.types.MeshUVLoopLayer:
    """The mesh's active UV map, made where there is none. Raises Refusal."""
    return mesh.uv_layers.active or new(mesh, "UVMap")


def new(mesh: bpy.types.Mesh, name: str) -> bpy.types.MeshUVLoopLayer:
    """One more map, which is active. Raises Refusal."""
    layer = mesh.uv_layers.new(name=name)
    if layer is None:
        raise Refusal(f"'{mesh.name}' has as many UV maps as Blender allows: remove one")
    mesh.uv_layers.active = layer
    return layer


def pinned(mesh: bpy.types.Mesh, patches: Patches) -> Held | None:
    """What is pinned in the active UV map of a mesh, by flat vertices; None where nothing is."""
    layer = mesh.uv_layers.active
    kept = None if layer is None else mesh.attributes.get(f".pn.{layer.name}")
    if kept is None:
        return None
    pins = np.empty(len(mesh.loops), bool)
    kept.data.foreach_get("value", pins)
    held = pins[patches.corners]
    if not held.any():
        return None
    rows, first = np.unique(patches.flat[held], return_index=True)
    return Held(rows.astype(np.int32), read(layer)[patches.corners[held][first]].astype(np.float64))


def laid_out(context: bpy.types.Context, patches: Patches, flat: Flat, *, keep_scale: bool) -> Array:
    """n x 2 places in a UV map of patches laid flat: those that are held stay, the others are packed.

    All have one scale: what is held tells it, else `keep_scale` makes it the scene's, or they fill the map.
    """
    held = np.zeros(patches.count, bool)
    held[flat.held] = True
    free = ~held[patches.patch]
    places = flat.places / flat.unit
    if free.any():
        scaled = not (keep_scale or held.any())
        places = _packed(context, patches, places, locked=held, scaled=scaled)
    return places


def _packed(
    context: bpy.types.Context, patches: Patches, places: Array, *, locked: Mask, scaled: bool
) -> Array:
    """n x 2 places in a UV map with its islands packed by Blender, in Object Mode.

    `locked` patches stay where they are. `scaled`: all others are scaled alike, to fill the map.
    """
    mesh = bpy.data.meshes.new("Flatten")
    obj = bpy.data.objects.new("Flatten", mesh)
    selected, active = list(context.selected_objects), context.view_layer.objects.active
    try:
        starts = np.cumsum(patches.sizes)[:-1]
        faces = [face.tolist() for face in np.split(patches.flat, starts)]
        mesh.from_pydata(np.pad(places, ((0, 0), (0, 1))).tolist(), [], faces)
        layer = mesh.uv_layers.new(name="UVMap")
        write(mesh, layer, places[patches.flat].astype(np.float32))
        compat.uv_pins(mesh).foreach_set("value", locked[patches.patch[patches.flat]])
        context.scene.collection.objects.link(obj)
        select_alone(context, obj)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.uv.select_all(action="SELECT")
        # By their outlines six squares take Blender from a second to minutes, which nobody can end.
        bpy.ops.uv.pack_islands(
            scale=scaled, margin=MARGIN, pin=True, pin_method="LOCKED", shape_method="AABB"
        )
        bpy.ops.object.mode_set(mode="OBJECT")
        result = places.copy()
        result[patches.flat] = read(mesh.uv_layers.active)
        return result
    finally:
        bpy.data.objects.remove(obj)
        bpy.data.meshes.remove(mesh)
        for other in selected:
            other.select_set(True)
        context.view_layer.objects.active = active
