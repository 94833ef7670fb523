# SPDX-License-Identifier: GPL-3.0-or-later
"""What the files of an object's images were when its mesh was made of them, and whether they are that still.

An image is known by its file's name, so that it stays known where the file is moved, the image renamed, a
material added, or the object appended to another file.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple


class ImageFile(NamedTuple):
    """One of them."""

    name: str  # without its folder
    state: str  # differs once it is another file; empty where there is none; see recognised()
    width: int = 0  # in pixels; 0 where that is not known
    height: int = 0


def packed(files: Iterable[ImageFile]) -> str:
    """As text, to be stored."""
    return json.dumps([list(file) for file in files])


def unpacked(text: str, names: Sequence[str]) -> list[ImageFile]:
    """What packed() has stored. Older versions stored states alone, in the order of images of these names."""
    if text.startswith("["):
        return [ImageFile(*file) for file in json.loads(text)]
    return [ImageFile(name, state) for name, state in zip(names, text.split("|"), strict=False) if state]


def recognised(state: str, kept: Iterable[str], digest: Callable[[], str]) -> str:
    """The state among those `kept` that a file with a state "time/size" still has, else its own.

    Those kept may have the `digest` of its bytes behind them, which tells that a copy is the same file.
    """
    alike = [other for other in kept if other.count("/") == 2 and other.split("/")[1] == state.split("/")[-1]]
    same = [other for other in alike if other.startswith(f"{state}/")]
    if not same and alike:
        same = [other for other in alike if other.split("/")[2] == (digest() or None)]
    return same[0] if same else state


def is_changed(kept: Sequence[ImageFile], now: Sequence[ImageFile]) -> bool:
    """Whether a file has been written since, or another taken in the place of one."""
    states, names = {file.state for file in kept}, {file.name for file in kept}
    new = [file for file in now if file.state and file.state not in states]
    replaced = bool(names - {file.name for file in now})
    return any(file.name in names or replaced for file in new)


def joined(kept: str, other: str) -> str:
    """What is stored of an object once another one has been joined to it."""
    if not (kept.startswith("[") and other.startswith("[")):
        return kept or other
    return packed(dict.fromkeys([*unpacked(kept, ()), *unpacked(other, ())]))


def size_of(kept: Sequence[ImageFile], now: Iterable[ImageFile], name: str) -> tuple[int, int] | None:
    """Width and height that the image of a file had, or the one in whose place it is; None: not known."""
    names = {file.name for file in now}
    before = [file for file in kept if file.name == name] or [file for file in kept if file.name not in names]
    sizes = {(file.width, file.height) for file in before}
    return sizes.pop() if len(sizes) == 1 and 0 not in min(sizes) else None
