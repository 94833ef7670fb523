# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever goes wrong inside of something that is running ends it once, with everything as it was."""

import contextlib
import io
import time
from collections.abc import Callable, Iterator
from typing import Any

import bpy
import numpy as np
from cutouts import active, pin_data, ready, selected, shape
from harness import Window, addon
from poses import LEFT, RIGHT, keyed, pin_place, stored

Gesture = Callable[[Window], Iterator[None]]


class Broken:
    """Something of the add-on that raises when it is called, from a call on; how often it has."""

    def __init__(self, owner: Any, name: str, after: int = 0):
        self._owner, self._name, self._before = owner, name, getattr(owner, name)
        self.raised, self.calls, self.after = 0, 0, after

    def __enter__(self) -> "Broken":
        def call(*args: Any, **options: Any) -> Any:
            self.calls += 1
            if self.calls <= self.after:
                return self._before(*args, **options)
            self.raised += 1
            raise ZeroDivisionError(f"{self._name} is broken")

        setattr(self._owner, self._name, call)
        return self

    def __exit__(self, *_: object) -> None:
        setattr(self._owner, self._name, self._before)


def everything() -> tuple:
    keys = active().data.shape_keys
    return (
        shape().tobytes(),
        selected(),
        active().planar.active_pin,
        str(pin_data()),
        None if keys is None else stored()[:4],
        bpy.context.scene.frame_current,
    )


def broken_in(window: Window, owner: Any, name: str, gesture: Gesture, *, after: int = 0) -> Iterator[None]:
    """Break something, do a gesture: it ended with one error, and nothing is left of it."""
    running, what = addon("operators.modal.running"), f"{getattr(owner, '__name__', owner)}.{name}"
    before, stderr = everything(), io.StringIO()
    with Broken(owner, name, after) as broken, contextlib.redirect_stderr(stderr):
        yield from gesture(window)
        x, y = window.mouse
        yield from window.move((x + 3, y))
        yield from window.move((x, y))
        yield from window.wait(0.2)
    assert broken.raised >= 1, f"{what} was never called"
    assert window.busy == [], what
    assert running.now() is None, what
    assert not running._clocks, what
    assert everything() == before, what
    assert stderr.getvalue().count("\nZeroDivisionError") == 1, (what, stderr.getvalue())
    yield from window.key("ESC")  # Blender's own popup with the report, which takes the next click
    yield from window.wait(0.1)


def drag(window: Window) -> Iterator[None]:
    """Of the right pin, with a rest in the middle."""
    yield from window.hover(window.pixel(pin_place(1)))
    yield from window.press()
    yield from window.move(window.pixel((1.7, 0.0, 0.6)), steps=6)
    yield from window.wait(0.2)
    yield from window.release()
    yield from window.settled()


def grab(window: Window) -> Iterator[None]:
    """G, a value, Enter."""
    yield from window.hover(window.pixel((0.0, 0.0, 0.0)))
    yield from window.key("G")
    yield from window.type("0.3")
    yield from window.wait(0.2)
    yield from window.key("RET")
    yield from window.settled()


def settle(window: Window) -> Iterator[None]:
    with window.context(), contextlib.suppress(RuntimeError):  # as in slide(), where the thread is that fast
        bpy.ops.planar.settle_pose("INVOKE_DEFAULT", True)
    yield from window.settled()


def settle_late(window: Window) -> Iterator[None]:
    """The same, where something has been solved before Blender looks for the first time."""
    session = addon("operators.modal.session").Session
    release = session.release

    def late(self: Any) -> None:
        self._thread.wait()
        release(self)

    session.release = late
    try:
        yield from settle(window)
    finally:
        session.release = release


def record(window: Window) -> Iterator[None]:
    with window.context():
        bpy.ops.planar.record_pins("INVOKE_DEFAULT", True)
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    x, y = window.mouse
    for step in range(8):
        yield from window.move((x, y + 8 * step))
        yield
    yield from window.release()
    until = time.monotonic() + 5.0
    while window.busy and time.monotonic() < until:
        yield


def slide(window: Window) -> Iterator[None]:
    """A breakdown."""
    yield from window.hover(window.pixel((0.0, 0.0, 0.0)))
    with window.context(), contextlib.suppress(RuntimeError):  # what went wrong in the invoke is told at once
        bpy.ops.planar.breakdown("INVOKE_DEFAULT", True)
    x, y = window.mouse
    yield from window.move((x + 60, y), steps=3)
    yield from window.key("RET")
    yield from window.wait(0.2)


def generate(window: Window) -> Iterator[None]:
    with window.context(), contextlib.suppress(RuntimeError):
        bpy.ops.planar.generate_inbetweens("INVOKE_DEFAULT", True)
    yield from window.wait(0.6)


