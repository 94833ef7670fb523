# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that show an image as it is: what they show, and where in them its pixels lie."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import bpy
import numpy as np

from ...errors import ObjectGone, Refusal
from ...model.image.placement import Misfit, Placement, placed
from ...model.plane.frame import Array
from ..flatten import uv_maps
from ..objects.flat_object import MAKE_LOCAL
from ..objects.new_faces import face_settings
from ..storage import points
from ..storage.topology import corner_vertices
from . import reading


@dataclass(frozen=True)
class ImagePlane:
    """An object whose mesh shows an image. Holds no reference to Blender's data."""

    name: str
    session_uid: int
    slot: int  # of the material that shows the image
    node: str  # in that material, the texture
    uv_map: str  # by which it lies on the mesh
    placement: Placement

    def resolve(self) -> bpy.types.Object:
        """The object. Raises ObjectGone."""
        obj = bpy.data.objects.get(self.name)
        if obj is None or obj.session_uid != self.session_uid:
            raise ObjectGone(f"'{self.name}' is gone")
        return obj

    @property
    def texture(self) -> bpy.types.ShaderNodeTexImage:
        """The node that shows the image. Raises ObjectGone."""
        obj = self.resolve()
        tree = _tree_in(obj, self.slot)
        node = None if tree is None else tree.nodes.get(self.node)
        if node is None or node.image is None:
            raise ObjectGone(f"'{self.name}' shows its image no more")
        return node


def refusal(obj: bpy.types.Object) -> str | None:
    """Why an object is no image plane at first sight, and what to do; None where it may be one."""
    if obj.type == "EMPTY" and obj.empty_display_type == "IMAGE":
        return (
            f"'{obj.name}' is an image empty: convert it first, with Object > Convert > Convert to Mesh Plane"
        )
    if obj.type != "MESH":
        return f"'{obj.name}' is no mesh: select planes that show an image"
    if obj.library is not None or obj.override_library is not None:
        return f"'{obj.name}' is linked from a library: {MAKE_LOCAL}"
    if not obj.data.polygons:
        return f"'{obj.name}' has no faces: select planes that show an image"
    return None


def read(obj: bpy.types.Object, sizes: Mapping[bpy.types.Image, tuple[int, int]] | None = None) -> ImagePlane:
    """What an object shows. Raises Refusal where that is no image, or not as on a plane.

    `sizes` that are known spare Blender from reading files.
    """
    reason = refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    slot, node = _texture(obj)
    size = (sizes or {}).get(node.image) or reading.size_of(node.image)
    mesh = obj.data
    layer = uv_map(obj, node)
    try:
        placement = placed(uv_maps.read(layer), points.read(obj)[corner_vertices(mesh)], _normal(mesh), size)
    except Misfit as misfit:
        raise Refusal(
            f"'{obj.name}' is no image plane, {misfit}: add the image with Add > Image > Cutout from Image"
        ) from misfit
    return ImagePlane(obj.name, obj.session_uid, slot, node.name, layer.name, placement)


def _texture(obj: bpy.types.Object) -> tuple[int, bpy.types.ShaderNodeTexImage]:
    """The slot that the faces have, and in its material the node of the image that is shown."""
    numbers, _ = face_settings(obj.data)
    slots = np.unique(
        np.clip(numbers, 0, max(len(obj.material_slots) - 1, 0))
    ).tolist()  # as Blender shows them
    nodes = [texture_in(obj, slot) for slot in slots]
    if None in nodes:
        which = "A face of " if len(nodes) > 1 else ""
        raise Refusal(
            f"{which}'{obj.name}' shows no image: give its material an Image Texture, or add the image with "
            "Add > Image"
        )
    if len(nodes) > 1:
        raise Refusal(
            f"The faces of '{obj.name}' have several materials: separate them in Edit Mode with P > By "
            "Material"
        )
    return slots[0], nodes[0]


def texture_in(obj: bpy.types.Object, slot: int) -> bpy.types.ShaderNodeTexImage | None:
    """The node of the image that the material in a slot shows; None where it shows none."""
    tree = _tree_in(obj, slot)
    if tree is None:
        return None
    nodes = [node for node in tree.nodes if _has_image(node)]
    nodes = [node for node in _reaching(tree.get_output_node("ALL")) if _has_image(node)] or nodes
    if not nodes:
        return None
    return tree.nodes.active if tree.nodes.active in nodes else nodes[0]


def _tree_in(obj: bpy.types.Object, slot: int) -> bpy.types.NodeTree | None:
    """The nodes of the material in a slot."""
    material = obj.material_slots[slot].material if slot < len(obj.material_slots) else None
    return None if material is None else material.node_tree


def _has_image(node: bpy.types.Node) -> bool:
    return node.type == "TEX_IMAGE" and node.image is not None


def _reaching(output: bpy.types.Node | None) -> list[bpy.types.Node]:
    """The nodes from which links lead to one, itself among them, by the order of its inputs."""
    found: list[bpy.types.Node] = []
    ahead = [] if output is None else [output]
    while ahead:
        node = ahead.pop()
        if node in found:
            continue
        found.append(node)
        links = [link for socket in node.inputs for link in socket.links if not link.is_muted]
        ahead += [link.from_node for link in reversed(links)]
    return found


def uv_map(obj: bpy.types.Object, node: bpy.types.ShaderNodeTexImage) -> bpy.types.MeshUVLoopLayer:
    """By which an image lies on a mesh. Raises Refusal where none tells."""
    layers = obj.data.uv_layers
    if not layers:
        raise Refusal(f"'{obj.name}' has no UV map: unwrap it in Edit Mode with U > Reset")
    rendered = next((layer for layer in layers if layer.active_render), layers[0])
    links = node.inputs["Vector"].links
    if not links:
        return rendered
    source, socket = links[0].from_node, links[0].from_socket
    if source.type == "UVMAP":
        return layers.get(source.uv_map, rendered)
    if source.type == "TEX_COORD" and socket.name == "UV":
        return rendered
    raise Refusal(
        f"The image of '{obj.name}' is laid on by the node '{source.name}': disconnect it from the Image "
        "Texture, so that the UV map tells where the image is"
    )


def _normal(mesh: bpy.types.Mesh) -> Array:
    normals = np.empty(3 * len(mesh.polygons), np.float32)
    mesh.polygons.foreach_get("normal", normals)
    total: Array = normals.reshape(-1, 3).sum(axis=0, dtype=np.float64)
    return total
