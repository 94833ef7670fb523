# SPDX-License-Identifier: GPL-3.0-or-later
"""One thing runs at a time: what a script's operators, undo, another file and unregistering do to it.

What operators start in a window is made here as they make it: without one they do not wait for events.
"""

import base64
import time

import bpy
import numpy as np
import pytest
from sequences import go_to, key
from support import add_end_pins, bar, coordinates

STILL, FAR = (0.0, 0.0, 0.0), (0.0, 0.4, 0.0)
KEYED = (1, 25, 49)


def held(obj):
    """All that a posing may change and Esc takes back."""
    settings, keys = obj.planar, obj.data.shape_keys
    return (
        coordinates(obj.data.vertices).tobytes(),
        [(block.name, block.frame, coordinates(block.data).tobytes()) for block in keys.key_blocks],
        keys.eval_time,
        [pin.select for pin in settings.pins],
        [pose.at for pose in settings.poses],
        bpy.context.scene.frame_current,
    )


def scene():
    """A bar with two pins and three keyed poses, at a frame between two of them."""
    obj = bar()
    add_end_pins(obj)
    for seed, frame in enumerate(KEYED):
        key(obj, frame, seed)
    go_to(13)
    return obj


def drag(kind=None, *, settling=False):
    from planar_deform.operators.modal.session import Session
    from planar_deform.operators.modal.several_posing import begin, begin_settling

    context = bpy.context
    posing = begin_settling(context) if settling else begin(context, unkeyed=kind is not None)
    session = Session(context, posing, "Keys") if kind is None else kind(context, posing)
    session.ask(STILL if settling else FAR)
    until = time.monotonic() + 20.0
    while not session.catch_up():  # which waits but a moment each time
        assert time.monotonic() < until
    assert session.shown is not None
    return session


def released_drag():
    session = drag()
    session.release()
    return session


def settling():
    session = drag(settling=True)
    session.release()
    return session


def waiting():
    from planar_deform.operators.modal import running
    from planar_deform.operators.record import _Waiting

    run = _Waiting()
    running.start(run)
    return run


def take():
    from planar_deform.operators.record import _Take

    run = drag(_Take)
    bpy.context.scene.frame_set(17)
    run.show(again=True)
    return run


def sliding():
    from planar_deform.operators.breakdown import Ways, _Sliding
    from planar_deform.operators.modal import running

    way = Ways(bpy.context, [bpy.context.object])
    run = _Sliding(way)
    running.start(run)
    assert run.work.wait(60.0)
    way.show(0.9)
    return run


def job():
    from planar_deform.operators.modal import running
    from planar_deform.operators.modal.long_job import Job, LongRun

    obj = bpy.context.object

    def write(_):
        before = obj.data.vertices[0].co.copy()
        try:
            obj.data.vertices[0].co.x += 1.0
            yield 0.1
            yield 0.2
        except GeneratorExit:
            obj.data.vertices[0].co = before
            raise

    run = LongRun(Job(write))
    running.start(run)
    assert not run.advance(5.0, 0.0)
    return run


TAKEN_BACK = {"drag": drag, "waiting": waiting, "take": take, "breakdown": sliding, "job": job}
KEPT = {"released drag": released_drag, "settling": settling}
STARTERS = {**TAKEN_BACK, **KEPT}


@pytest.fixture(autouse=True)
def _ended():
    yield
    from planar_deform.operators.modal import running

    running.end()
    running.stop_clocks()


@pytest.mark.parametrize("second", STARTERS)
@pytest.mark.parametrize("first", STARTERS)
def test_whatever_begins_ends_what_is_running(first, second):
    from planar_deform.operators.modal import running
    from planar_deform.scene.view import snapshot

    obj = scene()
    before = held(obj)
    one = STARTERS[first]()
    assert running.now() is one
    running.end()
    after = held(obj)
    assert (after == before) == (first not in KEPT)
    other = STARTERS[second]()
    assert running.now() is other
    during = held(obj)
    if hasattr(one, "end"):
        one.end()  # as its operator does it, at its next event
    assert running.now() is other
    assert held(obj) == during
    assert snapshot.following(obj) == (second not in ("waiting", "job"))


@pytest.mark.parametrize("first", STARTERS)
def test_started_over_another_one_it_is_the_only_one(first):
    from planar_deform.operators.modal import running

    obj = scene()
    before = held(obj)
    one = STARTERS[first]()
    other = waiting()
    assert running.now() is other
    assert (held(obj) == before) == (first not in KEPT)
    assert getattr(one, "ended", True)
    assert getattr(one, "stopped", True)


