# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes and paint for the example cutouts: smooth outlines, and cel-shaded layers painted into an image.

Lengths are world units, x to the right and z up; only `Layer.paint` knows pixels.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from PIL import Image, ImageChops, ImageDraw, ImageFilter
from shapely import affinity
from shapely.geometry import MultiPolygon, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

Colour = tuple[int, int, int]
Brush = Callable[["Canvas"], None]

INK: Colour = (52, 34, 44)
LINE_WIDTH = 0.024
SUPERSAMPLING = 3


def curve(points: Sequence[tuple], closed: bool = True, samples: int = 12) -> np.ndarray:
    """A smooth curve through points (x, z), as k x 2; a third entry "corner" lets the direction break there.

    Cubic Hermite pieces: the tangent at a point leans to its nearer neighbour and is as long as the piece, so
    that uneven spacing does not loop.
    """
    xy = np.array([point[:2] for point in points], float)
    corner = np.array([len(point) > 2 for point in points])
    n = len(xy)
    pieces = []
    for i in range(n if closed else n - 1):
        j = (i + 1) % n
        before, after = xy[i - 1], xy[(j + 1) % n]
        chord = xy[j] - xy[i]
        length = np.hypot(*chord)
        start = chord if corner[i] or (not closed and i == 0) else _tangent(before, xy[i], xy[j], length)
        end = chord if corner[j] or (not closed and j == n - 1) else _tangent(xy[i], xy[j], after, length)
        t = np.linspace(0, 1, samples, endpoint=False)[:, None]
        pieces.append(
            (2 * t**3 - 3 * t**2 + 1) * xy[i]
            + (t**3 - 2 * t**2 + t) * start
            + (3 * t**2 - 2 * t**3) * xy[j]
            + (t**3 - t**2) * end
        )
    if not closed:
        pieces.append(xy[-1:])
    return np.concatenate(pieces)


def _tangent(before: np.ndarray, here: np.ndarray, after: np.ndarray, length: float) -> np.ndarray:
    a, b = here - before, after - here
    la, lb = np.hypot(*a), np.hypot(*b)
    direction = a * lb / la + b * la / lb
    return direction * (length / max(np.hypot(*direction), 1e-12))


def blob(points: Sequence[tuple], samples: int = 12) -> Polygon:
    """The inside of a closed smooth curve."""
    return Polygon(curve(points, samples=samples)).buffer(0)


def ellipse(x: float, z: float, width: float, height: float, angle: float = 0.0) -> Polygon:
    """An ellipse by its centre, half axes and turn in degrees."""
    return affinity.rotate(affinity.scale(Point(x, z).buffer(1.0, 32), width, height), angle)


def limb(points: Sequence[tuple], radii: Sequence[float]) -> Polygon:
    """A smooth spine thickened by a radius at each of its points."""
    spine = curve(points, closed=False, samples=10)
    knots = np.linspace(0, 1, len(radii))
    radius = np.interp(np.linspace(0, 1, len(spine)), knots, radii)
    discs = [Point(*p).buffer(r, 16) for p, r in zip(spine, radius, strict=True)]
    return unary_union([unary_union(pair).convex_hull for pair in itertools.pairwise(discs)])


def line(points: Sequence[tuple], width: float = LINE_WIDTH) -> Polygon:
    """A drawn line: thick in the middle, thin at its ends."""
    return limb(points, (0.25 * width, 0.5 * width, 0.5 * width, 0.25 * width))


def moved(shape: BaseGeometry, dx: float, dz: float) -> BaseGeometry:
    """The shape shifted by (dx, dz)."""
    return affinity.translate(shape, dx, dz)


def tint(colour: Colour, amount: float) -> Colour:
    """Darker (amount < 0, towards a warm violet) or lighter (amount > 0, towards a warm white)."""
    goal = (255, 246, 226) if amount > 0 else (58, 30, 66)
    return tuple(round(c + (g - c) * abs(amount)) for c, g in zip(colour, goal, strict=True))


