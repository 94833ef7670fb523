# SPDX-License-Identifier: GPL-3.0-or-later
"""The selected pins of all objects that take part, and what a press on one of them makes of these."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import bpy

from ...errors import Refusal
from ...scene.pins.taking_part import taking_part


def select_only(obj: bpy.types.Object, wanted: set[int]) -> None:
    """These pins of an object, by their indices, and no others."""
    for index, pin in enumerate(obj.planar.pins):
        if pin.select != (index in wanted):
            pin.select = index in wanted


class _Before(NamedTuple):
    """What an object has of it."""

    uid: int  # its session_uid
    selected: set[int]
    active_pin: int


class PinSelection:
    """As it is at the start of an operator, which may press a pin, and take that back.

    Between events only names are kept.
    """

    def __init__(self, context: bpy.types.Context):
        objects = [obj for obj in taking_part(context).objects if obj.is_property_set("planar")]
        self._before = {obj.name: _selection(obj) for obj in objects}
        self._active = None if context.object is None else context.object.name
        self._pressed: tuple[str, int] | None = None
        self._extend = False

    def moved(self, name: str, pin: int, extend: bool) -> dict[str, set[int]]:
        """The pins that a drag takes along, by their objects, when `pin` (-1: none) of one is pressed.

        All selected ones if it is one; that object is the first, else the active one. Raises Refusal where
        there is no such pin.
        """
        selected = {other: before.selected for other, before in self._before.items()}
        if pin < 0:
            return selected
        if name not in self._before:
            raise Refusal(f"'{name}' takes no part: select it, and make sure that it is shown")
        count = len(bpy.data.objects[name].planar.pins)
        if pin >= count:
            raise Refusal(f"There is no pin {pin}: the object has {count}")
        kept = selected if extend or pin in selected[name] else {}
        return {name: kept.get(name, set()) | {pin}} | {
            other: pins for other, pins in kept.items() if other != name
        }

    def press(self, name: str, pin: int, extend: bool) -> None:
        """Select what a drag takes along, and make the pin and its object the active ones."""
        self._select(self.moved(name, pin, extend))
        self._pressed, self._extend = (name, pin), extend
        obj = bpy.data.objects[name]
        obj.planar.active_pin = pin
        if name != self._active:
            bpy.context.view_layer.objects.active = obj

    def click(self) -> bool:
        """The pressed pin was released where it is: select it alone, or the other way; whether that changed
        anything."""
        assert self._pressed is not None  # or there would be nothing to release
        name, pin = self._pressed
        selected = {other: before.selected for other, before in self._before.items()}
        after = {name: {pin}}
        if self._extend:
            after = selected | {name: selected[name] ^ {pin}}
        self._select(after)
        same = all(after.get(other, set()) == pins for other, pins in selected.items())
        return not same or name != self._active or self._before[name].active_pin != pin

    def restore(self) -> None:
        """Everything as it was."""
        if self._pressed is None:
            return
        self._select({name: before.selected for name, before in self._before.items()})
        for name, before in self._before.items():
            obj = _found(name, before)
            if obj is not None:
                obj.planar.active_pin = before.active_pin
        active = None if self._active is None else bpy.data.objects.get(self._active)
        if active is not None and active.name in bpy.context.view_layer.objects:
            bpy.context.view_layer.objects.active = active

    def _select(self, wanted: Mapping[str, set[int]]) -> None:
        for name, before in self._before.items():
            obj = _found(name, before)
            if obj is not None:
                select_only(obj, wanted.get(name, set()))


def _selection(obj: bpy.types.Object) -> _Before:
    settings = obj.planar
    selected = {index for index, pin in enumerate(settings.pins) if pin.select}
    return _Before(obj.session_uid, selected, settings.active_pin)


def _found(name: str, before: _Before) -> bpy.types.Object | None:
    obj = bpy.data.objects.get(name)
    return obj if obj is not None and obj.session_uid == before.uid else None
