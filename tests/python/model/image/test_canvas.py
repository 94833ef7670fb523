# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a drawing lies in its image once the canvas has another size."""

import numpy as np
import pytest

from planar_deform.model.image.canvas import moved

OLD = (80, 120)


def letter(scale=1):
    """An F of 80 x 120 pixels, of more of them by a scale."""
    art = np.zeros((120, 80), bool)
    art[10:110, 15:32] = art[93:110, 15:70] = art[55:72, 15:55] = True
    return np.kron(art, np.ones((scale, scale), bool))


def outline(margin=2.0, scale=1):
    """That of the F, `margin` pixels away, in shares of its canvas, as edges."""
    m = margin
    ring = [
        (15, 10),
        (32, 10),
        (32, 55),
        (55, 55),
        (55, 72),
        (32, 72),
        (32, 93),
        (70, 93),
        (70, 110),
        (15, 110),
    ]
    signs = [(-1, -1), (1, -1), (1, -1), (1, -1), (1, 1), (1, 1), (1, -1), (1, -1), (1, 1), (-1, 1)]
    ring = np.array(ring, float) * scale + np.array(signs) * m
    ring /= np.array(OLD) * scale
    return np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)


def image(art, size, at):
    """The art on a canvas of a size, its lower left corner at a pixel; what lies outside is cut off."""
    canvas = np.zeros((size[1] + 2 * 999, size[0] + 2 * 999), np.uint8)
    x, y = at[0] + 999, at[1] + 999
    canvas[y : y + art.shape[0], x : x + art.shape[1]] = 255 * art
    return canvas[999:-999, 999:-999]


@pytest.mark.parametrize(
    ("size", "at"),
    [
        ((120, 180), (20, 30)),  # grown about its middle
        ((81, 121), (0, 1)),
        ((200, 120), (120, 0)),  # to the left alone
        ((160, 240), (0, 120)),  # twice as large, from the upper left corner
        ((80, 200), (0, 80)),
    ],
)
def test_a_canvas_that_has_grown_is_found_to_the_pixel(size, at):
    assert moved(outline(), OLD, image(letter(), size, at)) == at


@pytest.mark.parametrize(("size", "at"), [((57, 102), (-14, -9)), ((133, 171), (37, 11))])
def test_one_that_has_been_trimmed_or_moved_is_found_nearly(size, at):
    found = moved(outline(), OLD, image(letter(), size, at))
    assert np.abs(np.subtract(found, at)).max() <= 2


def test_a_longer_arm_on_a_larger_canvas():
    art = image(letter(), (150, 140), (0, 0))
    art[93:110, 60:140] = 255
    found = moved(outline(), OLD, art)
    assert np.abs(np.subtract(found, (0, 0))).max() <= 2


@pytest.mark.parametrize("scale", [2, 5, 30])
def test_more_or_fewer_pixels_are_the_same_canvas(scale):
    assert moved(outline(), OLD, image(letter(scale), (80 * scale, 120 * scale), (0, 0))) is None
    assert moved(outline(2.0 * scale, scale), (80 * scale, 120 * scale), image(letter(), OLD, (0, 0))) is None
    squeezed = letter(scale)[:, ::2]
    assert moved(outline(), OLD, image(squeezed, squeezed.shape[::-1], (0, 0))) is None


def test_a_large_canvas_is_looked_at_coarsely():
    at = (1400, 500)
    found = moved(outline(60.0, 30), (2400, 3600), image(letter(30), (4100, 4100), at))
    assert np.abs(np.subtract(found, at)).max() < 20  # of 3600


def test_what_is_not_there_is_nowhere():
    nothing = np.zeros((200, 200), np.uint8)
    assert moved(outline(), OLD, nothing) is None
    assert moved(outline() + 7.0, OLD, nothing) is None
    assert moved(outline(), OLD, nothing + np.uint8(255)) is None
