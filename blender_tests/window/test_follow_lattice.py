# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins of a lattice that follow an Empty that is moved by hand, while it is moved."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import activate, active, carrying, pin_data, sheet
from harness import Window

START = (1.5, 0.0, 0.0)


def live(window: Window) -> Iterator[None]:
    """A sheet in a lattice, with a pin at each end, of which one follows an Empty, which is active."""
    obj = sheet("Sheet")
    activate(obj)
    yield from window.look("FRONT")
    with window.context():
        bpy.ops.planar.fit_lattice(resolution=(8, 6))
        for place in ((-1.5, 0.0, 0.0), START):
            bpy.ops.planar.add_pin(location=place)
    target = bpy.data.objects.new("Target", None)
    target.location = START
    bpy.context.collection.objects.link(target)
    cage = bpy.context.object
    cage.planar.pins[1].follow = target  # from where it is, which is the same place
    cage.planar.live = True
    activate(target)
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.hover(window.pixel(START))
    yield from window.wait(0.5)


def end() -> np.ndarray:
    """Where what the right pin holds is seen."""
    obj = bpy.data.objects["Sheet"].evaluated_get(bpy.context.evaluated_depsgraph_get())
    cage = next(obj for obj in bpy.data.objects if obj.type == "LATTICE")
    group = bpy.data.objects["Sheet"].vertex_groups[cage.planar.pins[1].group].index
    held = [(v.co, g.weight) for v in obj.data.vertices for g in v.groups if g.group == group]
    return np.average([obj.matrix_world @ co for co, _ in held], axis=0, weights=[w for _, w in held])


def shape() -> np.ndarray:
    data = next(obj for obj in bpy.data.objects if obj.type == "LATTICE").data
    return np.array([point.co_deform for point in data.points])


def test_the_pin_follows_while_its_target_is_moved(window: Window) -> Iterator[None]:
    yield from live(window)
    before, start = shape(), end()
    yield from window.key("G")
    goal = window.pixel((1.5, 0.0, 0.7))
    yield from window.move(goal, steps=6)
    yield from window.wait(0.5)
    moved = np.array(bpy.data.objects["Target"].matrix_world.translation)
    assert moved[2] > 0.4, moved
    assert np.linalg.norm(end() - moved) < 0.03, "it follows before the button is released"
    window.picture("follow_lattice")
    yield from window.confirm()
    yield from window.wait(0.5)
    after = shape()
    yield from window.undo()
    yield from window.wait(0.5)
    assert np.array_equal(shape(), before), "both go back with one undo"
    yield from window.redo()
    yield from window.wait(0.5)
    assert np.allclose(shape(), after, atol=1e-3)
    assert np.linalg.norm(end() - start) > 0.4


def test_escape_takes_the_pin_back_with_its_target(window: Window) -> Iterator[None]:
    yield from live(window)
    cage = next(obj for obj in bpy.data.objects if obj.type == "LATTICE")
    for way_out in ("ESC", "RIGHTMOUSE"):
        before, pins, start = shape(), pin_data(cage), end()
        yield from window.hover(window.pixel(bpy.data.objects["Target"].location))
        yield from window.key("G")
        yield from window.move(window.pixel((1.5, 0.0, 0.7)), steps=6)
        yield from window.wait(0.6)  # a hand that rests goes on with the same motion
        yield from window.move(window.pixel((1.2, 0.0, 0.9)), steps=6)
        yield from window.wait(0.4)
        assert np.linalg.norm(end() - start) > 0.4
        yield from window.key(way_out)
        yield from window.wait(0.5)
        assert np.array_equal(shape(), before), "to the bit"
        assert pin_data(cage) == pins
        yield from window.key("G")
        yield from window.type("0.2")
        yield from window.confirm()
        yield from window.wait(0.3)
        assert not np.array_equal(shape(), before), "the next one begins where this one has ended"


def test_the_frame_takes_the_target_and_the_pin_along(window: Window) -> Iterator[None]:
    yield from live(window)
    target = bpy.data.objects["Target"]
    for frame, z in ((1, 0.0), (11, 0.6)):
        target.location.z = z
        target.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(11)
    yield from window.wait(0.5)
    assert np.linalg.norm(end() - (1.5, 0.0, 0.6)) < 0.03, end()


def test_a_lattice_that_is_carried_goes_along_in_the_drag(window: Window) -> Iterator[None]:
    """Before the button is released; Esc takes it back to the bit."""
    sheet("Flag", columns=2, rows=4, at=(1.5, -0.05, -0.5))
    with window.context():
        assert bpy.ops.planar.fit_lattice(resolution=(5, 7)) == {"FINISHED"}
    lattice = active()
    for height in (-0.1, -0.9):
        bpy.ops.planar.add_pin(location=(1.5, -0.05, height), extend=True)
    yield from carrying(window, lattice)
    name = lattice.name

    def points() -> np.ndarray:
        data = bpy.data.objects[name].data
        return np.array([point.co_deform for point in data.points])

    yield from window.hover(window.pixel((1.5, 0.0, 0.0)))
    yield from window.wait(0.3)
    before = points()
    yield from window.press()
    yield from window.move(window.pixel((1.2, 0.0, 0.7)), steps=6)
    yield from window.wait(0.5)
    assert np.abs(points() - before).max() > 0.3, "before the button is released"
    yield from window.key("ESC")
    yield from window.release()
    yield from window.wait(0.5)
    assert np.array_equal(points(), before)
