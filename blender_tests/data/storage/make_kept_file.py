# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep a file of this version: files/VERSION.blend, with an object of every kind, and what it shows.

It is made once for each version that is published, by the oldest Blender, and never again: later versions
have to open it (test_kept_files.py).

usage: .venv/bin/python blender_tests/data/storage/make_kept_file.py
"""

import os
import sys
import tempfile
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parent
PROJECT = HERE.parents[2]
sys.path[:0] = [str(PROJECT / "addon"), *(str(HERE.parent / name) for name in (".", "follow", "lattice"))]
sys.path[:0] = [str(HERE.parent / name) for name in ("flatten", "image")]

import bpy  # noqa: E402
import figures  # noqa: E402
import kept  # noqa: E402
import numpy as np  # noqa: E402
from filling import bent_bar  # noqa: E402
from follow_scenes import in_poses  # noqa: E402
from lattice_scenes import layered, pin_at  # noqa: E402
from outlines import lines  # noqa: E402
from pictures import cutout, letter, save  # noqa: E402
from sequences import go_to, key, pull  # noqa: E402
from support import activate, add_pins, bar, pose  # noqa: E402
from surfaces import flatten, tube  # noqa: E402

OLDEST = (4, 2)


def named(obj, name):
    obj.name = obj.data.name = name
    return obj


def drag(obj, frame, **options):
    """Drag at a frame and key it."""
    go_to(frame)
    activate(obj)
    assert bpy.ops.planar.drag_pins(**options) == {"FINISHED"}
    assert bpy.ops.planar.key_pose() == {"FINISHED"}


def generate(obj):
    activate(obj)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}


def attached():
    """A figure of four layers hung together, in front of whose chest a hand comes."""
    obj = named(figures.pinned(figures.BODY, figures.ARM, figures.HAND, figures.HEAD, cell=0.2), "Figure")
    figures.pin_at(obj, (4.5, 3.2), "Hand")
    figures.pin_at(obj, (2.9, 3.2), "Elbow").enabled = False
    key(obj, 1)
    go_to(13)
    figures.drag(obj, "Hand", (-0.1, 0.2))
    bpy.ops.planar.select_pins(action="SELECT", pin=obj.planar.pins.find("Hand"))
    assert bpy.ops.planar.set_depth(depth=2.0) == {"FINISHED"}
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    generate(obj)


def planted():
    """A foot that stands, a hand that goes along a curve, and stiffness that is painted."""
    obj = bar(plane="XZ", nx=16, ny=5, name="Planted")
    add_pins(obj, [0, 1, 17, 18], kind="PATCH")
    add_pins(obj, [101])
    obj.planar.active_pin = 1
    obj.planar.pins[0].weight = 2.0
    assert bpy.ops.planar.paint_stiffness() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    group = obj.vertex_groups[obj.planar.stiffness_group]
    group.add([v.index for v in obj.data.vertices if v.co.x > 1.2], 0.9, "REPLACE")
    pull(obj, 1, (0.0, 0.0))
    pull(obj, 10, (-0.5, 0.6))
    pull(obj, 20, (0.3, -0.9))
    curve = bpy.data.curves.new("Way", "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("POLY")
    spline.points.add(8)
    for point, share in zip(spline.points, np.linspace(0.0, 1.0, 9), strict=True):
        point.co = (share, 0.0, 2.0 * share * (1.0 - share), 1.0)
    bpy.context.scene.collection.objects.link(way := bpy.data.objects.new("Way", curve))
    assert bpy.ops.planar.add_pin_path(pose=0) == {"FINISHED"}
    path = obj.planar.pins[1].paths[-1]
    path.kind, path.ease, path.curve = "CURVE", "EASE_IN", way
    generate(obj)


def bent():
    """Swings, with an extra turn and smoothly through the pose in the middle."""
    obj, _ = bent_bar(frames=(1, 10, 20))
    named(obj, "Bent").planar.smooth = True
    obj.planar.poses[0].turns = 1
    generate(obj)


def followed():
    """Poses whose tip follows an Empty."""
    obj, _ = in_poses(live=True)
    named(obj, "Followed")


def in_a_lattice():
    """Two layers bent by the pins of their lattice, one of which holds a point of the lattice itself."""
    cage, _, front = layered()
    named(cage, "Cage")
    for vertex in (0, 6):
        pin_at(front, vertex)
    activate(cage)
    assert bpy.ops.planar.add_pin(lattice_point=0) == {"FINISHED"}
    drag(cage, 1, pin=1, offset=(0.1, 0.1))
    drag(cage, 16, pin=1, offset=(-0.4, 0.5))
    generate(cage)


def lines_of_a_curve():
    """A poly curve with poses."""
    obj = lines("2D curve", name="Lines")
    key(obj, 1)
    key(obj, 13, seed=3)
    generate(obj)


def laid_flat():
    """A tube laid flat, whose UV map follows the pin that is dragged."""
    flat = named(flatten(tube(12, 4)), "Flat")
    for vertex in (0, len(flat.data.vertices) - 1):
        add_pins(flat, [vertex])
    flat.planar.live_uv = True
    pose(flat, offset=(0.2, 0.3))


def drawn(folder):
    """A cutout of a picture that is packed, by the method of 2011."""
    obj = named(cutout(save(folder, "letter.png", letter()), vertices=120), "Letter")
    bpy.data.images["letter.png"].pack()
    obj.planar.method = "AKVF"
    bottom, top = obj.data.vertices[0], max(obj.data.vertices, key=lambda vertex: vertex.co.z)
    add_pins(obj, [bottom.index], [top.index])
    drag(obj, 1, pin=1, offset=(0.03, 0.02))


def main():
    if bpy.app.version[:2] != OLDEST:
        sys.exit(f"A file is kept of Blender {OLDEST[0]}.{OLDEST[1]}, so that all others open it")
    import planar_deform

    version = tomllib.loads((PROJECT / "addon/planar_deform/blender_manifest.toml").read_text())["version"]
    path = kept.FILES / f"{version}.blend"
    if path.exists():
        sys.exit(f"{path.relative_to(PROJECT)} is kept already")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    planar_deform.register()
    with tempfile.TemporaryDirectory() as folder:
        for make in (attached, planted, bent, followed, in_a_lattice, lines_of_a_curve, laid_flat):
            make()
        drawn(Path(folder))
    go_to(1)
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)
    bpy.ops.wm.open_mainfile(filepath=str(path))
    found = kept.record()
    path.with_suffix(".json").write_text(kept.written(found), encoding="utf-8")
    print(f"{path.relative_to(PROJECT)}: {path.stat().st_size / 1000:.0f} kB, {', '.join(found)}", flush=True)
    os._exit(0)  # bpy crashes as Python ends with the add-on registered


if __name__ == "__main__":
    main()
