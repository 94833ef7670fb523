# SPDX-License-Identifier: GPL-3.0-or-later
"""The river dragon: one long part, whose belly plates and stripes show how the drawing bends."""

from __future__ import annotations

import itertools

import numpy as np
from shapely.geometry import LineString, Point, Polygon
from shapely.ops import unary_union

from comparison import Trial, arc, loop
from drawing import Colour, Layer, blob, curve, ellipse, limb, moved, tint
from puppet import PinPlan, Pose

SCALE: Colour = (58, 158, 126)
BELLY: Colour = (252, 232, 170)
FIN: Colour = (240, 104, 92)
HORN: Colour = (250, 240, 214)

# The spine runs from the tail (left) to the neck (right); its radii follow at even steps.
SPINE = [
    (-3.9, 1.22),
    (-3.0, 1.02),
    (-2.0, 1.10),
    (-1.0, 1.34),
    (0.0, 1.40),
    (1.0, 1.26),
    (1.8, 1.34),
    (2.35, 1.78),
    (2.62, 2.25),
]
RADII = (0.05, 0.16, 0.27, 0.36, 0.41, 0.42, 0.40, 0.36, 0.33, 0.31)


def layers() -> list[Layer]:
    """The dragon in one layer, about seven and a half units long."""
    layer = Layer("Dragon", depth=0.0)
    body = limb(SPINE, RADII)
    _fins(layer)
    layer.fill(body, SCALE, shade=0.10)
    _markings(layer, body)
    _legs(layer)
    _head(layer)
    return [layer]


def _along(fraction: float, side: float) -> tuple[float, float]:
    """The point at a fraction of the spine's points, `side` radii to its left (the back is +1)."""
    spine = curve(SPINE, closed=False, samples=10)
    at = fraction * (len(spine) - 1)
    i = min(int(at), len(spine) - 2)
    point = spine[i] + (at - i) * (spine[i + 1] - spine[i])
    ahead = spine[min(i + 2, len(spine) - 1)] - spine[max(i - 1, 0)]
    left = np.array([-ahead[1], ahead[0]]) / np.hypot(*ahead)
    radius = np.interp(fraction, np.linspace(0, 1, len(RADII)), RADII)
    x, z = point + side * radius * left
    return (float(x), float(z))


def _fins(layer: Layer) -> None:
    tail = blob([
        (-3.70, 1.20), (-4.02, 1.46), (-4.20, 1.86, "corner"), (-4.30, 1.56), (-4.62, 1.50, "corner"),
        (-4.40, 1.26), (-4.66, 0.98, "corner"), (-4.32, 0.98), (-4.16, 0.66, "corner"), (-3.98, 0.98),
        (-3.68, 1.12),
    ])  # fmt: skip
    layer.fill(tail, FIN, shade=0.06)
    for tip in ((-4.14, 1.66), (-4.48, 1.46), (-4.50, 1.03), (-4.14, 0.80)):
        layer.stroke(
            [(-3.86, 1.2), (0.5 * (tip[0] - 3.86), 0.5 * (tip[1] + 1.2)), tip], 0.026, tint(FIN, -0.45)
        )
    steps = np.linspace(0.10, 0.93, 15)
    for a, b in itertools.pairwise(steps):
        height = 1.85 - 0.25 * np.cos(8 * a)
        middle = a + 0.28 * (b - a)
        spike = blob(
            [
                _along(a - 0.012, 0.7),
                _along(a, 1.1),
                (*_along(middle - 0.035, height), "corner"),
                _along(middle + 0.01, 1.42),
                _along(b, 1.05),
                _along(b, 0.7),
            ]
        )
        layer.fill(spike, FIN, shade=0.04)


