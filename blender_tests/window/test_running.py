# SPDX-License-Identifier: GPL-3.0-or-later
"""One thing runs at a time: each interactive operator started while each other one is on."""

import contextlib
from collections.abc import Iterator

import bpy
from cutouts import ready
from harness import Window, addon
from poses import LEFT, RIGHT, keyed, stored

STARTERS = ("drag_pins", "record_pins", "breakdown", "generate_inbetweens", "settle_pose")


@contextlib.contextmanager
def slow_jobs() -> Iterator[None]:
    """Let jobs not be done at once."""
    run = addon("operators.modal.long_job").LongRun
    advance = run.advance
    run.advance = lambda self, wait, write: False
    try:
        yield
    finally:
        run.advance = advance


def held() -> tuple:
    """All that is stored but the blocks of an unkeyed pose: those stay behind when the frame has changed."""
    blocks, *others = stored()
    hold = addon("scene.sequence.pose_blocks").HOLD
    return [block for block in blocks if block[1] < hold], *others


def begin(window: Window, operator: str) -> object:
    """Start it as a key would; what is running then."""
    with window.context():
        assert getattr(bpy.ops.planar, operator)("INVOKE_DEFAULT") == {"RUNNING_MODAL"}, operator
    run = addon("operators.modal.running").now()
    assert run is not None
    return run


def test_each_one_ends_each_other(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    keyed((1, 0.6), (25, -0.8))
    yield from window.hover(window.pixel((0.0, 0.0, 0.0)))
    running = addon("operators.modal.running")
    with slow_jobs():
        for first in STARTERS:
            for second in STARTERS:
                if first == second == "record_pins":
                    continue  # that one ends itself, see test_record.py
                bpy.context.scene.frame_set(13)
                before = held()
                one = begin(window, first)
                x, y = window.mouse
                yield from window.move((x + 40, y))
                if first != "settle_pose":  # which may have settled by now
                    assert running.now() is one
                    assert window.busy == [f"PLANAR_OT_{first}"]
                other = begin(window, second)
                assert running.now() is other
                yield from window.move((x, y))
                if second != "settle_pose":
                    assert running.now() is other, (first, second)
                    assert f"PLANAR_OT_{second}" in window.busy, (first, second, window.busy)
                yield from window.key("ESC")  # then those below it get events again, and end
                yield
                assert window.busy == [], (first, second, window.busy)
                assert running.now() is None
                assert held() == before or "settle_pose" in (first, second), (first, second)
