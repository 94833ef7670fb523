# SPDX-License-Identifier: GPL-3.0-or-later
"""The compiled solvers: the one place that imports them."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path
from typing import Literal, TypedDict

import numpy as np
from numpy.typing import NDArray

from .errors import RestartNeeded

_in_memory = "planar_native" in sys.modules
try:
    import planar_native

    _found = planar_native.build_info()["version"]
except (ImportError, AttributeError) as error:  # the latter where all but the folder has gone
    raise ImportError(
        "Planar Deform's compiled module cannot be loaded on this platform or Python version: "
        "install the extension file made for this system"
    ) from error

# Both are made together, and of one version.
with Path(__file__).with_name("blender_manifest.toml").open("rb") as _file:
    _needed = tomllib.load(_file)["version"]
if _found != _needed:
    if _in_memory:  # no process lets go of a compiled module
        raise RestartNeeded(
            f"Restart Blender to finish the update of Planar Deform from version {_found} to {_needed}"
        )
    raise ImportError(
        f"Planar Deform needs version {_needed} of its compiled module and found {_found}: "
        "remove other copies of the extension, install it again and restart Blender"
    )

Method = Literal["hold", "akvf", "arap"]


class Elements(TypedDict, total=False):
    """What joins points, counted from 0, as the solvers take it: one of the two."""

    triangles: NDArray[np.int32]  # m x 3
    edges: NDArray[np.int32]  # e x 2


FlattenMethod = Literal["hold", "two_step"]
EdgeWeights = Literal["cotangent", "uniform"]
LatticeBasis = Literal["BERNSTEIN", "LINEAR", "CARDINAL", "CATMULL_ROM", "BSPLINE"]
# A sparse matrix by rows: where each row begins, columns, values.
LatticeWeights = tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]

Cancelled = planar_native.Cancelled
Distortion = planar_native.Distortion
Flattener = planar_native.Flattener
Inbetweens = planar_native.Inbetweens
LatticeReport = planar_native.LatticeReport
LatticeSolver = planar_native.LatticeSolver
Poser = planar_native.Poser
Report = planar_native.Report
SolveError = planar_native.SolveError
cutout = planar_native.cutout
distortion = planar_native.distortion
edit_sequence = planar_native.edit_sequence
harmonic = planar_native.harmonic
key_colour = planar_native.key_colour
lattice_weights = planar_native.lattice_weights
transfer_motion = planar_native.transfer_motion