def packed(samples):
    return base64.b64encode(np.asarray(samples, "<f4").tobytes()).decode("ascii")


SCRIPTS = {
    "drag_pins": {"offset": (0.1, 0.1)},
    "rotate_pins": {"angle": 0.1},
    "settle_pose": {},
    "record_pins": {"path": packed([STILL, (0.1, 0.0, 0.0), (0.2, 0.0, 0.0)])},
    "breakdown": {"percent": 30.0},
    "generate_inbetweens": {},
    "key_pose": {},
    "reset_to_rest": {},
    "remove_pins": {},
}


@pytest.mark.parametrize("script", SCRIPTS)
def test_a_script_s_operator_ends_what_is_running(script):
    """And does what it does without that, unless that is kept."""
    from planar_deform.operators.modal import running

    alone = None
    for first, start in {"nothing": lambda: None, **STARTERS}.items():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        obj = scene()
        start()
        assert getattr(bpy.ops.planar, script)(**SCRIPTS[script]) == {"FINISHED"}, first
        assert running.now() is None, first
        alone = alone or held(obj)
        assert held(obj) == alone or first in KEPT, first


@pytest.mark.parametrize("first", STARTERS)
@pytest.mark.parametrize("event", ["undo", "redo", "load"])
def test_undo_and_another_file_end_it_and_do_what_they_do(first, event):
    from planar_deform.operators.modal import running
    from planar_deform.scene.view import snapshot

    obj = scene()
    uid = obj.session_uid
    bpy.ops.ed.undo_push(message="Start")
    states = [held(obj)]
    obj.data.vertices[0].co.x += 0.5
    bpy.ops.ed.undo_push(message="Step")
    states.append(held(obj))
    if event == "redo":
        bpy.ops.ed.undo()
    run = STARTERS[first]()
    if event == "load":
        bpy.ops.wm.read_factory_settings(use_empty=True)
    else:
        getattr(bpy.ops.ed, event)()
        assert held(bpy.data.objects["Cutout"]) == states[event == "redo"]
    assert running.now() is None
    assert uid not in snapshot._followed
    assert getattr(run, "ended", True)
    assert getattr(run, "stopped", True)


@pytest.mark.parametrize("first", STARTERS)
def test_turning_the_add_on_off_ends_it(first):
    import planar_deform
    from planar_deform.operators.modal import running

    obj = scene()
    before = held(obj)[:3]
    STARTERS[first]()
    planar_deform.unregister()
    try:
        assert running.now() is None
        assert running._clocks == set()
        keys = obj.data.shape_keys
        after = (
            coordinates(obj.data.vertices).tobytes(),
            [(block.name, block.frame, coordinates(block.data).tobytes()) for block in keys.key_blocks],
            keys.eval_time,
        )
        assert (after == before) == (first not in KEPT)
    finally:
        planar_deform.register()


def test_record_pressed_again_ends_the_recording():
    from planar_deform.operators.modal import running

    scene()
    waiting().conclude()
    assert running.now() is None
    recording = take()
    recording.conclude()
    assert recording.concluded
    assert running.now() is recording, "until its operator has kept the motion"


class Hands:
    """An interactive operator of which every event goes wrong."""

    def __init__(self, session):
        self._session, self.reports = session, []

    def report(self, kind, message):
        self.reports.append(message)

    def handle(self, context, event):
        raise ZeroDivisionError("by zero")


@pytest.mark.parametrize("start", [drag, take, released_drag])
def test_an_error_on_the_way_ends_it_once_with_everything_as_it_was(start, capfd, monkeypatch):
    from planar_deform.operators.modal import running
    from planar_deform.operators.modal.session import Interactive
    from planar_deform.operators.modal.several_posing import SeveralPosing

    def fail(*_):
        raise ZeroDivisionError("by zero")

    obj = scene()
    before = held(obj)
    operator = type("Broken", (Hands, Interactive), {})(start())
    assert held(obj) != before
    monkeypatch.setattr(SeveralPosing, "finish", fail)
    event = type("Event", (), {"type": "RET", "value": "PRESS"})()
    assert operator.modal(bpy.context, event) == {"CANCELLED"}
    assert held(obj) == before
    assert running.now() is None
    assert len(operator.reports) == 1
    assert capfd.readouterr().err.count("Traceback") == 1
    assert running._clocks == set()
    assert operator.modal(bpy.context, event) == {"CANCELLED"}, "once"
    assert len(operator.reports) == 1
