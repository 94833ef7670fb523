# SPDX-License-Identifier: GPL-3.0-or-later
"""The lamplighter, a mouse seen from the side: seven layers that hang together, and its lantern."""

from __future__ import annotations

from shapely.geometry import box
from shapely.ops import unary_union

from drawing import Colour, Layer, blob, ellipse, limb, tint
from puppet import PinPlan

FUR: Colour = (176, 160, 160)
PINK: Colour = (240, 158, 152)
COAT: Colour = (196, 74, 66)
TROUSERS: Colour = (74, 84, 124)
BOOT: Colour = (122, 78, 56)
SCARF: Colour = (120, 172, 120)
CREAM: Colour = (255, 242, 218)
CAP: Colour = (62, 98, 160)
BRASS: Colour = (206, 150, 64)
GLOW: Colour = (255, 226, 120)

HAND = (1.06, 1.70)  # of the far arm
HANDLE = (1.06, 1.76)  # what the lantern hangs by
FAR = 0.13  # how far the far leg stands before the near one


def layers() -> list[Layer]:
    """The mouse from back to front, standing on z = 0 and looking to the right, four units tall."""
    return [
        _tail(),
        _far_arm(),
        _leg("Far Leg", 0.12, FAR),
        _leg("Near Leg", 0.06, 0.0),
        _body(),
        _head(),
        _near_arm(),
    ]


def lantern() -> Layer:
    """The lantern as it hangs from the far hand, behind it."""
    layer = Layer("Lantern", depth=0.21)
    x, z = HAND
    ring = ellipse(x, z - 0.10, 0.19, 0.21).difference(ellipse(x, z - 0.10, 0.135, 0.155))
    layer.fill(ring, BRASS, shade=0.03)
    glass = blob([
        (x - 0.15, z - 0.42), (x + 0.15, z - 0.42), (x + 0.21, z - 0.60), (x + 0.15, z - 0.78),
        (x - 0.15, z - 0.78), (x - 0.21, z - 0.60),
    ])  # fmt: skip
    layer.fill(glass, GLOW, shade=0.04)
    flame = blob([(x, z - 0.46, "corner"), (x + 0.075, z - 0.63), (x, z - 0.73), (x - 0.075, z - 0.63)])
    layer.gradient(flame.buffer(0.05), (255, 252, 230), inside=glass, blur=0.05)
    layer.fill(flame, (246, 140, 40), shade=0, outline=False)
    heart = blob([(x, z - 0.56, "corner"), (x + 0.04, z - 0.65), (x, z - 0.71), (x - 0.04, z - 0.65)])
    layer.fill(heart, (255, 238, 150), shade=0, outline=False)
    for dx in (-0.10, 0.10):
        layer.stroke(
            [(x + dx, z - 0.43), (x + 1.3 * dx, z - 0.60), (x + dx, z - 0.77)], 0.028, tint(BRASS, -0.5)
        )
    cap = blob([
        (x - 0.07, z - 0.30, "corner"), (x + 0.07, z - 0.30, "corner"), (x + 0.22, z - 0.44, "corner"),
        (x - 0.22, z - 0.44, "corner"),
    ])  # fmt: skip
    layer.fill(cap, BRASS, shade=0.035)
    layer.fill(box(x - 0.19, z - 0.86, x + 0.19, z - 0.76), BRASS, shade=0.035)
    return layer


def _tail() -> Layer:
    layer = Layer("Tail", depth=0.24)
    points = [(-0.02, 1.34), (-0.46, 1.02), (-0.98, 0.88), (-1.38, 1.10), (-1.52, 1.50), (-1.36, 1.80)]
    layer.fill(limb(points, (0.095, 0.085, 0.07, 0.058, 0.046, 0.034)), PINK, shade=0.035)
    for x, z in ((-0.62, 0.95), (-0.80, 0.905), (-0.98, 0.895), (-1.16, 0.965)):
        layer.stroke([(x + 0.01, z - 0.05), (x - 0.01, z), (x - 0.005, z + 0.05)], 0.018, tint(PINK, -0.35))
    return layer


