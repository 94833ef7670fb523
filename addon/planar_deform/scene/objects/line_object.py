# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that are made of lines: meshes of edges without faces, and curves of poly splines.

Their shapes are keyed and filled in like those of cutouts; they are posed in Edit Mode, for pins need faces.
"""

from __future__ import annotations

from collections.abc import Iterable

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.plane.connectivity import unique_edges
from ...model.plane.cutout import connected_parts, diagonal_of
from ...model.plane.frame import Array, Array32, Indices, PlaneFrame, frame_across, mapped
from ...model.plane.outline import plane_normal
from ..sequence import pose_state
from ..storage import points, shape_keys
from ..storage.topology import edge_vertices
from .flat_object import FlatObject, data_refusal, is_flat
from .pose_store import store_of


def outline_refusal(obj: bpy.types.Object) -> str | None:
    """Why shapes of a curve, or of a mesh without faces, cannot be keyed, and what to do; None when they can.

    Cheap enough for polls; LineObject finds the rest.
    """
    reason = data_refusal(obj, "OBJECT")
    if reason is not None:
        return reason
    if obj.type == "MESH":
        if not obj.data.edges:
            return f"'{obj.name}' has no faces and no edges: draw some"
    elif any(spline.type != "POLY" for spline in obj.data.splines):
        return f"'{obj.name}' has curved splines: make them lines in Edit Mode with Set Spline Type > Poly"
    elif not any(len(spline.points) > 1 for spline in obj.data.splines):
        return f"'{obj.name}' has no lines: draw some"
    return pose_state.refusal(obj) if pose_state.has_blocks(obj) else shape_keys.refusal(obj)


class LineObject(FlatObject):
    """A curve or a mesh without faces, as points joined by edges. Indices are those of its joined points."""

    rest: Array  # n x 2
    diagonal: float  # of the rest shape's bounding box
    elements: native.Elements  # edges

    def __init__(self, obj: bpy.types.Object, unkeyed: bool):
        super().__init__(obj, store_of(obj, unkeyed))
        edges = edges_of(obj)
        used, compact = np.unique(edges, return_inverse=True)
        compact = compact.reshape(-1, 2).astype(np.int32)
        shown = self._take_points(obj, used.astype(np.int32), connected_parts(len(used), compact))
        keys = obj.data.shape_keys
        self._rest_shape = self._store.begin if keys is None else points.read_block(obj, keys.reference_key)
        rest = self._rest_shape[used, :3].astype(np.float64)
        blocks = [] if keys is None else keys.key_blocks
        others = (points.read_block(obj, block)[used, :3].astype(np.float64) for block in blocks)
        self._take_frame(self._flat_frame(shown, others, "Its points do"), mapped(shown, self._linear))
        flat = self._flat_frame(rest, [], "Its Basis does")
        self.rest = flat.flatten(mapped(rest, self._linear))
        self.diagonal = diagonal_of(self.rest)
        self.elements = {"edges": compact}

    def rest_coordinates(self) -> Array32:
        """The shape, see storage/points.py, of the object at rest: the Basis, or else its present one."""
        return self._rest_shape

    def _flat_frame(self, shape: Array, others: Iterable[Array], subject: str) -> PlaneFrame:
        frame = frame_across(plane_normal(shape, others, self.parts), self._linear)
        if not is_flat(frame, mapped(shape, self._linear), self.parts):
            raise Refusal(
                f"{subject} not lie in parallel planes: flatten the drawing in Edit Mode (scale it to 0 "
                "along its normal)"
            )
        return frame


def edges_of(obj: bpy.types.Object) -> Indices:
    """The lines of a mesh or of a curve's poly splines, e x 2 points of it, each once, sorted."""
    if obj.type == "MESH":
        return unique_edges(edge_vertices(obj.data))
    lines, start = [], 0
    for spline in obj.data.splines:
        line = np.arange(start, start + len(spline.points), dtype=np.int32)
        start += len(line)
        closed = spline.use_cyclic_u and len(line) > 2
        lines.append(np.stack([line, np.roll(line, -1)], axis=1)[: len(line) if closed else -1])
    return unique_edges(np.concatenate(lines))
