# SPDX-License-Identifier: GPL-3.0-or-later
"""The lantern fox: four layers (tail, lantern arm, body, waving arm); the lantern's handle makes a hole."""

from __future__ import annotations

from shapely.geometry import Polygon, box
from shapely.ops import unary_union

from drawing import Colour, Layer, blob, ellipse, limb, moved, tint
from puppet import PinPlan, Pose

FUR: Colour = (232, 119, 46)
CREAM: Colour = (255, 240, 214)
SOCK: Colour = (84, 50, 56)
SWEATER: Colour = (38, 128, 137)
SCARF: Colour = (247, 190, 62)
BRASS: Colour = (206, 150, 64)
GLOW: Colour = (255, 226, 120)


def layers() -> list[Layer]:
    """The fox from back to front, standing on z = 0, about four units tall."""
    return [_tail(), _lantern_arm(), _body(), _waving_arm()]


def _tail() -> Layer:
    layer = Layer("Tail", depth=0.12)
    tail = blob([
        (0.05, 1.52), (-0.30, 1.34), (-0.72, 1.10), (-1.22, 1.06), (-1.66, 1.34), (-1.88, 1.80),
        (-1.90, 2.22), (-1.80, 2.72, "corner"), (-1.62, 2.34), (-1.40, 2.02), (-1.12, 1.80), (-0.78, 1.72),
        (-0.42, 1.80), (0.02, 1.84),
    ])  # fmt: skip
    tip = blob([
        (-1.80, 2.90), (-2.30, 2.20), (-2.20, 1.50), (-1.92, 1.42, "corner"), (-1.80, 1.66),
        (-1.74, 1.52, "corner"), (-1.64, 1.78), (-1.52, 1.68, "corner"), (-1.47, 1.96),
        (-1.34, 1.92, "corner"), (-1.30, 2.40),
    ])  # fmt: skip
    layer.fill(tail, FUR, shade=0.10)
    layer.fill(tip, CREAM, shade=0.09, outline=False, inside=tail)
    layer.gradient(ellipse(-0.05, 1.62, 0.36, 0.5), tint(FUR, -0.35), inside=tail, blur=0.10, opacity=0.8)
    for x, z in ((-0.80, 1.24), (-0.95, 1.37)):
        layer.stroke([(x + 0.17, z + 0.02), (x, z), (x - 0.15, z + 0.03)], 0.028, tint(FUR, -0.45))
    layer.stroke([(-1.70, 1.92), (-1.72, 2.10), (-1.70, 2.26)], 0.028, tint(CREAM, -0.35))
    return layer


def _lantern_arm() -> Layer:
    layer = Layer("Lantern Arm", depth=0.06)
    sleeve = limb([(0.22, 2.34), (0.56, 2.14), (0.86, 1.86)], (0.15, 0.125, 0.12))
    forearm = limb([(0.78, 1.92), (1.02, 1.72), (1.22, 1.50)], (0.075, 0.07, 0.075))
    x, z = 1.28, 1.42  # the hand
    _hang_lantern(layer, x, z)
    layer.fill(forearm, SOCK, shade=0.035)
    layer.fill(ellipse(x - 0.02, z + 0.02, 0.125, 0.115, -20), SOCK, shade=0.04)
    for dx, dz in ((-0.075, -0.06), (0.0, -0.085), (0.075, -0.06)):
        layer.fill(ellipse(x + dx, z + dz, 0.05, 0.06), tint(SOCK, 0.10), shade=0.02)
    layer.fill(sleeve, tint(SWEATER, -0.18), shade=0.05)
    layer.fill(limb([(0.83, 1.91), (0.89, 1.84)], (0.115, 0.115)), tint(SWEATER, -0.40), shade=0.03)
    layer.gradient(
        ellipse(0.15, 2.36, 0.32, 0.34), tint(SWEATER, -0.7), inside=sleeve, blur=0.08, opacity=0.7
    )
    return layer