def _leg(name: str, depth: float, x: float) -> Layer:
    layer = Layer(name, depth)
    near = x == 0.0
    cloth, leather = (TROUSERS, BOOT) if near else (tint(TROUSERS, -0.28), tint(BOOT, -0.28))
    leg = limb([(x - 0.02, 1.30), (x + 0.04, 0.78), (x, 0.30)], (0.205, 0.155, 0.125))
    boot = blob([
        (x - 0.14, 0.40), (x - 0.155, 0.20), (x - 0.18, 0.03, "corner"), (x - 0.10, 0.0), (x + 0.20, 0.0),
        (x + 0.42, 0.015), (x + 0.455, 0.10), (x + 0.38, 0.20), (x + 0.20, 0.25), (x + 0.145, 0.40),
    ])  # fmt: skip
    layer.fill(leg, cloth, shade=0.06)
    layer.stroke([(x + 0.10, 0.86), (x + 0.03, 0.82), (x - 0.03, 0.84)], 0.022, tint(cloth, -0.4))
    layer.fill(boot, leather, shade=0.05)
    sole = blob([(x - 0.19, 0.06), (x - 0.185, -0.02), (x + 0.5, -0.02), (x + 0.48, 0.05), (x + 0.1, 0.045)])
    layer.fill(sole, tint(leather, -0.55), shade=0, outline=False, inside=boot)
    layer.fill(limb([(x - 0.125, 0.40), (x + 0.13, 0.40)], (0.065, 0.065)), tint(leather, 0.22), shade=0.03)
    for dz in (0.0, 0.07):
        layer.stroke([(x + 0.10, 0.30 - dz), (x + 0.16, 0.285 - dz), (x + 0.20, 0.30 - dz)], 0.022, CREAM)
    return layer


def _body() -> Layer:
    layer = Layer("Body", depth=0.0)
    _scarf_end(layer)
    coat = blob([
        (-0.16, 2.22), (-0.31, 2.02), (-0.40, 1.66), (-0.48, 1.36), (-0.52, 1.14, "corner"), (-0.27, 1.09),
        (0.05, 1.08), (0.36, 1.10), (0.58, 1.16, "corner"), (0.56, 1.36), (0.52, 1.62), (0.43, 1.96),
        (0.26, 2.22),
    ])  # fmt: skip
    layer.fill(coat, COAT, shade=0.085)
    hem = blob([(-0.7, 1.22), (0.0, 1.155), (0.7, 1.23), (0.7, 0.9), (-0.7, 0.9)])
    layer.fill(hem, tint(COAT, -0.26), shade=0, outline=False, inside=coat)
    layer.stroke([(0.36, 2.08), (0.385, 1.60), (0.41, 1.12)], 0.026, tint(COAT, -0.55))
    for z in (1.86, 1.62, 1.38):
        layer.fill(ellipse(0.455, z, 0.042, 0.048), BRASS, shade=0.015)
    pocket = blob([(0.03, 1.44, "corner"), (0.31, 1.47, "corner"), (0.29, 1.29), (0.06, 1.26)])
    layer.fill(pocket, tint(COAT, -0.14), shade=0.025)
    layer.stroke([(0.03, 1.395), (0.17, 1.40), (0.31, 1.425)], 0.02, tint(COAT, -0.55))
    layer.gradient(ellipse(0.05, 2.12, 0.46, 0.16), tint(COAT, -0.65), inside=coat, blur=0.05, opacity=0.7)
    wrap = blob([(-0.30, 2.26), (-0.33, 2.10), (-0.14, 2.00), (0.10, 1.99), (0.34, 2.05), (0.44, 2.18),
                 (0.38, 2.34), (0.04, 2.44)])  # fmt: skip
    layer.fill(wrap, SCARF, shade=0.06)
    for x in (-0.20, 0.04, 0.27):
        stripe = blob([(x - 0.05, 2.5), (x + 0.05, 2.5), (x + 0.06, 2.1), (x + 0.04, 1.9), (x - 0.05, 1.9),
                       (x - 0.03, 2.1)])  # fmt: skip
        layer.fill(stripe, CREAM, shade=0, outline=False, inside=wrap)
    layer.gradient(ellipse(0.05, 2.40, 0.45, 0.14), tint(SCARF, -0.6), inside=wrap, blur=0.04, opacity=0.6)
    return layer


def _scarf_end(layer: Layer) -> None:
    end = blob([
        (-0.12, 2.26), (-0.44, 2.20), (-0.80, 2.03), (-1.14, 1.98, "corner"), (-1.09, 1.72, "corner"),
        (-0.78, 1.76), (-0.46, 1.90), (-0.16, 2.02),
    ])  # fmt: skip
    layer.fill(end, SCARF, shade=0.05)
    for x in (-0.50, -0.74, -0.98):
        stripe = blob([(x - 0.07, 2.4), (x + 0.04, 2.4), (x + 0.10, 1.9), (x + 0.08, 1.5), (x - 0.02, 1.5),
                       (x - 0.03, 1.9)])  # fmt: skip
        layer.fill(stripe, CREAM, shade=0, outline=False, inside=end)
    for i in range(4):
        z = 1.77 + 0.055 * i
        layer.stroke([(-1.11, z), (-1.07, z + 0.004), (-1.03, z + 0.01)], 0.018)


