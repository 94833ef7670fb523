# SPDX-License-Identifier: GPL-3.0-or-later
"""What in-betweens are compared with: the paper as printed, and a polar blend with one Poisson solve a frame.

Complex numbers stand for points, a shape is n of them. Both functions give the frames between two shapes at
uniform times, frames x n, with their centroids on a straight line, as the module's are.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, csr_array, dia_array
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree
from scipy.sparse.linalg import SuperLU, splu

TOLERANCE = 5e-4  # tau of (11), of the box's diagonal
MOST_ITERATIONS = 14  # where it converges it takes at most 13


def inbetween_times(frames: int) -> np.ndarray:
    return np.arange(1, frames + 1) / (frames + 1)


def printed(first: np.ndarray, last: np.ndarray, triangles: np.ndarray, frames: int) -> np.ndarray:
    """Algorithm 2 of Li et al. 2013, equations (8) to (13) with (8) as corrected, forward and reverse.

    Where it does not converge it gives what it has, be it not finite.
    """
    edges = np.unique(sides(triangles), axis=0)
    start, end = (shape[edges[:, 1]] - shape[edges[:, 0]] for shape in (first, last))
    times = np.arange(frames + 2) / (frames + 1)
    scale = np.abs(end) / np.abs(start)  # (12)
    angles = breadth_first(np.angle(end / start), edges, len(first))
    e = (1 - times + np.outer(scale, times)) * np.exp(1j * np.outer(angles, times)) * start[:, None]  # (13)

    rows = np.repeat(np.arange(len(edges)), 2)
    signs = np.tile([-1.0, 1.0], len(edges))
    difference = csc_array((signs, (rows, edges.ravel())), shape=(len(edges), len(first)))
    held = first_of_parts(edges, len(first))
    points = np.zeros((frames, len(first)), dtype=complex)
    diagonal = np.hypot(np.ptp(first.real), np.ptp(first.imag))
    for iteration in range(MOST_ITERATIONS):
        before = points
        points = np.array([assembled(difference, held, column) for column in e[:, 1:-1].T])
        if not np.isfinite(points).all():
            break
        if iteration > 0 and np.abs(points - before).max() < TOLERANCE * diagonal:  # (11)
            break
        e[:, 1:-1] = difference @ points.T
        e[:, 1:-1] = relaxed(e)
    return centred(points, first, last)


def assembled(difference: csc_array, held: np.ndarray, e: np.ndarray) -> np.ndarray:
    """The points that minimise (10) with weights 1/|e|, those held at 0."""
    length = np.abs(e)
    if not (np.isfinite(length) & (length > 0)).all():
        return np.full(difference.shape[1], np.nan, dtype=complex)
    weighted = dia_array((1 / length[None], [0]), shape=(len(e), len(e))) @ difference
    return solved(factored(difference.T @ weighted, held), weighted.T @ e)


def relaxed(e: np.ndarray) -> np.ndarray:
    """The inner columns of e (edges x times) that minimise (9), forward and reverse, the outer ones fixed: a
    tridiagonal system an edge, all edges at once."""
    change = np.diff(e)
    normal = 1j * e
    forward = (normal[:, :-1].conj() * change).real / np.abs(e[:, :-1]) ** 2  # (8), times the time step
    reverse = (normal[:, 1:].conj() * change).real / np.abs(e[:, 1:]) ** 2
    ahead, back = 1 + 1j * forward, 1 - 1j * reverse  # of |e[k+1] - ahead e[k]|² + |back e[k+1] - e[k]|²
    pivot = (np.abs(back[:, :-1]) ** 2 + np.abs(ahead[:, 1:]) ** 2 + 2).astype(complex)
    above = -(ahead.conj() + back)
    x = np.zeros_like(e[:, 1:-1])
    x[:, 0] -= above[:, 0].conj() * e[:, 0]
    x[:, -1] -= above[:, -1] * e[:, -1]
    for k in range(1, x.shape[1]):
        factor = above[:, k].conj() / pivot[:, k - 1]
        pivot[:, k] -= factor * above[:, k]
        x[:, k] -= factor * x[:, k - 1]
    x[:, -1] /= pivot[:, -1]
    for k in reversed(range(x.shape[1] - 1)):
        x[:, k] = (x[:, k] - above[:, k + 1] * x[:, k + 1]) / pivot[:, k]
    return x


def polar_poisson(first: np.ndarray, last: np.ndarray, triangles: np.ndarray, frames: int) -> np.ndarray:
    """The rotation of each triangle's polar decomposition, unwrapped, and its stretch blended apart; then the
    points whose Jacobians are nearest, by the first shape's areas, from one factor for all frames."""
    corners = first[triangles]
    b, c = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    doubled = (b.conj() * c).imag
    # A triangle's Jacobian is z -> alpha z + beta conj(z); its rotation is that of alpha.
    hats = np.stack([c - b, -c, b], axis=1).ravel() / np.repeat(2j * doubled, 3)
    place = np.repeat(np.arange(len(triangles)), 3), triangles.ravel()
    of_alpha = csr_array((-hats.conj(), place), shape=(len(triangles), len(first)))
    of_beta = csr_array((hats, place), shape=of_alpha.shape)
    alpha, beta = of_alpha @ last, of_beta @ last
    angles = smallest_first(np.angle(alpha), triangles)

    areas = np.abs(doubled)
    laplacian = 2 * (of_alpha.conj().T @ (areas[:, None] * of_alpha)).real
    factor = factored(laplacian, first_of_parts(sides(triangles), len(first)))
    points = []
    for t in inbetween_times(frames):
        turn = areas * np.exp(1j * t * angles)
        stretch = np.exp(-1j * np.angle(alpha))
        right = of_alpha.conj().T @ (turn * (1 - t + t * stretch * alpha))
        right += of_beta.conj().T @ (turn * t * stretch * beta)
        points.append(solved(factor, right))
    return centred(np.array(points), first, last)