def lantern(x: float, z: float, depth: float) -> Layer:
    """A lantern of its own, of which a hand has hold at (x, z)."""
    layer = Layer("Lantern", depth=depth)
    _hang_lantern(layer, x, z)
    return layer


def _hang_lantern(layer: Layer, x: float, z: float) -> None:
    """It hangs from a hand there: a ring, a cap, a glass and a foot. The ring's inside is the hole."""
    ring = ellipse(x, z - 0.17, 0.28, 0.32).difference(ellipse(x, z - 0.17, 0.205, 0.25))
    layer.fill(ring, BRASS, shade=0.03)
    glass = blob(
        [
            (x - 0.20, z - 0.50),
            (x + 0.20, z - 0.50),
            (x + 0.27, z - 0.74),
            (x + 0.20, z - 0.98),
            (x - 0.20, z - 0.98),
            (x - 0.27, z - 0.74),
        ]
    )
    layer.fill(glass, GLOW, shade=0.05)
    flame = blob([(x, z - 0.56, "corner"), (x + 0.10, z - 0.76), (x, z - 0.90), (x - 0.10, z - 0.76)])
    layer.gradient(flame.buffer(0.05), (255, 252, 230), inside=glass, blur=0.05)
    layer.fill(flame, (246, 140, 40), shade=0, outline=False)
    layer.fill(
        blob([(x, z - 0.68, "corner"), (x + 0.05, z - 0.80), (x, z - 0.88), (x - 0.05, z - 0.80)]),
        (255, 238, 150),
        shade=0,
        outline=False,
    )
    for dx in (-0.13, 0.13):
        layer.stroke(
            [(x + dx, z - 0.52), (x + 1.3 * dx, z - 0.74), (x + dx, z - 0.97)], 0.03, tint(BRASS, -0.5)
        )
    cap = blob(
        [
            (x - 0.09, z - 0.38, "corner"),
            (x + 0.09, z - 0.38, "corner"),
            (x + 0.27, z - 0.53, "corner"),
            (x - 0.27, z - 0.53, "corner"),
        ]
    )
    layer.fill(cap, BRASS, shade=0.04)
    layer.fill(box(x - 0.24, z - 1.06, x + 0.24, z - 0.95), BRASS, shade=0.04)


def _leg(
    layer: Layer, hip: tuple[float, float], knee: tuple[float, float], ankle: tuple[float, float], fur: Colour
) -> None:
    leg = limb([hip, knee, ankle], (0.185, 0.10, 0.08))
    x, z = ankle
    foot = blob(
        [
            (x - 0.11, z + 0.04),
            (x - 0.13, 0.03),
            (x + 0.06, 0.0),
            (x + 0.34, 0.01),
            (x + 0.43, 0.07),
            (x + 0.32, 0.17),
            (x + 0.10, z + 0.02),
        ]
    )
    whole = unary_union([leg, foot])
    layer.fill(whole, fur, shade=0.05)
    x, z = knee
    jagged_edge = blob([
        (x - 0.30, z - 0.30), (x - 0.12, z + 0.12, "corner"), (x - 0.04, z - 0.02),
        (x + 0.02, z + 0.16, "corner"), (x + 0.07, z - 0.02), (x + 0.13, z + 0.10, "corner"),
        (x + 0.30, z - 0.30),
    ])  # fmt: skip
    sock = unary_union([leg.intersection(box(-2, -1, 2, z + 0.02)), foot, jagged_edge])
    colour = SOCK if fur == FUR else tint(SOCK, -0.15)
    layer.fill(sock, colour, shade=0.045, outline=False, inside=whole)
    x = ankle[0]
    for dx in (0.22, 0.32):
        layer.stroke([(x + dx, 0.03), (x + dx - 0.015, 0.065), (x + dx - 0.02, 0.10)], 0.022)


