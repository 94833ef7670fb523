# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of what is on one side, and of what is on the other, as Blender flips them."""

from __future__ import annotations

import re

_OTHER = {"l": "r", "r": "l", "L": "R", "R": "L"}
_WORDS = {
    "left": "right",
    "right": "left",
    "Left": "Right",
    "Right": "Left",
    "LEFT": "RIGHT",
    "RIGHT": "LEFT",
}
# In the order in which Blender looks: a letter behind a separator, one before it, a word at either end.
_LETTER_BEHIND = re.compile(r"(.*[-._ ])([lrLR])", re.DOTALL)
_LETTER_BEFORE = re.compile(r"([lrLR])([-._ ].*)", re.DOTALL)
_WORD_BEFORE = re.compile("({})(.*)".format("|".join(_WORDS)), re.DOTALL)
_WORD_BEHIND = re.compile("(.*)({})".format("|".join(_WORDS)), re.DOTALL)
_NUMBER = re.compile(r"(.*)(\.\d+)", re.DOTALL)


def flipped(name: str) -> str:
    """The name of the same on the other side: Hand.L for Hand.R, rightFoot.001 for leftFoot.001.

    A name that tells of no side stays what it is.
    """
    numbered = _NUMBER.fullmatch(name)
    name, number = numbered.groups() if numbered else (name, "")
    if found := _LETTER_BEHIND.fullmatch(name):
        name = found[1] + _OTHER[found[2]]
    elif found := _LETTER_BEFORE.fullmatch(name):
        name = _OTHER[found[1]] + found[2]
    elif found := _WORD_BEFORE.fullmatch(name):
        name = _WORDS[found[1]] + found[2]
    elif found := _WORD_BEHIND.fullmatch(name):
        name = found[1] + _WORDS[found[2]]
    return name + number
