# SPDX-License-Identifier: GPL-3.0-or-later
"""What of an image is art, with an alpha and without, and the cutout of it."""

import numpy as np
import pytest

from planar_deform.model.image.art import Art, art_of, united
from planar_deform.model.image.cutting import NoArt, Settings, cut
from planar_deform.model.image.placement import Window

HEIGHT, WIDTH = 60, 90


def disc(x=45.0, y=30.0, radius=20.0):
    """Truths h x w, rows from the bottom."""
    rows, columns = np.indices((HEIGHT, WIDTH)) + 0.5
    return np.hypot(columns - x, rows - y) < radius


def painted(art, *, channels=4, ground=(1.0, 1.0, 1.0)):
    """Red where there is art; else clear, or without an alpha in a colour."""
    pixels = np.where(art[..., None], [0.8, 0.1, 0.1, 1.0], [*ground, 0.0 if channels == 4 else 1.0])
    return pixels[..., :channels].astype(np.float32)


def test_alpha_tells_what_is_art():
    found = art_of(painted(disc()))
    assert found.said is None
    assert np.array_equal(found.alpha == 255, disc())
    assert set(np.unique(found.alpha)) == {0, 255}


def test_soft_edges_are_kept():
    pixels = painted(disc())
    pixels[..., 3] = np.linspace(0, 1, WIDTH)
    assert np.array_equal(art_of(pixels).alpha[0], np.rint(np.linspace(0, 255, WIDTH)))


@pytest.mark.parametrize("channels", [3, 4])
def test_without_an_alpha_a_plain_border_tells(channels):
    pixels = painted(disc(), channels=3)
    if channels == 4:
        pixels = np.dstack([pixels, np.ones((HEIGHT, WIDTH), np.float32)])
    found = art_of(pixels)
    assert np.array_equal(found.alpha > 0, disc())
    assert "colour of its border" in found.said


def test_a_grey_image_is_keyed_as_well():
    pixels = np.where(disc(), 0.1, 0.9).astype(np.float32)[..., None]
    assert np.array_equal(art_of(pixels).alpha > 0, disc())


def test_without_a_plain_border_all_is_art():
    noise = np.random.default_rng(0).uniform(0, 1, (HEIGHT, WIDTH, 3)).astype(np.float32)
    found = art_of(noise)
    assert (found.alpha == 255).all()
    assert "all of it is the cutout" in found.said
    assert "not plain" in found.said


def test_an_alpha_that_is_not_used_does_not_count():
    assert "colour of its border" in art_of(painted(disc()), uses_alpha=False).said


def test_numbers_that_are_none_are_clear():
    pixels = painted(disc())
    pixels[:5] = np.nan
    assert not art_of(pixels).alpha[:5].any()


def test_a_sequence_is_cut_out_as_wide_as_all_its_frames():
    first, second = art_of(painted(disc(x=30))), art_of(painted(disc(x=60)))
    assert np.array_equal(united([first, second]).alpha > 0, disc(x=30) | disc(x=60))
    assert united([first, Art(second.alpha, "keyed")]).said == "keyed"
    assert np.array_equal(first.alpha > 0, disc(x=30)), "the frames stay"


def test_a_cutout_has_all_of_the_art_in_pixels_of_the_image():
    found = cut(art_of(painted(disc())).alpha, Settings(vertices=200))
    assert found.points.min(axis=0) == pytest.approx([25, 10], abs=2)
    assert found.points.max(axis=0) == pytest.approx([65, 50], abs=2)


def test_of_a_window_only_what_it_shows():
    alpha = art_of(painted(disc(x=20, radius=10) | disc(x=70, radius=10))).alpha
    assert cut(alpha, Settings(vertices=200)).islands.max() == 1
    found = cut(alpha, Settings(vertices=200), window=Window(45, 0, 90, 60))
    assert found.islands.max() == 0
    assert found.points.min(axis=0) == pytest.approx([60, 20], abs=2)


def test_islands_come_apart_the_largest_first():
    found = cut(art_of(painted(disc(x=15, radius=8) | disc(x=60, radius=22))).alpha, Settings(vertices=200))
    large, small = found.separated()
    assert len(large.points) + len(small.points) == len(found.points)
    assert len(large.triangles) + len(small.triangles) == len(found.triangles)
    assert large.points[:, 0].min() > 30 > small.points[:, 0].max()
    for part in (large, small):
        assert part.triangles.max() == len(part.points) - 1
        (ring,) = part.rings
        sides = part.points[np.roll(ring, -1)] - part.points[ring]
        x, y = part.points[ring].T
        assert (x * sides[:, 1] - y * sides[:, 0]).sum() > 0, "the art is on the left of its ring"


def test_nothing_to_cut_out_is_told():
    clear = np.zeros((HEIGHT, WIDTH), np.uint8)
    with pytest.raises(NoArt, match="all of it is transparent: export it"):
        cut(clear, Settings())
    with pytest.raises(NoArt, match="above the threshold of 0.50: lower that below 0.24"):
        cut(clear + 60, Settings(threshold=0.5))
    with pytest.raises(NoArt, match="two million|vertices"):
        cut(clear + 255, Settings(edge=1e-3))


def test_an_edge_longer_than_the_image_is_as_long_as_that():
    alpha = np.zeros((60, 80), np.uint8)
    alpha[20:40, 20:60] = 255
    longest, longer = (cut(alpha, Settings(edge=edge)) for edge in (80.0, 5000.0))
    assert np.array_equal(longer.points, longest.points)
    assert np.ptp(longer.points, axis=0).max() < 80