def _body() -> Layer:
    layer = Layer("Body", depth=0.0)
    _leg(layer, (0.20, 1.58), (0.35, 0.92), (0.45, 0.20), tint(FUR, -0.20))
    _leg(layer, (-0.14, 1.58), (-0.26, 0.92), (-0.40, 0.20), FUR)
    hips = blob(
        [
            (-0.32, 1.78),
            (-0.325, 1.56),
            (-0.26, 1.40, "corner"),
            (-0.03, 1.43),
            (0.04, 1.46),
            (0.12, 1.43),
            (0.34, 1.44, "corner"),
            (0.375, 1.56),
            (0.37, 1.78),
        ]
    )
    layer.fill(hips, FUR, shade=0, outline=False)
    layer.gradient(box(-0.6, 1.50, 0.6, 1.80), tint(FUR, -0.45), inside=hips, blur=0.05, opacity=0.8)

    torso = blob(
        [
            (-0.20, 2.56),
            (-0.34, 2.32),
            (-0.38, 1.96),
            (-0.42, 1.66),
            (-0.20, 1.57),
            (0.04, 1.55),
            (0.28, 1.57),
            (0.46, 1.66),
            (0.40, 1.98),
            (0.34, 2.34),
            (0.20, 2.56),
        ]
    )
    layer.fill(torso, SWEATER, shade=0.07)
    for z, colour in ((2.06, CREAM), (1.90, (236, 100, 78))):
        band = blob(
            [
                (-0.6, z + 0.05),
                (0.0, z - 0.03),
                (0.6, z + 0.05),
                (0.6, z - 0.03),
                (0.0, z - 0.11),
                (-0.6, z - 0.03),
            ]
        )
        layer.fill(band, colour, shade=0, outline=False, inside=torso)
        layer.gradient(
            moved(torso, 0.62, 0.0),
            tint(colour, -0.35),
            inside=band.intersection(torso),
            blur=0.02,
            opacity=0.8,
        )
    hem = blob([(-0.43, 1.76), (0.02, 1.66), (0.47, 1.76), (0.46, 1.62), (0.04, 1.53), (-0.43, 1.62)])
    layer.fill(hem, tint(SWEATER, -0.28), shade=0.03)
    for i in range(9):
        x = -0.34 + 0.09 * i
        sag = 0.62 * (x - 0.02) ** 2
        layer.stroke(
            [(x, 1.66 + sag - 0.01), (x + 0.004, 1.62 + sag), (x, 1.575 + sag)], 0.02, tint(SWEATER, -0.6)
        )

    _scarf(layer, torso)
    _head(layer)
    return layer


def _scarf(layer: Layer, torso: Polygon) -> None:
    layer.gradient(
        ellipse(0.02, 2.42, 0.42, 0.20), tint(SWEATER, -0.65), inside=torso, blur=0.05, opacity=0.7
    )
    end = blob(
        [
            (0.02, 2.48),
            (0.22, 2.44),
            (0.32, 2.16),
            (0.34, 1.90, "corner"),
            (0.12, 1.86, "corner"),
            (0.10, 2.14),
        ]
    )
    layer.fill(end, SCARF, shade=0.05)
    for z in (2.22, 2.02):
        layer.fill(box(0, z, 0.5, z + 0.07), (232, 98, 72), shade=0, outline=False, inside=end)
    for i in range(4):
        x = 0.15 + 0.05 * i
        layer.stroke([(x, 1.87), (x + 0.004, 1.91), (x + 0.006, 1.95)], 0.018)
    wrap = blob(
        [
            (-0.36, 2.52),
            (-0.38, 2.40),
            (-0.18, 2.30),
            (0.06, 2.28),
            (0.30, 2.32),
            (0.42, 2.44),
            (0.38, 2.58),
            (0.0, 2.66),
        ]
    )
    layer.fill(wrap, SCARF, shade=0.06)
    for x in (-0.25, 0.02, 0.28):
        stripe = blob(
            [
                (x - 0.05, 2.8),
                (x + 0.05, 2.8),
                (x + 0.06, 2.4),
                (x + 0.04, 2.2),
                (x - 0.05, 2.2),
                (x - 0.03, 2.4),
            ]
        )
        layer.fill(stripe, (232, 98, 72), shade=0, outline=False, inside=wrap)
    layer.gradient(ellipse(0.0, 2.66, 0.46, 0.14), tint(SCARF, -0.6), inside=wrap, blur=0.04, opacity=0.6)


