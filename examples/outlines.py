# SPDX-License-Identifier: GPL-3.0-or-later
"""What a cutout of each drawing is: its outline and its mesh, over the drawing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

import planar_native

FINE = 2  # drawn larger, so that lines are smooth
GROUND = (226, 228, 220)
OUTLINE = (232, 110, 20)
EDGES = (20, 20, 24, 230)
FADED = 0.5  # of a drawing under its mesh
DRAWINGS = ("Lantern Fox Body", "Lantern Fox Lantern Arm", "Lantern Fox Tail", "River Dragon")
WISHES = (1500, 400)
CELL = (430, 430)

Cell = tuple[str, str, Image.Image]  # label, note, picture


def rows(folder: Path) -> list[list[Cell]]:
    """For each drawing its outline, and meshes of it, from fine to coarse."""
    found = []
    for name in DRAWINGS:
        with Image.open(folder / f"{name}.png") as file:
            drawing = file.convert("RGBA")
        drawing = drawing.crop(drawing.getbbox())
        alpha = np.asarray(drawing.getchannel("A"))[::-1]
        cutouts = [planar_native.cutout(alpha, vertices=wish) for wish in WISHES]
        around = cutouts[0].outline
        holes = f", {around.holes} hole{'s' if around.holes > 1 else ''}" if around.holes else ""
        cells = [(name, f"{drawing.width} x {drawing.height} pixels{holes}", _over(drawing, around.rings))]
        for cutout in cutouts:
            rings = [cutout.points[ring] for ring in cutout.rings]
            picture = _over(drawing, rings, cutout.points[_edges(cutout.triangles)])
            cells.append((f"{len(cutout.points)} vertices", f"edges of {cutout.edge:.0f} pixels", picture))
        found.append(cells)
    return found


def _over(drawing: Image.Image, rings: list[np.ndarray], edges: np.ndarray | None = None) -> Image.Image:
    """The drawing in a cell, with closed lines and edges (e x 2 x 2), in its pixels from the lower left."""
    size = np.array(CELL) * FINE
    scale = 0.92 * min(size / np.array(drawing.size))
    large = drawing.resize([round(scale * side) for side in drawing.size], Image.Resampling.LANCZOS)
    corner = (size - large.size) // 2
    paper = Image.new("RGB", tuple(size), GROUND)
    shown = 1.0 if edges is None else FADED
    paper.paste(large, tuple(corner.tolist()), mask=large.getchannel("A").point(lambda value: shown * value))
    draw = ImageDraw.Draw(paper, "RGBA")

    def pixels(points: np.ndarray) -> np.ndarray:
        return (points * [1, -1] + [0, drawing.height]) * scale + corner

    for a, b in [] if edges is None else pixels(edges):
        draw.line((*a, *b), fill=EDGES, width=1)
    for ring in rings:
        draw.line([tuple(point) for point in pixels(np.concatenate([ring, ring[:2]]))], fill=OUTLINE, width=4)
    return paper.resize(CELL, Image.Resampling.LANCZOS)


def _edges(triangles: np.ndarray) -> np.ndarray:
    return np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
