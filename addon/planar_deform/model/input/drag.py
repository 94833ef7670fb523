# SPDX-License-Identifier: GPL-3.0-or-later
"""The state of a drag: how mouse, Shift, axis locks and typed numbers make an offset or a turn.

States are values: each event gives a new one. Points are where the mouse is in the cutout's plane (world
lengths), so the view is not known here. Offset and turn count from an anchor, not from the last event: a
mouse that returns to where it was gives what there was, however many events lie between. The anchor moves,
and what was reached is kept, when the same mouse position starts to mean something else: Shift is pressed or
released, or the view has changed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Literal

from ..posing.posing import Sample
from .numeric import Numeric

Mode = Literal["MOVE", "ROTATE"]
Point = tuple[float, float]

PRECISE = 0.1  # what Shift makes of a movement, as in Blender's transforms
TURN_STEP, PRECISE_TURN_STEP = math.radians(5.0), math.radians(1.0)  # what Ctrl snaps a turn to, as there


@dataclass(frozen=True)
class Drag:
    """A moving or turning of pins under way; start one with `begin`."""

    mode: Mode
    letters: tuple[str, str]  # the names of the plane's axes, which are the keys of the locks
    pivot: Point  # what ROTATE turns about
    anchor: Point  # where the mouse counts from
    point: Point  # where it is
    turn: float = 0.0  # radians from anchor to point about the pivot, whole turns included
    base: Sample = (0.0, 0.0, 0.0)  # what had been reached at the anchor
    precise: bool = False
    snapped: bool = False
    step: float = 1.0  # world length that offsets are snapped to
    lock: str = ""  # the letter of the only axis that moves, or none
    numeric: Numeric = field(default_factory=lambda: Numeric(("",)))

    @staticmethod
    def begin(mode: Mode, letters: tuple[str, str], pivot: Point, point: Point, step: float = 1.0) -> Drag:
        """A drag whose mouse is at `point`, and which has moved nothing yet."""
        return Drag(mode, letters, pivot, point, point, step=step, numeric=_no_numbers(mode, ""))

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
        if self.mode == "MOVE" and key in self.letters:
            lock = "" if self.lock == key else key
            return replace(self, lock=lock, numeric=_no_numbers(self.mode, lock))
        numeric = self.numeric.pressed(key)
        return None if numeric is None else replace(self, numeric=numeric)

    @property
    def sample(self) -> Sample:
        """(du, dv, angle) since the start: world lengths along the plane's axes, and radians."""
        if self.mode == "ROTATE":
            if self.numeric.active:
                return (0.0, 0.0, math.radians(self.numeric.values[0]))
            step = PRECISE_TURN_STEP if self.precise else TURN_STEP
            return (0.0, 0.0, self._snap(self._by_mouse[2], step))
        if self.numeric.active:
            values = self.numeric.values
            if not self.lock:
                return (values[0], values[1], 0.0)
            return (values[0], 0.0, 0.0) if self.lock == self.letters[0] else (0.0, values[0], 0.0)
        step = self.step * (PRECISE if self.precise else 1.0)
        du, dv = (self._snap(value, step) for value in self._by_mouse[:2])
        return (du if self.lock != self.letters[1] else 0.0, dv if self.lock != self.letters[0] else 0.0, 0.0)

    @property
    def text(self) -> str:
        """What the header of the view says."""
        du, dv, angle = self.sample
        if self.mode == "ROTATE":
            shown = self.numeric.shown(0) if self.numeric.active else f"{math.degrees(angle):.2f}"
            return f"Turn Pins: {shown}°"
        letters = (self.lock,) if self.lock else self.letters
        values = {self.letters[0]: du, self.letters[1]: dv}
        numbers = [
            f"{letter}: {self.numeric.shown(i) if self.numeric.active else format(values[letter], '.4f')}"
            for i, letter in enumerate(letters)
        ]
        along = f" along {self.lock}" if self.lock else ""
        return f"Move Pins: {'   '.join(numbers)}   ({math.hypot(du, dv):.4f}){along}"

    def _snap(self, value: float, step: float) -> float:
        return step * round(value / step) if self.snapped else value

    @property
    def _by_mouse(self) -> Sample:
        factor = PRECISE if self.precise else 1.0
        du, dv, angle = self.base
        if self.mode == "ROTATE":
            return (0.0, 0.0, angle + factor * self.turn)
        return (
            du + factor * (self.point[0] - self.anchor[0]),
            dv + factor * (self.point[1] - self.anchor[1]),
            0.0,
        )


def _no_numbers(mode: Mode, lock: str) -> Numeric:
    return Numeric(("",) if mode == "ROTATE" or lock else ("", ""))


def _angle(pivot: Point, point: Point) -> float:
    return math.atan2(point[1] - pivot[1], point[0] - pivot[0])