def _head(layer: Layer) -> None:
    near_ear = [
        (-0.56, 3.22),
        (-0.64, 3.56),
        (-0.60, 4.04, "corner"),
        (-0.30, 3.86),
        (-0.04, 3.60),
        (-0.10, 3.2),
    ]
    near_hollow = [
        (-0.46, 3.34),
        (-0.54, 3.58),
        (-0.54, 3.86, "corner"),
        (-0.32, 3.72),
        (-0.18, 3.54),
        (-0.2, 3.3),
    ]
    near_tip = [(-0.75, 3.80), (-0.55, 3.74), (-0.42, 3.82), (-0.30, 3.76), (-0.28, 4.1), (-0.7, 4.2)]
    far_ear = [(0.18, 3.3), (0.22, 3.62), (0.48, 3.90), (0.74, 4.06, "corner"), (0.76, 3.62), (0.66, 3.24)]
    far_hollow = [(0.32, 3.34), (0.34, 3.58), (0.52, 3.76), (0.68, 3.88, "corner"), (0.67, 3.60), (0.56, 3.3)]
    far_tip = [(0.4, 3.86), (0.50, 3.78), (0.62, 3.84), (0.74, 3.74), (0.9, 3.8), (0.8, 4.2), (0.5, 4.2)]
    for ear, hollow, tip in ((near_ear, near_hollow, near_tip), (far_ear, far_hollow, far_tip)):
        outer = blob(ear)
        layer.fill(outer, FUR, shade=0.05)
        layer.fill(blob(tip), SOCK, shade=0, outline=False, inside=outer)
        layer.fill(blob(hollow), (122, 62, 66), shade=0.03, outline=False)
    tuft = blob([(-0.42, 3.3), (-0.36, 3.56, "corner"), (-0.28, 3.40), (-0.2, 3.52, "corner"), (-0.14, 3.3)])
    layer.fill(tuft, CREAM, shade=0, outline=False, inside=blob(near_hollow))

    face = blob([
        (0.06, 3.66), (-0.32, 3.58), (-0.60, 3.32), (-0.70, 3.08), (-0.94, 2.92, "corner"), (-0.74, 2.84),
        (-0.80, 2.68, "corner"), (-0.54, 2.64), (-0.22, 2.50), (0.14, 2.46), (0.46, 2.54), (0.70, 2.68),
        (0.98, 2.74, "corner"), (0.88, 2.88), (1.02, 3.02, "corner"), (0.80, 3.14), (0.68, 3.36),
        (0.42, 3.58),
    ])  # fmt: skip
    layer.fill(face, FUR, shade=0.08)
    mask = blob([
        (-1.1, 2.96), (-0.66, 2.98), (-0.30, 2.96), (0.00, 2.92), (0.16, 3.02, "corner"), (0.34, 2.93),
        (0.60, 2.98), (0.90, 3.02), (1.2, 3.06), (1.1, 2.3), (-1.1, 2.3),
    ])  # fmt: skip
    layer.fill(mask, CREAM, shade=0.06, outline=False, inside=face)
    layer.gradient(
        moved(face, 0.0, 0.13),
        CREAM,
        inside=face.intersection(mask).intersection(ellipse(0.05, 2.8, 0.55, 0.36)),
        blur=0.02,
    )
    for x, z in ((-0.52, 2.86), (0.76, 2.90)):
        layer.gradient(ellipse(x, z, 0.11, 0.075), (255, 150, 110), inside=face, blur=0.03, opacity=0.75)
    layer.gradient(ellipse(-0.12, 3.50, 0.30, 0.09, 12), tint(FUR, 0.45), inside=face, blur=0.05, opacity=0.8)

    for x, z, width in ((-0.26, 3.09, 0.125), (0.50, 3.11, 0.115)):
        eye = ellipse(x, z, width, 0.165, -4)
        layer.fill(eye, (255, 252, 246), shade=0)
        iris = ellipse(x + 0.025, z - 0.01, 0.085, 0.125)
        layer.fill(iris, (96, 52, 30), shade=0, outline=False, inside=eye)
        layer.gradient(
            ellipse(x + 0.03, z - 0.09, 0.06, 0.05), (214, 132, 52), inside=iris.intersection(eye), blur=0.02
        )
        layer.fill(ellipse(x + 0.03, z + 0.0, 0.05, 0.08), (30, 16, 20), shade=0, outline=False)
        layer.fill(ellipse(x - 0.015, z + 0.065, 0.034, 0.042), (255, 255, 255), shade=0, outline=False)
        layer.fill(ellipse(x + 0.06, z - 0.06, 0.016, 0.02), (255, 255, 255), shade=0, outline=False)
        layer.stroke(
            [
                (x - width - 0.02, z + 0.06),
                (x - 0.5 * width, z + 0.165),
                (x + 0.5 * width, z + 0.17),
                (x + width + 0.01, z + 0.08),
            ],
            0.05,
        )
    layer.stroke([(-0.40, 3.36), (-0.28, 3.42), (-0.14, 3.40)], 0.055, tint(SOCK, -0.1))
    layer.stroke([(0.42, 3.42), (0.54, 3.44), (0.64, 3.38)], 0.055, tint(SOCK, -0.1))

    nose = blob([(0.16, 2.91), (0.28, 2.89), (0.285, 2.83), (0.17, 2.765), (0.05, 2.83), (0.05, 2.89)])
    layer.stroke([(0.17, 2.80), (0.17, 2.74), (0.165, 2.69)], 0.03)
    mouth = blob(
        [
            (-0.06, 2.70, "corner"),
            (0.06, 2.665),
            (0.165, 2.69, "corner"),
            (0.29, 2.66),
            (0.40, 2.71, "corner"),
            (0.32, 2.585),
            (0.17, 2.54),
            (0.02, 2.585),
        ]
    )
    layer.fill(mouth, (140, 44, 52), shade=0, outline=False)
    layer.fill(ellipse(0.17, 2.545, 0.12, 0.05), (240, 128, 118), shade=0, outline=False, inside=mouth)
    layer.stroke([(-0.10, 2.735), (0.02, 2.67), (0.165, 2.69)], 0.032)
    layer.stroke([(0.165, 2.69), (0.32, 2.665), (0.44, 2.74)], 0.032)
    layer.fill(nose, (52, 30, 38), shade=0)
    layer.fill(ellipse(0.13, 2.875, 0.04, 0.018), (190, 168, 172), shade=0, outline=False)


