# SPDX-License-Identifier: GPL-3.0-or-later
"""A flat mesh laid flat again after its surface has been edited."""

from __future__ import annotations

import bpy
import numpy as np

from ...errors import ObjectGone, Refusal
from ...model.flatten.flattening import Settings
from ...model.flatten.layout import nearest_motion
from ...model.plane.frame import Array, Array32, Indices
from ...model.work import Progress
from ..objects import mesh_edits, rest_shape
from ..objects.flat_object import data_refusal
from ..pins import pin_list
from ..storage import points
from .flat_mesh import upright
from .link import CORNER, Link, is_flat_mesh, numbers_of, renewed, write_numbers
from .pattern import patches_of
from .pushing import shown_places
from .surface import Surface, places_of


def refusal(obj: bpy.types.Object | None) -> str | None:
    """Why nothing can be done with a flat mesh and its surface, and what to do; None if it can."""
    if not is_flat_mesh(obj):
        return "The active object is no flat mesh of a surface: make one with Flatten, and select it"
    return data_refusal(obj, "OBJECT")


class Refresh:
    """The rest shape of a flat mesh anew. What it shows stays where a pose is shown."""

    def __init__(self, obj: bpy.types.Object, settings: Settings):
        """Read a flat mesh and its surface. Raises Refusal, with nothing changed."""
        if obj.data.shape_keys is not None:
            raise Refusal(
                f"'{obj.name}' has shape keys, none of which would fit any more: remove them first, poses "
                "with Clear Poses"
            )
        shown_places(obj)  # refuses what does not lie in its plane
        link = renewed(obj)
        self._object, self._settings = (obj.name, obj.session_uid), settings
        self._corners: Indices = link.corners
        self._surface, self._rows = _surface(obj, link)
        stored = rest_shape.stored_of(obj.data)
        shown = points.read(obj)
        self._rest = shown if stored is None else stored
        self._shown, self._stored, self._owners = shown, stored, rest_shape.owners_of(obj.data)
        self._corners_before = numbers_of(obj.data, CORNER)
        self._pins_before: pin_list.SavedResults | None = None
        self.posed = stored is not None and not np.array_equal(stored, shown)

    def solve(self, progress: Progress) -> Array32:
        """The new rest shape; each patch lies where it lay. Raises Refusal and native.Cancelled."""
        flat = self._surface.flattened(self._settings, progress).places
        before = self._rest[self._rows][:, [0, 2]].astype(np.float64)
        patches = self._surface.patches
        places: Array = np.zeros_like(flat)
        for patch in range(patches.count):
            rows = patches.rows(patch)
            places[rows] = nearest_motion(flat[rows], before[rows]).of(flat[rows])
        rest = self._rest.copy()
        rest[self._rows] = upright(places)
        return rest

    def write(self, rest: Array32) -> None:
        """Give the flat mesh its new rest shape, and show it where no pose is shown. Raises ObjectGone."""
        obj = self._resolve()
        self._pins_before = pin_list.SavedResults(obj)
        write_numbers(obj.data, CORNER, self._corners + 1)
        rest_shape.write(obj.data, rest)
        if not self.posed:
            points.write(obj, rest)
            pin_list.forget_targets(obj)
        points.update(obj)
        mesh_edits.see(obj)

    def take_back(self) -> None:
        """Put everything back as it was before it was written. Raises ObjectGone."""
        obj = self._resolve()
        if self._corners_before is not None:
            write_numbers(obj.data, CORNER, self._corners_before)
        rest_shape.put_back(obj.data, self._stored, self._owners)
        points.write(obj, self._shown)
        if self._pins_before is not None:
            self._pins_before.restore(obj)
        points.update(obj)
        mesh_edits.see(obj)

    def _resolve(self) -> bpy.types.Object:
        obj = bpy.data.objects.get(self._object[0])
        if obj is None or obj.session_uid != self._object[1] or len(obj.data.vertices) != len(self._rest):
            raise ObjectGone(f"'{self._object[0]}' is gone, or has changed")
        return obj


def _surface(obj: bpy.types.Object, link: Link) -> tuple[Surface, Indices]:
    """What is to be laid flat, and which vertices of the flat mesh that is: it stays cut as it is."""
    patches = patches_of(obj.data)
    rows = patches.vertices
    places = places_of(link.surface)[link.vertices[rows]]
    return Surface(obj.name, patches, places, mirrored=False), rows
