# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a pose of an object is written: its own points, its posed shape key, or its pose sequence.

A store is read once, at the start of a posing, and holds no reference to Blender's data.
"""

from __future__ import annotations

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array, Array32
from ..sequence import pose_showing, pose_state
from ..storage import points, shape_keys


def store_of(obj: bpy.types.Object, unkeyed: bool) -> PoseStore:
    """Where the object's next pose goes. `unkeyed`: never into a keyed pose. Raises Refusal."""
    if obj.data.shape_keys is None:
        return OwnStore(obj)
    return SequenceStore(obj, unkeyed) if pose_state.is_ours(obj) else KeyStore(obj)


def shown_by(obj: bpy.types.Object) -> Array32:
    """The shape that an object shows without its modifiers. Raises Refusal."""
    return store_of(obj, unkeyed=True).shown.astype(np.float32)


class OwnStore:
    """The mesh's or curve's own points."""

    begin: Array32  # what is stored at the start, a shape as in storage/points.py
    shown: Array  # the same for the shape shown
    share: Array  # count x 1, how much the shown shape moves when what is stored does

    def __init__(self, obj: bpy.types.Object):
        self.begin = points.read(obj)
        self.shown = self.begin.astype(np.float64)
        self.share = np.ones((len(self.begin), 1))

    def is_there(self, obj: bpy.types.Object) -> bool:
        """Whether the object still stores its shape in this way."""
        return obj.data.shape_keys is None

    def write(self, obj: bpy.types.Object, shape: Array32) -> None:
        """Show a shape."""
        points.write(obj, shape)

    def restore(self, obj: bpy.types.Object) -> None:
        """Put everything back as it was, to the bit."""
        self.write(obj, self.begin)

    def rest(self, obj: bpy.types.Object, rest: Array32) -> Array32 | None:
        """What to store for the shape `rest` to show; None if it does already."""
        return rest


class KeyStore:
    """The active one of relative shape keys; with the Basis active, a Pose key that is made when needed."""

    def __init__(self, obj: bpy.types.Object):
        keys = obj.data.shape_keys
        key = shape_keys.posed_key(obj)
        self._name = None if key is None else key.name
        self._added: str | None = None
        self.begin = points.read_block(obj, keys.reference_key if key is None else key)
        self.shown = shape_keys.shown_points(obj)
        self.share = shape_keys.share_of_posed_key(obj)

    def is_there(self, obj: bpy.types.Object) -> bool:
        keys = obj.data.shape_keys
        name = self._added or self._name
        return keys is not None and keys.use_relative and (name is None or name in keys.key_blocks)

    def write(self, obj: bpy.types.Object, shape: Array32) -> None:
        if self._name is None and self._added is None:
            self._added = shape_keys.add_pose_key(obj).name
        key = obj.data.shape_keys.key_blocks[self._added or self._name]
        points.write_block(key, shape)

    def restore(self, obj: bpy.types.Object) -> None:
        if self._added is None:
            self.write(obj, self.begin)
            return
        keys = obj.data.shape_keys
        index = list(keys.key_blocks).index(keys.reference_key)
        obj.shape_key_remove(keys.key_blocks[self._added])
        obj.active_shape_key_index = index
        self._added = None

    def rest(self, obj: bpy.types.Object, rest: Array32) -> Array32 | None:
        if self._name is None:
            return None  # the Basis is the rest
        return points.read_block(obj, shape_keys.under_posed_key(obj))


class SequenceStore:
    """The pose that is keyed at the present frame; elsewhere the scratch, which the next frame takes away."""

    def __init__(self, obj: bpy.types.Object, unkeyed: bool):
        keys = obj.data.shape_keys
        keyed = pose_state.keyed_pose_shown(obj, bpy.context.scene.frame_current_final)
        if keyed is not None and keyed.lock_shape and not unkeyed:
            raise Refusal(f"Shape key '{keyed.name}' is locked: open its lock in the Shape Keys panel")
        self._name = None if keyed is None or unkeyed else keyed.name
        self._time = keys.eval_time
        self._was_unkeyed = pose_state.unkeyed(obj)
        self.begin = pose_state.shown_points(obj)
        self.shown = self.begin.astype(np.float64)
        self.share = np.ones((len(self.begin), 1))

    def is_there(self, obj: bpy.types.Object) -> bool:
        if not pose_state.is_ours(obj):
            return False
        return self._name is None or self._name in obj.data.shape_keys.key_blocks

    def write(self, obj: bpy.types.Object, shape: Array32) -> None:
        if self._name is None:
            pose_showing.show_unkeyed(obj, shape)
        else:
            points.write_block(obj.data.shape_keys.key_blocks[self._name], shape)

    def restore(self, obj: bpy.types.Object) -> None:
        if self._name is not None or self._was_unkeyed:
            self.write(obj, self.begin)
        else:
            pose_showing.drop_scratch(obj)
            obj.data.shape_keys.eval_time = self._time

    def rest(self, obj: bpy.types.Object, rest: Array32) -> Array32 | None:
        return rest


PoseStore = OwnStore | KeyStore | SequenceStore
