# SPDX-License-Identifier: GPL-3.0-or-later
"""A posing of one object: the model's, with the object it is read from and written to."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, partial

import bpy
import numpy as np

from ...errors import Refusal
from ...model.posing.pins import Holder
from ...model.posing.posing import Posing, Solved
from ...scene.flatten import pushing
from ...scene.lattice.posed import begin_posing
from ...scene.lattice.rig import waiting
from ...scene.objects import modifiers
from ...scene.objects.cutout_object import CutoutObject
from ...scene.pins import joint_list, partners, pin_list, pose_holding
from ...scene.sequence.playback import Steps
from ...scene.view import snapshot
from .. import keying
from .reports import Tell


class ObjectPosing:
    """Begins on an object; is moved any number of times; then is kept or taken back.

    Nothing changes before the first move. Between events only names and arrays are kept.
    """

    def __init__(
        self,
        context: bpy.types.Context,
        obj: bpy.types.Object,
        moving: set[int] | None,
        *,
        pressed: int = -1,
        unkeyed: bool = False,
        pivot: Sequence[float] | None = None,
        facing: Sequence[float] | None = None,
        model: type[Posing] = Posing,
    ):
        """`moving`: the pins that move, by their indices; None: all of them hold, and the pose settles.
        `pressed`: the one that the mouse is on. `unkeyed`, `facing`: as in `begin_posing`. `pivot`: a world
        position. `model`: what samples mean.

        Raises Refusal.
        """
        self.drawing = begin_posing(context, obj, unkeyed=unkeyed, facing=facing)
        covered = modifiers.covering(obj)
        if covered is not None:
            raise Refusal(covered)
        pin_list.sync(obj)
        self._joints = joint_list.bound_joints(obj, self.drawing)
        self._solver = joint_list.solver_of(obj, self.drawing, self._joints)
        self._pins = pin_list.model_pins(obj, self.drawing)
        if moving is None and not any(pin.enabled for pin in self._pins):
            raise Refusal("No pin is on and holds vertices: add or enable one in the Planar tab")
        self._pressed, self._settling, self._moving = pressed, moving is None, moving or set()
        self._wrote = False
        self._make_model = model
        self._kept_before: pin_list.SavedResults | None = None
        self._model: Posing | None = None
        self._off: list[Holder] = []
        drawing, self._unheld = self.drawing, None
        if isinstance(drawing, CutoutObject):
            self._unheld = pose_holding.unheld(obj, lambda: drawing.distortion)
        self._led_away = _led_away(obj, self._moving)
        self._uv_told: str | None = None
        self._uv = self._followed_uv(obj)
        self.pivot_given = pivot is not None
        self._pivot = (
            None if pivot is None else self.drawing.from_world(np.array([pivot], dtype=np.float64))[0]
        )

    @property
    def model(self) -> Posing:
        """The model's posing, made when first needed. Raises Refusal if no selected pin can be moved."""
        if self._model is None:
            usable = {pin.key for pin in self._pins if pin.enabled}
            moving = set() if self._settling else self._moving & usable
            if not self._settling and not self._moving:
                raise Refusal("No pins are selected: click one first")
            if not self._settling and not moving:
                raise Refusal(
                    joint_list.unmoved(self.drawing.resolve(), self._moving)
                    or waiting(self.drawing.resolve(), self._moving)
                    or "The selected pins are off or hold no vertices: enable them in the Planar tab"
                )
            positions, cutout = self.drawing.positions, self.drawing.cutout
            make_poser = partial(self._solver, positions)
            self._off = [Holder(pin, cutout) for pin in self._pins if not pin.enabled]
            self._model = self._make_model(cutout, positions, self._pins, moving, make_poser, self._pivot)
            self._model.mirrored = partners.going_along(self.drawing.resolve(), cutout, self._pins, moving)
        return self._model

    @cached_property
    def leading(self) -> Holder | None:
        """The pin in whose plane the mouse moves: the pressed one, else a moving one."""
        chosen = [pin for pin in self._pins if pin.key == self._pressed]
        chosen += [pin for pin in self._pins if pin.key in self._moving]
        return Holder(chosen[0], self.drawing.cutout) if chosen else None

    def show(self, solved: Solved) -> None:
        """Show what a thread has solved, and where all pins are by now. Raises ObjectGone."""
        self.write(solved)
        results = [*solved.results, *pin_list.carried(self._off, solved.positions)]
        results += joint_list.carried(self._joints, self.drawing, solved.positions)
        snapshot.follow(self.drawing, solved.positions, results)

    def keep(self, solved: Solved) -> None:
        """Let the pins hold the drawing where this, which is shown, left it."""
        obj = self.drawing.resolve()
        self._kept_before = self._kept_before or pin_list.SavedResults(obj)
        pin_list.store_results(obj, self.drawing, solved.results)

    def finish(self, solved: Solved, tell: Tell) -> Steps:
        """End it with this, which is shown; auto-key keys it, see playback.together()."""
        self.keep(solved)
        for text in (self._unheld, self._led_away, self._uv_told):
            if text is not None:
                tell(text)
        yield from keying.auto_key(bpy.context, self.drawing.resolve(), tell)

    def cancel(self) -> None:
        """End it with everything as it was, to the bit. Raises ObjectGone."""
        obj = self.drawing.resolve()
        if self._wrote:
            self._wrote = False
            self.drawing.restore()
        if self._kept_before is not None:
            self._kept_before.restore(obj)
        if self._uv is not None:
            self._uv.take_back(obj)

    def write(self, solved: Solved) -> None:
        """Let the object show this."""
        self._wrote = True
        self.drawing.write(solved.positions)
        if self._uv is not None:
            self._uv.follow(self.drawing.resolve())

    def _followed_uv(self, obj: bpy.types.Object) -> pushing.Following | None:
        """The UV map that follows; where it cannot, the drawing is posed all the same, and that is told."""
        try:
            return pushing.following(obj)
        except Refusal as refusal:
            self._uv_told = f"The UV map did not follow: {refusal}"
            return None


def _led_away(obj: bpy.types.Object, moving: set[int]) -> str | None:
    """What is to be told where pins are moved by hand that follow something: they do not stay."""
    going = [pin for pin in (obj.planar.pins[key] for key in sorted(moving)) if pin.follow is not None]
    if not going or not obj.planar.live:
        return None
    names = ", ".join(f"'{pin.name}'" for pin in going) + (" go" if going[1:] else " goes")
    return (
        f"{names} back to '{going[0].follow.name}' with the next frame: move that, or keep this by Set Offset"
    )