@dataclass
class Canvas:
    """An RGBA image over a rectangle of the world."""

    origin: tuple[float, float]  # the world's (left, top)
    scale: float  # pixels per world unit
    image: Image.Image

    def mask(self, shape: BaseGeometry, blur: float = 0.0) -> Image.Image:
        """The shape's coverage, 0-255, softened by a blur radius in world units."""
        mask = Image.new("L", self.image.size)
        draw = ImageDraw.Draw(mask)
        for polygon in _polygons(shape):
            draw.polygon(self._pixels(polygon.exterior.coords), fill=255)
            for hole in polygon.interiors:
                draw.polygon(self._pixels(hole.coords), fill=0)
        return mask.filter(ImageFilter.GaussianBlur(blur * self.scale)) if blur else mask

    def fill(self, mask: Image.Image, colour: Colour, opacity: float = 1.0) -> None:
        """Lays a colour over the image where the mask is, as paint does (alpha grows)."""
        if opacity < 1:
            mask = mask.point(lambda value: round(value * opacity))
        paint = Image.new("RGBA", self.image.size, (*colour, 0))
        paint.putalpha(mask)
        self.image = Image.alpha_composite(self.image, paint)

    def _pixels(self, coords: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
        left, top = self.origin
        return [((x - left) * self.scale, (top - z) * self.scale) for x, z in coords]


def _polygons(shape: BaseGeometry) -> list[Polygon]:
    if isinstance(shape, Polygon):
        return [] if shape.is_empty else [shape]
    return [part for part in getattr(shape, "geoms", []) if isinstance(part, Polygon) and not part.is_empty]


@dataclass
class Layer:
    """One part of a cutout: brushes from back to front, and the silhouette its mesh will fill."""

    name: str
    depth: float  # along the view, larger is further away
    silhouette: BaseGeometry = field(default_factory=MultiPolygon)
    brushes: list[tuple[BaseGeometry, Brush]] = field(default_factory=list)

    def outline(self, shape: BaseGeometry, width: float = LINE_WIDTH) -> None:
        """Ink around a shape, a little heavier on the side away from the light."""
        inked = unary_union([shape.buffer(width), moved(shape.buffer(width), 0.25 * width, -0.35 * width)])
        self._add(inked, lambda canvas: canvas.fill(canvas.mask(inked), INK))

    def fill(
        self,
        shape: BaseGeometry,
        colour: Colour,
        *,
        shade: float = 0.05,
        outline: bool = True,
        inside: BaseGeometry | None = None,
    ) -> None:
        """A shape in one colour with a band of shadow (`shade` wide) away from the light, at the upper left.

        `inside` clips it, as markings are clipped by the limb they lie on.
        """
        if inside is not None:
            shape = shape.intersection(inside)
        if outline:
            self.outline(shape)

        def brush(canvas: Canvas) -> None:
            body = canvas.mask(shape)
            canvas.fill(body, colour)
            if shade:
                shadow = canvas.mask(shape.difference(moved(shape, -shade, 0.9 * shade)), blur=0.10 * shade)
                canvas.fill(ImageChops.multiply(shadow, body), tint(colour, -0.30))
                light = canvas.mask(
                    shape.difference(moved(shape, 0.45 * shade, -0.5 * shade)), blur=0.15 * shade
                )
                canvas.fill(ImageChops.multiply(light, body), tint(colour, 0.40), opacity=0.75)

        self._add(shape, brush)

    def gradient(
        self, shape: BaseGeometry, colour: Colour, inside: BaseGeometry, blur: float, opacity: float = 1.0
    ) -> None:
        """A soft-edged colour within another shape: cheeks, a glow, the shadow of one part on the next."""

        def brush(canvas: Canvas) -> None:
            canvas.fill(ImageChops.multiply(canvas.mask(shape, blur), canvas.mask(inside)), colour, opacity)

        self._add(inside, brush)

    def stroke(self, points: Sequence[tuple], width: float = LINE_WIDTH, colour: Colour = INK) -> None:
        """A drawn line."""
        shape = line(points, width)
        self._add(shape, lambda canvas: canvas.fill(canvas.mask(shape), colour))

    def _add(self, shape: BaseGeometry, brush: Brush) -> None:
        self.silhouette = unary_union([self.silhouette, shape])
        self.brushes.append((shape, brush))

    def paint(self, bounds: tuple[float, float, float, float], scale: float) -> Image.Image:
        """The layer over bounds (left, bottom, right, top), at `scale` pixels per world unit, with alpha."""
        left, bottom, right, top = bounds
        fine = scale * SUPERSAMPLING
        size = (round((right - left) * fine), round((top - bottom) * fine))
        image = Image.new("RGBA", size, (*INK, 0))
        for shape, brush in self.brushes:
            # A brush only touches its own neighbourhood: paint a crop, not the sheet.
            x0, z0, x1, z1 = shape.bounds
            box = (
                max(0, int((x0 - left) * fine) - 4),
                max(0, int((top - z1) * fine) - 4),
                min(size[0], int((x1 - left) * fine) + 5),
                min(size[1], int((top - z0) * fine) + 5),
            )
            if box[0] >= box[2] or box[1] >= box[3]:
                continue  # beside the sheet
            canvas = Canvas((left + box[0] / fine, top - box[1] / fine), fine, image.crop(box))
            brush(canvas)
            image.paste(canvas.image, box)
        return image.resize((size[0] // SUPERSAMPLING, size[1] // SUPERSAMPLING), Image.Resampling.LANCZOS)
