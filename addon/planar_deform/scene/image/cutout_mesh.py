# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh of a cutout, which takes the place of an image plane's."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np

from ...model.image.cutting import Drawing
from ...model.image.placement import affine_fit, carried
from ...model.plane.carrying import carrying
from ...model.plane.frame import Array, Array32, Indices
from ..flatten import uv_maps
from ..objects import attributes, triangulation
from ..objects.adding import link_beside
from ..objects.new_faces import face_of_corners
from ..storage.points import read
from ..storage.topology import corner_vertices
from .image_plane import ImagePlane


def swap(plane: ImagePlane, drawing: Drawing, *, separate: bool = False) -> list[bpy.types.Object]:
    """Give the plane the cutout's mesh; the object stays what and where it is, with its materials.

    All UV maps go on to show what they showed. `separate`: the largest island alone becomes the plane's, each
    other one a copy of it; these follow in the list. Raises ObjectGone, with nothing changed.
    """
    obj = plane.resolve()
    meshes = [mesh_of(plane, part) for part in (drawing.separated() if separate else [drawing])]
    old = obj.data
    name = old.name
    obj.data = meshes[0]
    if not old.users:
        bpy.data.meshes.remove(old)
    obj.data.name = name
    objects = [obj]
    for mesh in meshes[1:]:
        island = obj.copy()
        island.data = mesh
        mesh.name = island.name
        link_beside(bpy.context, obj, island)
        for collection in obj.users_collection:
            if collection.library is None and island.name not in collection.objects:
                collection.objects.link(island)
        objects.append(island)
    _show_no_more_than_the_image(plane.texture, drawing)
    return objects


def joined(context: bpy.types.Context, objects: list[bpy.types.Object], name: str) -> bpy.types.Object:
    """One object of several, the first one of them, with a part for each and this name."""
    meshes = [obj.data for obj in objects[1:]]
    context.view_layer.update()
    with context.temp_override(
        active_object=objects[0],
        object=objects[0],
        selected_editable_objects=objects,
        selected_objects=objects,
    ):
        bpy.ops.object.join()
    for mesh in meshes:
        if not mesh.users:
            bpy.data.meshes.remove(mesh)
    objects[0].name = objects[0].data.name = name
    return objects[0]


def mesh_of(plane: ImagePlane, drawing: Drawing) -> bpy.types.Mesh:
    """A new mesh of the cutout, as the plane shows its image. Raises ObjectGone."""
    source = plane.resolve().data
    placement = plane.placement
    triangles = facing(plane, drawing)
    mesh = bpy.data.meshes.new(source.name)
    mesh.from_pydata(places(plane, drawing).tolist(), [], triangles.tolist())
    for material in source.materials:
        mesh.materials.append(material)
    if plane.slot:
        mesh.polygons.foreach_set("material_index", np.full(len(triangles), plane.slot, np.int32))
    corners = placement.uvs(drawing.points)[triangles.ravel()]
    shown = uv_maps.read(source.uv_layers[plane.uv_map])
    for layer in source.uv_layers:
        copy = mesh.uv_layers.new(name=layer.name)
        linear = affine_fit(shown, uv_maps.read(layer))
        assert linear is not None  # else there would be no placement
        uv_maps.write(mesh, copy, carried(corners, linear).astype(np.float32))
        copy.active_render = layer.active_render
    if source.uv_layers.active is not None:
        mesh.uv_layers.active_index = source.uv_layers.active_index
    _carry(plane, source, mesh, drawing.points, triangles)
    for name in source.keys():  # noqa: SIM118 - a mesh is no mapping
        if name not in mesh.bl_rna.properties:
            mesh[name] = source[name]
    return mesh


def lost(plane: ImagePlane) -> str | None:
    """What to tell of a plane's attributes that its cutout will not have. Raises ObjectGone."""
    mesh = plane.resolve().data
    names = attributes.not_read(mesh)
    return f"'{plane.name}': without its attributes {', '.join(names)}" if names else None


def _carry(
    plane: ImagePlane, source: bpy.types.Mesh, mesh: bpy.types.Mesh, points: Array, triangles: Indices
) -> None:
    """Give the cutout's mesh the attributes of the plane's, as they are where its points lie."""
    found = [one for one in attributes.read(source) if not one.is_map]
    if not found:
        return
    shown = uv_maps.read(source.uv_layers[plane.uv_map]).astype(np.float64) * plane.placement.size
    corners = triangulation.corner_triangles(source, read(plane.resolve()))
    hung = carrying(shown, corners, points)
    middles = carrying(shown, corners, points[triangles].mean(axis=1))
    faces = face_of_corners(source)[corners[middles.triangles, 0]]
    vertices = corner_vertices(source)
    for one in found:
        mesh.attributes.new(one.name, one.kind, one.domain)
        if one.domain == "FACE":
            values = one.values[faces]
        elif one.domain == "CORNER":
            values = one.carried(hung)[triangles.ravel()]
        else:
            values = replace(one, values=one.values[vertices]).carried(hung)
        attributes.write(mesh, one, values)
    colours, names = source.color_attributes, mesh.color_attributes.keys()
    if colours.active_color_name in names:
        mesh.color_attributes.active_color_name = colours.active_color_name
    if 0 <= colours.render_color_index < len(colours):
        rendered = colours[colours.render_color_index].name
        if rendered in names:
            mesh.color_attributes.render_color_index = names.index(rendered)


def places(plane: ImagePlane, drawing: Drawing) -> Array32:
    """The cutout's points in the plane's coordinates, n x 3."""
    found: Array32 = plane.placement.places(drawing.points).astype(np.float32)
    return found


def facing(plane: ImagePlane, drawing: Drawing) -> Indices:
    """The cutout's triangles, m x 3, which face where the plane's faces do."""
    found = drawing.triangles[:, ::-1] if plane.placement.mirrored else drawing.triangles
    return np.ascontiguousarray(found, dtype=np.int32)


def _show_no_more_than_the_image(texture: bpy.types.ShaderNodeTexImage, drawing: Drawing) -> None:
    """The mesh reaches beyond the image by its margin, where a texture that repeats would show again."""
    size = np.array(texture.image.size)
    within = (drawing.points >= 0.0).all() and (drawing.points <= size).all()
    if not within and texture.id_data.library is None:
        texture.extension = "CLIP"
