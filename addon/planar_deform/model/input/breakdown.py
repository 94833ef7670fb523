# SPDX-License-Identifier: GPL-3.0-or-later
"""A breakdown: a pose on the way from one keyed pose to the next, and the slider that chooses how far.

The slider is handled as those of Blender's own breakdowns. Its states are values: each event gives a new one.
The share counts from an anchor, which moves when the same mouse position starts to mean something else.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from ..plane.frame import Array
from .numeric import Numeric

WIDTH = 300.0  # pixels of the mouse from one pose to the other, at a UI scale of 1; as this and:
PRECISE = 1 / 8  # what Shift makes of a movement
STEP = 0.1  # what Ctrl snaps to, in Blender's sliders
OVERSHOOT = "E"  # the key that is for it there
FURTHEST = 1.0  # beyond the poses, of the way between them: as far as the solver goes


@dataclass(frozen=True)
class Slider:
    """The choice of a share under way; start one with `begin`."""

    width: float  # pixels from 0 to 100 %
    anchor: float  # where the mouse counts from
    x: float  # where it is
    base: float  # the share at the anchor
    overshoot: bool = False  # whether the share may leave 0 to 1
    precise: bool = False
    snapped: bool = False
    numeric: Numeric = field(default_factory=lambda: Numeric(("",)))

    @staticmethod
    def begin(share: float, x: float, width: float = WIDTH, *, overshoot: bool = False) -> Slider:
        """A slider that stands at a share while the mouse is at `x`."""
        return Slider(width, x, x, share, overshoot)

    def moved(self, x: float) -> Slider:
        """After the mouse went to `x`."""
        return replace(self, x=x)

    def held(self, *, shift: bool, ctrl: bool) -> Slider:
        """While these keys are held: Shift for precision, Ctrl for snapping."""
        slider = self
        if shift != self.precise:
            slider = replace(self, base=self._by_mouse, anchor=self.x, precise=shift)
        return slider if ctrl == self.snapped else replace(slider, snapped=ctrl)

    def pressed(self, key: str) -> Slider | None:
        """After a key with this name (Blender's) was pressed; None if it means nothing to a slider."""
        if key == OVERSHOOT:
            return replace(self, overshoot=not self.overshoot)
        numeric = self.numeric.pressed(key)
        return None if numeric is None else replace(self, numeric=numeric)

    @property
    def share(self) -> float:
        """How far the breakdown is on its way: 0 is the pose before, 1 the one behind."""
        if self.numeric.active:
            return limited(self.numeric.values[0] / 100.0, overshoot=self.overshoot)
        share = limited(self._by_mouse, overshoot=self.overshoot)
        return round(share / STEP) * STEP if self.snapped else share

    @property
    def text(self) -> str:
        """What the header of the view says."""
        shown = f"{100.0 * self.share:.1f} %"
        if self.numeric.active:
            shown = f"{self.numeric.shown(0)} %" + (f"  ({shown})" if self._limits else "")
        return f"Breakdown: {shown}" + ("   Overshoot" if self.overshoot else "")

    @property
    def _by_mouse(self) -> float:
        return self.base + (PRECISE if self.precise else 1.0) * (self.x - self.anchor) / self.width

    @property
    def _limits(self) -> bool:
        """Whether the typed number is not the share."""
        return abs(self.numeric.values[0] - 100.0 * self.share) > 1e-6


def limited(share: float, *, overshoot: bool) -> float:
    """The nearest share that there is: from pose to pose, or beyond them."""
    beyond = FURTHEST if overshoot else 0.0
    return min(max(share, -beyond), 1.0 + beyond)


def nearest_share(at: Callable[[float], Array], shape: Array) -> float:
    """The whole percentage of the way, as a share, whose shape is nearest to this one (n x 2).

    It is looked for in steps of 5 %, and around the best of them.
    """

    def distance(percent: int) -> float:
        return float(((at(percent / 100.0) - shape) ** 2).sum())

    coarse = min(range(0, 101, 5), key=distance)
    return min(range(max(coarse - 4, 0), min(coarse + 4, 100) + 1), key=distance) / 100.0
