# SPDX-License-Identifier: GPL-3.0-or-later
"""What it costs to read a sheet of 10 000 vertices with four pins for drawing, after each kind of change.

    .venv/bin/python blender_tests/data/reading_cost.py [SIDE]

The median ms of processor time of asking for what is shown, once after each change; Blender's own update is
not counted. "drawn" is with what colours and mesh edges need beside the pins: world positions and distortion.
"mesh" tells how often the mesh was read in a hundred changes.
"""

import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "addon"))
from support import activate, add_pins, bar, grid, make_object

import planar_deform

COUNT = 100


def sheet(side: int) -> bpy.types.Object:
    """With a shape key that is animated, and pins in its corners, one of which has a target."""
    vertices, faces = grid(side - 1, side - 1, 4.0, 4.0)
    obj = make_object(vertices, faces.tolist(), name="Sheet")
    add_pins(obj, [0], [side - 1], [side * (side - 1)], [side * side - 1])
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Key")
    rows = vertices * [1.0, 1.25, 1.0]
    key.data.foreach_set("co", rows.astype(np.float32).ravel())
    obj.active_shape_key_index = 1
    for frame, value in {1: 0.25, 100_000: 1.0}.items():
        key.value = value
        key.keyframe_insert("value", frame=frame)
    return obj


def measure(name: str, change: Callable[[int], object]) -> None:
    from planar_deform.scene.objects import cutout_object
    from planar_deform.scene.view import snapshot

    asked, drawn, read, reads = [], [], cutout_object.read, []
    cutout_object.read = lambda *of, **more: reads.append(name) or read(*of, **more)
    for step in range(COUNT):
        change(step)
        bpy.context.view_layer.update()
        start = time.process_time()
        seen = snapshot.of_active(bpy.context)
        asked.append(1e3 * (time.process_time() - start))
        assert len(seen.points)
        assert seen.distortion is not None
        drawn.append(1e3 * (time.process_time() - start))
    cutout_object.read = read
    print(
        f"{name:34}{statistics.median(asked):9.3f}{statistics.median(drawn):9.3f}{len(reads):7}", flush=True
    )


def main() -> None:
    side = int((*sys.argv[1:], "100")[0])
    planar_deform.register()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    from planar_deform.scene.view import snapshot

    obj, other = sheet(side), bar(name="Other")
    activate(obj)
    key = obj.data.shape_keys.key_blocks[1]
    print(f"{len(obj.data.vertices)} vertices\n{'':34}{'asked':>9}{'drawn':>9}{'mesh':>7}")
    measure("first time", lambda _: snapshot.forget())
    measure("nothing", lambda _: None)
    measure("another object moved", lambda step: setattr(other, "location", (step, 0, 0)))
    measure("another object edited", lambda step: setattr(other.data.vertices[0], "co", (step, 0, 0)))
    measure("the object carried", lambda step: setattr(obj, "location", (step, 0, 0)))
    measure("the object turned", lambda step: setattr(obj, "rotation_euler", (0, 0, step)))
    measure("a pin's target", lambda step: setattr(obj.planar.pins[0], "target", (step, 0, 0)))
    measure("a weight", lambda step: obj.vertex_groups[0].add([1 + step], 0.5, "REPLACE"))
    measure("a vertex of the key", lambda step: setattr(key.data[0], "co", (0.0, 1e-3 * step, 0.0)))
    measure("the frame", lambda step: bpy.context.scene.frame_set(2 + step))
    activate(other)
    measure_none()


def measure_none() -> None:
    """An object without pins."""
    from planar_deform.scene.view import snapshot

    start = time.process_time()
    for _ in range(COUNT):
        assert snapshot.of_active(bpy.context) is None
    print(f"{'an object without pins':34}{1e3 * (time.process_time() - start) / COUNT:9.3f}")


if __name__ == "__main__":
    try:
        main()
    finally:
        planar_deform.unregister()
