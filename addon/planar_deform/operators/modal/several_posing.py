# SPDX-License-Identifier: GPL-3.0-or-later
"""The posings of all objects whose selected pins move, as one."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial

import bpy
import numpy as np

from ... import native
from ...errors import ObjectGone, Refusal, naming, try_all
from ...model.posing import solving
from ...model.posing.pins import Holder
from ...model.posing.posing import MOST_REFINEMENTS, Posing, Sample
from ...model.posing.together import Part, Plane, SolvedTogether, Together
from ...scene.lattice.posed import PosedObject
from ...scene.pins import taking_part
from ...scene.pins.pin_list import is_joint
from ...scene.sequence import playback
from .object_posing import ObjectPosing
from .pin_selection import PinSelection
from .reports import telling

NOTICED = 0.1  # seconds after which progress is shown


class SeveralPosing:
    """Moves the posings of several objects as one; is kept or taken back with all of them.

    Samples are told in the plane of the first, whose pin is pressed, or which is the active object.
    """

    def __init__(self, posings: Sequence[ObjectPosing], selection: PinSelection | None = None):
        self.posings = list(posings)
        self._selection = selection
        self._model: Together | None = None

    @property
    def drawing(self) -> PosedObject:
        """The first one's."""
        return self.posings[0].drawing

    @property
    def names(self) -> list[str]:
        """Of the objects."""
        return [posing.drawing.object_name for posing in self.posings]

    @property
    def leading(self) -> Holder | None:
        """The pin in whose plane the mouse moves."""
        return self.posings[0].leading

    @property
    def model(self) -> Together:
        """The model's posing, made when first needed. Raises Refusal if a selected pin cannot be moved."""
        if self._model is None:
            parts = []
            for posing, name in self._named():
                with naming(name):
                    plane = Plane.of(posing.drawing.frame, self.drawing.frame)
                    parts.append(Part(posing.model, plane, name))
            self._share([part.posing for part in parts])
            self._model = Together(parts)
        return self._model

    def _share(self, models: list[Posing]) -> None:
        """Let all turn about one pivot, and spread from it."""
        movers = [model.movers for model in models]
        if len(models) == 1 or not any(movers):
            return
        pairs = list(zip(self.posings, models, strict=True))
        places = [posing.drawing.to_world(model.pivot[None, :])[0] for posing, model in pairs]
        middle = np.average(places, axis=0, weights=movers)
        for posing, model in pairs:
            model.companions = sum(movers) - model.movers
            if not posing.pivot_given:
                model.pivot = posing.drawing.from_world(middle[None, :])[0]

    def _named(self) -> Iterator[tuple[ObjectPosing, str | None]]:
        """The posings, with the names that refusals have to tell."""
        for posing in self.posings:
            yield posing, posing.drawing.object_name if len(self.posings) > 1 else None

    @property
    def visible(self) -> bool:
        """Whether all of it can be seen. Raises ObjectGone."""
        return all(posing.drawing.resolve().visible_get() for posing in self.posings)

    def run(
        self, path: list[Sample], *, settle: bool, ways: Sequence[Sequence[Sample]] | None = None
    ) -> str | None:
        """Take the pins along a path, here and now, and end with what is reached; as finish() tells.

        `ways`: those that each posing has gone along the path before. Raises Refusal, with everything as it
        was.
        """
        try:
            self.solve(path, settle=settle, ways=ways)
            solved = self.model.solved()
            for (posing, name), one in zip(self._named(), solved.each, strict=True):
                with naming(name):
                    posing.write(one)
            return self.finish(solved)
        except Exception:
            self.cancel()
            raise

    def solve(
        self,
        path: list[Sample],
        seen: Callable[[SolvedTogether], None] | None = None,
        *,
        settle: bool = False,
        ways: Sequence[Sequence[Sample]] | None = None,
    ) -> None:
        """Solve a path, here and now, and tell `seen` of each sample; nothing is written. Raises Refusal.

        What takes longer than a moment shows its progress at the mouse. `ways`: as in run().
        """
        solving.halt()
        manager = bpy.context.window_manager
        manager.progress_begin(0, len(path) + MOST_REFINEMENTS * settle)
        began = time.perf_counter()
        steps = self._steps(path, settle) if ways is None else self.model.again(path, ways)
        try:
            for count, _ in enumerate(steps):
                if seen is not None:
                    seen(self.model.solved())
                if time.perf_counter() - began > NOTICED:
                    manager.progress_update(count)
        except native.SolveError as error:
            raise Refusal(str(error)) from error
        finally:
            manager.progress_end()

    def _steps(self, path: Iterable[Sample], settle: bool) -> Iterator[None]:
        for sample in path:
            self.model.move(*sample)
            yield
        while settle and not self.model.settled:
            self.model.move(*self.model.path[-1])
            yield

    def show(self, solved: SolvedTogether) -> None:
        """Show what a thread has solved, and where all pins are by now. Raises ObjectGone."""
        for (posing, name), one in zip(self._named(), solved.each, strict=True):
            with naming(name):
                posing.show(one)

    def keep(self, solved: SolvedTogether) -> None:
        """Let the pins hold the drawings where this, which is shown, left them."""
        for posing, one in zip(self.posings, solved.each, strict=True):
            posing.keep(one)

    def finish(self, solved: SolvedTogether) -> str | None:
        """End it with this, which is shown; auto-key keys it. What the user is to be told."""
        told: list[str] = []
        steps = []
        for (posing, name), one in zip(self._named(), solved.each, strict=True):
            steps.append(playback.named(name, posing.finish(one, telling(told, name))))
        playback.run(playback.together(steps))
        bpy.context.view_layer.update()  # while it is known to be ours
        return ". ".join(told) or None

    def cancel(self) -> None:
        """End it with everything as it was, to the bit, as far as it is there."""
        undo: list[Callable[[], None]] = [partial(_cancel, posing) for posing in self.posings]
        if self._selection is not None:
            undo.append(self._selection.restore)
        try_all(undo)

    def click(self) -> bool:
        """End it, unmoved, as a click on the pressed pin; whether that changed the selection."""
        assert self._selection is not None  # a pin is pressed
        return self._selection.click()


