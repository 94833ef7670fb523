# SPDX-License-Identifier: GPL-3.0-or-later
"""What a drag costs in the window: run by `make bench` through run.py, which shows the table.

Each row drags one of four pins of a square sheet round a circle, event by event. "event" is the time from the
mouse event's arrival to the coordinates written to the mesh and the next event awaited; "solve", "write" and
"marks" are its parts, and "first" is the event that also makes the solver. "frames" are pictures of the view
drawn per second meanwhile, "idle" the same without a drag: what this machine can draw at all, without a
graphics card.
"""

import statistics
import sys
import time
from collections.abc import Callable, Generator, Iterator

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


def show(*cells: str) -> None:
    print("    ", *(f"{cell:>8}" for cell in cells), flush=True)


def frames(turn: Callable[[], None]) -> Generator[None, None, float]:
    """Call `turn` before each of EVENTS steps; the pictures drawn a second meanwhile."""
    drawn = [0]

    def seen() -> None:
        drawn[0] += 1

    handle = bpy.types.SpaceView3D.draw_handler_add(seen, (), "WINDOW", "POST_PIXEL")
    start = time.perf_counter()
    for _ in range(EVENTS):
        turn()
        yield
    seconds = time.perf_counter() - start
    bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")
    return drawn[0] / seconds


def test_event_cost(window: Window) -> Iterator[None]:
    show("vertices", "event ms", "slowest", "first", "solve", "write", "marks", "frames/s", "idle")
    for side in SIDES:
        sheet("Sheet", columns=side - 1, rows=side - 1, cell=4.0 / (side - 1))
        pin((-1.5, 0, -1.5), (1.5, 0, -1.5), (-1.5, 0, 1.5), (1.5, 0, 1.5))
        bpy.ops.ed.undo_push(message="Test Scene")
        yield from window.look()
        yield from window.use_tool()
        idle = yield from frames(window.area.tag_redraw)

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
        yield from window.move(circle[EVENTS // 4])
        first = max(clock.times["event"])  # that makes the solver
        clock.times.clear()
        way = iter(circle)

        def step(way: Iterator[tuple[int, int]] = way) -> None:
            window.mouse = next(way)
            x, y = window.mouse
            window.window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)

        rate = yield from frames(step)
        clock.stop()
        yield from window.release()
        times, parts = clock.times, ("solve", "write", "marks")
        assert len(times["solve"]) > EVENTS // 2, "most of the events moved the pin"
        figures = [max(times["event"]), first, *(statistics.median(times[name]) for name in parts)]
        figures = [statistics.median(times["event"]), *figures, rate, idle]
        show(str(side * side), *(f"{figure:.1f}" for figure in figures))
        fresh_file()
        yield from window.wait(0.2)
