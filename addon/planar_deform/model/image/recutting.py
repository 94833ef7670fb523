# SPDX-License-Identifier: GPL-3.0-or-later
"""New meshes of the images that the parts of a mesh show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..plane.carrying import carrying
from ..plane.cutout import oriented, signed_areas
from ..plane.frame import Array, Indices
from ..plane.locate import INSIDE
from ..work import Progress
from .art import OPAQUE, Art
from .cutting import NoArt, Settings, cut
from .filling import Filling, Piece
from .placement import Placement

FEW = 0.02  # of the points on the part that has most of them: a neighbour's edge


@dataclass(frozen=True)
class Layer:
    """Parts of a mesh that show one image in one place."""

    image: str  # its name
    art: Callable[[], Art]
    placement: Placement
    to_plane: Callable[[Array], Array]  # the mesh's coordinates at rest (k x 3) to those of its plane (k x 2)
    parts: Indices
    whole: bool  # a plane that shows a window of the image, outside of which nothing is asked for
    alone: bool  # nothing else shows the image: what is new in it belongs here


def recut(
    layers: list[Layer],
    settings: Settings,
    rest: Array,
    triangles: Indices,
    part_of: Indices,
    progress: Progress,
) -> Filling:
    """New pieces for a mesh, n x 2 with triangles m x 3 that are of parts (m,), of what its images are now.

    An island takes over from the parts that it lies on. What lies on none is a new part if nothing else shows
    its image. Raises NoArt, native.Cancelled and native.SolveError.
    """
    pieces: list[Piece] = []
    said: list[str] = []
    taken: set[int] = set()
    sizes = np.abs(signed_areas(rest, triangles))
    areas = np.array([sizes[np.isin(part_of, layer.parts)].sum() for layer in layers])
    for number, layer in enumerate(layers):

        def tell(share: float, number: int = number) -> bool:
            return progress((number + share) / len(layers))

        art = layer.art()
        share = areas[number] / areas.sum() * _times_as_much(layer, art, settings.threshold, areas[number])
        wish = replace(settings, vertices=max(3, round(settings.vertices * share)))
        window = layer.placement.window if layer.whole else None
        try:
            drawing = cut(art.alpha, wish, window=window, progress=tell)
        except NoArt as reason:
            raise NoArt(f"'{layer.image}' cannot be cut out: {reason}") from reason
        told = drawing.said if art.said is None else [art.said, *drawing.said]
        said += [f"'{layer.image}': {sentence}" for sentence in told]
        among = np.isin(part_of, layer.parts)
        for island in drawing.separated():
            places = layer.to_plane(layer.placement.places(island.points))
            cells = oriented(places, island.triangles)
            parts = _parts_under(places[cells].mean(axis=1), rest, triangles[among], part_of[among])
            taken.update(parts.tolist())
            if not len(parts):
                if not layer.alone:
                    continue
                parts = layer.parts
            pieces.append(Piece(places, cells, parts))
    lost = len(np.unique(part_of)) - len(taken)
    if lost:
        said.append(f"{lost} part{'s have' if lost > 1 else ' has'} no drawing any more")
    return Filling(pieces, tuple(said))


def _times_as_much(layer: Layer, art: Art, threshold: float, area: float) -> float:
    """How many times the art that a layer of an area has is in its image, as others show that as well."""
    if layer.alone or layer.whole:
        return 1.0
    corner, right, up = layer.to_plane(layer.placement.places(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])))
    (ax, ay), (bx, by) = right - corner, up - corner
    pixels = np.count_nonzero(art.alpha > threshold * OPAQUE)
    return max(1.0, float(pixels * abs(ax * by - ay * bx) / area))


def _parts_under(middles: Array, rest: Array, triangles: Indices, part_of: Indices) -> Indices:
    """The parts that points lie on, all but those that have a few of them."""
    found = []
    for part in np.unique(part_of):
        hung = carrying(rest, triangles[part_of == part], middles)
        found.append((int(part), int(np.count_nonzero(hung.weights.min(axis=1) >= INSIDE))))
    most = max((count for _, count in found), default=0)
    return np.array([part for part, count in found if count > 0 and count >= FEW * most], np.int32)
