# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins on a cutout: where they hold it, and the handles the solver gets."""

from __future__ import annotations

import math
from copy import copy
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from ..plane.cutout import Cutout
from ..plane.frame import Array, Indices
from ..plane.locate import MeshPoint, at, nearest_point
from ..plane.space import nearest_in_space

Kind = Literal["POINT", "PATCH"]
AS_AT_REST = 0.02  # of a patch that nobody has scaled: grown by less it is held as large as at rest
LEAST_SCALE = 0.05  # a patch of no size would have no shape


@dataclass(frozen=True)
class Pin:
    """One pin with a usable vertex group."""

    key: int  # its index in the object's pin list
    kind: Kind
    vertices: Indices  # cutout vertices of the group whose weight is not 0
    weights: Array  # their weights in the group, all positive
    enabled: bool = True
    weight: float = 1.0  # how strongly the pin holds, relative to what the method does by itself
    angle: float = 0.0  # radians a patch is turned from rest
    scale: float = 1.0  # what a patch has grown by since rest
    target: Array | None = None  # (2,) where the pin was asked to be, None: wherever it is


class Holder:
    """A pin bound to a cutout: the mesh points by which it holds it."""

    def __init__(self, pin: Pin, cutout: Cutout):
        self.pin, self.cutout = pin, cutout
        self.shares = pin.weights / pin.weights.sum()
        self.part = int(cutout.parts[pin.vertices[0]])  # whose depth the pin is drawn in
        rest_centre = self.shares @ cutout.rest[pin.vertices]
        self._arms = cutout.rest[pin.vertices] - rest_centre
        self._point = None if pin.kind == "PATCH" else _point_at(pin, self.shares, rest_centre, cutout)

    def holding(self, pin: Pin, cutout: Cutout) -> Holder:
        """This one where it holds the cutout as the pin does now, with the pin's settings; else a new one."""
        mine = self.pin
        if self.cutout is not cutout or (mine.kind, len(mine.vertices)) != (pin.kind, len(pin.vertices)):
            return Holder(pin, cutout)
        if not (np.array_equal(mine.vertices, pin.vertices) and np.array_equal(mine.weights, pin.weights)):
            return Holder(pin, cutout)
        held = copy(self)
        held.pin = pin
        return held

    def place(self, positions: Array) -> Array:
        """Where the pin is (2,) on n x 2 positions: its point, or the weighted centre of its patch."""
        if self._point is None:
            centre: Array = self.shares @ positions[self.pin.vertices]
            return centre
        return at(positions, self.cutout.triangles, self._point)

    def fitted_angle(self, positions: Array) -> float:
        """The turn from rest (radians) that fits a patch best; the pin's own angle where none is defined."""
        if self.pin.kind == "POINT":
            return self.pin.angle
        arms = positions[self.pin.vertices] - self.place(positions)
        along = float(self.shares @ (self._arms[:, :2] * arms[:, :2]).sum(axis=1))
        across = float(self.shares @ (self._arms[:, 0] * arms[:, 1] - self._arms[:, 1] * arms[:, 0]))
        return math.atan2(across, along) if along or across else self.pin.angle

    @property
    def size(self) -> float:
        """Of a patch at rest: how far its vertices are from its middle, in the mean of squares."""
        return math.sqrt(float(self.shares @ (self._arms[:, :2] ** 2).sum(axis=1)))

    def fitted_scale(self, positions: Array) -> float:
        """What a patch has grown by since rest, by the similarity that fits it best; 1 where none does."""
        size, angle = self.size, self.fitted_angle(positions)
        if self.pin.kind == "POINT" or not size:
            return 1.0
        arms = positions[self.pin.vertices] - self.place(positions)
        along = (turned(self._arms[:, :2], angle) * arms[:, :2]).sum(axis=1)
        return float(self.shares @ along) / size**2

    def held_scale(self, positions: Array) -> float:
        """What a patch is held at of which nothing was asked: what it has grown by, if that is seen."""
        scale = self.fitted_scale(positions)
        return 1.0 if abs(scale - 1.0) < AS_AT_REST else max(scale, LEAST_SCALE)

    def handle_vertices(self) -> tuple[Indices, Array]:
        """Triangles (k,) and barycentric weights k x 3 of the pin's handles."""
        if self._point is not None:
            return np.array([self._point.triangle], np.int32), self._point.weights[None, :]
        # A patch holds vertices: each as a corner of some triangle it belongs to.
        corners = self.cutout.first_corners[self.pin.vertices]
        weights = np.zeros((len(corners), 3))
        weights[np.arange(len(corners)), corners % 3] = 1.0
        return (corners // 3).astype(np.int32), weights

    def handle_targets(self, target: Array, angle: float, scale: float = 1.0) -> Array:
        """Where the handles should be (k x 2) when the pin is at `target`, turned and scaled from rest."""
        if self._point is not None:
            return target[None, :]
        return target + scale * turned(self._arms, angle)

    def as_shown(self, positions: Array) -> Holder:
        """This one with its patch, unturned and unscaled, as n x 3 positions have it: no angle tells that."""
        shown = copy(self)
        shown.pin = replace(self.pin, angle=0.0, scale=1.0)
        shown._arms = positions[self.pin.vertices] - self.place(positions)
        return shown


def rotation(angle: float) -> Array:
    """The 2 x 2 matrix that turns counter-clockwise by an angle in radians."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])


def turned(offsets: Array, angle: float) -> Array:
    """Offsets, one or k, turned in the plane; a third coordinate stays."""
    flat: Array = offsets[..., :2] @ rotation(angle).T
    return flat if offsets.shape[-1] == 2 else np.concatenate([flat, offsets[..., 2:]], axis=-1)


def _point_at(pin: Pin, shares: Array, centre: Array, cutout: Cutout) -> MeshPoint:
    """The mesh point of a point pin, looked for once in a cutout."""
    asked = pin.vertices.tobytes() + shares.tobytes()
    if asked not in cutout.found:
        cutout.found[asked] = _find_point(pin, shares, centre, cutout)
    return cutout.found[asked]


def _find_point(pin: Pin, shares: Array, centre: Array, cutout: Cutout) -> MeshPoint:
    """The group's weighted centre on the rest shape.

    A group that fits into one triangle gives its weights directly, which is exact; any other is looked up in
    the connected parts it touches, and the nearest point of those is taken where the centre lies outside of
    the mesh.
    """
    triangles = cutout.triangles
    if len(pin.vertices) <= 3:
        about = np.flatnonzero(triangles.ravel() == pin.vertices[0]) // 3
        inside = [triangle for triangle in about.tolist() if set(pin.vertices) <= set(triangles[triangle])]
        if inside:
            weights = np.zeros(3)
            for vertex, share in zip(pin.vertices, shares, strict=True):
                weights[np.flatnonzero(triangles[inside[0]] == vertex)[0]] = share
            return MeshPoint(inside[0], weights)
    parts = np.unique(cutout.parts[pin.vertices])
    among = np.flatnonzero(np.isin(cutout.parts[triangles[:, 0]], parts)).astype(np.int32)
    nearest = nearest_point if cutout.rest.shape[1] == 2 else nearest_in_space
    point = nearest(cutout.rest, triangles, centre, among)
    assert point is not None  # every cutout vertex belongs to a triangle
    return point
