# SPDX-License-Identifier: GPL-3.0-or-later
"""The lamplighter's walk: how far its limbs are turned in each keyed pose, and by that where its pins are.

A step is contact, down, passing and up. A heel stands from its contact until its foot rolls off, a toe until
the other foot has taken the weight. All is planned in the plane of the drawing, (x, z), and turns are
counterclockwise from rest. The limbs are imaginary: they say where pins go, as in puppet.py.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mouse import FAR, PINS

Place = np.ndarray  # (2,)

STEP = 1.0  # its length
NAMES = ("Contact", "Down", "Passing", "Up")
REST = {plan.name: np.array(plan.at) for plan in PINS}


@dataclass(frozen=True)
class Limb:
    """What turns as one about a joint, with the limbs that hang on it: the pins on it."""

    name: str
    parent: str | None
    joint: tuple[float, float]
    pins: tuple[str, ...]


def _leg(side: str, x: float) -> list[Limb]:
    return [
        Limb(f"{side} Thigh", "Hips", (x - 0.02, 1.28), (f"{side} Knee",)),
        Limb(f"{side} Shin", f"{side} Thigh", (x + 0.04, 0.78), ()),
        Limb(f"{side} Boot", f"{side} Shin", (x, 0.34), (f"{side} Heel", f"{side} Toe")),
    ]


LIMBS = (
    Limb("Hips", None, (0.04, 1.36), ("Hips",)),
    Limb("Chest", "Hips", (0.04, 1.36), ("Chest",)),
    Limb("Scarf", "Chest", (-0.20, 2.15), ("Scarf Tip",)),
    Limb("Head", "Chest", (0.16, 2.30), ("Head", "Cap Tip")),
    *_leg("Far", FAR),
    *_leg("Near", 0.0),
    Limb("Far Upper Arm", "Chest", (0.16, 1.97), ("Far Elbow",)),
    Limb("Far Forearm", "Far Upper Arm", (0.50, 1.60), ("Far Hand",)),
    Limb("Near Upper Arm", "Chest", (-0.01, 1.92), ("Near Elbow",)),
    Limb("Near Forearm", "Near Upper Arm", (-0.13, 1.52), ("Near Hand",)),
    Limb("Tail", "Hips", (-0.03, 1.34), ("Tail Middle",)),
    Limb("Tail Tip", "Tail", (-0.98, 0.88), ("Tail Tip",)),
)

# In degrees, by pose of one step, as the lift of the hips; of two steps from the contact of the near foot.
LIFT = (-0.085, -0.14, -0.03, 0.015)
HIPS, CHEST, HEAD, SCARF = (-2, -3, -1, -1), (-5, -7, -4, -3), (2, -2, -3, 1), (6, -9, -10, 6)
NEAR_UPPER_ARM, NEAR_FOREARM = (-34, -40, -14, 14, 28, 28, 8, -18), (-30, -34, -4, 36, 62, 60, 26, -8)
FAR_UPPER_ARM, FAR_FOREARM = (-2, -7, -6, -1, 3, -4, -5, -2), (1, -9, -9, 3, 8, -6, -8, 0)
LANTERN = (-7, -10, -2, 8, 9, 2, -7, -10)
TAIL, TAIL_TIP = (4, -5, -8, 0, 6, -3, -8, 0), (-6, -6, 6, 14, 6, -8, -6, 12)
# Of one boot in two steps from its contact: its turn, and about what; in the air where its ankle is beside
# the hips, and how far it is lifted.
BOOT: tuple[tuple[float, str | tuple[float, float]], ...] = (
    (16, "Heel"), (0, "Heel"), (0, "Heel"), (-11, "Toe"),
    (-30, "Toe"), (-46, "Toe"), (-32, (-0.08, 0.28)), (5, (0.30, 0.15)),
)  # fmt: skip


@dataclass(frozen=True)
class Moment:
    """A pose of the walk: how far the drawing has gone from rest, and by how many radians what is turned."""

    name: str
    shift: Place
    turns: Mapping[str, float]


def moments(steps: int) -> list[Moment]:
    """The poses of so many steps to the right, from contact to contact, the near foot's first."""
    return [_moment(number) for number in range(len(NAMES) * steps + 1)]


