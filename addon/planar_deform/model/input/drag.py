# SPDX-License-Identifier: GPL-3.0-or-later
"""The state of a drag: how mouse, Shift, axis locks and typed numbers make an offset, a turn or a spread.

States are values: each event gives a new one. Points are where the mouse is in the cutout's plane (world
lengths), so the view is not known here. What is reached counts from an anchor, not from the last event: a
mouse that returns to where it was gives what there was, however many events lie between. The anchor moves,
and what was reached is kept, when the same mouse position starts to mean something else: Shift is pressed or
released, or the view has changed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Literal

from ..plane.axes import Orientation, PlaneAxes
from ..posing.posing import Sample
from ..posing.spreading import growth
from .numeric import Numeric

Mode = Literal["MOVE", "ROTATE", "SPREAD"]
Point = tuple[float, float]

PRECISE = 0.1  # what Shift makes of a movement, as in Blender's transforms
TURN_STEP, PRECISE_TURN_STEP = math.radians(5.0), math.radians(1.0)  # what Ctrl snaps a turn to, as there
SPREAD_STEP = 0.1  # and a factor


@dataclass(frozen=True)
class Drag:
    """A moving, turning or spreading of pins under way; start one with `begin`."""

    mode: Mode
    global_axes: PlaneAxes  # whose letters are the keys of the locks, pressed once
    local_axes: PlaneAxes  # and pressed twice
    pivot: Point  # what ROTATE turns about, and SPREAD leads away from
    anchor: Point  # where the mouse counts from
    point: Point  # where it is
    turn: float = 0.0  # radians from anchor to point about the pivot, whole turns included
    base: Sample = (0.0, 0.0, 0.0)  # what had been reached at the anchor
    precise: bool = False
    snapped: bool = False
    step: float = 1.0  # world length that offsets are snapped to
    reach: float = 1.0  # world length by which a mouse that goes away from the pivot doubles a spread
    orientation: Orientation = "GLOBAL"  # of the axes that locks, typed numbers and snapping are about
    lock: str = ""  # the letter of the only axis that moves, or none
    numeric: Numeric = field(default_factory=lambda: Numeric(("",)))

    @staticmethod
    def begin(
        mode: Mode,
        global_axes: PlaneAxes,
        local_axes: PlaneAxes,
        pivot: Point,
        point: Point,
        step: float = 1.0,
    ) -> Drag:
        """A drag whose mouse is at `point`, and which has moved nothing yet."""
        reach = max(math.dist(pivot, point), step)
        numeric = _no_numbers(mode, "")
        return Drag(
            mode, global_axes, local_axes, pivot, point, point, step=step, reach=reach, numeric=numeric
        )

    @property
    def axes(self) -> PlaneAxes:
        """Those that locks, typed numbers and snapping are about."""
        return self.global_axes if self.orientation == "GLOBAL" else self.local_axes

    @property
    def letters(self) -> str:
        """The keys that lock an axis."""
        return "" if self.mode == "ROTATE" else "XYZ"

    def moved(self, point: Point) -> Drag:
        """After the mouse went to `point`."""
        turn = _angle(self.pivot, point) - _angle(self.pivot, self.anchor)
        turn += math.tau * round((self.turn - turn) / math.tau)  # the nearest to where it was
        return replace(self, point=point, turn=turn)

    def seen_from_elsewhere(self, point: Point) -> Drag:
        """After the view changed under a resting mouse, which is now at `point` of the plane."""
        return replace(self, base=self._by_mouse, anchor=point, point=point, turn=0.0)

    def held(self, *, shift: bool, ctrl: bool) -> Drag:
        """While these keys are held: Shift for precision, Ctrl for snapping."""
        drag = self if shift == self.precise else replace(self.seen_from_elsewhere(self.point), precise=shift)
        return drag if ctrl == self.snapped else replace(drag, snapped=ctrl)

    def pressed(self, key: str) -> Drag | None:
        """After a key with this name (Blender's) was pressed; None if it means nothing to a drag."""
        if key in self.letters:
            return self._locked(key)
        numeric = self.numeric.pressed(key)
        return None if numeric is None else replace(self, numeric=numeric)

    def _locked(self, letter: str) -> Drag:
        """To the global axis of this letter, then to the local one, then to none.

        An axis that does not lie in the plane leaves nothing that could be moved.
        """
        order: Orientation = "GLOBAL"
        lock = letter
        if letter == self.lock and self.orientation == "GLOBAL":
            order = "LOCAL"
        elif letter == self.lock:
            lock = ""
        return replace(self, lock=lock, orientation=order, numeric=_no_numbers(self.mode, lock))

    @property
    def sample(self) -> Sample:
        """(du, dv, angle) since the start: world lengths along the plane's u and v, and radians.

        Of SPREAD as posing/spreading.py has it.
        """
        if self.mode == "ROTATE":
            if self.numeric.active:
                return (0.0, 0.0, math.radians(self.numeric.values[0]))
            step = PRECISE_TURN_STEP if self.precise else TURN_STEP
            return (0.0, 0.0, self._snap(self._by_mouse[2], step))
        if self.mode == "SPREAD":
            if not self.lock:
                return growth(self.grown)
            axis = self.axes.along(self.lock)
            return (0.0, 0.0, 0.0) if axis is None else growth(self.grown, axis)
        return (*self.axes.offset(self._values), 0.0)

    @property
    def grown(self) -> float:
        """The share by which a spread makes distances from the pivot grow."""
        if self.numeric.active:
            return self.numeric.values[0] - 1.0
        step = SPREAD_STEP * (PRECISE if self.precise else 1.0)
        return max(self._snap(self._by_mouse[0], step), -1.0)

    @property
    def text(self) -> str:
        """What the header of the view says."""
        if self.mode == "ROTATE":
            shown = self.numeric.shown(0) if self.numeric.active else f"{math.degrees(self.sample[2]):.2f}"
            return f"Turn Pins: {shown}°"
        if self.mode == "SPREAD":
            shown = self.numeric.shown(0) if self.numeric.active else f"{1.0 + self.grown:.4f}"
            return f"Spread Pins: {shown}{self._along}"
        letters = (self.lock,) if self.lock else self.axes.letters
        values = {self.lock: 0.0, **dict(zip(self.axes.letters, self._values, strict=True))}
        numbers = [
            f"{letter}: {self.numeric.shown(i) if self.numeric.active else format(values[letter], '.4f')}"
            for i, letter in enumerate(letters)
        ]
        return f"Move Pins: {'   '.join(numbers)}   ({math.hypot(*self._values):.4f}){self._along}"

    @property
    def _along(self) -> str:
        """How the header names the lock."""
        if not self.lock:
            return ""
        across = "" if self.axes.along(self.lock) else ", which does not lie in the drawing"
        return f" along {self.orientation.lower()} {self.lock}{across}"

    @property
    def _values(self) -> Point:
        """How far it has moved along each axis."""
        if self.numeric.active and not self.lock:
            return self.numeric.values[0], self.numeric.values[1]
        if self.numeric.active:
            one = self.numeric.values[0]
            first, second = one, one
        else:
            step = self.step * (PRECISE if self.precise else 1.0)
            du, dv, _ = self._by_mouse
            first, second = (self._snap(value, step) for value in self.axes.values((du, dv)))
        letters = self.axes.letters
        free = [self.lock in ("", letter) for letter in letters]
        return first if free[0] else 0.0, second if free[1] else 0.0

    def _snap(self, value: float, step: float) -> float:
        return step * round(value / step) if self.snapped else value

    @property
    def _by_mouse(self) -> Sample:
        factor = PRECISE if self.precise else 1.0
        du, dv, angle = self.base
        if self.mode == "ROTATE":
            return (0.0, 0.0, angle + factor * self.turn)
        if self.mode == "SPREAD":
            away = math.dist(self.pivot, self.point) - math.dist(self.pivot, self.anchor)
            return (du + factor * away / self.reach, 0.0, 0.0)
        return (
            du + factor * (self.point[0] - self.anchor[0]),
            dv + factor * (self.point[1] - self.anchor[1]),
            0.0,
        )


def _no_numbers(mode: Mode, lock: str) -> Numeric:
    return Numeric(("", "") if mode == "MOVE" and not lock else ("",))


def _angle(pivot: Point, point: Point) -> float:
    return math.atan2(point[1] - pivot[1], point[0] - pivot[0])
