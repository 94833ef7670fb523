# SPDX-License-Identifier: GPL-3.0-or-later
"""How many frames a second the window plays of a drawing that follows, run by `make bench` through run.py.

A square sheet of 5041 vertices with ten controls swings for 48 frames, played as fast as can be. "first" are
the frames a second of the first time, "again" those when it is played once more, "plain" those with Live off:
what this machine draws at all, without a graphics card. As with a card, a frame that takes longer than 42 ms
is late at 24 a second.
"""

import time
from collections.abc import Generator, Iterator

import bpy
import numpy as np
from cutouts import activate, pin, sheet
from harness import Window

FRAMES = 48
SIDE = 71


def swinging(obj: bpy.types.Object) -> None:
    """All controls go to and fro, each in its own time."""
    for number, each in enumerate(obj.planar.pins):
        start = np.array(each.follow.location)
        for frame in range(1, FRAMES + 1, 6):
            turn = 2 * np.pi * frame / FRAMES + number
            each.follow.location = start + 0.2 * np.array((np.sin(turn), 0.0, np.cos(turn)))
            each.follow.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_end = FRAMES


def played(window: Window) -> Generator[None, None, float]:
    """Frames a second, of the range played once."""
    times: list[float] = []

    def see(*_: object) -> None:
        times.append(time.perf_counter())

    bpy.context.scene.frame_set(1)
    bpy.context.scene.render.fps = 240
    bpy.context.scene.sync_mode = "NONE"
    bpy.app.handlers.frame_change_post.append(see)
    with window.context():
        bpy.ops.screen.animation_play()
    while len(times) < FRAMES:
        yield
    with window.context():
        bpy.ops.screen.animation_cancel(restore_frame=False)
    bpy.app.handlers.frame_change_post.remove(see)
    yield from window.wait(0.3)
    return (FRAMES - 1) / (times[FRAMES - 1] - times[0])


def test_follow_cost(window: Window) -> Iterator[None]:
    obj = sheet("Sheet", columns=SIDE - 1, rows=SIDE - 1, cell=4.0 / (SIDE - 1))
    pin(*((1.6 * np.cos(turn), 0.0, 1.6 * np.sin(turn)) for turn in np.linspace(0, 2 * np.pi, 11)[:-1]))
    activate(obj)
    yield from window.look()
    with window.context():
        bpy.ops.planar.add_controls()
    swinging(obj)
    first = yield from played(window)
    again = yield from played(window)
    obj.planar.live = False
    plain = yield from played(window)
    print(f"NOTE frames a second: first {first:.1f}, again {again:.1f}, plain {plain:.1f}", flush=True)