def joints(moment: Moment) -> dict[str, Place]:
    """Where each limb's joint is in a pose."""
    found: dict[str, Place] = {}
    for limb in LIMBS:
        if limb.parent is None:
            found[limb.name] = np.array(limb.joint) + moment.shift
        else:
            carrier = next(other for other in LIMBS if other.name == limb.parent)
            way = np.array(limb.joint) - carrier.joint
            found[limb.name] = found[limb.parent] + turned(way, moment.turns[limb.parent])
    return found


def pin_places(moment: Moment) -> dict[str, Place]:
    """Where each pin is in a pose."""
    at = joints(moment)
    return {
        pin: at[limb.name] + turned(REST[pin] - limb.joint, moment.turns[limb.name])
        for limb in LIMBS
        for pin in limb.pins
    }


def turned(way: Place, angle: float) -> Place:
    """A vector turned counterclockwise."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * way[0] - s * way[1], s * way[0] + c * way[1]])


def _moment(number: int) -> Moment:
    beat, stride = number % 4, number % 8
    shift = np.array([STEP * (0.25 * number - 0.5), LIFT[beat]])
    degrees = {
        "Hips": HIPS[beat],
        "Chest": CHEST[beat],
        "Scarf": SCARF[beat],
        "Head": HEAD[beat],
        "Near Upper Arm": NEAR_UPPER_ARM[stride],
        "Near Forearm": NEAR_FOREARM[stride],
        "Far Upper Arm": FAR_UPPER_ARM[stride],
        "Far Forearm": FAR_FOREARM[stride],
        "Lantern": LANTERN[stride],
        "Tail": TAIL[stride],
        "Tail Tip": TAIL_TIP[stride],
    }
    turns = {name: float(np.radians(value)) for name, value in degrees.items()}
    for side, late in (("Near", 0), ("Far", 4)):
        turns |= _stepping(side, number + late, late // 4, shift, turns["Hips"])
    return Moment(f"{NAMES[beat]} {1 + number // 4}", shift, turns)


def _stepping(side: str, number: int, behind: int, shift: Place, hips: float) -> dict[str, float]:
    """The turns of a leg whose boot is where its plan says. Raises ValueError where it does not reach."""
    thigh, shin, boot = (
        next(limb for limb in LIMBS if limb.name == f"{side} {part}") for part in ("Thigh", "Shin", "Boot")
    )
    hip, knee, ankle = (np.array(limb.joint) for limb in (thigh, shin, boot))
    degrees, about = BOOT[number % 8]
    turn = float(np.radians(degrees))
    root = np.array(LIMBS[0].joint)
    joint = root + shift + turned(hip - root, hips)
    if isinstance(about, str):
        pivot = REST[f"{side} {about}"]
        goal = pivot + turned(ankle - pivot, turn) + np.array([STEP * (2 * (number // 8) - behind), 0.0])
    else:
        goal = ankle + np.array([shift[0] + about[0], about[1]])
    upper, lower, way = np.hypot(*(knee - hip)), np.hypot(*(ankle - knee)), goal - joint
    far = np.hypot(*way)
    if far > upper + lower:
        raise ValueError(
            f"the {side.lower()} leg is too short for pose {number}: by {far - upper - lower:.3f}"
        )
    along = (far**2 + upper**2 - lower**2) / (2 * far)
    bent = joint + (along * way + np.sqrt(upper**2 - along**2) * np.array([-way[1], way[0]])) / far
    return {
        thigh.name: _angle(knee - hip, bent - joint),
        shin.name: _angle(ankle - knee, goal - bent),
        boot.name: turn,
    }


def _angle(rest: Place, now: Place) -> float:
    """By which a vector is turned."""
    return float(np.arctan2(rest[0] * now[1] - rest[1] * now[0], rest @ now))