def sides(triangles: np.ndarray) -> np.ndarray:
    """3m x 2: the sides of each triangle in turn, their smaller vertices first."""
    return np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)


def breadth_first(angles: np.ndarray, edges: np.ndarray, count: int) -> np.ndarray:
    """Whole turns added such that each edge agrees with the one that it is reached from over a vertex."""
    place = np.repeat(np.arange(len(edges)), 2), edges.ravel()
    ends = csr_array((np.ones(edges.size), place), shape=(len(edges), count))
    return along_trees(angles, csr_array(ends @ ends.T))


def smallest_first(angles: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Whole turns added over shared sides, smallest difference first; each part's median is within half a
    turn."""
    edge = sides(triangles) @ [int(triangles.max()) + 1, 1]
    order = np.argsort(edge, kind="stable")
    shared = np.flatnonzero(np.diff(edge[order]) == 0)
    one, other = order[shared] // 3, order[shared + 1] // 3
    apart = np.abs(np.angle(np.exp(1j * (angles[one] - angles[other])))) + 1e-12  # 0 would be no link
    graph = csr_array((apart, (one, other)), shape=(len(angles), len(angles)))
    result = along_trees(angles, minimum_spanning_tree(graph))
    parts, part = connected_components(graph, directed=False)
    for number in range(parts):
        result[part == number] -= whole_turns(np.median(result[part == number]))
    return result


def along_trees(angles: np.ndarray, graph: csr_array) -> np.ndarray:
    result = angles.copy()
    parts, part = connected_components(graph, directed=False)
    for root in [int(np.argmax(part == number)) for number in range(parts)]:
        order, before = breadth_first_order(graph, root, directed=False)
        for node in order[1:]:
            result[node] += whole_turns(result[before[node]] - result[node])
    return result


def whole_turns(angle: float) -> float:
    return float(2 * np.pi * np.round(angle / (2 * np.pi)))


def first_of_parts(edges: np.ndarray, count: int) -> np.ndarray:
    """1 at the first vertex of each part and at isolated vertices, else 0: translations are free."""
    graph = csr_array((np.ones(len(edges)), edges.T), shape=(count, count))
    _, part = connected_components(graph, directed=False)
    held = np.zeros(count)
    held[np.unique(part, return_index=True)[1]] = 1
    return held


def factored(matrix: csc_array, held: np.ndarray) -> SuperLU:
    """The right sides of a part add up to 0, so that what is added to the diagonal holds a vertex exactly."""
    hold = dia_array((held[None] * matrix.diagonal().mean(), [0]), shape=matrix.shape)
    return splu(csc_array(matrix + hold), permc_spec="MMD_AT_PLUS_A")


def solved(factor: SuperLU, right: np.ndarray) -> np.ndarray:
    return factor.solve(right.real) + 1j * factor.solve(right.imag)


def centred(points: np.ndarray, first: np.ndarray, last: np.ndarray) -> np.ndarray:
    times = inbetween_times(len(points))
    centres = (1 - times) * first.mean() + times * last.mean()
    return points + (centres - points.mean(axis=1))[:, None]
