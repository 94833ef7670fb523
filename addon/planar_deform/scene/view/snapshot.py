# SPDX-License-Identifier: GPL-3.0-or-later
"""What is shown of the active object: where its pins and edges are in the world, and how distorted it is.

Reading a mesh takes milliseconds, so it is done once and kept until Blender says that something has changed.
While a drag is on, the drag itself tells where everything is.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.plane.frame import Array, Indices
from ...model.posing.pins import Holder
from ...model.posing.pose_action import PinResult
from ..objects.cutout_object import SceneCutout, read_cutout
from ..pins.pin_list import model_pins


@dataclass(frozen=True)
class PinPlace:
    """A pin that can be drawn."""

    key: int  # its index in the object's list
    place: Array  # (3,) in the world
    target: Array  # (3,) where it was asked to be; equal to place when it is there
    turned: Array  # (3,) the direction in the world that was u at rest, turned with the pin
    angle: float  # radians a patch is turned from rest


@dataclass(frozen=True)
class Snapshot:
    """What there is to draw of one object."""

    pins: tuple[PinPlace, ...]
    points: Array  # n x 3 world positions of the cutout's vertices
    edges: Array  # e x 2 indices into them; none unless the mesh's edges are shown
    triangles: Indices  # m x 3 indices into them, as they are solved
    distortion: native.Distortion | None = None  # of the shown shape
    refusal: str | None = None  # why the object cannot be posed, and what to do; then there is nothing else

    def pin(self, key: int) -> PinPlace | None:
        """The pin with this index, None if it has no place (its group is missing or empty)."""
        return next((pin for pin in self.pins if pin.key == key), None)

    @cached_property
    def worst(self) -> tuple[float, float]:
        """The largest distortion of any triangle: area and angle."""
        assert self.distortion is not None
        return float(self.distortion.triangle_area.max()), float(self.distortion.triangle_angle.max())


@dataclass(frozen=True)
class _Kept:
    signature: tuple
    snapshot: Snapshot


_kept: _Kept | None = None
_followed: tuple[str, int] | None = None  # the object that a drag is telling about


def of_active(context: bpy.types.Context) -> Snapshot | None:
    """The active object's snapshot; None if it is no mesh with pins. Changes no data."""
    global _kept
    obj = context.object
    if obj is None or obj.type != "MESH" or not obj.planar.pins:
        return None
    if _followed == (obj.name, obj.session_uid) and _kept is not None:
        return _kept.snapshot
    signature = _signature(obj)
    if _kept is None or _kept.signature != signature:
        _kept = _Kept(signature, _read(obj))
    return _kept.snapshot


def follow(scene: SceneCutout, positions: Array, results: Iterable[PinResult]) -> None:
    """A drag is on: show this until `release`, whatever Blender's updates say."""
    global _kept, _followed
    if _followed is None or _kept is None:
        _followed = (scene.object_name, scene.session_uid)
        edges = _edges(scene)
    else:
        edges = _kept.snapshot.edges
    _kept = _Kept((), _snapshot(scene, positions, results, edges))


def following() -> bool:
    """Whether a drag is on."""
    return _followed is not None


def release() -> None:
    """The drag is over: what is shown is read again."""
    global _followed
    _followed = None
    forget()


def changed() -> None:
    """What is shown may be another one; a drag tells that itself."""
    if _followed is None:
        forget()


def forget() -> None:
    """Read again when it is next asked for."""
    global _kept
    _kept = None


def _signature(obj: bpy.types.Object) -> tuple:
    """All that a snapshot depends on and of whose changes Blender does not tell."""
    pins = tuple((pin.group, pin.kind, pin.has_target, tuple(pin.target)) for pin in obj.planar.pins)
    return obj.name, obj.session_uid, obj.mode, obj.planar.show_mesh, pins


def _read(obj: bpy.types.Object) -> Snapshot:
    try:
        scene = read_cutout(obj)
    except Refusal as refusal:
        nothing = np.empty((0, 3)), np.empty((0, 2), np.int32), np.empty((0, 3), np.int32)
        return Snapshot((), *nothing, refusal=str(refusal))
    results = []
    for pin in model_pins(obj, scene):
        holder = Holder(pin, scene.cutout)
        place = holder.place(scene.positions)
        target = place if pin.target is None else pin.target
        angle = holder.fitted_angle(scene.positions) if pin.kind == "PATCH" else 0.0
        results.append(PinResult(pin.key, holder.part, target, place, angle))
    return _snapshot(scene, scene.positions, results, _edges(scene))


def _edges(scene: SceneCutout) -> Indices:
    """The mesh's own edges, e x 2 in the cutout's indices, without loose ones; none unless they are shown."""
    obj = scene.resolve()
    if not obj.planar.show_mesh:
        return np.empty((0, 2), np.int32)
    pairs = np.empty(len(obj.data.edges) * 2, np.int32)
    obj.data.edges.foreach_get("vertices", pairs)
    rows = np.full(len(obj.data.vertices), -1, np.int32)
    rows[scene.vertex_indices] = np.arange(len(scene.vertex_indices), dtype=np.int32)
    edges = rows[pairs.reshape(-1, 2)]
    return edges[(edges >= 0).all(axis=1)]


def _snapshot(scene: SceneCutout, positions: Array, results: Iterable[PinResult], edges: Indices) -> Snapshot:
    pins = []
    for result in results:
        part = np.array([result.part, result.part], np.int32)
        place, target = scene.to_world(np.array([result.reached, result.target]), part)
        turned = scene.frame.lift(np.array([[np.cos(result.angle), np.sin(result.angle)]]))[0]
        pins.append(PinPlace(result.key, place, target, turned, result.angle))
    cutout = scene.cutout
    return Snapshot(
        tuple(pins),
        scene.to_world(positions, cutout.parts),
        edges,
        cutout.triangles,
        native.distortion(cutout.rest, positions, cutout.triangles),
    )
