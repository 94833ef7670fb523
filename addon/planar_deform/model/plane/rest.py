# SPDX-License-Identifier: GPL-3.0-or-later
"""Rest positions for vertices that an edit of the mesh added without a rest of their own."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .frame import Array, Array32, Indices, Mask

Complex = NDArray[np.complex128]


def coincident_edges(rest: Array32, triangles: Indices) -> Indices:
    """The edges k x 2 of triangles m x 3 whose two ends have the same rest, n x d; some of them twice."""
    edges: Indices = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    for axis in rest.T:  # one coordinate after the other: few edges are left after the first
        edges = edges[axis[edges[:, 0]] == axis[edges[:, 1]]]
    return edges


def copied_along_edges(coincident: Indices, current: Array, least: float) -> Mask:
    """The vertices (mask n) whose rest is a copy of a neighbour's that is more than `least` away.

    That is what extruding leaves: Blender copies the point attributes of the tail vertex to the new one,
    which comes later in the mesh. `coincident` is what coincident_edges() finds, `current` is n x d.
    """
    apart = np.linalg.norm(current[coincident[:, 0]] - current[coincident[:, 1]], axis=1) > least
    copied = np.zeros(len(current), bool)
    copied[coincident[apart].max(axis=1)] = True
    return copied


def copied_parts(rest: Array | Array32, parts: Indices) -> list[int]:
    """The parts all of whose rest positions (n x 3, as float32) repeat those of vertices of earlier parts.

    That is what duplicating a part leaves: its rest lies on top of the original's.
    """
    if not len(parts) or not parts.max():
        return []
    bits = np.ascontiguousarray(rest, np.float32).view(np.uint32).astype(np.uint64)
    mixed = (bits[:, 0] * np.uint64(0x9E3779B97F4A7C15)) ^ (bits[:, 1] * np.uint64(0xC2B2AE3D27D4EB4F))
    mixed ^= bits[:, 2] * np.uint64(0x165667B19E3779F9)
    _, first, inverse = np.unique(mixed, return_index=True, return_inverse=True)
    earliest = np.full(len(first), np.iinfo(np.int32).max, np.int32)
    np.minimum.at(earliest, inverse, parts)
    repeated = earliest[inverse] < parts
    alone = np.bincount(parts, weights=~repeated)
    return [int(part) for part in np.flatnonzero(alone == 0.0)]


def fitted(rest: Array, current: Array, scaled: bool) -> Array:
    """k x 3 rest positions moved onto the current ones by the best rigid motion, or similarity if `scaled`.

    Closed form after Umeyama 1991, "Least-squares estimation of transformation parameters". Points of a plane
    leave the sense of the rotation about it free; it is taken proper, so a mirrored drawing is turned over.
    """
    rest_centre, centre = rest.mean(axis=0), current.mean(axis=0)
    arms = rest - rest_centre
    left, sizes, right = np.linalg.svd((current - centre).T @ arms)
    sign = np.sign(np.linalg.det(left) * np.linalg.det(right))
    turn = left @ np.diag([1.0, 1.0, sign]) @ right
    spread = float((arms * arms).sum())
    scale = float(sizes @ [1.0, 1.0, sign]) / spread if scaled and spread > 0.0 else 1.0
    result: Array = centre + scale * (arms @ turn.T)
    return result


def completed(rest: Array, current: Array, triangles: Indices, known: Mask) -> Array:
    """n x 2 rest positions in which those that are not `known` (mask n) continue the known ones around them.

    Each takes its place from its known neighbours as if the current shape around it were turned back rigidly
    with them; neighbours of those follow in further rounds. A part where nothing is known rests as it is now.
    """
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    edges = np.concatenate([edges, edges[:, ::-1]])
    tail, head = edges.T
    flat_rest, flat_current = rest @ np.array([1.0, 1j]), current @ np.array([1.0, 1j])
    count, known = len(rest), known.copy()

    # The turn back to rest around each known vertex: the best fit of its edges to known neighbours.
    both = known[tail] & known[head]
    turns = _gathered(
        (flat_rest[head] - flat_rest[tail]) * np.conj(flat_current[head] - flat_current[tail]),
        head,
        both,
        count,
    )
    turns = _unit(turns)
    while True:
        step = known[tail] & ~known[head]
        if not step.any():
            break
        places = flat_rest[tail] + turns[tail] * (flat_current[head] - flat_current[tail])
        share = np.bincount(head[step], minlength=count)
        reached = share > 0
        flat_rest[reached] = _gathered(places, head, step, count)[reached] / share[reached]
        turns[reached] = _unit(_gathered(turns[tail], head, step, count))[reached]
        known |= reached
    flat_rest[~known] = flat_current[~known]
    return np.stack([flat_rest.real, flat_rest.imag], axis=1)


def _gathered(values: Complex, head: Indices, chosen: Mask, count: int) -> Complex:
    result = np.zeros(count, np.complex128)
    np.add.at(result, head[chosen], values[chosen])
    return result


def _unit(values: Complex) -> Complex:
    sizes = np.abs(values)
    return np.where(sizes > 0.0, values / np.where(sizes > 0.0, sizes, 1.0), 1.0)
