# SPDX-License-Identifier: GPL-3.0-or-later
"""Deforms planar triangle meshes by handles: holding the rest shape, as-Killing-as-possible fields
(AKVF), or as rigid as possible in two linear steps (ARAP).

NumPy arrays go in and out: positions are n x 2 float64 in any unit of length, triangles m x 3 vertex indices
of either orientation. Real and integer arrays of any layout are converted; nothing passed in changes.

Handles, k of them, are given as vertex indices (an integer array of k) or as points inside triangles: a tuple
(triangle indices k, barycentric weights k x 3).

Errors: ValueError names the argument and, where there is one, the row; TypeError is for options of a wrong
type; SolveError (a RuntimeError) is a numerical failure. A call that raises leaves every object as it was.

Every solve runs without the GIL.
"""

from ._core import (
    Cancelled,
    Cutout,
    Distortion,
    Flattener,
    Harmonic,
    Inbetweens,
    Keyed,
    LatticeReport,
    LatticeSolver,
    Outline,
    Poser,
    Report,
    SolveError,
    TransitionReport,
    advance_along_spirals,
    arap_two_step,
    build_info,
    cutout,
    distortion,
    edit_sequence,
    flatten,
    inbetween,
    key_colour,
    killing_field,
    lattice_weights,
    outline,
    transfer_motion,
)

__all__ = [
    "Cancelled",
    "Cutout",
    "Distortion",
    "Flattener",
    "Harmonic",
    "Inbetweens",
    "Keyed",
    "LatticeReport",
    "LatticeSolver",
    "Outline",
    "Poser",
    "Report",
    "SolveError",
    "TransitionReport",
    "advance_along_spirals",
    "arap_two_step",
    "build_info",
    "cutout",
    "distortion",
    "edit_sequence",
    "flatten",
    "inbetween",
    "key_colour",
    "killing_field",
    "lattice_weights",
    "outline",
    "transfer_motion",
]
