# SPDX-License-Identifier: GPL-3.0-or-later
"""What a drag costs in the window: run by `make bench` through run.py, which shows the table.

Each row drags one of four pins of a square sheet round a circle, event by event. "event" is the time from the
mouse event's arrival to the coordinates written to the mesh and the next event awaited; "solve", "write" and
"marks" are its parts. "frames" are pictures of the view drawn per second meanwhile, "idle" the same without a
drag: what this machine can draw at all, without a graphics card.
"""

import statistics
import sys
import time
from collections.abc import Callable, Iterator

import bpy
import numpy as np
from cutouts import pin, place, sheet
from harness import Window, fresh_file

EVENTS = 80
SIDES = (71, 100)  # vertices a side: 5k and 10k


class Clock:
    """Times calls of functions that it wraps, in milliseconds."""

    def __init__(self) -> None:
        self.times: dict[str, list[float]] = {}
        self._undo: list[tuple[object, str, Callable]] = []

    def watch(self, name: str, owner: object, attribute: str) -> None:
        original = getattr(owner, attribute)

        def timed(*arguments, **options):
            start = time.perf_counter()
            result = original(*arguments, **options)
            self.times.setdefault(name, []).append(1e3 * (time.perf_counter() - start))
            return result

        self._undo.append((owner, attribute, original))
        setattr(owner, attribute, timed)

    def stop(self) -> None:
        for owner, attribute, original in self._undo:
            setattr(owner, attribute, original)


def installed(name: str):
    """A module of the installed extension."""
    return next(module for path, module in sys.modules.items() if path.endswith(f".planar_deform.{name}"))


def frames(window: Window, turn: Callable[[], None], count: int) -> Iterator[None]:
    """Draw the view so many times; the frames a second are in `frames.rate` afterwards."""
    drawn = [0]

    def seen() -> None:
        drawn[0] += 1

    handle = bpy.types.SpaceView3D.draw_handler_add(seen, (), "WINDOW", "POST_PIXEL")
    start = time.perf_counter()
    for _ in range(count):
        turn()
        yield
    frames.rate = drawn[0] / (time.perf_counter() - start)
    bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")


def test_event_cost(window: Window) -> Iterator[None]:
    print(
        f"     {'vertices':>8} {'event ms':>9} {'slowest':>8} {'first':>7} {'solve':>7} {'write':>7} {'marks':>7}",
        end="",
    )
    print(f" {'frames/s':>9} {'idle':>7}", flush=True)
    for side in SIDES:
        sheet("Sheet", columns=side - 1, rows=side - 1, cell=4.0 / (side - 1))
        pin((-1.5, 0, -1.5), (1.5, 0, -1.5), (-1.5, 0, 1.5), (1.5, 0, 1.5))
        bpy.ops.ed.undo_push(message="Test Scene")
        yield from window.look()
        yield from window.use_tool()
        yield from frames(window, window.area.tag_redraw, EVENTS)
        idle = frames.rate

        clock = Clock()
        scene = installed("scene.access").SceneCutout
        clock.watch("solve", installed("model.posing").PoseAction, "move")
        clock.watch("marks", installed("scene.snapshot"), "follow")
        clock.watch("write", scene, "write")
        clock.watch("event", installed("operators.drag").PinTransform, "_handle")
        circle = [
            window.pixel((1.5 + 0.3 * np.sin(angle), 0, 1.8 - 0.3 * np.cos(angle)))
            for angle in np.linspace(0, 2 * np.pi, EVENTS)
        ]
        yield from window.hover(window.pixel(place(3)))
        yield from window.press()
        yield from window.move(circle[0], steps=8)
        first = max(clock.times["event"])  # that makes the solver
        clock.times.clear()
        way = iter(circle)

        def step(way: Iterator[tuple[int, int]] = way) -> None:
            window.mouse = next(way)
            x, y = window.mouse
            window.window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)

        yield from frames(window, step, EVENTS)
        clock.stop()
        yield from window.release()
        times = clock.times
        assert len(times["solve"]) > EVENTS // 2, "most of the events moved the pin"
        parts = [statistics.median(times[name]) for name in ("solve", "write", "marks")]
        print(
            f"     {side * side:8} {statistics.median(times['event']):9.1f} {max(times['event']):8.1f} {first:7.1f}"
            f" {parts[0]:7.1f} {parts[1]:7.1f} {parts[2]:7.1f} {frames.rate:9.1f} {idle:7.1f}",
            flush=True,
        )
        fresh_file()
        yield from window.wait(0.2)
