# SPDX-License-Identifier: GPL-3.0-or-later
"""What a drag costs in the window: run by `make bench` through run.py, which shows the table.

Each row drags one of four pins of a square sheet round a circle, event by event, lets it go and lets it
settle, then presses it once more. "event" is the time in ms from a mouse event's arrival to its shape written
to the mesh, median and 99th percentile of those that are shown; the others are overtaken. "solve" is the part
of it that the solver takes, median; what one bare factorization takes is in the first table of `make bench`.
"shapes" are shown per second, "frames" are pictures of the view drawn per second meanwhile, and "idle" the
same without a drag: what this machine can draw at all, without a graphics card. "first", "drag", "release",
"press" are the longest times in ms for which one event kept Blender waiting for the extension, its handler
or what it draws did: at the first press, during the drag, from the release until the drawing has settled,
which takes "settled" ms in all, and at the second press. Sheets above 8000 vertices are solved by a cage.
"""

import statistics
import time
from collections.abc import Callable, Generator, Iterator

import bpy
import numpy as np
from cutouts import pin, place, sheet
from harness import Window, addon, fresh_file

EVENTS = 80
SIDES = (71, 224, 317, 447)  # vertices a side: 5k, 50k, 100k and 200k
KINDS = (
    *("event", "99%", "solve", "shapes", "frames", "idle", "first", "drag", "release", "settled", "press"),
)


class Watch:
    """Times what the add-on does while it is on."""

    def __init__(self) -> None:
        self.waits: list[float] = []  # ms for which each call kept Blender waiting
        self.delays: list[float] = []  # ms from an event to its shape
        self.solves: list[float] = []  # ms that each shape took the solver
        self.shown = 0
        self._asked: dict[tuple[float, ...], float] = {}
        self._undo: list[tuple[object, str, Callable]] = []
        self._wrap(addon("operators.drag").PinTransform, "invoke", self._handling)
        self._wrap(addon("operators.modal.session").Interactive, "modal", self._handling)
        self._wrap(addon("scene.follow"), "match", self._timed)
        self._wrap(addon("scene.view.snapshot"), "of_active", self._timed)
        self._wrap(addon("model.posing.posing").Posing, "move", self._solving)
        self._wrap(addon("model.posing.solving").Solving, "ask", self._asking)
        self._wrap(addon("operators.modal.several_posing").SeveralPosing, "show", self._showing)

    def _wrap(self, owner: object, name: str, wrapper: Callable) -> None:
        original = getattr(owner, name)
        self._undo.append((owner, name, original))
        setattr(owner, name, wrapper(original))

    def _timed(self, original: Callable) -> Callable:
        return _lasting(original, self.waits)

    def _handling(self, original: Callable) -> Callable:
        timed = self._timed(original)

        def handling(operator, context, event):  # Blender counts what it takes
            return timed(operator, context, event)

        return handling

    def _solving(self, original: Callable) -> Callable:
        return _lasting(original, self.solves)

    def _asking(self, original: Callable) -> Callable:
        def asking(solving, sample):
            self._asked.setdefault(tuple(np.float32(sample).tolist()), time.perf_counter())
            original(solving, sample)

        return asking

    def _showing(self, original: Callable) -> Callable:
        def showing(posing, solved):
            original(posing, solved)
            self.shown += 1
            asked = self._asked.pop(solved.path[-1], None)
            if asked is not None:
                self.delays.append(1e3 * (time.perf_counter() - asked))

        return showing

    def longest_wait(self) -> float:
        """Since it was last asked for."""
        longest = max(self.waits, default=0.0)
        self.waits.clear()
        return longest

    def stop(self) -> None:
        for owner, name, original in self._undo:
            setattr(owner, name, original)


def _lasting(original: Callable, lasted: list[float]) -> Callable:
    """The same, which notes how many ms it took."""

    def timed(*of):
        start = time.perf_counter()
        result = original(*of)
        lasted.append(1e3 * (time.perf_counter() - start))
        return result

    return timed


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
    show("vertices", *KINDS)
    for side in SIDES:
        sheet("Sheet", columns=side - 1, rows=side - 1, cell=4.0 / (side - 1))
        pin((-1.5, 0, -1.5), (1.5, 0, -1.5), (-1.5, 0, 1.5), (1.5, 0, 1.5))
        bpy.ops.ed.undo_push(message="Test Scene")
        yield from window.look()
        yield from window.use_tool()
        idle = yield from frames(window.area.tag_redraw)

        watch = Watch()
        circle = [
            window.pixel((1.5 + 0.3 * np.sin(angle), 0, 1.8 - 0.3 * np.cos(angle)))
            for angle in np.linspace(0, 2 * np.pi, EVENTS)
        ]
        yield from window.hover(window.pixel(place(3)))
        yield from window.press()
        yield from window.move(circle[-1])
        first = watch.longest_wait()
        yield from window.settled(120.0)  # by then the solver is made
        watch.delays.clear()
        watch.solves.clear()
        watch.shown = 0
        way = iter(circle)

        def step(way: Iterator[tuple[int, int]] = way) -> None:
            window.mouse = next(way)
            x, y = window.mouse
            window.window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)

        start = time.perf_counter()
        rate = yield from frames(step)
        shapes, drag = watch.shown / (time.perf_counter() - start), watch.longest_wait()
        start = time.perf_counter()
        yield from window.release()
        yield from window.settled(120.0)
        settled = time.perf_counter() - start
        yield from window.wait(0.5)  # what follows it is done by then
        release = watch.longest_wait()
        delays, solve = watch.delays, statistics.median(watch.solves)
        yield from window.press()
        yield from window.move(window.pixel((0.3, 0, 0.3)))
        press = watch.longest_wait()
        watch.stop()
        yield from window.key("ESC")
        yield from window.release()
        figures = [statistics.median(delays), float(np.quantile(delays, 0.99)), solve, shapes, rate, idle]
        figures += [first, drag, release, 1e3 * settled, press]
        show(str(side * side), *(f"{figure:.1f}" for figure in figures))
        fresh_file()
        yield from window.wait(0.2)