def _cancel(posing: ObjectPosing) -> None:
    with contextlib.suppress(ObjectGone):  # then there is nothing to put back
        posing.cancel()


def begin(
    context: bpy.types.Context,
    pressed: int = -1,
    extend: bool = False,
    *,
    of: str = "",
    unkeyed: bool = False,
    pivot: Sequence[float] | None = None,
    facing: Sequence[float] | None = None,
    model: type[Posing] = Posing,
) -> SeveralPosing:
    """The posing of the selected pins of all objects that take part, after a press on one of them.

    `pressed`: that pin, by its index, of the object of the name `of` or the active one; -1: none. Nothing but
    the selection changes before the first move. Raises Refusal, with nothing changed.
    """
    selection = PinSelection(context)
    lead = of or ("" if context.object is None else context.object.name)
    moving = selection.moved(lead, pressed, extend)
    posings = []
    names = _moved_objects(moving, lead if pressed >= 0 else None) or [lead]
    for name in names:
        with naming(name if len(names) > 1 else None):
            one = ObjectPosing(
                context,
                bpy.data.objects.get(name),
                moving.get(name, set()),
                pressed=pressed if name == lead else -1,
                unkeyed=unkeyed,
                pivot=pivot,
                facing=facing,
                model=model,
            )
        posings.append(one)
    if pressed >= 0:
        selection.press(lead, pressed, extend)
    return SeveralPosing(posings, selection)


def begin_settling(context: bpy.types.Context) -> SeveralPosing:
    """That of all objects that take part, in which no pin moves and all of them hold. Raises Refusal."""
    objects = [obj for obj in taking_part.with_pins(context) if _moves(obj, set(range(len(obj.planar.pins))))]
    objects = objects or [context.object]
    posings = []
    for obj in objects:
        with naming(obj.name if len(objects) > 1 else None):
            posings.append(ObjectPosing(context, obj, None))
    return SeveralPosing(posings)


def _moved_objects(moving: dict[str, set[int]], pressed: str | None) -> list[str]:
    """The objects with pins that move, and the pressed one; where all are off, those with any."""
    found = [name for name, pins in moving.items() if name == pressed or _moves(bpy.data.objects[name], pins)]
    return found or [name for name, pins in moving.items() if pins]


def _moves(obj: bpy.types.Object, pins: set[int]) -> bool:
    """Whether any of these pins can move it, as far as the list tells."""
    chosen = (obj.planar.pins[pin] for pin in pins)
    return any(pin.enabled and not is_joint(pin) for pin in chosen)
