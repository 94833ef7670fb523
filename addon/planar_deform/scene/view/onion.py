# SPDX-License-Identifier: GPL-3.0-or-later
"""The outlines of the poses keyed before and behind the present frame.

They are read when the frame has other neighbours, or when Blender says that the object's shapes may have
changed; a frame change alone reads nothing but the curve.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Indices
from ..objects.line_object import edges_of
from ..sequence import pose_state
from ..sequence.neighbours import KeyedPose, around
from ..sequence.pose_blocks import block_at
from ..storage import points
from . import snapshot

MODES = ("OBJECT", "EDIT_MESH", "EDIT_CURVE")  # outlines without faces are posed in Edit Mode


@dataclass(frozen=True, eq=False)
class Onion:
    """What there is to draw of one object, in its own space."""

    edges: Indices  # e x 2 indices of points: the outline
    before: np.ndarray | None  # count x 3 float32; None: nothing is keyed before
    behind: np.ndarray | None

    def same(self, other: Onion) -> bool:
        return all(
            (a is None) == (b is None) and (a is None or np.array_equal(a, b))
            for a, b in ((self.edges, other.edges), (self.before, other.before), (self.behind, other.behind))
        )


@dataclass
class _Kept:
    signature: tuple
    onion: Onion


_kept: _Kept | None = None
_changed = False  # Blender has said that shapes may have changed


def of_active(context: bpy.types.Context) -> Onion | None:
    """What to draw of the active object; the same one as long as it is the same. Changes no data."""
    global _kept, _changed
    obj = context.object
    if obj is None or context.mode not in MODES or not obj.planar.show_onion or not pose_state.is_ours(obj):
        return None
    before, behind = around(obj, context.scene.frame_current_final)
    places = tuple(None if pose is None else pose.at for pose in (before, behind))
    if places == (None, None):
        return None
    signature = obj.name, obj.session_uid, places
    changed = _changed and not snapshot.following()  # a drag would have it read at each event
    if _kept is None or _kept.signature != signature or changed:
        try:
            onion = Onion(outline(obj), _shape(obj, before), _shape(obj, behind))
        except Refusal:
            return None  # the panel says what is wrong
        _changed = False
        _kept = _Kept(signature, _kept.onion if _kept is not None and _kept.onion.same(onion) else onion)
    return _kept.onion


def outline(obj: bpy.types.Object) -> Indices:
    """The edges of at most one face of a mesh, or all of a curve, e x 2 indices of points."""
    if obj.type == "CURVE":
        return edges_of(obj)
    mesh = obj.data
    ends = np.empty(len(mesh.edges) * 2, np.int32)
    mesh.edges.foreach_get("vertices", ends)
    sides = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("edge_index", sides)
    return ends.reshape(-1, 2)[np.bincount(sides, minlength=len(mesh.edges)) < 2]


def _shape(obj: bpy.types.Object, pose: KeyedPose | None) -> np.ndarray | None:
    block = None if pose is None else block_at(obj.data.shape_keys, pose.at)
    return None if block is None else np.ascontiguousarray(points.read_block(obj, block)[:, :3])


def changed() -> None:
    """Shapes may have changed."""
    global _changed
    _changed = True


def forget() -> None:
    """Keep nothing."""
    global _kept, _changed
    _kept, _changed = None, False
