# SPDX-License-Identifier: GPL-3.0-or-later
"""Images to make cutouts of, written by Blender itself, and what cutouts are compared with."""

from pathlib import Path

import bpy
import numpy as np

SHARED = Path(__file__).resolve().parents[4] / "shared" / "data"


def letter(height=120, width=80):
    """Truths h x w, rows from the bottom: an F, which looks like itself however it is turned or mirrored."""
    art = np.zeros((height, width), bool)
    art[10:110, 15:32] = art[93:110, 15:70] = art[55:72, 15:55] = True
    return art


def blobs(*places, size=(120, 80), radius=14):
    """Discs about these places x, y."""
    rows, columns = np.indices(size) + 0.5
    return np.any([np.hypot(columns - x, rows - y) < radius for x, y in places], axis=0)


def pixels_of(art, *, colour=(0.8, 0.2, 0.1), ground=None):
    """h x w x 4; clear around the art, or without an alpha in a colour."""
    around = (0.0, 0.0, 0.0, 0.0) if ground is None else (*ground, 1.0)
    return np.where(art[..., None], (*colour, 1.0), around).astype(np.float32)


def new_image(art, name="Drawing", **look):
    pixels = pixels_of(art, **look)
    image = bpy.data.images.new(name, art.shape[1], art.shape[0], alpha=True)
    image.pixels.foreach_set(pixels.ravel())
    return image


def save(folder, name, art, **look):
    """A file of it, and no image in Blender."""
    image = new_image(art, **look)
    image.filepath_raw = str(Path(folder) / name)
    image.file_format = {".png": "PNG", ".jpg": "JPEG", ".tif": "TIFF", ".webp": "WEBP", ".exr": "OPEN_EXR"}[
        Path(name).suffix
    ]
    image.save()
    bpy.data.images.remove(image)
    return Path(folder) / name


def cutout(*paths, vertices=300, **options):
    """Made of these files, coarser than by itself; the active object."""
    files = [{"name": path.name} for path in paths]
    folder = str(paths[0].parent)
    bpy.ops.planar.cutout_from_image(directory=folder, files=files, vertices=vertices, **options)
    bpy.context.view_layer.update()
    return bpy.context.object


def plane(folder, art=None, **look):
    """An image plane as Blender imports it, facing the front; 600 pixels are a unit."""
    path = save(folder, "plane.png", letter() if art is None else art, **look)
    bpy.ops.image.import_as_mesh_planes(
        files=[{"name": path.name}], directory=str(folder), align_axis="-Y", size_mode="DPBU", relative=False
    )
    return bpy.context.object


def blocks():
    """How much there is of what an import may leave behind."""
    kinds = ("objects", "meshes", "materials", "images", "node_groups")
    return {kind: len(getattr(bpy.data, kind)) for kind in kinds}


def corner_uvs(mesh):
    uvs = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers.active.data.foreach_get("uv", uvs)
    return uvs.reshape(-1, 2)


def corner_places(obj):
    """In the world, for each corner of a face."""
    places = np.array([vertex.co for vertex in obj.data.vertices])
    matrix = np.array(obj.matrix_world)
    corners = np.array([loop.vertex_index for loop in obj.data.loops])
    return (places @ matrix[:3, :3].T + matrix[:3, 3])[corners]


def covered(obj, size):
    """Truths h x w: the pixels of the image whose middle is in one of the triangles, by the UV map."""
    height, width = size
    corners = (corner_uvs(obj.data) * [width, height]).reshape(-1, 3, 2).astype(np.float64)
    found = np.zeros(size, bool)
    for a, b, c in corners:
        low = np.maximum(np.floor(np.min([a, b, c], axis=0)).astype(int), 0)
        high = np.minimum(np.ceil(np.max([a, b, c], axis=0)).astype(int), [width, height])
        y, x = np.mgrid[low[1] : high[1], low[0] : high[0]] + 0.5
        sides = [(q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]) for p, q in ((a, b), (b, c), (c, a))]
        inside = np.all([side >= -1e-4 for side in sides], axis=0) | np.all(
            [side <= 1e-4 for side in sides], axis=0
        )
        found[low[1] : high[1], low[0] : high[0]] |= inside
    return found
