# SPDX-License-Identifier: GPL-3.0-or-later
"""The ease of new keys of poses: how the drawing leaves one pose and comes to the next."""

from __future__ import annotations

from dataclasses import dataclass

PREFERENCES = "PREFERENCES"

# As Blender wants an enum's items.
EASES = (
    (PREFERENCES, "As in Preferences", "As Blender's preferences say for new keyframes"),
    ("LINEAR", "Linear", "At one speed all the way"),
    ("EASE", "Ease", "Slow out of the pose and slow into the next"),
    ("EASE_IN", "Ease In", "Slow out of the pose, fast into the next"),
    ("EASE_OUT", "Ease Out", "Fast out of the pose, slow into the next"),
    ("HOLD", "Hold", "Stay at the pose until the next"),
)


@dataclass(frozen=True)
class KeyEase:
    """What a key of a curve is given, as Blender names it."""

    interpolation: str
    easing: str = "AUTO"
    handles: str = "AUTO_CLAMPED"


LINEAR = KeyEase("LINEAR")

_MEANING = {
    "LINEAR": LINEAR,
    "EASE": KeyEase("SINE", "EASE_IN_OUT"),
    "EASE_IN": KeyEase("SINE", "EASE_IN"),
    "EASE_OUT": KeyEase("SINE", "EASE_OUT"),
    "HOLD": KeyEase("CONSTANT"),
}


def meaning(chosen: list[str], preferences: KeyEase) -> KeyEase:
    """Of the first of the eases chosen that says more than to follow the preferences."""
    return next((_MEANING[ease] for ease in chosen if ease in _MEANING), preferences)
