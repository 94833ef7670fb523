# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers typed during a drag, one or two of them, as in Blender's own transforms."""

from __future__ import annotations

from dataclasses import dataclass, replace

_DIGITS = ("ZERO", "ONE", "TWO", "THREE", "FOUR", "FIVE", "SIX", "SEVEN", "EIGHT", "NINE")

# Blender's names of keys -> what is typed.
KEYS: dict[str, str] = {
    **{name: str(digit) for digit, name in enumerate(_DIGITS)},
    **{f"NUMPAD_{digit}": str(digit) for digit in range(10)},
    "PERIOD": ".",
    "NUMPAD_PERIOD": ".",
    "MINUS": "-",
    "NUMPAD_MINUS": "-",
    "BACK_SPACE": "BACK",
    "TAB": "NEXT",
    "COMMA": "NEXT",
}


@dataclass(frozen=True)
class Numeric:
    """What has been typed so far: a text for each number. As long as all are empty, the mouse rules."""

    fields: tuple[str, ...]
    current: int = 0

    @property
    def active(self) -> bool:
        """Whether something is typed, so that the numbers rule and not the mouse."""
        return any(self.fields)

    @property
    def values(self) -> tuple[float, ...]:
        """The typed numbers; a field with no digit in it is 0."""
        return tuple(float(text) if any(c.isdigit() for c in text) else 0.0 for text in self.fields)

    def pressed(self, key: str) -> Numeric | None:
        """After a key with this name (Blender's) was pressed; None if it types nothing at present."""
        typed = KEYS.get(key)
        if typed is None or (not self.active and typed in ("BACK", "NEXT")):
            return None
        return self.typed(typed)

    def typed(self, key: str) -> Numeric:
        """After one of the right-hand sides of KEYS.

        '-' turns the sign round wherever it is typed; the field after the last one is the first; erasing an
        empty field goes back to the one before.
        """
        text = self.fields[self.current]
        if key == "NEXT":
            return replace(self, current=(self.current + 1) % len(self.fields))
        if key == "BACK":
            if not text and self.current > 0:
                return replace(self, current=self.current - 1)
            return self._with(text[:-1])
        if key == "-":
            return self._with(text[1:] if text.startswith("-") else "-" + text)
        if key == "." and "." in text:
            return self
        return self._with(text + key)

    def shown(self, index: int) -> str:
        """A field as the user should see it, with a cursor where the next key goes."""
        return self.fields[index] + ("|" if index == self.current else "")

    def _with(self, text: str) -> Numeric:
        return replace(self, fields=(*self.fields[: self.current], text, *self.fields[self.current + 1 :]))
