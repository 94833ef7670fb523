# SPDX-License-Identifier: GPL-3.0-or-later
"""The outlines of the poses keyed before and behind the present frame.

They are read when the frame has other neighbours, or when Blender says that the object's shapes may have
changed; a frame change alone reads nothing but the curve.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

import bpy
import numpy as np

from ...errors import Refusal
from ...model.lattice.cells import border
from ...model.plane.frame import Array32, Indices
from ..objects.lattice_object import counts_of
from ..objects.line_object import edges_of
from ..sequence import pose_state
from ..sequence.neighbours import KeyedPose, around
from ..sequence.pose_blocks import block_at
from ..storage import changes, points
from ..storage.topology import corner_edges, edge_vertices
from . import snapshot

MODES = ("OBJECT", "EDIT_MESH", "EDIT_CURVE")  # outlines without faces are posed in Edit Mode


@dataclass(frozen=True, eq=False)
class Onion:
    """What there is to draw of one object, in its own space."""

    edges: Indices  # e x 2 indices of points: the outline
    before: Array32 | None  # count x 3; None: nothing is keyed before
    behind: Array32 | None

    def same(self, other: Onion) -> bool:
        """Whether the other one looks the same."""
        pairs = (self.edges, other.edges), (self.before, other.before), (self.behind, other.behind)
        return all(a is b or (a is not None and b is not None and np.array_equal(a, b)) for a, b in pairs)


@dataclass(frozen=True)
class _Kept:
    eval_times: tuple[float | None, float | None]  # of the two poses
    changed: changes.Edits
    onion: Onion


CAPACITY = 8  # objects

_kept: OrderedDict[int, _Kept] = OrderedDict()  # by session_uid, the last one asked for at the end


def of_active(context: bpy.types.Context) -> Onion | None:
    """What to draw of the active object; the same one as long as it is the same. Changes no data."""
    obj = context.object
    if obj is None or context.mode not in MODES or not obj.is_property_set("planar"):
        return None
    if not obj.planar.show_onion or not pose_state.is_ours(obj):
        return None
    before, behind = around(obj, context.scene.frame_current_final)
    if before is None and behind is None:
        return None
    eval_times = None if before is None else before.at, None if behind is None else behind.at
    kept, changed = _kept.get(obj.session_uid), changes.edits(obj)
    current = kept is not None and kept.changed == changed
    if kept is None or kept.eval_times != eval_times or not (current or snapshot.following(obj)):
        try:
            onion = Onion(outline(obj), _shape(obj, before), _shape(obj, behind))
        except Refusal:
            return None  # the panel says what is wrong
        kept = _Kept(
            eval_times, changed, kept.onion if kept is not None and kept.onion.same(onion) else onion
        )
        _kept[obj.session_uid] = kept
        if len(_kept) > CAPACITY:
            _kept.popitem(last=False)
    _kept.move_to_end(obj.session_uid)
    return kept.onion


def outline(obj: bpy.types.Object) -> Indices:
    """The edges of at most one face of a mesh, all of a curve, a lattice's border, e x 2 points."""
    if obj.type == "CURVE":
        return edges_of(obj)
    if obj.type == "LATTICE":
        return border(counts_of(obj))
    ends = edge_vertices(obj.data)
    return ends[np.bincount(corner_edges(obj.data), minlength=len(ends)) < 2]


def _shape(obj: bpy.types.Object, pose: KeyedPose | None) -> Array32 | None:
    block = None if pose is None else block_at(obj.data.shape_keys, pose.at)
    return None if block is None else np.ascontiguousarray(points.read_block(obj, block)[:, :3])


def forget() -> None:
    """Keep nothing."""
    _kept.clear()
