# SPDX-License-Identifier: GPL-3.0-or-later
"""A long story of random drags, adds, removes and undos in one window, hasty ones and wild ones."""

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
from cutouts import active, pin_data, place, ready, shape
from harness import Window, addon

ACTIONS = 300 if os.environ.get("PLANAR_WHOLE") else 100
LEFT, RIGHT, TOP = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0), (0.2, 0.0, 0.6)


class Story:
    def __init__(self, window: Window):
        self.window = window
        self.random = np.random.default_rng(20261122)
        self.told: dict[str, int] = {}
        self.moved = 0  # drags that were waited for and moved the drawing

    def somewhere(self) -> tuple[int, int]:
        """A place in the view, clear of what lies over it."""
        region = self.window.region()
        x = self.random.uniform(region.x + 90, region.x + region.width - 130)
        y = self.random.uniform(region.y + 90, region.y + region.height - 90)
        return round(x), round(y)

    def pins_in_view(self) -> list[tuple[int, int]]:
        """Where pins are on the screen, without those that were pushed out of the view."""
        region = self.window.region()
        pixels = [self.window.pixel(place(index)) for index in range(len(active().planar.pins))]
        return [
            (x, y)
            for x, y in pixels
            if 90 < x - region.x < region.width - 130 and 90 < y - region.y < region.height - 90
        ]

    def any_pin(self) -> tuple[int, int]:
        seen = self.pins_in_view()
        return seen[int(self.random.integers(len(seen)))]

    def drag(self) -> Iterator[None]:
        """Some pin to somewhere, in few events; half of the time without waiting for it to settle."""
        window, before = self.window, shape()
        yield from window.move(self.any_pin())
        yield from window.press()
        yield from window.move(self.somewhere(), steps=int(self.random.integers(1, 4)))
        yield from window.release()
        if self.random.random() < 0.5:
            yield from window.settled()
            self.moved += not np.array_equal(shape(), before)

    def escape(self) -> Iterator[None]:
        yield from self.window.settled()
        before = shape()
        yield from self.window.move(self.any_pin())
        yield from self.window.press()
        yield from self.window.move(self.somewhere())
        yield from self.window.key("ESC")
        yield from self.window.release()
        assert np.array_equal(shape(), before), "Esc restores every bit"

    def add(self) -> Iterator[None]:
        """A pin where the drawing is hit, if there are not too many."""
        if len(active().planar.pins) >= 12:
            return
        yield from self.window.move(self.somewhere())
        yield from self.window.press(ctrl=True)
        yield from self.window.release(ctrl=True)

    def remove(self) -> Iterator[None]:
        if len(active().planar.pins) <= 3:
            return
        yield from self.window.move(self.any_pin())
        yield from self.window.press()
        yield from self.window.release()
        yield from self.window.key("X")

    def undo(self) -> Iterator[None]:
        """A drag and its undo, sometimes its redo, too."""
        yield from self.window.settled()
        before = shape()
        yield from self.drag()
        yield from self.window.settled()
        after = shape()
        if np.array_equal(before, after):
            return  # another pin lay over it, or the mouse came back
        yield from self.window.undo()
        assert np.array_equal(shape(), before)
        if self.random.random() < 0.5:
            yield from self.window.redo()
            assert np.array_equal(shape(), after)

    def turn(self) -> Iterator[None]:
        yield from self.window.move(self.somewhere())
        yield from self.window.key("A")
        yield from self.window.key("R")
        yield from self.window.type(str(int(self.random.integers(10, 90))))
        yield from self.window.confirm()
        yield from self.window.key("A", alt=True)

    def switch(self) -> Iterator[None]:
        """Turn some pin off or on."""
        pins = active().planar.pins
        item = pins[int(self.random.integers(len(pins)))]
        item.enabled = not item.enabled or sum(pin.enabled for pin in pins) < 3
        bpy.ops.ed.undo_push(message="Switch a Pin")
        yield

    def tell(self) -> Iterator[None]:
        kinds = ("drag", "escape", "add", "remove", "undo", "turn", "switch")
        for _ in range(ACTIONS):
            if len(self.pins_in_view()) < 2:
                yield from self.window.settled()
                bpy.ops.planar.reset_to_rest("EXEC_DEFAULT", True)
                self.told["reset"] = self.told.get("reset", 0) + 1
            kind = str(self.random.choice(kinds, p=(0.5, 0.08, 0.12, 0.1, 0.1, 0.03, 0.07)))
            yield from getattr(self, kind)()
            self.told[kind] = self.told.get(kind, 0) + 1
            assert np.isfinite(shape()).all(), self.told
        yield from self.window.settled()


def flipped() -> int:
    """Flipped triangles of what is shown, judged on the float32 coordinates that Blender stores."""
    drawing = addon("scene.objects.cutout_object").read_cutout(active())
    return (
        addon("native").distortion(drawing.cutout.rest, drawing.positions, drawing.cutout.triangles).flipped
    )


def test_a_long_story_ends_well(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT, TOP)
    before = shape()
    story = Story(window)
    yield from story.tell()
    print(f"NOTE {story.told}, {story.moved} drags seen to move the drawing", flush=True)
    assert story.moved > ACTIONS // 8, "the story is about dragging"
    assert window.busy == []
    posed, pins = shape(), pin_data()
    assert np.isfinite(posed).all()
    assert not np.array_equal(posed, before)
    assert np.array_equal(posed[:, 1], before[:, 1]), "the drawing is flat"
    assert flipped() == 0
    assert tuple(active().location) == (0.0, 0.0, 0.0), "only pins were moved"
    window.picture("stress")
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "story.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
    yield from window.wait(0.3)
    assert np.array_equal(shape(), posed)
    assert pin_data() == pins
    assert flipped() == 0
