# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of a mesh's vertices, corners and faces, among them its UV maps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...model.plane.carrying import Carrying
from ..storage.migration import OWNER, REST, SEEN

# The field and the size of each kind. Between vertices the first ones are blended; the others do not change.
BLENDED = {
    "FLOAT": ("value", 1),
    "FLOAT2": ("vector", 2),
    "FLOAT_VECTOR": ("vector", 3),
    "FLOAT_COLOR": ("color", 4),
    "BYTE_COLOR": ("color", 4),
}
FIELDS = BLENDED | {
    "INT": ("value", 1),
    "INT8": ("value", 1),
    "BOOLEAN": ("value", 1),
    "INT16_2D": ("value", 2),
    "INT32_2D": ("value", 2),
    "QUATERNION": ("value", 4),
    "FLOAT4X4": ("value", 16),
}
OURS = frozenset((REST, OWNER, SEEN))
BUILT_IN = frozenset(("position", "material_index", "sharp_face"))  # belong to vertices and faces themselves


@dataclass(frozen=True)
class Attribute:
    """One of a mesh."""

    name: str
    domain: str  # POINT, CORNER or FACE
    kind: str
    values: NDArray[Any]  # count x size

    @property
    def is_map(self) -> bool:
        """Whether it lays an image on the mesh: it goes on outside of the mesh as it does within."""
        return self.domain == "CORNER" and self.kind == "FLOAT2"

    def carried(self, carrying: Carrying) -> NDArray[Any]:
        """Its values at the points, or corners, of another mesh."""
        if self.kind in BLENDED:
            weights = carrying.weights if self.is_map else carrying.within
            blended: NDArray[Any] = np.einsum(
                "kc,kcd->kd", weights, self.values.astype(np.float64)[carrying.corners]
            )
            return blended
        nearest = carrying.corners[np.arange(len(carrying.weights)), carrying.weights.argmax(axis=1)]
        chosen: NDArray[Any] = self.values[nearest]
        return chosen


def read(mesh: bpy.types.Mesh) -> list[Attribute]:
    """All that can be carried to another mesh."""
    found = []
    for attribute in filter(_is_carried, _own(mesh)):
        field, size = FIELDS[attribute.data_type]
        values: NDArray[Any] = np.empty(len(attribute.data) * size, _type_of(attribute.data_type))
        attribute.data.foreach_get(field, values)
        found.append(
            Attribute(attribute.name, attribute.domain, attribute.data_type, values.reshape(-1, size))
        )
    return found


def not_read(mesh: bpy.types.Mesh) -> list[str]:
    """The names of those that cannot."""
    return [attribute.name for attribute in _own(mesh) if not _is_carried(attribute)]


def _own(mesh: bpy.types.Mesh) -> list[bpy.types.Attribute]:
    return [
        attribute
        for attribute in mesh.attributes
        if attribute.name not in OURS | BUILT_IN and not attribute.name.startswith(".")
    ]


def _is_carried(attribute: bpy.types.Attribute) -> bool:
    return attribute.domain in {"POINT", "CORNER", "FACE"} and attribute.data_type in FIELDS


def write(mesh: bpy.types.Mesh, attribute: Attribute, values: NDArray[Any]) -> None:
    """Give an attribute, which the mesh has, its values."""
    field, _ = FIELDS[attribute.kind]
    data = mesh.attributes[attribute.name].data
    data.foreach_set(field, np.ascontiguousarray(values, dtype=_type_of(attribute.kind)).ravel())


def _type_of(kind: str) -> type:
    if kind == "BOOLEAN":
        return np.bool_
    return np.int32 if kind.startswith("INT") else np.float32