def test_in_drags_and_settlings(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    bpy.ops.planar.select_pins(action="SELECT", pin=1)
    bpy.ops.planar.drag_pins(offset=(0.1, 0.3))  # the pins have held something by now
    bpy.ops.ed.undo_push(message="Posed")
    yield
    operator = addon("operators.drag").PLANAR_OT_drag_pins
    posing = addon("operators.modal.several_posing").SeveralPosing
    session = addon("operators.modal.session").Session
    mouse = addon("operators.modal.plane_mouse").PlaneMouse
    keying = addon("operators.keying")
    for owner, name, gesture, after in (
        (operator, "handle", drag, 3),
        (operator, "keep_result", drag, 0),
        (mouse, "moved", drag, 1),
        (mouse, "begin", drag, 0),
        (posing, "show", drag, 0),
        (posing, "show", drag, 1),
        (posing, "keep", drag, 0),
        (posing, "finish", drag, 0),
        (keying, "auto_key", drag, 0),
        (session, "ask", drag, 1),
        (session, "release", drag, 0),
        (session, "retrace", grab, 0),
        (operator, "edited", grab, 0),
        (posing, "show", settle, 0),
        (posing, "show", settle_late, 0),
        (posing, "finish", settle, 0),
    ):
        yield from broken_in(window, owner, name, gesture, after=after)
    before = shape()
    yield from drag(window)
    assert np.abs(shape() - before).max() > 0.1, "the next drag does what it should"
    yield from window.undo()
    assert np.array_equal(shape(), before), "none of those that failed is a step of undo"


def test_in_recordings(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    operator = addon("operators.record").PLANAR_OT_record_pins
    posing = addon("operators.modal.several_posing").SeveralPosing
    mouse = addon("operators.modal.plane_mouse").PlaneMouse
    for owner, name, after in (
        (operator, "_wait", 0),
        (operator, "_start", 0),
        (mouse, "begin", 0),
        (mouse, "moved", 2),
        (operator, "_play", 3),
        (posing, "show", 0),
        (operator, "_end", 0),
        (operator, "_keep", 0),
        (addon("operators.record"), "keying", 0),
    ):
        yield from broken_in(window, owner, name, record, after=after)


def test_in_breakdowns_and_long_jobs(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    keyed((1, 0.6), (25, -0.8))
    bpy.context.scene.frame_set(13)
    bpy.ops.ed.undo_push(message="Two Poses")
    operator = addon("operators.breakdown").PLANAR_OT_breakdown
    way = addon("scene.inbetweens.breakdown").Way
    run = addon("operators.modal.long_job").LongRun
    writing = addon("scene.inbetweens.writing")
    for owner, name, gesture, after in (
        (way, "show", slide, 0),
        (way, "show", slide, 1),
        (operator, "_handle", slide, 1),
        (addon("operators.breakdown"), "key_shown", slide, 0),
        (run, "advance", generate, 0),
        (run, "advance", generate, 1),
        (writing, "write", generate, 0),
    ):
        if owner is run and after:
            with slow(run):
                yield from broken_in(window, run, name, gesture, after=after)
        else:
            yield from broken_in(window, owner, name, gesture, after=after)


def test_in_the_end_of_a_long_job(window: Window) -> Iterator[None]:
    """What cannot be put back must not keep Esc from ending it."""
    yield from ready(window, LEFT, RIGHT)
    keyed((1, 0.3), (25, -0.6))
    bpy.ops.ed.undo_push(message="Two Poses")
    run = addon("operators.modal.long_job").LongRun

    def start_and_escape(window: Window) -> Iterator[None]:
        with window.context():
            bpy.ops.planar.generate_inbetweens("INVOKE_DEFAULT", True)
        yield from window.wait(0.1)
        yield from window.key("ESC")

    with slow(run):
        yield from broken_in(window, run, "stop", start_and_escape)


@contextlib.contextmanager
def slow(run: Any) -> Iterator[None]:
    """Let jobs not be done at once."""
    advance = run.advance
    run.advance = lambda self, wait, write: False
    try:
        yield
    finally:
        run.advance = advance


def test_in_what_settles_painted_stiffness(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    bpy.ops.planar.select_pins(action="SELECT", pin=1)
    bpy.ops.planar.drag_pins(offset=(-0.4, 0.8))
    bpy.ops.planar.paint_stiffness()
    stiffness, running = addon("operators.stiffness"), addon("operators.modal.running")
    yield from window.wait(0.3)
    group = active().vertex_groups[active().planar.stiffness_group]
    posed = shape()
    stderr = io.StringIO()
    with Broken(stiffness._Settling, "show") as broken, contextlib.redirect_stderr(stderr):
        group.add(list(range(40)), 1.0, "REPLACE")
        active().update_tag()
        yield from window.wait(0.5)
        for _ in range(2):  # other things go on meanwhile
            active().location.x += 0.0
            active().update_tag()
            yield from window.wait(0.2)
    assert broken.raised == 1
    assert stderr.getvalue().count("\nZeroDivisionError") == 1
    assert running.now() is None
    assert np.array_equal(shape(), posed)
    group.add(list(range(60, 90)), 1.0, "REPLACE")
    active().update_tag()
    active().data.update_tag()
    yield from window.wait(1.0)
    assert running.now() is None
    assert np.abs(shape() - posed).max() > 1e-4, "the next stroke settles"
    with window.context():
        bpy.ops.object.mode_set(mode="OBJECT")
