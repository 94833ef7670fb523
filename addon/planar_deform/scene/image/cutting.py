# SPDX-License-Identifier: GPL-3.0-or-later
"""Cutouts of image planes, found one after the other: pixels are read here, all else is done in a thread."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

from ... import native
from ...errors import Refusal, Refusals
from ...model.image.art import Art, united
from ...model.image.cutting import Drawing, NoArt, Settings, cut
from ...model.work import Progress, Work
from . import reading
from .image_plane import ImagePlane

WAIT = 0.01  # seconds between two looks at the thread

Result = TypeVar("Result")


@dataclass(frozen=True)
class Cut:
    """A plane, and what is to take its mesh's place."""

    plane: ImagePlane
    drawing: Drawing
    said: tuple[str, ...]  # to be told, a sentence each


def cuts(
    planes: Sequence[ImagePlane], settings: Settings, *, loaded: bool = False
) -> Generator[float, None, list[Cut]]:
    """The cutouts of planes; yields the share done. Changes nothing. Closed, it ends at once.

    `loaded`: the images have just been loaded, so that what has been found in the same files is good still.

    Raises Refusal and ObjectGone.
    """
    found, refused = [], Refusals()
    for number, plane in enumerate(planes):
        with refused.noting():
            found.append((yield from among(_cut(plane, settings, loaded), number, len(planes))))
    refused.tell()
    return found


def among(steps: Generator[float, None, Result], number: int, count: int) -> Generator[float, None, Result]:
    """What one of so many jobs comes to; yields the share done of all."""
    while True:
        try:
            share = next(steps)
        except StopIteration as end:
            result: Result = end.value
            return result
        yield (number + share) / count


def _cut(plane: ImagePlane, settings: Settings, loaded: bool) -> Generator[float, None, Cut]:
    image = plane.texture.image.name
    art = yield from _art(plane, loaded)
    try:
        drawing = yield from _solved(
            lambda progress: cut(art.alpha, settings, window=plane.placement.window, progress=progress)
        )
    except NoArt as error:
        raise Refusal(f"'{image}' cannot be cut out: {error}") from error
    except native.SolveError as error:
        raise Refusal(f"'{image}' cannot be cut out: {error}; try a wider margin") from error
    said = drawing.said if art.said is None else [art.said, *drawing.said]
    return Cut(plane, drawing, tuple(f"'{image}': {sentence}" for sentence in said))


def _art(plane: ImagePlane, loaded: bool) -> Generator[float, None, Art]:
    texture = plane.texture
    key = reading.file_key(texture.image) if loaded else None
    art = reading.kept(key)
    if art is not None:
        return art
    for frame in reading.frames(texture.image, texture.image_user):
        found = yield from _solved(partial(_art_of, frame))
        art = found if art is None else united([art, found])
    assert art is not None
    reading.keep(key, art)
    return art


def _art_of(frame: reading.Frame, _progress: Progress) -> Art:
    return frame.art()


def _solved(solve: Callable[[Progress], Result]) -> Generator[float, None, Result]:
    """What a thread comes to; yields the share done."""
    work = Work(solve)
    try:
        while not work.wait(WAIT):
            yield work.share
        return work.result()
    finally:
        work.stop()
