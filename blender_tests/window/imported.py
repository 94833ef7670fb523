# SPDX-License-Identifier: GPL-3.0-or-later
"""A drawing that comes from another program: a PNG, and an OBJ of squares over it, in its pixels."""

from pathlib import Path

import bpy
import numpy as np

WIDTH, HEIGHT = 480, 640  # pixels
SQUARE = 16  # side of a face, in pixels

# Strokes of a doll: from, to, radius, colour.
INK, SKIN, RED, BLUE = (0.10, 0.08, 0.12), (0.93, 0.72, 0.55), (0.80, 0.22, 0.20), (0.20, 0.34, 0.62)
STROKES = (
    ((195, 260), (180, 60), 30, BLUE),
    ((285, 260), (300, 60), 30, BLUE),
    ((200, 420), (70, 390), 24, SKIN),
    ((280, 420), (410, 390), 24, SKIN),
    ((240, 420), (240, 290), 72, RED),
    ((240, 545), (240, 555), 66, SKIN),
    ((216, 565), (216, 565), 7, INK),
    ((264, 565), (264, 565), 7, INK),
    ((222, 520), (258, 520), 4, INK),
)
# Where its pins belong, in pixels.
HEAD, BELLY, LEFT_HAND, RIGHT_HAND = (240, 560), (240, 300), (70, 390), (410, 390)
LEFT_FOOT, RIGHT_FOOT = (180, 60), (300, 60)


def painted() -> np.ndarray:
    """RGBA, rows from the bottom, as Blender's pixels."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH].astype(float)
    picture = np.zeros((HEIGHT, WIDTH, 4), np.float32)
    for start, end, radius, colour in STROKES:
        (ax, ay), (bx, by) = start, end
        dx, dy = bx - ax, by - ay
        along = np.clip(((x - ax) * dx + (y - ay) * dy) / max(dx * dx + dy * dy, 1), 0, 1)
        distance = np.hypot(x - ax - along * dx, y - ay - along * dy)
        for reach, ink in ((radius, INK), (radius - 4, colour)):
            share = np.clip(reach - distance, 0, 1)[..., None]
            picture[..., :3] += share * (np.array(ink) - picture[..., :3])
            picture[..., 3:] = np.maximum(picture[..., 3:], share)
    return picture


def save_png(path: Path, picture: np.ndarray) -> Path:
    """Pixels h x w x 4, rows from the bottom, as a file alone."""
    height, width = picture.shape[:2]
    image = bpy.data.images.new(path.stem, width, height, alpha=True)
    image.pixels.foreach_set(picture.ravel())
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)
    return path


def import_doll(folder: Path) -> bpy.types.Object:
    """The doll drawn, written as doll.png and doll.obj, and imported by Blender's own importer."""
    picture = painted()
    save_png(folder / "doll.png", picture)
    squares = [
        (x, y)
        for y in range(0, HEIGHT, SQUARE)
        for x in range(0, WIDTH, SQUARE)
        if picture[y : y + SQUARE, x : x + SQUARE, 3].any()
    ]
    corners = sorted({(x + i, y + j) for x, y in squares for i in (0, SQUARE) for j in (0, SQUARE)})
    number = {corner: index + 1 for index, corner in enumerate(corners)}
    lines = ["mtllib doll.mtl", "o Doll", *(f"v {x} {y} 0" for x, y in corners)]
    lines += [f"vt {x / WIDTH:.6f} {y / HEIGHT:.6f}" for x, y in corners]
    lines.append("usemtl Paper")
    for x, y in squares:
        around = ((x, y), (x + SQUARE, y), (x + SQUARE, y + SQUARE), (x, y + SQUARE))
        lines.append("f " + " ".join(f"{number[corner]}/{number[corner]}" for corner in around))
    (folder / "doll.obj").write_text("\n".join(lines) + "\n")
    (folder / "doll.mtl").write_text("newmtl Paper\nKd 1 1 1\nmap_Kd doll.png\nmap_d doll.png\n")
    bpy.ops.wm.obj_import(filepath=str(folder / "doll.obj"))
    obj = bpy.context.view_layer.objects.active
    assert obj is not None
    return obj