def _head() -> Layer:
    layer = Layer("Head", depth=-0.06)
    far_ear = ellipse(0.47, 3.00, 0.21, 0.25, -12)
    layer.fill(far_ear, tint(FUR, -0.22), shade=0.03)
    face = blob([
        (-0.34, 2.52), (-0.40, 2.74), (-0.28, 3.00), (0.02, 3.14), (0.34, 3.08), (0.56, 2.88), (0.78, 2.68),
        (1.00, 2.54), (1.02, 2.42), (0.86, 2.34), (0.56, 2.26), (0.22, 2.20), (-0.12, 2.28),
    ])  # fmt: skip
    layer.fill(face, FUR, shade=0.075)
    muzzle = blob([(0.34, 2.10), (0.36, 2.40), (0.56, 2.52), (0.80, 2.54), (1.1, 2.52), (1.1, 2.1)])
    layer.fill(muzzle, CREAM, shade=0.05, outline=False, inside=face)
    layer.gradient(ellipse(0.32, 2.46, 0.13, 0.085), (255, 140, 116), inside=face, blur=0.04, opacity=0.8)
    _eye(layer)
    layer.fill(ellipse(1.00, 2.50, 0.085, 0.075, -20), (216, 92, 104), shade=0.025)
    layer.fill(ellipse(0.985, 2.525, 0.025, 0.016), (255, 220, 220), shade=0, outline=False)
    layer.stroke([(0.93, 2.38), (0.80, 2.33), (0.62, 2.345), (0.54, 2.40)], 0.032)
    for start, end in (
        ((0.72, 2.44), (0.50, 2.20)),
        ((0.76, 2.43), (0.66, 2.14)),
        ((0.70, 2.47), (0.38, 2.31)),
    ):
        middle = (0.5 * (start[0] + end[0]) + 0.02, 0.5 * (start[1] + end[1]) - 0.03)
        layer.stroke([start, middle, end], 0.016, tint(FUR, -0.6))
    _cap(layer)
    near_ear = ellipse(-0.16, 2.84, 0.31, 0.335, 14)
    layer.fill(near_ear, FUR, shade=0.05)
    layer.fill(ellipse(-0.145, 2.825, 0.215, 0.24, 14), PINK, shade=0.045, outline=False)
    return layer


def _eye(layer: Layer) -> None:
    eye = ellipse(0.52, 2.68, 0.115, 0.155, 6)
    layer.fill(eye, (255, 252, 246), shade=0)
    iris = ellipse(0.555, 2.67, 0.08, 0.118)
    layer.fill(iris, (74, 46, 36), shade=0, outline=False, inside=eye)
    layer.gradient(ellipse(0.56, 2.60, 0.06, 0.05), (188, 120, 60), inside=iris.intersection(eye), blur=0.02)
    layer.fill(ellipse(0.565, 2.675, 0.046, 0.074), (26, 14, 20), shade=0, outline=False)
    layer.fill(ellipse(0.525, 2.735, 0.032, 0.040), (255, 255, 255), shade=0, outline=False)
    layer.stroke([(0.40, 2.74), (0.45, 2.82), (0.54, 2.835), (0.62, 2.78)], 0.046)
    layer.stroke([(0.44, 2.91), (0.54, 2.95), (0.64, 2.90)], 0.045, tint(FUR, -0.6))


def _cap(layer: Layer) -> None:
    cone = blob([
        (0.58, 3.03, "corner"), (0.54, 3.24), (0.36, 3.52), (0.06, 3.72), (-0.34, 3.74), (-0.72, 3.54),
        (-0.98, 3.20), (-1.07, 2.92, "corner"), (-0.95, 2.90, "corner"), (-0.80, 3.12), (-0.58, 3.30),
        (-0.36, 3.34), (-0.28, 3.20), (-0.26, 3.06, "corner"),
    ])  # fmt: skip
    layer.fill(cone, CAP, shade=0.075)
    for x, z in (
        (0.30, 3.34),
        (0.02, 3.42),
        (-0.32, 3.54),
        (-0.66, 3.40),
        (-0.06, 3.20),
        (0.38, 3.16),
        (0.14, 3.60),
    ):
        layer.fill(ellipse(x, z, 0.042, 0.042), tint(CAP, 0.55), shade=0, outline=False, inside=cone)
    layer.stroke([(-0.30, 3.33), (-0.20, 3.44), (-0.08, 3.50)], 0.026, tint(CAP, -0.5))
    layer.fill(ellipse(-1.02, 2.86, 0.135, 0.135), CREAM, shade=0.045)
    for x, z in ((-1.06, 2.90), (-0.99, 2.83), (-1.04, 2.80)):
        layer.stroke([(x - 0.025, z), (x, z + 0.012), (x + 0.02, z - 0.01)], 0.016, tint(CREAM, -0.35))
    brim = limb([(0.60, 2.99), (0.36, 3.11), (0.06, 3.16), (-0.26, 3.08)], (0.085, 0.095, 0.095, 0.085))
    layer.fill(brim, CREAM, shade=0.045)
    for x, z in ((0.48, 3.06), (0.28, 3.15), (0.06, 3.18), (-0.14, 3.15)):
        layer.stroke([(x - 0.02, z + 0.06), (x, z), (x - 0.01, z - 0.06)], 0.018, tint(CREAM, -0.35))


