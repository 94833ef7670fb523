# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins that stand in both poses stand in every frame between them, and the drawing is no worse for it."""

import json

import bpy
import numpy as np
import pytest
from drawings import SHARED, character
from filling import generate, put, shown
from sequences import go_to, pull
from support import activate, add_pins, bar

import planar_native

STANDING = 2e-4  # of the diagonal
FRAMES = range(1, 14)


def drawing_of(obj):
    from planar_deform.scene.objects.any_object import begin_shape

    activate(obj)
    return begin_shape(bpy.context)


def holders_of(obj):
    from planar_deform.model.posing.pins import Holder
    from planar_deform.scene.pins import pin_list

    drawing = drawing_of(obj)
    return [Holder(pin, drawing.cutout) for pin in pin_list.model_pins(obj, drawing)]


def walking(name, number=0):
    """A character with pins on the handles of a published pose, keyed in it, and which two of them stand."""
    obj = character(name)
    published = json.loads((SHARED / f"{name}.json").read_text())["poses"][number]
    drawing = drawing_of(obj)
    begin, end = (drawing.from_local(np.pad(published[side], ((0, 0), (0, 1)))) for side in ("src", "dst"))
    pinned = [int(((drawing.rest - place) ** 2).sum(axis=1).argmin()) for place in begin]
    add_pins(obj, *([int(drawing.vertex_indices[row])] for row in pinned))
    feet = np.argsort(np.hypot(*(end - begin).T))[:2]
    end[feet] = begin[feet]
    put(obj, {1: drawing.rest, 13: dragged(drawing, pinned, drawing.rest[pinned] + end - begin)})
    return obj, feet


def dragged(drawing, pinned, targets, steps=20):
    """The drawing with vertices taken to targets by Hold Shape."""
    poser = planar_native.Poser(drawing.rest, drawing.faces)
    poser.set_handles(pinned)
    for step in range(1, steps + 1):
        poser.move(drawing.rest[pinned] + (targets - drawing.rest[pinned]) * step / steps)
    return poser.settle()


def places_of(obj, frames=FRAMES):
    """Where the pins are in frames (f x k x 2), and the shapes."""
    drawing, holders = drawing_of(obj), holders_of(obj)
    shapes = [drawing.flattened(shown(obj, frame)) for frame in frames]
    return np.array([[holder.place(shape) for holder in holders] for shape in shapes]), shapes


def worst(obj, shapes):
    drawing = drawing_of(obj)
    found = [planar_native.distortion(drawing.rest, shape, drawing.faces) for shape in shapes]
    return [one.area + one.angle for one in found], sum(one.flipped for one in found)


def drift(obj, pins):
    """How far pins come off the straight way between their poses, of the diagonal; and the distortions."""
    places, shapes = places_of(obj)
    along = np.linspace(0.0, 1.0, len(places))[:, None, None]
    ways = places[0] + along * (places[-1] - places[0])
    off = np.linalg.norm(places - ways, axis=2)[:, pins].max() / drawing_of(obj).diagonal
    sizes, flips = worst(obj, shapes)
    return off, max(sizes) / max(sizes[0], sizes[-1]), flips


CASES = [("elephant", 0), ("giraffe", 1), ("horse", 0), ("horse", 3), ("horse", 4), ("racoon", 3)]


@pytest.mark.parametrize(("name", "number"), CASES)
def test_feet_of_characters_stand(name, number):
    obj, feet = walking(name, number)
    generate(obj)
    off, distortion, flips = drift(obj, feet)
    assert off <= STANDING
    assert distortion <= 1.0 + 1e-3
    assert flips == 0


def stepping(plane="XY", **options):
    """A bar that stands on two patches while its other end, a pin, goes far to a side."""
    obj = bar(plane=plane, nx=24, ny=8)
    add_pins(obj, [0, 1, 25, 26], [6, 7, 31, 32], kind="PATCH")
    add_pins(obj, [224])
    pull(obj, 1, (0.0, 0.0))
    pull(obj, 13, (-0.7, 0.9))
    return obj


@pytest.mark.parametrize("plane", ["XY", "XZ", "tilted"])
def test_patches_stand_whatever_the_object_is_like(plane):
    obj = stepping(plane)
    obj.matrix_world = [[1.0, 0.4, 0.0, 3.0], [-0.3, 2.0, 0.1, -1.0], [0.0, 0.2, 1.5, 2.0], [0, 0, 0, 1]]
    generate(obj)
    off, distortion, flips = drift(obj, [0, 1])
    assert off <= STANDING
    assert distortion <= 1.0 + 1e-3
    assert flips == 0


def test_feet_stand_where_the_motion_is_smooth_and_the_next_step_lets_one_of_them_go():
    obj = stepping()
    for index, pin in enumerate(obj.planar.pins):
        pin.select = index == 1
    pull(obj, 25, (0.3, 0.2))  # the second foot is lifted
    generate(obj, smooth=True)
    assert drift(obj, [0, 1])[0] <= STANDING
    places, _ = places_of(obj, range(13, 26))
    gaps = np.linalg.norm(places[:, 0] - places[0, 0], axis=1)
    assert gaps.max() <= gaps[-1] + STANDING * drawing_of(obj).diagonal
    assert np.linalg.norm(places[-1, 1] - places[0, 1]) > 0.3


def test_pins_that_are_off_or_move_hold_nothing():
    obj = stepping()
    generate(obj)
    held = shown(obj, 7)
    obj.planar.pins[2].enabled = False  # it moves, and leads nothing where others stand
    generate(obj)
    assert np.abs(shown(obj, 7) - held).max() < 1e-6
    obj.planar.pins[0].enabled = obj.planar.pins[1].enabled = False
    generate(obj)
    assert np.abs(shown(obj, 7) - held).max() > 1e-3


def test_a_breakdown_is_the_frame_that_would_be_there():
    obj = stepping()
    generate(obj)
    wanted = shown(obj, 7)
    go_to(7)
    assert bpy.ops.planar.breakdown(percent=50.0) == {"FINISHED"}
    assert np.abs(shown(obj, 7) - wanted).max() < 1e-6


def test_feet_of_a_drawing_that_is_solved_coarsely_stand_as_well(monkeypatch):
    from planar_deform.scene.inbetweens import planning

    obj = stepping()
    generate(obj)
    wanted = shown(obj, 7)
    monkeypatch.setattr(planning, "cage_of", lambda _: 60)
    generate(obj)
    assert drift(obj, [0, 1])[0] < 5e-4  # of the middle of four vertices, of which 60 say where they are
    assert np.abs(shown(obj, 7) - wanted).max() > 0.0  # or there is no coarse mesh