def _markings(layer: Layer, body: Polygon) -> None:
    edge = [_along(f, -0.34) for f in np.linspace(0.0, 1.0, 40)]
    under = [_along(f, -1.3) for f in np.linspace(1.0, 0.0, 40)]
    belly = Polygon(edge + under).buffer(0).intersection(body)
    layer.fill(belly, BELLY, shade=0.0, outline=False)
    shadow = Polygon([_along(f, -0.72) for f in np.linspace(0, 1, 40)] + under).buffer(0)
    layer.gradient(shadow, tint(BELLY, -0.28), inside=belly, blur=0.03, opacity=0.9)
    for f in np.linspace(0.05, 0.97, 40):
        layer.stroke(
            [_along(f, -0.36), _along(f + 0.006, -0.66), _along(f - 0.002, -0.98)], 0.028, tint(BELLY, -0.48)
        )
    rim = LineString(edge).buffer(0.017)
    layer.fill(rim, tint(SCALE, -0.55), shade=0, outline=False, inside=body)

    for f in np.linspace(0.12, 0.90, 13):
        width = 0.011
        stripe = Polygon(
            [
                _along(f - width, 1.1),
                _along(f + width, 1.1),
                _along(f + 0.9 * width, 0.72),
                _along(f - 0.006, 0.30),
                _along(f - 0.5 * width, 0.72),
            ]
        )
        layer.gradient(stripe.buffer(0.03), tint(SCALE, -0.55), inside=body, blur=0.008, opacity=0.85)
    for k, f in enumerate(np.linspace(0.16, 0.93, 44)):
        x, z = _along(f, (0.10, 0.42, -0.12)[k % 3])
        layer.fill(
            moved(_scale(0.055), x, z), tint(SCALE, -0.30), shade=0, outline=False, inside=body.buffer(-0.02)
        )
    glow = Polygon(
        [_along(f, 0.95) for f in np.linspace(0.06, 0.98, 40)]
        + [_along(f, 0.80) for f in np.linspace(0.98, 0.06, 40)]
    ).buffer(0)
    layer.gradient(glow, tint(SCALE, 0.6), inside=body, blur=0.03, opacity=0.55)


def _scale(size: float) -> Polygon:
    """A crescent, as a drawn scale."""
    disc = Point(0, 0).buffer(size, 16)
    return disc.difference(moved(disc, 0.55 * size, 0.25 * size))


def _legs(layer: Layer) -> None:
    for x, z, size in ((-1.55, 0.92, 0.9), (1.28, 0.98, 1.0)):
        thigh = ellipse(x, z, 0.28 * size, 0.34 * size, 24)
        shin = limb(
            [(x - 0.04, z - 0.12), (x + 0.06 * size, z - 0.40 * size), (x - 0.02, z - 0.62 * size)],
            (0.16 * size, 0.12 * size, 0.10 * size),
        )
        toes = [
            limb([(x, z - 0.62 * size), (x + dx * size, z - 0.74 * size)], (0.09 * size, 0.075 * size))
            for dx in (0.02, 0.16, 0.29)
        ]
        leg = unary_union([thigh, shin, *toes])
        layer.fill(leg, tint(SCALE, 0.10), shade=0.06)
        for dx in (0.09, 0.34, 0.215):
            claw = blob(
                [
                    (x + dx * size, z - 0.70 * size),
                    (x + (dx + 0.11) * size, z - 0.79 * size, "corner"),
                    (x + dx * size, z - 0.80 * size),
                ]
            )
            layer.fill(claw, HORN, shade=0)
        layer.stroke(
            [(x + 0.02, z - 0.42 * size), (x + 0.11, z - 0.44 * size), (x + 0.17, z - 0.40 * size)],
            0.024,
            tint(SCALE, -0.5),
        )
        layer.gradient(
            ellipse(x - 0.05, z + 0.12, 0.12, 0.14), tint(SCALE, 0.5), inside=thigh, blur=0.05, opacity=0.6
        )