def _far_arm() -> Layer:
    layer = Layer("Far Arm", depth=0.18)
    x, z = HAND
    sleeve = limb([(0.16, 1.98), (0.36, 1.72), (0.58, 1.58), (0.84, 1.62)], (0.15, 0.145, 0.13, 0.125))
    layer.fill(limb([(0.80, 1.60), (x, z)], (0.075, 0.075)), FUR, shade=0.03)
    layer.fill(ellipse(x, z, 0.125, 0.115, 15), FUR, shade=0.04)
    for dx, dz in ((-0.06, -0.07), (0.01, -0.09), (0.075, -0.065)):
        layer.fill(ellipse(x + dx, z + dz, 0.046, 0.058), tint(FUR, 0.15), shade=0.02)
    layer.fill(sleeve, tint(COAT, -0.22), shade=0.05)
    layer.fill(limb([(0.835, 1.74), (0.865, 1.50)], (0.06, 0.06)), tint(COAT, -0.42), shade=0.025)
    layer.gradient(ellipse(0.16, 2.0, 0.30, 0.34), tint(COAT, -0.7), inside=sleeve, blur=0.08, opacity=0.6)
    return layer


def _near_arm() -> Layer:
    layer = Layer("Near Arm", depth=-0.12)
    sleeve = limb([(0.00, 1.96), (-0.11, 1.70), (-0.13, 1.46), (-0.05, 1.24)], (0.165, 0.155, 0.14, 0.13))
    x, z = 0.02, 1.02
    fingers = [
        limb([(x, z), tip], (0.05, 0.042))
        for tip in ((x - 0.03, z - 0.15), (x + 0.05, z - 0.155), (x + 0.12, z - 0.12))
    ]
    thumb = limb([(x + 0.03, z + 0.05), (x + 0.14, z + 0.0)], (0.045, 0.04))
    paw = unary_union(
        [limb([(-0.05, 1.22), (x, z)], (0.075, 0.075)), ellipse(x, z, 0.10, 0.115, -15), thumb, *fingers]
    )
    layer.fill(paw, FUR, shade=0.04)
    layer.fill(sleeve, COAT, shade=0.06)
    layer.fill(limb([(-0.175, 1.215), (0.085, 1.27)], (0.06, 0.06)), tint(COAT, -0.3), shade=0.025)
    layer.gradient(sleeve.intersection(box(-0.3, 1.42, 0.3, 1.52)), tint(COAT, -0.2),
                   inside=sleeve, blur=0.05, opacity=0.5)  # fmt: skip
    return layer


PINS = (
    PinPlan("Hips", "Body", (0.04, 1.36), radius=0.15),
    PinPlan("Chest", "Body", (0.06, 2.06), "Hips", radius=0.12),
    PinPlan("Scarf Tip", "Body", (-1.06, 1.86), "Chest"),
    PinPlan("Head", "Head", (0.26, 2.60), "Chest", radius=0.30),
    PinPlan("Cap Tip", "Head", (-1.02, 2.86), "Head"),
    PinPlan("Far Knee", "Far Leg", (FAR + 0.04, 0.78), "Hips"),
    PinPlan("Far Heel", "Far Leg", (FAR - 0.12, 0.07), "Far Knee"),
    PinPlan("Far Toe", "Far Leg", (FAR + 0.35, 0.07), "Far Heel"),
    PinPlan("Near Knee", "Near Leg", (0.04, 0.78), "Hips"),
    PinPlan("Near Heel", "Near Leg", (-0.12, 0.07), "Near Knee"),
    PinPlan("Near Toe", "Near Leg", (0.35, 0.07), "Near Heel"),
    PinPlan("Far Elbow", "Far Arm", (0.50, 1.60), "Chest"),
    PinPlan("Far Hand", "Far Arm", HAND, "Far Elbow", radius=0.10),
    PinPlan("Near Elbow", "Near Arm", (-0.13, 1.52), "Chest"),
    PinPlan("Near Hand", "Near Arm", (0.02, 1.04), "Near Elbow", radius=0.09),
    PinPlan("Tail Middle", "Tail", (-0.98, 0.88), "Hips"),
    PinPlan("Tail Tip", "Tail", (-1.38, 1.76), "Tail Middle"),
)
