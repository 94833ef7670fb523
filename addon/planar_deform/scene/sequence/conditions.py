# SPDX-License-Identifier: GPL-3.0-or-later
"""What in-betweens are made with beside their poses: pins and their paths, scale, timing, a coarse mesh."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ... import compat
from ...model.posing.joints import KINDS as JOINTS
from ..storage import digests, pin_paths
from ..storage.cage import cage_of

WHAT = ("pins", "scale", "timing", "coarse solving", "paths of pins")


@dataclass(frozen=True)
class Conditions:
    """Of an object, in short."""

    pins: str  # which vertices, or points of a lattice, the enabled ones hold
    scale: str  # in the plane, of the object alone; empty while it is animated
    paths: Mapping[str, str]  # of the pins, by the name of the pose behind which they are
    coarse: str  # about how many vertices the mesh has on which it is solved; empty: its own

    def of(self, durations: Sequence[float], transition: int, smooth: bool, pose: str) -> str:
        """Those of a transition, behind a pose, among others that last so many frames."""
        timing = ""
        if smooth:  # then the speed at the poses depends on how long the neighbours take
            around = np.asarray(durations[max(0, transition - 1) : transition + 2], float)
            shares = np.round(around / around.sum(), 3)
            timing = " ".join(f"{share:g}" for share in shares)
        return "|".join((self.pins, self.scale, timing, self.coarse, self.paths.get(pose, "")))


def conditions(obj: bpy.types.Object) -> Conditions:
    """Cheap as long as the object's vertex groups stay what they are."""
    return Conditions(_pins(obj), _scale(obj), pin_paths.stamps(obj), str(cage_of(obj) or ""))


def changed(then: str, now: str) -> list[str]:
    """What of the conditions is another than it was; nothing where it is not known."""
    # What an older file does not tell was not there.
    pairs = itertools.zip_longest(WHAT, then.split("|"), now.split("|"), fillvalue="")
    return [what for what, before, after in pairs if then and before != after]


def _pins(obj: bpy.types.Object) -> str:
    enabled = [pin for pin in obj.planar.pins if pin.enabled]
    if obj.type == "MESH":
        hung = [pin.group for pin in enabled if pin.kind in JOINTS]
        pins = [pin.group for pin in enabled if pin.kind not in JOINTS]
        parts = [digests.of_groups(obj, groups) if groups else "" for groups in (pins, hung)]
        return "+".join(parts) if hung else parts[0]
    held = [str(pin.lattice_point) for pin in enabled if pin.lattice_point >= 0]
    for pinned in {pin.object for pin in enabled if pin.object is not None}:
        held.append(digests.of_groups(pinned, [pin.group for pin in enabled if pin.object == pinned]))
    return digests.digest(",".join(sorted(held)).encode()) if held else ""


def _scale(obj: bpy.types.Object) -> str:
    if any(
        curve.data_path in {"scale", "delta_scale"} for curve in compat.curves_of(obj.animation_data) or ()
    ):
        return ""
    corners = np.array(obj.bound_box)
    extent = corners.max(axis=0) - corners.min(axis=0)
    sizes = np.abs(np.array(obj.scale) * np.array(obj.delta_scale))[extent > 1e-6 * extent.max()]
    # As large as it is does not count, only how it is stretched.
    return " ".join(f"{share:.3f}" for share in sizes / sizes.max()) if len(sizes) and sizes.max() else ""
