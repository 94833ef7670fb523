# SPDX-License-Identifier: GPL-3.0-or-later
"""One factorization by the system's CHOLMOD, as it comes: what dense solvers are measured against."""

from __future__ import annotations

import ctypes
import ctypes.util
import os
import time

import numpy as np
import scipy.sparse

COMMON = 65536  # bytes; cholmod_common takes a few thousand


class Sparse(ctypes.Structure):
    """cholmod_sparse."""

    _fields_ = (
        *((name, ctypes.c_size_t) for name in ("nrow", "ncol", "nzmax")),
        *((name, ctypes.c_void_p) for name in ("p", "i", "nz", "x", "z")),
        *((name, ctypes.c_int) for name in ("stype", "itype", "xtype", "dtype", "sorted", "packed")),
    )


def system(n: int, triangles: np.ndarray) -> scipy.sparse.csc_matrix:
    """The lower triangle of a Laplacian of the mesh, for two unknowns a vertex that hang together."""
    sides = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    ones = np.ones(len(sides))
    graph = scipy.sparse.coo_matrix((ones, (sides[:, 0], sides[:, 1])), shape=(n, n))
    graph = graph + graph.T
    laplacian = scipy.sparse.diags(np.asarray(graph.sum(axis=0)).ravel() + 1e-3) - graph
    both = scipy.sparse.kron(laplacian, np.array([[1.0, 0.1], [0.1, 1.0]]), format="csc")
    return scipy.sparse.tril(both, format="csc")


def bare_factorization(n: int, triangles: np.ndarray) -> float:
    """Seconds, without the analysis; in one thread, in which it is at its best here (systems.cpp)."""
    for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):  # read where the library is loaded
        os.environ.setdefault(variable, "1")
    cholmod = ctypes.CDLL(ctypes.util.find_library("cholmod"))
    cholmod.cholmod_analyze.restype = ctypes.c_void_p
    matrix = system(n, triangles)
    start, row = matrix.indptr.astype(np.int32), matrix.indices.astype(np.int32)
    common = ctypes.create_string_buffer(COMMON)
    cholmod.cholmod_start(common)
    sparse = Sparse(
        2 * n, 2 * n, len(row), start.ctypes.data, row.ctypes.data, None, matrix.data.ctypes.data, None
    )
    sparse.stype, sparse.xtype, sparse.sorted, sparse.packed = -1, 1, 1, 1
    factor = ctypes.c_void_p(cholmod.cholmod_analyze(ctypes.byref(sparse), common))
    began = time.perf_counter()
    done = cholmod.cholmod_factorize(ctypes.byref(sparse), factor, common)
    seconds = time.perf_counter() - began
    cholmod.cholmod_free_factor(ctypes.byref(factor), common)
    cholmod.cholmod_finish(common)
    if not done:
        raise RuntimeError("CHOLMOD could not factor the matrix")
    return seconds
