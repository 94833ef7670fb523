# SPDX-License-Identifier: GPL-3.0-or-later
"""A flat mesh laid flat again after its surface has been edited."""

from __future__ import annotations

import bpy
import numpy as np

from ... import native
from ...errors import ObjectGone, Refusal
from ...model.flatten.flattening import Settings
from ...model.flatten.layout import nearest_motion
from ...model.plane.frame import Array, Array32, Indices
from ...model.work import Progress
from ..objects import mesh_edits, rest_shape
from ..objects.flat_object import data_refusal
from ..pins import pin_list
from ..sequence import pose_state, up_to_date
from ..storage import points
from .flat_mesh import upright
from .link import CORNER, Link, is_flat_mesh, numbers_of, read_link, write_numbers
from .pattern import patches_of
from .pushing import shown_places
from .surface import Surface, places_of


def refusal(obj: bpy.types.Object | None) -> str | None:
    """Why nothing can be done with a flat mesh and its surface, and what to do; None if it can."""
    if not is_flat_mesh(obj):
        return "The active object is no flat mesh of a surface: make one with Flatten, and select it"
    return data_refusal(obj, "OBJECT")


CHUNK = 64  # poses between two looks at whether anybody still waits
LAYING = 0.9  # of the progress, where poses are carried over as well

Shapes = dict[str, Array32]  # by the names of shape keys


class Refresh:
    """The rest shape of a flat mesh anew. A pose that is shown stays; keyed ones are carried over to it.

    The mesh is what it was but for its vertices' places, so that poses of the old rest shape are poses of the
    new one.
    """

    def __init__(self, obj: bpy.types.Object, settings: Settings):
        """Read a flat mesh and its surface. Raises Refusal, with nothing changed."""
        keys = obj.data.shape_keys
        if keys is not None and not pose_state.is_ours(obj):
            raise Refusal(
                f"'{obj.name}' has shape keys of its own, none of which would fit any more: remove them first"
            )
        reason = pose_state.refusal(obj)
        if reason is not None:
            raise Refusal(reason)
        if pose_state.unkeyed(obj):
            raise Refusal("The pose shown is not keyed: use Key Pose, or change the frame first")
        shown_places(obj)  # refuses what does not lie in its plane
        link = read_link(obj, renewed=True)
        self._object, self._settings = (obj.name, obj.session_uid), settings
        self._corners: Indices = link.corners
        self._surface, self._rows = _surface(obj, link)
        stored = rest_shape.stored_of(obj.data)
        shown = points.read(obj)
        self._rest = shown if stored is None else stored
        self._poses: Shapes = {}
        if keys is not None:
            self._rest = points.read_block(obj, keys.reference_key)
            blocks = (block for block in keys.key_blocks if block != keys.reference_key)
            self._poses = {block.name: points.read_block(obj, block) for block in blocks}
        self._fresh = up_to_date.found(obj)
        self._keyed = keys is not None
        self._shown, self._stored, self._owners = shown, stored, rest_shape.owners_of(obj.data)
        self._corners_before = numbers_of(obj.data, CORNER)
        self._pins_before: pin_list.SavedResults | None = None
        self.posed = not self._keyed and stored is not None and not np.array_equal(stored, shown)

    def solve(self, progress: Progress) -> tuple[Array32, Shapes]:
        """The new rest shape and poses; patches lie where they lay. Raises Refusal and native.Cancelled."""
        share = LAYING if self._poses else 1.0
        flat = self._surface.flattened(self._settings, lambda done: progress(share * done)).places
        places = self._laid(flat, self._in_plane(self._rest))
        rest = self._rest.copy()
        rest[self._rows] = upright(places)
        return rest, self._carried(places, lambda done: progress(share + (1.0 - share) * done))

    def _laid(self, places: Array, where: Array) -> Array:
        """Each patch of k x 2 places, moved as a whole to where it was."""
        laid: Array = np.zeros_like(places)
        for patch in range(self._surface.patches.count):
            rows = self._surface.patches.rows(patch)
            laid[rows] = nearest_motion(places[rows], where[rows]).of(places[rows])
        return laid

    def _in_plane(self, shape: Array32) -> Array:
        places: Array = shape[self._rows][:, [0, 2]].astype(np.float64)
        return places

    def _carried(self, rest: Array, progress: Progress) -> Shapes:
        """The poses as the new rest shape has them."""
        carried: Shapes = {}
        names, before = list(self._poses), self._in_plane(self._rest)
        for start in range(0, len(names), CHUNK):
            if not progress(start / len(names)):
                raise native.Cancelled
            chunk = names[start : start + CHUNK]
            old = [self._in_plane(self._poses[name]) for name in chunk]
            new = native.transfer_motion([before, *old], rest, triangles=self._surface.patches.triangles)
            for name, was, places in zip(chunk, old, new[1:], strict=True):
                shape = self._poses[name].copy()
                shape[self._rows[:, None], [0, 2]] = self._laid(places, was)
                carried[name] = shape
        return carried

    def write(self, new: tuple[Array32, Shapes]) -> None:
        """Give the flat mesh its new rest shape and poses; with none, it is shown. Raises ObjectGone."""
        obj, (rest, poses) = self._resolve(), new
        self._pins_before = pin_list.SavedResults(obj)
        write_numbers(obj.data, CORNER, self._corners + 1)
        if self._keyed:
            self._write_keys(obj, rest, poses)
        else:
            rest_shape.write(obj.data, rest)
        if not self.posed:
            points.write(obj, rest)
            pin_list.forget_targets(obj)
        points.update(obj)
        up_to_date.mark(obj, self._fresh if self._keyed else {})
        mesh_edits.see(obj)

    def _write_keys(self, obj: bpy.types.Object, rest: Array32, poses: Shapes) -> None:
        keys = obj.data.shape_keys
        points.write_block(keys.reference_key, rest)
        for name, shape in poses.items():
            points.write_block(keys.key_blocks[name], shape)

    def take_back(self) -> None:
        """Put everything back as it was before it was written. Raises ObjectGone."""
        obj = self._resolve()
        if self._corners_before is not None:
            write_numbers(obj.data, CORNER, self._corners_before)
        if self._keyed:
            self._write_keys(obj, self._rest, self._poses)
        else:
            rest_shape.put_back(obj.data, self._stored, self._owners)
        points.write(obj, self._shown)
        if self._pins_before is not None:
            self._pins_before.restore(obj)
        points.update(obj)
        up_to_date.mark(obj, self._fresh if self._keyed else {})
        mesh_edits.see(obj)

    def _resolve(self) -> bpy.types.Object:
        obj = bpy.data.objects.get(self._object[0])
        if obj is None or obj.session_uid != self._object[1] or len(obj.data.vertices) != len(self._rest):
            raise ObjectGone(f"'{self._object[0]}' is gone, or has changed")
        keys = obj.data.shape_keys
        names = (
            set() if keys is None else {block.name for block in keys.key_blocks} - {keys.reference_key.name}
        )
        if names != set(self._poses) or (keys is not None) != self._keyed:
            raise ObjectGone(f"The shape keys of '{self._object[0]}' have changed")
        return obj


def _surface(obj: bpy.types.Object, link: Link) -> tuple[Surface, Indices]:
    """What is to be laid flat, and which vertices of the flat mesh that is: it stays cut as it is."""
    patches = patches_of(obj.data)
    rows = patches.vertices
    places = places_of(link.surface)[link.vertices[rows]]
    return Surface(obj.name, patches, places, mirrored=False), rows
