# SPDX-License-Identifier: GPL-3.0-or-later
"""A posing in Blender: the model's, with the object it is read from and written to."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property, partial

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.plane.frame import Array
from ...model.posing import solving
from ...model.posing.pins import Holder
from ...model.posing.posing import MOST_REFINEMENTS, Posing, Sample, Solved
from ...scene.flatten import pushing
from ...scene.lattice.posed import begin_posing
from ...scene.lattice.rig import waiting
from ...scene.objects import modifiers
from ...scene.objects.cutout_object import CutoutObject
from ...scene.pins import joint_list, partners, pin_list, pose_holding
from ...scene.view import snapshot
from .. import keying

NOTICED = 0.1  # seconds after which progress is shown


def selection_on_press(selected: set[int], pin: int, extend: bool) -> set[int]:
    """The pins that a drag takes along when `pin` (-1: none) is pressed: all selected ones if it is one."""
    if pin < 0 or pin in selected:
        return selected
    return {pin} | (selected if extend else set())


def selection_on_click(selected: set[int], pin: int, extend: bool) -> set[int]:
    """The selection after `pin` was pressed and released where it is."""
    return selected ^ {pin} if extend else {pin}


class ObjectPosing:
    """Begins on the active object; is moved any number of times; then is kept or taken back.

    Nothing but the selection changes before the first move. Between events only names and arrays are kept.
    """

    def __init__(
        self,
        context: bpy.types.Context,
        pressed: int = -1,
        extend: bool = False,
        *,
        settling: bool = False,
        unkeyed: bool = False,
        pivot: Sequence[float] | None = None,
        facing: Sequence[float] | None = None,
        model: type[Posing] = Posing,
    ):
        """`settling`: no pin moves, all of them hold. `unkeyed`, `facing`: as in `begin_posing`. `pivot`: a
        world position. `model`: what samples mean.

        Raises Refusal, with nothing changed.
        """
        self.drawing = begin_posing(context, unkeyed=unkeyed, facing=facing)
        obj = context.object
        covered = modifiers.covering(obj)
        if covered is not None:
            raise Refusal(covered)
        settings = obj.planar
        if pressed >= len(settings.pins):
            raise Refusal(f"There is no pin {pressed}: the object has {len(settings.pins)}")
        pin_list.sync(obj)
        self._joints = joint_list.bound_joints(obj, self.drawing)
        self._solver = joint_list.solver_of(obj, self.drawing, self._joints)
        self._pins = pin_list.model_pins(obj, self.drawing)
        if settling and not any(pin.enabled for pin in self._pins):
            raise Refusal("No pin is on and holds vertices: add or enable one in the Planar tab")
        self._selected_before = {index for index, pin in enumerate(settings.pins) if pin.select}
        self._active_before = settings.active_pin
        self._pressed, self._extend = pressed, extend
        self._wrote = False
        self._make_model = model
        self._kept_before: pin_list.SavedResults | None = None
        self._model: Posing | None = None
        self._off: list[Holder] = []
        self._moving = selection_on_press(self._selected_before, pressed, extend)
        self._settling = settling
        drawing, self._unheld = self.drawing, None
        if isinstance(drawing, CutoutObject):
            self._unheld = pose_holding.unheld(obj, lambda: drawing.distortion)
        self._uv_told: str | None = None
        self._uv = self._followed_uv(obj)
        self._pivot = (
            None if pivot is None else self.drawing.from_world(np.array([pivot], dtype=np.float64))[0]
        )
        if pressed >= 0:
            settings.active_pin = pressed
            self._select(self._moving)

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

    def run(self, path: list[Sample], *, settle: bool) -> str | None:
        """Take the pins along a path, here and now, and end with what is reached; as finish() tells.

        Raises Refusal, with everything as it was.
        """
        try:
            self.solve(path, settle=settle)
            solved = self.model.solved()
            self._write(solved.positions)
            return self.finish(solved)
        except Exception:
            self.cancel()
            raise

    def solve(
        self, path: list[Sample], seen: Callable[[Solved], None] | None = None, *, settle: bool = False
    ) -> None:
        """Solve a path, here and now, and tell `seen` of each sample; nothing is written. Raises Refusal.

        What takes longer than a moment shows its progress at the mouse.
        """
        solving.halt()
        manager = bpy.context.window_manager
        manager.progress_begin(0, len(path) + MOST_REFINEMENTS * settle)
        began = time.perf_counter()
        try:
            for count, sample in enumerate(self._samples(path, settle)):
                self.model.move(*sample)
                if seen is not None:
                    seen(self.model.solved())
                if time.perf_counter() - began > NOTICED:
                    manager.progress_update(count)
        except native.SolveError as error:
            raise Refusal(str(error)) from error
        finally:
            manager.progress_end()

    def _samples(self, path: list[Sample], settle: bool) -> Iterator[Sample]:
        yield from path
        while settle and not self.model.settled:
            yield self.model.path[-1]

    def show(self, solved: Solved) -> None:
        """Show what a thread has solved, and where all pins are by now. Raises ObjectGone."""
        self._write(solved.positions)
        results = [*solved.results, *pin_list.carried(self._off, solved.positions)]
        results += joint_list.carried(self._joints, self.drawing, solved.positions)
        snapshot.follow(self.drawing, solved.positions, results)

    def keep(self, solved: Solved) -> None:
        """Let the pins hold the drawing where this, which is shown, left it."""
        obj = self.drawing.resolve()
        self._kept_before = self._kept_before or pin_list.SavedResults(obj)
        pin_list.store_results(obj, self.drawing, solved.results)

    def finish(self, solved: Solved) -> str | None:
        """End it with this, which is shown; auto-key keys it. What the user is to be told."""
        self.keep(solved)
        told = [text for text in (self._unheld, self._uv_told) if text is not None]
        if (
            bpy.context.object == self.drawing.resolve()
            and (keyed := keying.auto_key(bpy.context)) is not None
        ):
            told.append(keyed)
        bpy.context.view_layer.update()  # while it is known to be ours
        return ". ".join(told) or None

    def cancel(self) -> None:
        """End it with everything as it was, to the bit. Raises ObjectGone."""
        obj = self.drawing.resolve()
        if self._wrote:
            self._wrote = False
            self.drawing.restore()
        if self._kept_before is not None:
            self._kept_before.restore(obj)
        self._select(self._selected_before)
        obj.planar.active_pin = self._active_before
        if self._uv is not None:
            self._uv.take_back(obj)

    def click(self) -> bool:
        """End it, unmoved, as a click on the pressed pin; whether that changed the selection."""
        after = selection_on_click(self._selected_before, self._pressed, self._extend)
        self._select(after)
        return after != self._selected_before or self._active_before != self._pressed

    def _write(self, positions: Array) -> None:
        self._wrote = True
        self.drawing.write(positions)
        if self._uv is not None:
            self._uv.follow(self.drawing.resolve())

    def _followed_uv(self, obj: bpy.types.Object) -> pushing.Following | None:
        """The UV map that follows; where it cannot, the drawing is posed all the same, and that is told."""
        try:
            return pushing.following(obj)
        except Refusal as refusal:
            self._uv_told = f"The UV map did not follow: {refusal}"
            return None

    def _select(self, wanted: set[int]) -> None:
        for index, pin in enumerate(self.drawing.resolve().planar.pins):
            pin.select = index in wanted
