# SPDX-License-Identifier: GPL-3.0-or-later
"""Small meshes, and the methods of Solomon et al. 2011 (AKVF) in dense NumPy, written from the formulas."""

import numpy as np


def bar(columns=8, rows=5, hole=True):
    """A jittered grid of (columns + 1) x (rows + 1) vertices; a hole is two triangles less in the middle."""
    x, y = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0))
    vertices = np.column_stack([x.ravel(), y.ravel()])
    vertices += np.random.default_rng(7).uniform(-0.2, 0.2, vertices.shape)
    triangles = []
    for row in range(rows):
        for column in range(columns):
            if hole and (row, column) == (rows // 2, columns // 2):
                continue
            a = row * (columns + 1) + column
            b, c, d = a + 1, a + columns + 1, a + columns + 2
            triangles += [(a, b, d), (a, d, c)]
    return vertices, np.array(triangles)


def gradients(vertices, triangles):
    """Per triangle its area and the 2 x 3 matrix that takes values at its corners to their gradient."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    turned = np.stack([c - b, a - c, b - a], axis=1) @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    doubled = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    return np.abs(doubled) / 2, np.swapaxes(turned, 1, 2) / doubled[:, None, None]


def boundary(triangles):
    """The vertices of edges that belong to one triangle only."""
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    return np.unique(unique[count == 1])


def killing_rows(vertices, triangles, stiffness=None):
    """P of (6) with its rows weighted by the square root of the area, as (2) asks; unknowns are (U1, U2)."""
    n, m = len(vertices), len(triangles)
    area, gradient = gradients(vertices, triangles)
    weight = np.sqrt(area * (np.ones(m) if stiffness is None else stiffness))
    rows = np.zeros((3 * m, 2 * n))
    for t, corners in enumerate(triangles):
        gx, gy = weight[t] * gradient[t]
        rows[3 * t, corners] = 2 * gx
        rows[3 * t + 1, corners] = np.sqrt(2) * gy
        rows[3 * t + 1, corners + n] = np.sqrt(2) * gx
        rows[3 * t + 2, corners + n] = 2 * gy
    return rows


def killing_field(vertices, triangles, handles, velocities, pin_weight, hard, dirichlet, stiffness=None):
    """(7), hard handles by Lagrange multipliers, then (8). `handles` is k x n: weights of the vertices."""
    n = len(vertices)
    rows = killing_rows(vertices, triangles, stiffness)
    energy = rows.T @ rows
    pick = np.kron(np.eye(2), handles)
    wanted = velocities.T.ravel()
    if hard:
        corner = np.zeros((len(pick), len(pick)))
        system = np.block([[energy, pick.T], [pick, corner]])
        field = np.linalg.solve(system, np.concatenate([np.zeros(2 * n), wanted]))[: 2 * n]
    else:
        field = np.linalg.solve(energy + pin_weight * pick.T @ pick, pin_weight * pick.T @ wanted)
    if dirichlet:
        edge = boundary(triangles)
        fixed = np.concatenate([edge, edge + n])
        free = np.setdiff1d(np.arange(2 * n), fixed)
        field[free] = np.linalg.solve(energy[np.ix_(free, free)], -energy[np.ix_(free, fixed)] @ field[fixed])
    return field.reshape(2, n).T


def advance_along_spirals(vertices, triangles, velocities):
    """(14)-(16) without their poles: the mean over a vertex's edges of p + u (e^z - 1) / z."""
    p = vertices @ [1, 1j]
    u = velocities @ [1, 1j]
    neighbours = [set() for _ in p]
    for corners in triangles.tolist():
        for corner in corners:
            neighbours[corner].update(set(corners) - {corner})
    result = p.copy()
    for i, around in enumerate(neighbours):
        ends = []
        for j in around:
            z = (u[i] - u[j]) / (p[i] - p[j])
            ends.append(p[i] + u[i] * (np.expm1(z) / z if abs(z) > 1e-6 else 1 + z / 2))
        if ends:
            result[i] = np.mean(ends)
    return np.column_stack([result.real, result.imag])


def distortion(rest, posed, triangles):
    """E_area and E_angle per triangle from singular values (AKVF, section 3.3), and the areas at rest."""
    area, gradient = gradients(rest, triangles)
    jacobian = np.swapaxes(posed[triangles], 1, 2) @ np.swapaxes(gradient, 1, 2)
    first, second = np.linalg.svd(jacobian, compute_uv=False).T
    return first * second + 1 / (first * second), first / second + second / first, area
