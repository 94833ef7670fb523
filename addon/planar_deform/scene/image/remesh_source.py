# SPDX-License-Identifier: GPL-3.0-or-later
"""What the new mesh of a cutout is made of: the images that it shows, or its own outline."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

import bpy
import numpy as np

from ...errors import Refusal
from ...model.image.art import Art, united
from ...model.image.cutting import NoArt, Settings
from ...model.image.filling import Filling
from ...model.image.placement import Misfit, Placement, placed
from ...model.image.recutting import Layer, recut
from ...model.image.silhouette import Overlap, Wish, refilled
from ...model.plane.frame import Array, Array32, Indices
from ...model.work import Progress
from ..flatten import uv_maps
from ..objects import triangulation
from ..objects.cutout_object import CutoutObject
from ..objects.new_faces import face_of_corners, face_settings
from ..storage.topology import corner_vertices
from . import image_plane, reading
from .file_state import images_of


@dataclass(frozen=True)
class Present:
    """The mesh as it is, all of whose vertices have faces: rows of the drawing are the mesh's."""

    drawing: CutoutObject
    rest: Array32  # n x 3, object-local
    corners: Indices  # m x 3, the corners of the mesh that triangles have
    triangles: Indices  # m x 3, their vertices, in the order in which they face
    maps: Mapping[str, Array32]  # the UV maps, corners x 2, by name
    arts: Mapping[str, Art] = field(default_factory=dict)  # those of images that have been found already

    @property
    def part_of(self) -> Indices:
        """The part of each triangle (m,)."""
        parts: Indices = self.drawing.parts[self.triangles[:, 0]]
        return parts


def present(obj: bpy.types.Object, drawing: CutoutObject) -> Present:
    """Read it."""
    rest = drawing.rest_coordinates()
    corners = triangulation.corner_triangles(obj.data, rest)
    maps = {layer.name: uv_maps.read(layer) for layer in obj.data.uv_layers}
    return Present(drawing, rest, corners, corner_vertices(obj.data)[corners], maps)


Source = Callable[[Progress], Filling]  # without Blender's data; raises Refusal

THOUSAND = 1000.0  # pixels along the longer side, where there is no image
ALL = 0.999  # of a rectangle's area
SAME_PLACE = 0.5  # pixels between two placements of an image that are one


def shows_image(obj: bpy.types.Object) -> bool:
    """Whether an object has any image to make a mesh of."""
    return bool(len(obj.data.uv_layers)) and bool(images_of(obj))


def of_images(obj: bpy.types.Object, now: Present, settings: Settings) -> Source:
    """The images that a cutout shows. Raises Refusal."""
    drawing, part_of, layers = now.drawing, now.part_of, _layers(obj, now)

    def solve(progress: Progress) -> Filling:
        try:
            filling = recut(layers, settings, drawing.rest, drawing.cutout.triangles, part_of, progress)
        except NoArt as reason:
            raise Refusal(str(reason)) from reason
        if not filling.pieces:
            raise Refusal(
                f"The image of '{drawing.object_name}' has no drawing any more where the mesh is: make a new "
                "cutout of it with Add > Image > Cutout from Image"
            )
        return filling

    return solve


def of_outline(obj: bpy.types.Object, now: Present, settings: Settings) -> Source:
    """The outline that a cutout has at rest. Lengths of the settings are pixels of its image."""
    drawing, pixel = now.drawing, _pixel(obj, now)
    wish = Wish(
        settings.vertices,
        None if settings.edge is None else settings.edge * pixel,
        (settings.margin or 0.0) * pixel,
        settings.finest,
        settings.holes == "FILL",
    )

    def solve(progress: Progress) -> Filling:
        try:
            return refilled(drawing.rest, drawing.cutout.triangles, drawing.parts, wish, progress)
        except Overlap as reason:
            raise Refusal(
                f"'{drawing.object_name}' lies over itself at rest, so that its outline does not tell its "
                "shape: take it apart there in Edit Mode, or give it an image"
            ) from reason
        except ValueError as reason:
            raise Refusal(f"'{drawing.object_name}' cannot be filled: {reason}") from reason

    return solve


def _pixel(obj: bpy.types.Object, now: Present) -> float:
    """The length of a pixel in the plane."""
    try:
        _, placement = _shown(obj, now, 0)
    except Refusal:
        return float(np.ptp(now.drawing.rest, axis=0).max()) / THOUSAND
    flat = now.drawing.rest_places(_pixel_corners(placement))
    return float(np.linalg.norm(flat[1:] - flat[0], axis=1).mean())


