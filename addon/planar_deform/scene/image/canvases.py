# SPDX-License-Identifier: GPL-3.0-or-later
"""Cutouts of images whose canvas has become larger or smaller since."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np

from ...model.image import canvas
from ...model.image.silhouette import contour
from ...model.plane.cutout import oriented
from ...model.plane.frame import Array, Array32, Mask
from ..objects.new_faces import face_of_corners, face_settings
from . import file_state, image_plane, reading, remesh_source
from .remesh_source import Present


def fitted(obj: bpy.types.Object, now: Present) -> tuple[Present, list[str]]:
    """A mesh whose UV maps show each drawing where it lies on its canvas by now, and what is to be told.

    Changes nothing. Raises Refusal.
    """
    slots = face_settings(obj.data)[0][face_of_corners(obj.data)]
    said = []
    for slot in np.unique(slots).tolist():
        node = image_plane.texture_in(obj, slot)
        old = None if node is None else file_state.size_before(obj, node.image)
        if node is None or old is None:
            continue
        new, image = reading.size_of(node.image), node.image.name
        if new == old:
            continue
        name, of_slot = image_plane.uv_map(obj, node).name, slots == slot
        art = now.arts.get(image) or remesh_source.art_of_node(node)()
        now = replace(now, arts={**now.arts, image: art})
        corner = canvas.moved(_outline(now, now.maps[name], of_slot), old, art.alpha)
        if corner is None:
            continue
        uvs = now.maps[name].astype(np.float64)
        uvs[of_slot] = (uvs[of_slot] * old + corner) / new
        now = replace(now, maps={**now.maps, name: uvs.astype(np.float32)})
        sizes = f"{new[0]} x {new[1]} pixels instead of {old[0]} x {old[1]}"
        said.append(f"the canvas of '{image}' is {sizes}, the drawing stays in place")
    return now, said


def _outline(now: Present, uvs: Array32, of_slot: Mask) -> Array:
    """The outline of the faces with these corners in a UV map, see canvas.moved()."""
    own = of_slot[now.corners[:, 0]]
    places = np.zeros((len(now.rest), 2))
    places[now.triangles[own]] = uvs[now.corners[own]]
    return places[contour(oriented(places, now.triangles[own]))]