def _waving_arm() -> Layer:
    layer = Layer("Waving Arm", depth=-0.06)
    sleeve = limb([(-0.24, 2.34), (-0.54, 2.12), (-0.80, 1.84)], (0.155, 0.13, 0.12))
    forearm = limb([(-0.72, 1.92), (-0.98, 1.66), (-1.14, 1.42)], (0.08, 0.07, 0.08))
    hand = ellipse(-1.19, 1.33, 0.13, 0.15, -25)
    fingers = [
        limb([(-1.19, 1.32), tip], (0.055, 0.05)) for tip in ((-1.35, 1.24), (-1.30, 1.15), (-1.20, 1.12))
    ]
    thumb = limb([(-1.14, 1.36), (-1.05, 1.25)], (0.05, 0.045))
    layer.fill(unary_union([forearm, hand, thumb, *fingers]), SOCK, shade=0.04)
    layer.fill(ellipse(-1.20, 1.31, 0.065, 0.075, -25), (190, 120, 112), shade=0.02, outline=False)
    layer.fill(sleeve, SWEATER, shade=0.06)
    layer.fill(limb([(-0.77, 1.89), (-0.83, 1.81)], (0.12, 0.12)), tint(SWEATER, -0.28), shade=0.03)
    return layer


PINS = (
    PinPlan("Hips", "Body", (0.03, 1.70), radius=0.14),
    PinPlan("Chest", "Body", (0.00, 2.34), "Hips"),
    PinPlan("Head", "Body", (0.08, 3.02), "Chest", radius=0.50),
    PinPlan("Near Knee", "Body", (-0.26, 0.92), "Hips"),
    PinPlan("Near Foot", "Body", (-0.34, 0.12), "Near Knee", radius=0.14),
    PinPlan("Far Knee", "Body", (0.35, 0.92), "Hips"),
    PinPlan("Far Foot", "Body", (0.51, 0.12), "Far Knee", radius=0.14),
    PinPlan("Tail Root", "Tail", (-0.10, 1.62), "Hips", radius=0.10),
    PinPlan("Tail Middle", "Tail", (-1.05, 1.40), "Tail Root"),
    PinPlan("Tail Tip", "Tail", (-1.80, 2.45), "Tail Middle"),
    PinPlan("Far Shoulder", "Lantern Arm", (0.20, 2.36), "Chest"),
    PinPlan("Far Elbow", "Lantern Arm", (0.86, 1.88), "Far Shoulder"),
    PinPlan("Far Hand", "Lantern Arm", (1.26, 1.46), "Far Elbow"),
    PinPlan("Lantern", "Lantern Arm", (1.28, 0.72), "Far Hand", radius=0.22),
    PinPlan("Near Shoulder", "Waving Arm", (-0.22, 2.36), "Chest"),
    PinPlan("Near Elbow", "Waving Arm", (-0.79, 1.86), "Near Shoulder"),
    PinPlan("Near Hand", "Waving Arm", (-1.18, 1.34), "Near Elbow", radius=0.12),
)

