# SPDX-License-Identifier: GPL-3.0-or-later
"""A flat mesh as a pattern for paper or cloth."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np

from ...errors import Refusal
from ...model.flatten.patches import Patches, cut
from ...model.flatten.pattern_svg import pattern_svg
from ..storage.topology import corner_edges
from .link import EDGE_NUMBER, numbers_of
from .pushing import shown_places
from .surface import corners_of, triangles_of


def patches_of(mesh: bpy.types.Mesh) -> Patches:
    """The patches of a flat mesh as they are; `vertices` and `corners` are the flat mesh's own."""
    faces, edges = np.ones(len(mesh.polygons), bool), np.zeros(len(mesh.edges), bool)
    try:
        return cut(corners_of(mesh), faces, edges, triangles_of(mesh))
    except ValueError as error:
        raise Refusal(f"'{mesh.name}' is not flat any more: {error}") from error


def export(obj: bpy.types.Object, path: Path, scale_length: float) -> None:
    """Write a flat mesh as it is shown to an SVG, at its true size. Raises Refusal."""
    mesh = obj.data
    if not mesh.polygons:
        raise Refusal(f"'{obj.name}' has no faces: undo their deletion, or lay the surface flat again")
    patches = patches_of(mesh)
    numbers = numbers_of(mesh, EDGE_NUMBER)
    if numbers is not None:
        patches = replace(patches, numbers=numbers[corner_edges(mesh)])
    places = shown_places(obj)[patches.vertices] * (1000.0 * scale_length)
    try:
        path.write_text(pattern_svg(patches, places, obj.name), encoding="utf-8")
    except OSError as error:
        raise Refusal(f"The pattern cannot be written: {error.strerror}: {path}") from error
