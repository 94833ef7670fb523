# SPDX-License-Identifier: GPL-3.0-or-later
"""A glow that the cutout does not hold is told; soft edges of plain drawings are not."""

import numpy as np
import pytest

from planar_deform.model.image.cutting import Settings, cut
from planar_deform.model.image.glow import share_cut_off

SIZE = 240


def star(blur=0.0):
    """h x w of 0 to 1: a star of five points with edges a pixel soft, and a glow about it that fades out."""
    y, x = np.indices((SIZE, SIZE)) + 0.5 - SIZE / 2
    rim = 45.0 + 18.0 * np.cos(5.0 * np.arctan2(y, x))
    outside = np.hypot(x, y) - rim
    sharp = np.clip(0.5 - outside, 0.0, 1.0)
    return sharp if blur == 0.0 else np.maximum(sharp, np.exp(-np.maximum(outside, 0.0) / blur))


def told(picture, **settings):
    alpha = np.rint(255 * picture).astype(np.uint8)
    found = cut(alpha, Settings(vertices=400, **settings))
    return [said for said in found.said if "soft glow is cut off: lower the Threshold" in said]


def test_a_glow_outside_of_the_outline_is_told():
    assert told(star(blur=12.0))
    assert told(star(blur=6.0), threshold=0.5)
    assert not told(star(blur=12.0), threshold=0.005), "as told, so done"


@pytest.mark.parametrize("threshold", [0.05, 0.5])
def test_plain_drawings_are_not_told(threshold):
    assert not told(star(), threshold=threshold)


def test_the_share_is_that_of_the_pixels_outside():
    alpha = np.zeros((40, 60), np.uint8)
    alpha[10:30, 10:30] = 250
    alpha[:, 40:50] = 10
    square = np.array([[8.0, 8.0], [32.0, 8.0], [32.0, 32.0], [8.0, 32.0]])
    whole = np.array([[0.0, 0.0], [60.0, 0.0], [60.0, 40.0], [0.0, 40.0]])
    ring = np.arange(4, dtype=np.int32)
    assert share_cut_off(alpha, 0.05, square, [ring]) == pytest.approx(4000 / (4000 + 100_000))
    assert share_cut_off(alpha, 0.05, whole, [ring]) == 0.0
    assert share_cut_off(alpha, 0.01, square, [ring]) == 0.0, "then it belongs to the drawing"
