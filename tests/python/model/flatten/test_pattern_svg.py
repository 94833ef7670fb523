# SPDX-License-Identifier: GPL-3.0-or-later
"""Patterns in millimetres."""

from xml.etree import ElementTree

import numpy as np
from test_patches import patches, sheet

from planar_deform.model.flatten.pattern_svg import MARGIN, pattern_svg

SVG = "{http://www.w3.org/2000/svg}"


def parsed(found, places):
    return ElementTree.fromstring(pattern_svg(found, places, "A & B"))


def corners_in(path):
    return np.array(
        [[float(v) for v in point.split(",")] for point in path.replace("M", "").replace("Z", "").split(" L")]
    )


def test_each_patch_is_a_group_with_its_outline_at_true_scale_and_the_numbers_of_its_seams():
    found = patches(sheet(2, 1), [(1, 4)])
    here = np.array([[0, 0], [30, 0], [60, 0], [0, 20], [30, 20], [60, 20]], float)[found.vertices]
    here[found.patch == 1] += (10.0, 0.0)
    root = parsed(found, here)
    assert root.get("width") == f"{70 + 2 * MARGIN:g}mm"
    assert root.get("height") == f"{20 + 2 * MARGIN:g}mm"
    assert root.get("viewBox") == f"0 0 {70 + 2 * MARGIN:g} {20 + 2 * MARGIN:g}"
    assert root.find(f"{SVG}title").text == "A & B"
    groups = root.findall(f"{SVG}g")
    assert [group.get("id") for group in groups] == ["patch-1", "patch-2"]
    for group in groups:
        outline = corners_in(group.find(f"{SVG}path").get("d"))
        assert np.ptp(outline, axis=0).tolist() == [30.0, 20.0]
        assert [text.text for text in group.findall(f"{SVG}text")] == ["1"]
        line = group.find(f"{SVG}line")
        assert abs(float(line.get("y1")) - float(line.get("y2"))) == 20.0
        x = float(group.find(f"{SVG}text").get("x"))
        assert outline[:, 0].min() < x < outline[:, 0].max(), "numbers are inside"


def test_holes_are_loops_of_their_own_and_nothing_is_numbered_without_seams():
    found = patches(sheet(3, 3), chosen=[0, 1, 2, 3, 5, 6, 7, 8])
    places = np.array([(i % 4, i // 4) for i in range(16)], float) * 10.0
    root = parsed(found, places[found.vertices])
    (group,) = root.findall(f"{SVG}g")
    path = group.find(f"{SVG}path").get("d")
    assert path.count("M") == path.count("Z") == 2
    assert group.find(f"{SVG}line") is None
    assert group.find(f"{SVG}text") is None