def _head(layer: Layer) -> None:
    mane = blob([
        (2.50, 2.92), (2.22, 3.16), (1.92, 3.14, "corner"), (2.10, 2.94), (1.80, 2.74, "corner"),
        (2.08, 2.62), (1.86, 2.32, "corner"), (2.18, 2.32), (2.10, 2.00, "corner"), (2.42, 2.06),
        (2.7, 2.2), (2.9, 2.7),
    ])  # fmt: skip
    layer.fill(mane, FIN, shade=0.07)
    for points in (
        [(2.5, 2.8), (2.28, 2.94), (2.06, 3.06)],
        [(2.42, 2.62), (2.2, 2.68), (1.98, 2.72)],
        [(2.44, 2.42), (2.24, 2.40), (2.02, 2.36)],
    ):
        layer.stroke(points, 0.03, tint(FIN, -0.45))
    for x, lean in ((2.86, -0.10), (2.58, -0.16)):
        horn = blob(
            [
                (x - 0.08, 2.90),
                (x + lean - 0.06, 3.20),
                (x + 2.2 * lean, 3.46),
                (x + 3.4 * lean, 3.58, "corner"),
                (x + lean + 0.12, 3.36),
                (x + 0.10, 2.92),
            ]
        )
        layer.fill(horn, HORN, shade=0.04)
        for k in (1, 2):
            z = 2.94 + 0.15 * k
            layer.stroke(
                [
                    (x - 0.08 + 0.45 * k * lean, z + 0.03),
                    (x + 0.3 * k * lean, z),
                    (x + 0.13 + 0.35 * k * lean, z + 0.05),
                ],
                0.022,
                tint(HORN, -0.45),
            )

    jaw = blob(
        [
            (2.55, 2.20),
            (2.74, 2.02),
            (3.10, 1.94),
            (3.52, 1.95),
            (3.84, 2.04),
            (3.92, 2.20),
            (3.60, 2.34),
            (2.9, 2.40),
        ]
    )
    layer.fill(jaw, BELLY, shade=0.06)
    inner = blob([(3.02, 2.30), (3.30, 2.10), (3.66, 2.10), (3.88, 2.26), (3.7, 2.42), (3.1, 2.42)])
    layer.fill(inner, (138, 42, 52), shade=0, outline=False)
    layer.fill(ellipse(3.48, 2.14, 0.24, 0.07, 4), (240, 128, 118), shade=0, outline=False, inside=inner)
    skull = blob([
        (2.34, 2.42), (2.36, 2.74), (2.60, 3.00), (2.94, 3.04), (3.20, 2.92), (3.36, 2.70), (3.62, 2.64),
        (3.86, 2.72), (4.06, 2.64), (4.12, 2.44), (3.98, 2.30), (3.66, 2.30), (3.34, 2.28), (3.04, 2.30),
        (2.84, 2.22), (2.62, 2.12), (2.44, 2.18),
    ])  # fmt: skip
    layer.fill(skull, SCALE, shade=0.08)
    for x in (3.34, 3.56, 3.80):
        layer.fill(
            blob([(x - 0.055, 2.31, "corner"), (x + 0.055, 2.31, "corner"), (x + 0.01, 2.19, "corner")]),
            (255, 252, 240),
            shade=0,
        )
    muzzle = blob([(3.30, 2.44), (3.60, 2.54), (3.90, 2.58), (4.3, 2.5), (4.2, 2.2), (3.2, 2.2)])
    layer.fill(muzzle, tint(SCALE, 0.22), shade=0, outline=False, inside=skull)
    layer.stroke([(2.96, 2.24), (3.04, 2.31), (3.34, 2.29), (3.70, 2.305), (3.98, 2.31), (4.10, 2.42)], 0.045)
    layer.stroke([(2.90, 2.30), (2.97, 2.24), (2.98, 2.17)], 0.035)
    layer.fill(ellipse(3.94, 2.58, 0.055, 0.035, 20), (40, 44, 50), shade=0, outline=False)
    layer.stroke([(3.84, 2.64), (3.94, 2.68), (4.03, 2.62)], 0.03)
    layer.gradient(ellipse(2.98, 2.42, 0.14, 0.09), (255, 150, 110), inside=skull, blur=0.04, opacity=0.75)
    layer.gradient(
        ellipse(2.74, 2.92, 0.16, 0.05, 14), tint(SCALE, 0.7), inside=skull, blur=0.03, opacity=0.7
    )

    x, z = 3.06, 2.72
    eye = ellipse(x, z, 0.165, 0.19, -6)
    layer.fill(eye, (255, 252, 246), shade=0)
    iris = ellipse(x + 0.045, z - 0.01, 0.105, 0.14)
    layer.fill(iris, (232, 150, 38), shade=0, outline=False, inside=eye)
    layer.gradient(
        ellipse(x + 0.05, z - 0.10, 0.08, 0.05), (255, 220, 110), inside=iris.intersection(eye), blur=0.02
    )
    layer.fill(ellipse(x + 0.055, z, 0.05, 0.105), (30, 16, 20), shade=0, outline=False)
    layer.fill(ellipse(x + 0.0, z + 0.07, 0.042, 0.05), (255, 255, 255), shade=0, outline=False)
    layer.fill(ellipse(x + 0.09, z - 0.07, 0.018, 0.022), (255, 255, 255), shade=0, outline=False)
    lid = eye.difference(moved(eye, 0.05, -0.12)).buffer(0)
    layer.fill(lid, tint(SCALE, -0.15), shade=0, outline=False, inside=eye)
    layer.stroke(
        [(x - 0.20, z + 0.07), (x - 0.04, z + 0.145), (x + 0.10, z + 0.13), (x + 0.19, z + 0.03)], 0.05
    )


