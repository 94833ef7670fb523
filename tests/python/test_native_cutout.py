# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings become cutouts, from Python."""

import struct
import zlib
from pathlib import Path

import numpy as np
import pytest

import planar_native

DRAWINGS = Path(__file__).resolve().parents[3] / "shared" / "data" / "images"


def figure(size=120):
    """A body with a hole, two arms and an island, as alpha."""
    y, x = (np.indices((size, size)) + 0.5) * 100 / size
    body = np.hypot((x - 50) / 18, (y - 50) / 30) < 1
    hole = np.hypot(x - 50, y - 40) < 7
    arms = (np.abs(y - 62) < 1.5) & (x > 8) & (x < 92)
    island = np.hypot(x - 88, y - 12) < 6
    return ((body & ~hole) | arms | island).astype(np.float32)


def read_alpha(path):
    """The alpha of a PNG of 8 bits RGBA, rows from the bottom."""
    data, place, packed, size = path.read_bytes(), 8, b"", (0, 0)
    while place < len(data):
        (length,) = struct.unpack(">I", data[place : place + 4])
        kind, body = data[place + 4 : place + 8], data[place + 8 : place + 8 + length]
        if kind == b"IHDR":
            assert body[8:] == bytes((8, 6, 0, 0, 0))
            size = struct.unpack(">II", body[:8])
        packed += body if kind == b"IDAT" else b""
        place += length + 12
    width, height = size
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + 4 * width)
    result, above = [], [0] * width
    for filtered in rows:
        row, left, corner = [], 0, 0
        for value, up in zip(filtered[4::4].tolist(), above, strict=True):
            nearest = min((left, up, corner), key=lambda c, p=left + up - corner: abs(p - c))
            left = (value + (0, left, up, (left + up) // 2, nearest)[filtered[0]]) % 256
            corner = up
            row.append(left)
        result.append(row)
        above = row
    return np.array(result[::-1], np.uint8)


def angles(points, triangles):
    corner = points[triangles]
    a, b = np.roll(corner, -1, axis=1) - corner, np.roll(corner, -2, axis=1) - corner
    cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return np.degrees(np.arctan2(cross, (a * b).sum(axis=2)))


def inside(rings, points):
    """Whether an odd number of rings goes round each point."""
    odd = np.zeros(len(points), bool)
    for ring in rings:
        for (x0, y0), (x1, y1) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            if y0 != y1:
                between = (points[:, 1] >= min(y0, y1)) & (points[:, 1] < max(y0, y1))
                odd ^= between & (points[:, 0] < x0 + (points[:, 1] - y0) * (x1 - x0) / (y1 - y0))
    return odd


def assert_holds(cutout, alpha):
    rows, columns = np.nonzero(alpha > 0.5)
    rings = [cutout.points[ring] for ring in cutout.rings]
    assert inside(rings, np.column_stack([columns, rows]) + 0.5).all()


def test_a_figure():
    alpha = figure()
    found = planar_native.cutout(alpha)
    assert found.points.dtype == np.float64
    assert found.triangles.dtype == np.int32
    assert found.reached
    assert found.said == []
    assert 1125 <= len(found.points) <= 1875
    assert angles(found.points, found.triangles).min() > 19
    assert_holds(found, alpha)
    assert found.n_parts == found.outline.islands == 2
    assert found.parts.shape == (len(found.points),)
    island = np.hypot(*(found.points - [105.6, 14.4]).T) < 12
    assert set(found.parts[island]) == {found.parts[np.argmin(found.points[:, 1])]}
    assert len(set(found.parts[~island])) == 1
    assert found.outline.holes == 1
    assert len(found.rings) == len(found.outline.rings) == 3
    assert f"points={len(found.points)}" in repr(found)


@pytest.mark.parametrize("kind", [bool, np.uint8, np.uint16, np.float16, np.float32, np.float64])
def test_any_kind_of_alpha(kind):
    alpha = figure()
    scale = np.iinfo(kind).max if np.issubdtype(kind, np.integer) else 1
    expected = planar_native.cutout(alpha, vertices=200)
    np.testing.assert_array_equal(
        planar_native.cutout((alpha * scale).astype(kind), vertices=200).points, expected.points
    )


def test_any_layout_of_alpha():
    alpha = figure()
    expected = planar_native.cutout(alpha, vertices=200).points
    pixels = np.zeros((*alpha.shape, 4), np.float32)
    pixels[..., 3] = alpha
    before = pixels.copy()
    for same in (pixels[..., 3], np.asfortranarray(alpha), alpha[::-1].copy()[::-1], alpha.tolist()):
        np.testing.assert_array_equal(planar_native.cutout(same, vertices=200).points, expected)
    np.testing.assert_array_equal(pixels, before)


def test_options_do_what_they_say():
    alpha = figure()
    kept = planar_native.outline(alpha, margin=3, rounding=1)
    assert (kept.margin, kept.rounding, kept.holes, kept.islands) == (3, 1, 1, 2)
    filled = planar_native.outline(alpha, holes="FILL", smallest=0.1)
    assert (filled.holes, filled.filled_holes, filled.islands, filled.dropped_islands) == (0, 1, 1, 1)
    assert filled.dropped_pixels == (alpha[:25, 90:] > 0).sum()
    assert planar_native.cutout(alpha, smallest=0.1).said == [
        f"Left out as specks: 1 island, {filled.dropped_pixels} pixels in all."
    ]
    coarse = planar_native.cutout(alpha, edge=8, finest=2)
    assert coarse.edge == 8
    assert coarse.shortest == 4
    assert coarse.reached
    assert_holds(coarse, alpha)
    few = planar_native.cutout(alpha, vertices=10)
    assert not few.reached
    assert few.said[0].startswith(f"This drawing needs at least {len(few.points)} vertices")
    faint = np.where(alpha > 0, alpha, 0.1)
    assert planar_native.outline(faint, threshold=0.2).islands == 2
    assert planar_native.outline(faint).islands == 1


@pytest.mark.parametrize(
    ("alpha", "options", "message"),
    [
        (np.zeros((4, 5)), {}, "alpha: all of the image is transparent"),
        (np.zeros((0, 5)), {}, "alpha: an image of 5 x 0 pixels"),
        (np.ones((4, 5, 4)), {}, r"alpha: shape \(4, 5, 4\), expected \(height, width\)"),
        (np.ones((4, 5), np.int64), {}, "alpha: dtype int64, expected real numbers"),
        ([[1.0, 2.0]], {}, "alpha, row 0: not a number from 0 to 1"),
        ([[1.0], [np.nan]], {}, "alpha, row 1: not a number"),
        ([[1.0], [2.0, 3.0]], {}, "alpha: not an array"),
        (np.broadcast_to(np.float32(1), (2**20, 2**20)), {}, "16384 pixels a side are possible"),
        (np.ones((4, 5)), {"vertices": 1}, "vertices: 1, expected 3 to 2000000"),
        (np.ones((4, 5)), {"vertices": 1.5}, "vertices: not a whole number"),
        (np.ones((4, 5)), {"edge": 0}, "edge"),
        (np.ones((4, 5)), {"margin": -1}, "margin"),
        (np.ones((4, 5)), {"rounding": np.inf}, "rounding"),
        (np.ones((4, 5)), {"threshold": 1}, "threshold"),
        (np.ones((4, 5)), {"holes": "CLOSE"}, "holes: 'CLOSE' is not available; there are 'KEEP' 'FILL'"),
        (np.ones((4, 5)), {"smallest": 1.5}, "smallest"),
        (np.ones((4, 5)), {"finest": 0}, "finest"),
    ],
)
@pytest.mark.parametrize("function", [planar_native.cutout, planar_native.outline])
def test_what_is_refused(function, alpha, options, message):
    with pytest.raises(ValueError, match=message):
        function(alpha, **options)


@pytest.mark.parametrize("function", [planar_native.cutout, planar_native.outline])
def test_progress_stops(function):
    told = []
    function(figure(), progress=told.append)
    assert told[0] == 0
    assert told[-1] == 1
    assert told == sorted(told)
    for stop in told:
        with pytest.raises(planar_native.Cancelled):
            function(figure(), progress=lambda share, stop=stop: share < stop)
    with pytest.raises(ValueError, match="progress: returned 3"):
        function(figure(), progress=lambda share: 3)


def test_results_are_made_by_the_library_alone():
    for kind in (planar_native.Cutout, planar_native.Outline, planar_native.Keyed):
        with pytest.raises(TypeError):
            kind()


@pytest.mark.parametrize("kind", [np.uint8, np.float32])
@pytest.mark.parametrize("channels", [3, 4])
def test_a_plain_border_is_keyed(kind, channels):
    alpha = figure()
    scale = 255 if kind is np.uint8 else 1
    pixels = np.where(alpha[..., None] > 0, [0.2, 0.4, 0.0, 1.0], [1.0, 1.0, 0.9, 1.0])[..., :channels]
    found = planar_native.key_colour((pixels * scale).astype(kind))
    assert found.keyed
    assert found.said == ""
    np.testing.assert_allclose(found.colour, [1, 1, 0.9], atol=0.005)
    assert found.alpha.shape == alpha.shape
    assert planar_native.outline(found.alpha).filled_holes == 0  # the border does not reach into the hole
    np.testing.assert_array_equal(found.alpha[alpha > 0], 1)


def test_what_cannot_be_keyed_is_said():
    noise = np.random.default_rng(1).random((20, 30, 3))
    found = planar_native.key_colour(noise)
    assert not found.keyed
    assert "not plain" in found.said
    np.testing.assert_array_equal(found.alpha, np.ones((20, 30)))
    for wrong in (noise[..., 0], noise[..., :2], np.zeros((2, 2, 3), int)):
        with pytest.raises(ValueError, match="^pixels"):
            planar_native.key_colour(wrong)


DRAWN = sorted(DRAWINGS.glob("*.png"))


@pytest.mark.skipif(not DRAWN, reason=f"no drawings (*.png) in {DRAWINGS}")
@pytest.mark.parametrize("path", DRAWN, ids=lambda path: path.stem)
def test_real_drawings(path):
    alpha = read_alpha(path)
    found = planar_native.cutout(alpha)
    smallest = angles(found.points, found.triangles).min(axis=1)
    assert smallest.min() > 19
    assert smallest.mean() > 47
    assert found.reached
    assert found.said == []
    assert_holds(found, alpha / 255)


@pytest.mark.skipif(not DRAWN, reason=f"no drawings (*.png) in {DRAWINGS}")
@pytest.mark.parametrize("path", DRAWN, ids=lambda path: path.stem)
def test_vertices_of_real_drawings_grow_with_the_wish(path):
    alpha = read_alpha(path)
    wishes = (10, 50, 100, 200, 400, 800, 1200)
    found = [planar_native.cutout(alpha, vertices=wish) for wish in wishes]
    counts = np.array([len(cutout.points) for cutout in found])
    wanted = np.maximum(wishes, counts[0])
    assert (np.abs(counts - wanted) <= 0.25 * wanted).all()
    assert (counts[1:] >= 0.97 * counts[:-1]).all()
    said = {sentence for cutout in found for sentence in cutout.said}
    assert said <= {f"This drawing needs at least {counts[0]} vertices."}
    for cutout in found:
        assert angles(cutout.points, cutout.triangles).min() > 19
