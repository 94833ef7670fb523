# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat patches as a pattern for paper or cloth: an SVG in millimetres, a group for each patch."""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree import ElementTree

import numpy as np

from ..plane.frame import Array
from .patches import Patches

NAMESPACE = "http://www.w3.org/2000/svg"
MARGIN = 5.0  # mm about everything
LINE = 0.2  # mm
LARGEST = 4.0  # mm, of numbers
NUMBER = 0.4  # of an edge's length, what its number may be high


def pattern_svg(patches: Patches, places: Array, title: str) -> str:
    """The file's text; `places`: of the flat vertices in millimetres, n x 2.

    Each patch has its outline, and over it the edges that were cut with a number, if they have any.
    """
    low, high = places.min(axis=0), places.max(axis=0)
    width, height = (high - low + 2.0 * MARGIN).tolist()
    page = np.stack([places[:, 0] - low[0], high[1] - places[:, 1]], axis=1) + MARGIN  # downwards
    root = ElementTree.Element(
        "svg",
        xmlns=NAMESPACE,
        width=f"{_text(width)}mm",
        height=f"{_text(height)}mm",
        viewBox=f"0 0 {_text(width)} {_text(height)}",
    )
    ElementTree.SubElement(root, "title").text = title
    style: dict[str, str] = {
        "fill": "none",
        "stroke": "black",
        "stroke-width": _text(LINE),
        "stroke-linejoin": "round",
    }
    rims = _rims(patches)
    for patch in range(patches.count):
        mine = [corner for corner in rims if patches.patch[patches.flat[corner]] == patch]
        group = ElementTree.SubElement(root, "g", {"id": f"patch-{patch + 1}", **style})
        loops = " ".join(
            "M" + " L".join(_point(page[vertex]) for vertex in loop) + " Z" for loop in _loops(patches, mine)
        )
        ElementTree.SubElement(group, "path", {"class": "outline", "d": loops})
        for corner in mine:
            if patches.numbers[corner]:
                _add_seam(group, page[patches.edges[corner]], int(patches.numbers[corner]))
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _rims(patches: Patches) -> list[int]:
    """The corners whose edges have one face alone."""
    ends = np.sort(patches.edges, axis=1)
    _, first, counts = np.unique(ends, axis=0, return_index=True, return_counts=True)
    rims: list[int] = np.sort(first[counts == 1]).tolist()
    return rims


def _loops(patches: Patches, corners: list[int]) -> Iterator[list[int]]:
    """The borders of a patch, each as its vertices in order."""
    following = dict(patches.edges[corners].tolist())
    while following:
        start, vertex = following.popitem()
        loop = [start]
        while vertex != start:
            loop.append(vertex)
            vertex = following.pop(vertex)
        yield loop


def _add_seam(group: ElementTree.Element, ends: Array, number: int) -> None:
    """An edge that was cut, with its number beside it in the patch, which runs counter-clockwise."""
    along = ends[1] - ends[0]
    length = float(np.hypot(*along))
    (x1, y1), (x2, y2) = ends.tolist()
    line = {"x1": _text(x1), "y1": _text(y1), "x2": _text(x2), "y2": _text(y2)}
    ElementTree.SubElement(group, "line", {"class": "seam", "stroke": "red", **line})
    if length == 0.0:
        return
    size = min(LARGEST, NUMBER * length)
    inwards = np.array([along[1], -along[0]]) / length  # y runs downwards
    x, y = (ends.mean(axis=0) + 0.8 * size * inwards).tolist()
    style = {"fill": "red", "stroke": "none", "text-anchor": "middle", "dominant-baseline": "central"}
    place = {"x": _text(x), "y": _text(y), "font-size": _text(size)}
    text = ElementTree.SubElement(group, "text", {**style, **place})
    text.text = str(number)


def _point(place: Array) -> str:
    return f"{_text(float(place[0]))},{_text(float(place[1]))}"


def _text(number: float) -> str:
    return f"{number:.4f}".rstrip("0").rstrip(".")