def _layers(obj: bpy.types.Object, now: Present) -> list[Layer]:
    """The parts by the images that they show. Raises Refusal where one shows none, or not as on a plane."""
    found: list[tuple[int, Placement, list[int]]] = []
    for part in range(int(now.drawing.parts.max()) + 1):
        slot, placement = _shown(obj, now, part)
        for other, known, parts in found:
            if other == slot and _is_same(known, placement):
                parts.append(part)
                break
        else:
            found.append((slot, placement, [part]))
    images = [_texture(obj, slot).image for slot, _, _ in found]
    layers = []
    for slot, placement, parts in found:
        node = _texture(obj, slot)
        alone = images.count(node.image) == 1 and _is_alone(obj, node.image)
        to_plane = now.drawing.rest_places
        own = np.array(parts, np.int32)
        whole = len(parts) == 1 and _is_plane(now, parts[0], placement)
        layers.append(Layer(node.image.name, _art(node, now), placement, to_plane, own, whole, alone))
    return layers


def _is_plane(now: Present, part: int, placement: Placement) -> bool:
    """Whether a part is all of the rectangle in which it shows its image."""
    own = now.rest[now.triangles[now.part_of == part]].astype(np.float64)
    area = 0.5 * np.linalg.norm(np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0]), axis=1).sum()
    corner, right, up = _pixel_corners(placement)
    window, pixel = placement.window, np.linalg.norm(np.cross(right - corner, up - corner))
    return bool(area >= ALL * pixel * (window.right - window.left) * (window.top - window.bottom))


def _pixel_corners(placement: Placement) -> Array:
    """Three corners of the image's first pixel in the mesh (3 x 3): lower left, lower right, upper left."""
    return placement.places(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))


def _shown(obj: bpy.types.Object, now: Present, part: int) -> tuple[int, Placement]:
    """The slot of the image that a part shows, and where that lies. Raises Refusal."""
    own = now.part_of == part
    corners, vertices = now.corners[own].ravel(), now.triangles[own].ravel()
    slots = face_settings(obj.data)[0][face_of_corners(obj.data)[corners]]
    if (slots != slots[0]).any():
        raise Refusal(f"A part of '{obj.name}' has several materials: remesh it by its outline")
    node = _texture(obj, int(slots[0]))
    size = reading.size_of(node.image)
    uvs = now.maps[image_plane.uv_map(obj, node).name][corners]
    try:
        return int(slots[0]), placed(uvs, now.rest[vertices], np.zeros(3), size)
    except Misfit as misfit:
        raise Refusal(
            f"'{obj.name}' does not show its image evenly, {misfit}: remesh it by its outline"
        ) from misfit


def _texture(obj: bpy.types.Object, slot: int) -> bpy.types.ShaderNodeTexImage:
    node = image_plane.texture_in(obj, slot)
    if node is None:
        raise Refusal(f"A part of '{obj.name}' shows no image: remesh it by its outline")
    return node


def _is_same(one: Placement, other: Placement) -> bool:
    ends = np.array([[0.0, 0.0], [one.size[0], 0.0], [0.0, one.size[1]]])
    gaps = np.linalg.norm(one.places(ends) - other.places(ends), axis=1)
    corner, *others = _pixel_corners(one)
    return bool(gaps.max() <= SAME_PLACE * np.linalg.norm(np.array(others) - corner, axis=1).mean())


def _is_alone(obj: bpy.types.Object, image: bpy.types.Image) -> bool:
    """Whether no other object shows an image."""
    others = (other for other in bpy.data.objects if other.type == "MESH" and other.data != obj.data)
    return not any(image in images_of(other) for other in others)


def _art(node: bpy.types.ShaderNodeTexImage, now: Present) -> Callable[[], Art]:
    known = now.arts.get(node.image.name)
    return art_of_node(node) if known is None else lambda: known


def art_of_node(node: bpy.types.ShaderNodeTexImage) -> Callable[[], Art]:
    """The art of an image, found when it is asked for; of a sequence it is found at once, frame by frame."""
    frames: Iterator[reading.Frame] = reading.frames(node.image, node.image_user)
    if node.image.source == "SEQUENCE":
        found = united(frame.art() for frame in frames)
        return lambda: found
    return next(frames).art
