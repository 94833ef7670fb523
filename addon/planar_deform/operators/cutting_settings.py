# SPDX-License-Identifier: GPL-3.0-or-later
"""How an image is cut out, as the panels of operators ask for it."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty

from ..model.image.cutting import Settings

DENSITIES = (
    ("VERTICES", "Vertices", "About as many vertices as wished; thin parts get shorter edges"),
    ("EDGE", "Edge Length", "Edges of this length where nothing asks for shorter ones"),
)
HOLES = (
    ("KEEP", "Keep", "Holes of the drawing are holes of the mesh, unless no triangle would fit in"),
    ("FILL", "Fill", "The mesh covers the holes of the drawing"),
)


class CuttingSettings:
    """The properties of operators that make meshes of images."""

    density: EnumProperty(name="Density", description="What tells how fine the mesh is", items=DENSITIES)
    vertices: IntProperty(
        name="Vertices",
        description="Wished for each image",
        default=1500,
        min=3,
        max=2_000_000,
        soft_max=20_000,
    )
    edge: FloatProperty(
        name="Edge Length",
        description="In pixels of the image",
        default=20.0,
        min=0.01,
        soft_max=200.0,
        subtype="PIXEL",
    )
    finest: FloatProperty(
        name="Finest",
        description="How many times shorter than elsewhere edges may be where the drawing is thin",
        default=6.0,
        min=1.0,
        max=100.0,
        soft_max=12.0,
    )
    margin: FloatProperty(
        name="Margin",
        description="How far the outline stays away from the drawing, in pixels. 0: a tenth of an edge",
        default=0.0,
        min=0.0,
        soft_max=100.0,
        subtype="PIXEL",
    )
    threshold: FloatProperty(
        name="Threshold",
        description="Pixels of a larger alpha belong to the drawing",
        default=0.05,
        min=0.0,
        max=0.99,
        subtype="FACTOR",
    )
    holes: EnumProperty(name="Holes", description="What becomes of holes", items=HOLES)
    smallest: FloatProperty(
        name="Smallest Part",
        description="Parts of a smaller share of the drawing are left out. 0: specks are",
        default=0.0,
        min=0.0,
        max=99.0,
        soft_max=10.0,
        precision=3,
        subtype="PERCENTAGE",
    )

    def settings(self) -> Settings:
        """All of them."""
        return Settings(
            vertices=self.vertices,
            edge=self.edge if self.density == "EDGE" else None,
            margin=self.margin or None,
            threshold=self.threshold,
            holes=self.holes,
            smallest=self.smallest / 100.0 or None,
            finest=self.finest,
        )

    def draw_cutting(self, column: bpy.types.UILayout, *, of_image: bool = True) -> None:
        """Draw them; not `of_image`: those that an outline without an image has."""
        column.row().prop(self, "density", expand=True)
        column.prop(self, "vertices" if self.density == "VERTICES" else "edge")
        for name in ("finest", "margin", *(("threshold",) if of_image else ())):
            column.prop(self, name)
        column.row().prop(self, "holes", expand=True)
        if of_image:
            column.prop(self, "smallest")
