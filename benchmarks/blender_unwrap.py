# SPDX-License-Identifier: GPL-3.0-or-later
"""Lays surfaces flat by Blender's own unwrap, for the table of flattening: with_bpy.sh VERSION this IN OUT.

IN and OUT are folders: of each surface an .npz with `vertices` and `triangles`, and of each method
that this Blender has an .npy with the place of each vertex in the UV map, and the seconds in seconds.json.
"""

import json
import sys
import time
from pathlib import Path

import bpy
import numpy as np

METHODS = ("ANGLE_BASED", "MINIMUM_STRETCH")
ROUNDS = 3  # the median counts


def unwrapped(vertices: np.ndarray, triangles: np.ndarray, method: str) -> tuple[np.ndarray, float]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("Surface")
    mesh.from_pydata(vertices.tolist(), [], triangles.tolist())
    mesh.uv_layers.new()
    obj = bpy.data.objects.new("Surface", mesh)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    start = time.perf_counter()
    bpy.ops.uv.unwrap(method=method)
    seconds = time.perf_counter() - start
    bpy.ops.object.mode_set(mode="OBJECT")
    uv = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers.active.data.foreach_get("uv", uv)
    flat = np.empty((len(vertices), 2))
    flat[triangles.ravel()] = uv.reshape(-1, 2)  # there is no seam: a vertex has one place
    return flat, seconds


def main() -> None:
    source, target = map(Path, sys.argv[1:])
    known = bpy.ops.uv.unwrap.get_rna_type().properties["method"].enum_items.keys()
    seconds = {}
    for path in sorted(source.glob("*.npz")):
        surface = np.load(path)
        vertices, triangles = surface["vertices"], surface["triangles"]
        for method in (method for method in METHODS if method in known):
            rounds = [unwrapped(vertices, triangles, method) for _ in range(ROUNDS)]
            np.save(target / f"{path.stem}-{method}.npy", rounds[0][0])
            seconds[f"{path.stem}-{method}"] = float(np.median([took for _, took in rounds]))
    (target / "seconds.json").write_text(json.dumps(seconds))


if __name__ == "__main__":
    main()
