# SPDX-License-Identifier: GPL-3.0-or-later
"""One action of posing: the model's, with the object it is read from and written to."""

from __future__ import annotations

import bpy
import numpy as np

from ..model import solver_cache
from ..model.frame import Array
from ..model.pins import Holder
from ..model.posing import PinResult, PoseAction, Sample
from ..scene import pins, snapshot
from ..scene.access import Refusal, begin


def selection_on_press(selected: set[int], pin: int, extend: bool) -> set[int]:
    """The pins that a drag takes along when `pin` (-1: none) is pressed: all selected ones if it is one."""
    if pin < 0 or pin in selected:
        return selected
    return {pin} | (selected if extend else set())


def selection_on_click(selected: set[int], pin: int, extend: bool) -> set[int]:
    """The selection after `pin` was pressed and released where it is."""
    return selected ^ {pin} if extend else {pin}


class SceneAction:
    """Begins on the active object; is moved any number of times; then is kept or taken back.

    Nothing but the selection changes before the first move. Between events only names and arrays are kept.
    """

    def __init__(self, context: bpy.types.Context, pressed: int = -1, extend: bool = False):
        """Raises Refusal, with nothing changed."""
        self.scene = begin(context)
        obj = context.object
        settings = obj.planar
        if pressed >= len(settings.pins):
            raise Refusal(f"There is no pin {pressed}: the object has {len(settings.pins)}")
        pins.sync(obj)
        self._key = obj.session_uid
        self._method = settings.method.lower()
        self._pins = pins.model_pins(obj, self.scene)
        self._selected_before = {index for index, pin in enumerate(settings.pins) if pin.select}
        self._active_before = settings.active_pin
        self._pressed, self._extend = pressed, extend
        self._wrote = False
        self._pose: PoseAction | None = None
        self._off: list[Holder] = []
        self._moving = selection_on_press(self._selected_before, pressed, extend)
        if pressed >= 0:
            settings.active_pin = pressed
            self._select(self._moving)

    @property
    def pose(self) -> PoseAction:
        """The model's action, made when first needed. Raises Refusal if no selected pin can be moved."""
        if self._pose is None:
            if not self._moving:
                raise Refusal("No pins are selected: click one first")
            usable = {pin.key for pin in self._pins if pin.enabled}
            if not self._moving & usable:
                raise Refusal("The selected pins are off or hold no vertices: enable them in the Planar tab")
            positions, cutout = self.scene.positions, self.scene.cutout
            poser = solver_cache.poser_for(self._key, cutout, self._method, positions)
            self._off = [Holder(pin, cutout) for pin in self._pins if not pin.enabled]
            self._pose = PoseAction(cutout, positions, self._pins, self._moving, poser)
        return self._pose

    def part(self) -> int:
        """The part of the cutout in whose plane the mouse moves: the pressed pin's, else a moving one's."""
        chosen = [pin for pin in self._pins if pin.key == self._pressed]
        chosen += [pin for pin in self._pins if pin.key in self._moving]
        return int(self.scene.cutout.parts[chosen[0].vertices[0]]) if chosen else 0

    def move(self, sample: Sample) -> None:
        """Take the pins to a total offset and turn, and show it. Raises ObjectGone and SolveError."""
        self.scene.resolve()
        self._write(self.pose.move(*sample))
        self._tell()

    def retrace(self, path: list[Sample]) -> None:
        """Take the pins along another path instead of the one so far, and show its end."""
        self._pose = None
        self.run(path)
        self._tell()

    def run(self, path: list[Sample]) -> None:
        """Take the pins along a path, and show its end."""
        for sample in path:
            self.pose.move(*sample)
        self._write(self.pose.positions)

    def keep(self) -> None:
        """End it with what was reached."""
        obj = self.scene.resolve()
        positions = self.pose.finish()
        self._write(positions)
        pins.store_results(obj, self.scene, self.pose.results())

    def cancel(self) -> None:
        """End it with everything as it was, to the bit. Raises ObjectGone."""
        obj = self.scene.resolve()
        if self._wrote:
            self._wrote = False
            self.scene.restore()
        self._select(self._selected_before)
        obj.planar.active_pin = self._active_before

    def click(self) -> bool:
        """End it, unmoved, as a click on the pressed pin; whether that changed the selection."""
        after = selection_on_click(self._selected_before, self._pressed, self._extend)
        self._select(after)
        return after != self._selected_before or self._active_before != self._pressed

    def _tell(self) -> None:
        """Where all pins are by now; those that are off go where the drawing takes them."""
        positions = self.pose.positions
        results = self.pose.results()
        for holder in self._off:
            place, angle = holder.place(positions), holder.fitted_angle(positions)
            results.append(PinResult(holder.pin.key, holder.part, place, place, angle))
        snapshot.follow(self.scene, positions, results)

    def _write(self, positions: Array) -> None:
        self._wrote = True
        self.scene.write(np.asarray(positions))

    def _select(self, wanted: set[int]) -> None:
        for index, pin in enumerate(self.scene.resolve().planar.pins):
            pin.select = index in wanted
