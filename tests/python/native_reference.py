# SPDX-License-Identifier: GPL-3.0-or-later
"""Small meshes, and the methods in dense NumPy, written from the formulas of Solomon et al. 2011 (AKVF),
and what method "hold" minimises."""

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


def picked(handles, triangles, n):
    """The k x n matrix that takes values at the vertices to values at the handles, given as the module takes
    them: vertices, or (triangles, barycentric weights)."""
    if not isinstance(handles, tuple):
        return np.eye(n)[handles]
    rows = np.zeros((len(handles[0]), n))
    for row, triangle, weights in zip(rows, *handles, strict=True):
        row[triangles[triangle]] = weights
    return rows


class HoldEnergy:
    """E(x) = sum_t stiffness_t A_t (|J|^2 + |1/J|^2) + sum_k weight_k |pick_k x - target_k|^2, the J of each
    triangle from rest to x; infinite where a triangle is flat or lies the other way round."""

    def __init__(self, rest, triangles, pick, targets, weights, stiffness=None):
        area, gradient = gradients(rest, triangles)
        self.area = area * (np.ones(len(triangles)) if stiffness is None else stiffness)
        self.pick, self.targets, self.weights = pick, targets, weights
        self.size = 2 * len(rest)
        # One row of J after another, from (x_0, y_0, x_1, y_1, ...): m x 4 x 2n.
        self.to_jacobian = np.zeros((len(triangles), 4, self.size))
        for t, corners in enumerate(triangles):
            for axis in range(2):
                self.to_jacobian[t, 2 * axis, 2 * corners + axis] = gradient[t, 0]
                self.to_jacobian[t, 2 * axis + 1, 2 * corners + axis] = gradient[t, 1]

    def _measured(self, x):
        j = self.to_jacobian @ x.ravel()  # m x 4: J00 J01 J10 J11
        slope = j[:, [3, 2, 1, 0]] * [1, -1, -1, 1]  # of the determinant
        return j, slope, (j * slope).sum(axis=1) / 2, (j**2).sum(axis=1)

    def value(self, x):
        _, _, det, square = self._measured(x)
        if not (det > 0).all():
            return np.inf
        off = self.pick @ x - self.targets
        return (self.area * (square + square / det**2)).sum() + (self.weights * (off**2).sum(axis=1)).sum()

    def gradient(self, x):
        """n x 2."""
        j, slope, det, square = self._measured(x)
        of_jacobian = (2 * (1 + det**-2))[:, None] * j - (2 * square * det**-3)[:, None] * slope
        flat = np.einsum("t,ti,tix->x", self.area, of_jacobian, self.to_jacobian)
        return flat.reshape(-1, 2) + 2 * self.pick.T @ (
            self.weights[:, None] * (self.pick @ x - self.targets)
        )

    def projected_hessian(self, x):
        """2n x 2n, each triangle's negative eigenvalues set to 0."""
        j, slope, det, square = self._measured(x)
        turned = np.zeros((4, 4))  # second derivative of the determinant
        turned[0, 3] = turned[3, 0] = 1
        turned[1, 2] = turned[2, 1] = -1
        mixed = np.einsum("ti,tj->tij", j, slope)
        each = (
            (2 * (1 + det**-2))[:, None, None] * np.eye(4)
            - (4 * det**-3)[:, None, None] * (mixed + mixed.swapaxes(1, 2))
            + (6 * square * det**-4)[:, None, None] * np.einsum("ti,tj->tij", slope, slope)
            - (2 * square * det**-3)[:, None, None] * turned
        )
        values, vectors = np.linalg.eigh(each)
        each = (vectors * np.maximum(values, 0)[:, None, :]) @ vectors.swapaxes(1, 2)
        stretched = (self.area[:, None, None] * each) @ self.to_jacobian
        rows = 4 * len(self.area)
        pins = self.pick.T @ (self.weights[:, None] * self.pick)
        return self.to_jacobian.reshape(rows, -1).T @ stretched.reshape(rows, -1) + 2 * np.kron(
            pins, np.eye(2)
        )

    def minimum(self, start):
        """Damped projected Newton from `start`, down to what rounding allows."""
        x, value = start, self.value(start)
        for _ in range(500):
            gradient = self.gradient(x)
            hessian = self.projected_hessian(x) + 1e-9 * self.area.sum() / self.size * np.eye(self.size)
            step = np.linalg.solve(hessian, -gradient.ravel()).reshape(-1, 2)
            slope = (gradient * step).sum()
            length = 1.0
            while length > 1e-9 and not self.value(x + length * step) <= value + 1e-4 * length * slope:
                length /= 2
            if slope > -1e-15 * value or length <= 1e-9:
                return x
            x = x + length * step
            value = self.value(x)
        return x
