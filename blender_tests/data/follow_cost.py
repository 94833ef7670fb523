# SPDX-License-Identifier: GPL-3.0-or-later
"""What a frame costs while a drawing of some 5000 vertices follows ten swinging Empties, run by `make bench`.

    .venv/bin/python blender_tests/data/follow_cost.py [FRAMES]

"frame" is what Blender takes to go to the next frame, with all that it evaluates, in ms: median and 95th
percentile; "cpu" the median of processor time, which other processes lengthen less; "fps" the frames that
play in a second, by both. The rest is processor time: "solve" the solver's part, "move" one step of a drag,
"again" a frame that is played for the second time, "plain" one with Live off. The figure has limbs, the sheet
is a square: its matrices are fuller.
"""

import os
import statistics
import sys
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "addon"))
from support import activate, add_pins, grid, make_object, world

import planar_deform
from planar_deform.model.posing.pin_follow import PinFollow

PINS = 10
REACH = 0.06  # of the drawing's height, to and fro


def figure(side=132):
    """A body with a head, two arms and two legs, in the cells of a grid."""
    vertices, faces = grid(side, side, 2.0, 2.0, origin=(-1.0, -1.0))
    x, y = vertices[faces].mean(axis=1)[:, :2].T
    body = (np.abs(x) < 0.22) & (y > -0.35) & (y < 0.45)
    head = np.hypot(x, y - 0.72) < 0.26
    arms = (np.abs(y - 0.3) < 0.1) & (np.abs(x) < 0.95)
    legs = (np.abs(np.abs(x) - 0.14) < 0.09) & (y < -0.3) & (y > -0.95)
    return _kept(vertices, faces[body | head | arms | legs])


def _kept(vertices, faces):
    used, back = np.unique(faces, return_inverse=True)
    return vertices[used], back.reshape(faces.shape)


def scene_of(vertices, faces, spots):
    """The drawing, upright, with pins nearest to these places, whose Empties swing."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    obj = make_object(vertices, faces.tolist(), name="Drawing")
    obj.rotation_euler = (np.pi / 2, 0.0, 0.0)
    activate(obj)
    add_pins(obj, *([int(np.hypot(*(vertices[:, :2] - spot).T).argmin())] for spot in spots))
    for pin in obj.planar.pins:
        pin.select = False
    bpy.ops.planar.add_controls()
    height = np.ptp(world(obj), axis=0).max()
    for number, pin in enumerate(obj.planar.pins):
        start = np.array(pin.follow.location)
        for frame in range(1, 202, 10):
            turn = 0.05 * frame + number
            pin.follow.location = start + REACH * height * np.array((np.sin(turn), 0.0, np.cos(1.3 * turn)))
            pin.follow.keyframe_insert("location", frame=frame)
    return obj


def measured(frames):
    """ms of time and of processor time for each frame."""
    times = []
    for frame in range(1, frames + 1):
        before = time.perf_counter(), time.process_time()
        bpy.context.scene.frame_set(frame)
        times.append((1e3 * (time.perf_counter() - before[0]), 1e3 * (time.process_time() - before[1])))
    return np.array(times[1:])


def main():
    frames = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    planar_deform.register()
    limbs = [(0, 0.72), (0, 0.45), (0, -0.3), (-0.55, 0.3), (0.55, 0.3), (-0.93, 0.3), (0.93, 0.3)]
    legs = [(-0.14, -0.6), (-0.14, -0.93), (0.14, -0.93)]
    ring = [(0.8 * np.cos(a), 0.8 * np.sin(a)) for a in np.linspace(0, 2 * np.pi, PINS, endpoint=False)]
    drawings = {
        "figure": (figure(), limbs + legs),
        "sheet": (grid(70, 70, 2.0, 2.0, origin=(-1.0, -1.0)), ring),
    }
    print(f"{'':8}vertices   frame    95%    cpu    fps  by cpu  solve   move  again  plain")
    run, move, solving, moving = PinFollow.run, PinFollow.move, [], []

    def timed(posing, *of):
        before = time.process_time()
        run(posing, *of)
        solving.append(1e3 * (time.process_time() - before))

    def timed_move(posing, *of):
        before = time.process_time()
        move(posing, *of)
        moving.append(1e3 * (time.process_time() - before))

    PinFollow.run, PinFollow.move = timed, timed_move
    for name, ((vertices, faces), spots) in drawings.items():
        obj = scene_of(vertices, faces, spots)
        solving.clear()
        moving.clear()
        times = measured(frames)
        solved = statistics.median(solving)
        again = measured(frames)
        obj.planar.live = False
        plain = measured(20)
        frame, cpu = np.median(times, axis=0)
        print(
            f"{name:8}{len(vertices):8}{frame:8.1f}{np.percentile(times[:, 0], 95):7.1f}{cpu:7.1f}"
            f"{1e3 / times[:, 0].mean():7.1f}{1e3 / times[:, 1].mean():8.1f}{solved:7.1f}"
            f"{statistics.median(moving):7.1f}{np.median(again[:, 1]):7.1f}{np.median(plain[:, 1]):7.1f}",
            flush=True,
        )
    os._exit(0)


main()