PINS = (
    PinPlan("Middle", "Dragon", _along(0.50, 0.0)),
    PinPlan("Shoulders", "Dragon", _along(0.625, 0.0), "Middle"),
    PinPlan("Neck", "Dragon", _along(0.78, 0.0), "Shoulders"),
    PinPlan("Throat", "Dragon", _along(0.90, 0.0), "Neck"),
    PinPlan("Head", "Dragon", (2.98, 2.46), "Throat", radius=0.42),
    PinPlan("Rump", "Dragon", _along(0.36, 0.0), "Middle"),
    PinPlan("Hind", "Dragon", _along(0.24, 0.0), "Rump"),
    PinPlan("Tail", "Dragon", _along(0.12, 0.0), "Hind"),
    PinPlan("Tail Fin", "Dragon", (-4.05, 1.22), "Tail", radius=0.12),
    PinPlan("Fore Foot", "Dragon", (1.36, 0.30), "Shoulders", radius=0.14),
    PinPlan("Hind Foot", "Dragon", (-1.48, 0.30), "Rump", radius=0.12),
)

POSES = (
    Pose("Rear Up", {
        "Shoulders": 40, "Neck": 68, "Throat": 62, "Head": 14, "Rump": 22, "Hind": 12, "Tail": -30,
        "Tail Fin": -74, "Fore Foot": 84, "Hind Foot": 0,
    }, step=(-0.1, 0.2), stands={"Hind Foot": (0.0, 0.0)}),
    Pose("Leap", {
        "Shoulders": -22, "Neck": -56, "Throat": -62, "Head": -40, "Rump": 20, "Hind": 44, "Tail": 58,
        "Tail Fin": 40, "Fore Foot": -44, "Hind Foot": 46,
    }, step=(0.0, 1.75)),
    Pose("Coil", {
        "Shoulders": 10, "Neck": 26, "Throat": 40, "Head": -6, "Rump": -8, "Hind": -60, "Tail": -126,
        "Tail Fin": -180, "Fore Foot": 0, "Hind Foot": 0,
    }, step=(0.0, -0.16), stands={"Fore Foot": (0.0, 0.0), "Hind Foot": (0.0, 0.0)}),
)  # fmt: skip

TRIALS = (
    Trial(
        "Bent to a ring",
        [("Head", arc((-2.4, 1.9), 0.8, 130)), ("Tail Fin", arc((3.4, 3.4), 0.8, -130))],
        holding=["Middle"],
    ),
    Trial("Round a loop and back", [("Head", loop(1.1))], holding=["Tail Fin", "Fore Foot", "Hind Foot"]),
)
