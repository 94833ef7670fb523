# SPDX-License-Identifier: GPL-3.0-or-later
"""What the figures are measured on: characters with poses from a folder, a bar, and figures known before."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np

# Area and angle distortion of the prototype of METHODS 1 "hold the rest shape" (NumPy, 20 straight moves per
# handle, mu = 1e3) on poses of Chen & Weber 2017; one pair a pose.
PROTOTYPE = {
    "elephant": [(2.020, 2.039)],
    "giraffe": [(2.059, 2.120), (2.037, 2.059)],
    "horse": [(2.015, 2.028), (2.022, 2.034), (2.034, 2.054), (2.126, 2.182), (2.130, 2.163)],
    "racoon": [(2.030, 2.040), (2.022, 2.028), (2.003, 2.004), (2.015, 2.023)],
}


@dataclasses.dataclass(frozen=True)
class Pose:
    """Handles (k vertices), where they go (k x 2), and the prototype's distortion where it is known."""

    name: str
    handles: np.ndarray
    targets: np.ndarray
    prototype: tuple[float, float] | None = None


@dataclasses.dataclass(frozen=True)
class Shape:
    """A rest shape n x 2 with triangles m x 3."""

    name: str
    rest: np.ndarray
    triangles: np.ndarray
    poses: list[Pose]

    @property
    def diagonal(self) -> float:
        return float(np.linalg.norm(np.ptp(self.rest, axis=0)))


def read_shape(obj: Path) -> Shape:
    """A Wavefront OBJ in its x-y plane; its poses from the JSON file beside it, if there is one.

    The JSON is {"poses": [{"src": k x 2, "dst": k x 2}, ...]}. A handle is the vertex nearest to `src`; its
    target is `dst` plus the difference between the two.
    """
    vertices, corners = [], []
    for line in obj.read_text().splitlines():
        kind, *words = line.split() or [""]
        if kind == "v":
            vertices.append([float(word) for word in words[:2]])
        elif kind == "f":
            if len(words) != 3:
                raise ValueError(f"{obj}: a face with {len(words)} corners; only triangles can be read")
            corners.append([int(word.split("/")[0]) - 1 for word in words])
    rest, triangles = np.array(vertices), np.array(corners)
    poses = []
    notes = obj.with_suffix(".json")
    for number, pose in enumerate(json.loads(notes.read_text())["poses"] if notes.exists() else []):
        source, target = np.array(pose["src"]), np.array(pose["dst"])
        handles = np.argmin(np.linalg.norm(rest[None] - source[:, None], axis=2), axis=1)
        known = PROTOTYPE.get(obj.stem, [])[number : number + 1]
        poses.append(Pose(f"{obj.stem} {number}", handles, target + rest[handles] - source, *known))
    return Shape(obj.stem, rest, triangles, poses)


def spread(shape: Shape, count: int) -> np.ndarray:
    """Vertices far from each other, for a shape without poses: each the furthest from those before it."""
    distance = np.linalg.norm(shape.rest - shape.rest.mean(axis=0), axis=1)
    chosen = [int(np.argmax(distance))]
    distance = np.full(len(shape.rest), np.inf)
    while len(chosen) < count:
        distance = np.minimum(distance, np.linalg.norm(shape.rest - shape.rest[chosen[-1]], axis=1))
        chosen.append(int(np.argmax(distance)))
    return np.array(chosen)


def arc_targets(rest: np.ndarray, handles: np.ndarray, columns: int, rows: int, degrees: float) -> np.ndarray:
    """Where a regular bar's handles are when its middle line is bent into an arc of its length."""
    bend = np.radians(degrees)
    angle = bend * (rest[handles, 0] / columns - 0.5)
    radius = columns / bend - (rest[handles, 1] - rows / 2)
    targets = np.column_stack([radius * np.sin(angle), columns / bend - radius * np.cos(angle)])
    return targets + np.array([columns, rows]) / 2


def bent_bar(columns: int = 159, rows: int = 31) -> Shape:
    """A regular bar of (columns + 1) x (rows + 1) vertices, all of its two ends' as handles.

    Its poses turn the ends by 90 and 120 degrees against each other, to where they are when the middle line
    is bent into an arc of its length.
    """
    x, y = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0))
    rest = np.column_stack([x.ravel(), y.ravel()])
    corner = (np.arange(columns) + (columns + 1) * np.arange(rows)[:, None]).ravel()
    above = corner + columns + 1
    triangles = np.concatenate(
        [np.column_stack([corner, corner + 1, above + 1]), np.column_stack([corner, above + 1, above])]
    )
    handles = np.flatnonzero((rest[:, 0] == 0) | (rest[:, 0] == columns))
    poses = [
        Pose(f"bar {degrees} deg", handles, arc_targets(rest, handles, columns, rows, degrees))
        for degrees in (90, 120)
    ]
    return Shape("bar", rest, triangles, poses)


def half_split(shape: Shape) -> Shape:
    """The shape with the triangles of its left half cut into four, and those beside them to match.

    The first vertices are the shape's own.
    """
    middle = shape.rest[shape.triangles].mean(axis=1)[:, 0]
    points, at = list(shape.rest), {}
    for a, b, c in shape.triangles[middle < np.median(middle)].tolist():
        for edge in ((a, b), (b, c), (c, a)):
            if frozenset(edge) not in at:
                at[frozenset(edge)] = len(points)
                points.append(shape.rest[list(edge)].mean(axis=0))
    cut: list[tuple[int, int, int]] = []
    rest = [tuple(corners) for corners in shape.triangles.tolist()]
    while rest:  # at the first side that is to be cut, until none is
        a, b, c = rest.pop()
        sides = ((a, b, c), (b, c, a), (c, a, b))
        halved = [(*side, at[frozenset(side[:2])]) for side in sides if frozenset(side[:2]) in at]
        if len(halved) == 3:
            ab, bc, ca = (middle for *_, middle in halved)
            cut += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        elif halved:
            start, end, other, middle_ = halved[0]
            rest += [(start, middle_, other), (middle_, end, other)]
        else:
            cut.append((a, b, c))
    return Shape(f"{shape.name}, half split", np.array(points), np.array(cut), shape.poses)


def rolled(bar: Shape, angle: float) -> np.ndarray:
    """A regular bar bent along its length into an arc of `angle`; its middle line keeps its length."""
    x, y = (bar.rest - bar.rest.mean(axis=0)).T
    length = float(np.ptp(x))
    radius = length / angle - y
    return np.column_stack([radius * np.sin(angle * x / length), -radius * np.cos(angle * x / length)])