POSES = (
    Pose("Wave", {
        "Hips": 3, "Chest": 4, "Head": 9, "Near Knee": -7, "Near Foot": -5, "Far Knee": 6, "Far Foot": 4,
        "Tail Middle": -14, "Tail Tip": 14, "Far Elbow": -8, "Far Hand": -16, "Lantern": 4,
        "Near Elbow": -52, "Near Hand": -128,
    }, step=(0.12, -0.02), stands={"Near Foot": (0.0, 0.0), "Far Foot": (0.0, 0.0)}),
    Pose("Stride", {
        "Hips": -4, "Chest": -8, "Head": 2, "Near Knee": 6, "Near Foot": -46, "Far Knee": 32,
        "Far Foot": -17, "Tail Middle": -14, "Tail Tip": -40, "Far Elbow": 10, "Far Hand": 44, "Lantern": -4,
        "Near Elbow": 42, "Near Hand": 84,
    }, step=(0.42, -0.28), stands={"Near Foot": (0.0, 0.0), "Far Foot": (0.52, 0.0)}),
    Pose("Jump", {
        "Hips": -5, "Chest": -3, "Head": 6, "Near Knee": -48, "Near Foot": -92, "Far Knee": 58,
        "Far Foot": -14, "Tail Middle": -4, "Tail Tip": 14, "Far Elbow": 76, "Far Hand": 106, "Lantern": 30,
        "Near Elbow": -72, "Near Hand": -96,
    }, step=(0.25, 0.90)),
)  # fmt: skip
