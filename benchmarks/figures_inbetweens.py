# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of how good in-betweens are, beside the paper's printed form and a polar blend."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
from figures_conditions import Conditions
from figures_data import Shape, bent_bar, rolled
from figures_posing import dragged
from inbetween_peers import inbetween_times, polar_poisson, printed

import planar_native

FRAMES = (8, 24)  # between two keys
FINE = 10  # samples for one, of the finely sampled solution

OF_THE_ENDS = 1.001  # a worst frame's distortion
OF_THE_PEER = 1.001
OF_THE_FINE_PATH = 1.02
OF_NEIGHBOURS = 1.5  # a jump between two frames
REVERSED = 1e-6  # of the diagonal
RIGID = 1e-9
EXTRA_KEY = 0.02
STANDING = 2e-4  # of the diagonal: how far a pin that stands in both keys may move
AS_SMOOTH = 2.0
TIE = 1e-4  # of area + angle: what is printed

WORST = f"""\
In-betweens of the poses (rest -> 0, 0 -> 1, ...), posed by hold: area and angle (2 is none) of the worse end,
of the worst frame and of the mean frame, and flips as float32 in the worst frame.
midpoint: at most {OF_THE_ENDS} times the worse end, no flips; area + angle at most {OF_THE_PEER} times
polar's unless that flips.
polar: unwrapped polar angle and stretch of each triangle blended, one Poisson solve a frame.
printed: Li et al. 2013, Algorithm 2, (8) to (13) with (8) as corrected."""
MOTION = f"""\
Motion of the same and of all other pairs of poses.
jump: furthest way of a vertex between two frames, by the larger one beside; at most {OF_NEIGHBOURS}.
path: a vertex's way, by its way in {FINE} times as many frames; at most {OF_THE_FINE_PATH}.
reversed: from the same with the keys exchanged, in diagonals; at most {REVERSED:g}.
one more key: from the same with the middle frame as a key, in diagonals; at most {EXTRA_KEY:g}."""
PINS = f"""\
Pins: from rest to each pose, the two of whose handles that move least stand; {FINE * FRAMES[1]} frames.
off: a foot from where it stands, in diagonals, without pins and with them; at most {STANDING:g} with them.
worst: area + angle of the worst frame by that of the worse end; at most {OF_THE_ENDS}. flips: none.
kink: the largest second difference of a vertex by that without pins; at most {AS_SMOOTH:g}."""
RIGID_KEYS = f"""\
Rigid motions: furthest vertex from the exact one, in diagonals, over 24 frames; at most {RIGID:g}."""
ROLLED_BAR = f"""\
A bar rolled up, frames with both keys counted: area / angle and flips of the worst frame. midpoint: at most
{OF_THE_ENDS} times the key's, no flips."""


@dataclasses.dataclass(frozen=True)
class Quality:
    """Distortion of frames from the rest shape: in the worst frame of each measure, and in the mean."""

    area: float
    angle: float
    flipped: int
    mean_area: float
    mean_angle: float
    worst: float  # area + angle of the worst frame

    def __str__(self) -> str:
        return (
            f"{short(self.area)} {short(self.angle)} {self.flipped:3}  "
            f"{short(self.mean_area)} {short(self.mean_angle)}"
        )

    @property
    def mean(self) -> float:
        return self.mean_area + self.mean_angle


def short(value: float) -> str:
    if value < 10:
        return f"{value:6.4f}"
    return f"{value:6.0f}" if value < 1e6 else f"{'> 1e6':>6}"


def quality(shape: Shape, frames: np.ndarray) -> Quality:
    if np.iscomplexobj(frames):
        frames = np.stack([frames.real, frames.imag], axis=2)
    if not np.isfinite(frames).all():
        return Quality(np.inf, np.inf, len(shape.triangles), np.inf, np.inf, np.inf)
    found = [planar_native.distortion(shape.rest, frame, shape.triangles) for frame in frames]
    area, angle = np.array([(each.area, each.angle) for each in found]).T
    return Quality(
        float(area.max()),
        float(angle.max()),
        max(each.flipped for each in found),
        float(area.mean()),
        float(angle.mean()),
        float((area + angle).max()),
    )


def between(shape: Shape, keys: list[np.ndarray], times: np.ndarray, **options: object) -> np.ndarray:
    return planar_native.inbetween(keys, times, triangles=shape.triangles, rest=shape.rest, **options)


def by_peer(peer, first: np.ndarray, last: np.ndarray, shape: Shape, frames: int) -> np.ndarray:
    """Frames of a peer, which are no numbers where it cannot solve."""
    try:
        with np.errstate(all="ignore"):
            return peer(first @ [1, 1j], last @ [1, 1j], shape.triangles, frames)
    except RuntimeError:  # a singular matrix
        return np.full((frames, len(first)), np.nan, dtype=complex)


Transition = tuple[str, Shape, np.ndarray, np.ndarray]


def transitions(shapes: list[Shape]) -> tuple[list[Transition], list[Transition]]:
    """Between consecutive poses, the rest shape before them, and between all other pairs."""
    consecutive, others = [], []
    for shape in shapes:
        if not shape.poses:
            continue
        keys = [("rest", shape.rest)]
        keys += [(str(number), dragged(shape, pose, 1)) for number, pose in enumerate(shape.poses)]
        for (i, (start, first)), (j, (end, last)) in itertools.combinations(enumerate(keys), 2):
            name = f"{shape.name} {start} -> {end}"
            (consecutive if j == i + 1 else others).append((name, shape, first, last))
    return consecutive, others


def check_ends(where: str, own: Quality, ends: Quality, conditions: Conditions) -> None:
    conditions.check(f"{where}: {own.flipped} flips", own.flipped == 0)
    for measure, mine, limit in (("area", own.area, ends.area), ("angle", own.angle, ends.angle)):
        conditions.check(
            f"{where}: {measure} {mine / limit:.4f} times the worse end's", mine <= OF_THE_ENDS * limit
        )


def worst_frames(of: list[Transition], conditions: Conditions) -> None:
    print(WORST)
    group = f"{'worst':^17}  {'mean':^13}"
    print(f"{'':23}{'worse end':^15}  {'midpoint':^32}  {'polar':^32}  {'printed':^32}")
    print(f"{'transition':20}{'':>3}{'':15}  {group}  {group}  {group}")
    wins = {"worst": [0, 0, 0], "mean": [0, 0, 0]}
    polar_flips = 0
    for name, shape, first, last in of:
        ends = quality(shape, np.array([first, last]))
        for frames in FRAMES:
            own = quality(shape, between(shape, [first, last], inbetween_times(frames)))
            peer, paper = (
                quality(shape, by_peer(method, first, last, shape, frames))
                for method in (polar_poisson, printed)
            )
            print(
                f"{name:20}{frames:3} {short(ends.area)} {short(ends.angle)}   {own}  {peer}  {paper}",
                flush=True,
            )
            where = f"{name}, {frames} frames"
            check_ends(where, own, ends, conditions)
            if peer.flipped:
                polar_flips += 1
                continue
            conditions.check(
                f"{where}: {own.worst / peer.worst:.4f} times polar", own.worst <= OF_THE_PEER * peer.worst
            )
            for measure, counts in wins.items():
                less = getattr(peer, measure) - getattr(own, measure)
                counts[0 if less > TIE else 2 if less < -TIE else 1] += 1
    for measure, (won, tied, lost) in wins.items():
        print(
            f"midpoint against polar, area + angle of the {measure} frame: "
            f"{won} lower, {tied} equal to {TIE:g}, {lost} higher, {polar_flips} where polar flips"
        )


def furthest(one: np.ndarray, other: np.ndarray, shape: Shape) -> float:
    return float(np.linalg.norm(one - other, axis=2).max()) / shape.diagonal


def motion(of: list[Transition], conditions: Conditions) -> None:
    print(MOTION)
    print(f"{'transition':24}{'jump':>8}{'path':>8}{'reversed':>10}{'one more key':>14}")
    for name, shape, first, last in of:
        for frames in FRAMES:
            times = np.linspace(0, 1, frames + 2)
            shown = between(shape, [first, last], times)
            ways = np.linalg.norm(np.diff(shown, axis=0), axis=2)
            steps = ways.max(axis=1)
            beside = np.maximum(np.append(0, steps[:-1]), np.append(steps[1:], 0))
            jump = float((steps / beside).max())

            fine = between(shape, [first, last], np.linspace(0, 1, FINE * (frames + 1) + 1))
            path = np.linalg.norm(np.diff(fine, axis=0), axis=2).sum(axis=0)
            moving = path > 1e-9 * shape.diagonal
            longer = float((ways.sum(axis=0)[moving] / path[moving]).max())

            back = furthest(between(shape, [last, first], times)[::-1], shown, shape)
            middle = len(times) // 2
            three = between(shape, [first, shown[middle], last], times, key_times=[0.0, times[middle], 1.0])
            changed = furthest(three, shown, shape)
            print(f"{name:20}{frames:4}{jump:8.3f}{longer:8.4f}{back:10.1e}{changed:14.4f}", flush=True)
            where = f"{name}, {frames} frames"
            conditions.check(f"{where}: a jump {jump:.3f} times those beside it", jump <= OF_NEIGHBOURS)
            conditions.check(f"{where}: a path {longer:.4f} times the fine one", longer <= OF_THE_FINE_PATH)
            conditions.check(f"{where}: {back:.1e} off when reversed", back <= REVERSED)
            conditions.check(f"{where}: {changed:.4f} off with one more key", changed <= EXTRA_KEY)


def standing(shapes: list[Shape], conditions: Conditions) -> None:
    print(PINS)
    print(f"{'pose':14}{'off without':>12}{'with':>10}{'worst':>9}{'flips':>7}{'kink':>7}")
    times = np.linspace(0, 1, FINE * FRAMES[1] + 2)
    for shape in shapes:
        for pose in shape.poses:
            start = shape.rest[pose.handles]
            feet = np.argsort(np.linalg.norm(pose.targets - start, axis=1))[:2]
            targets = pose.targets.copy()
            targets[feet] = start[feet]
            last = dragged(shape, dataclasses.replace(pose, targets=targets), 1)
            keys = [shape.rest, last]
            pins = pose.handles[feet]
            stand = (1 - times)[:, None, None] * shape.rest[pins] + times[:, None, None] * last[pins]
            off, kink = {}, {}
            for name, given in (("without", None), ("with", pins)):
                frames = between(shape, keys, times, pins=given)
                off[name] = float(np.linalg.norm(frames[:, pins] - stand, axis=2).max()) / shape.diagonal
                kink[name] = float(np.linalg.norm(np.diff(frames, 2, axis=0), axis=2).max())
            own, ends = quality(shape, frames), quality(shape, np.array(keys))
            worst, rougher = own.worst / ends.worst, kink["with"] / kink["without"]
            print(
                f"{pose.name:14}{off['without']:12.1e}{off['with']:10.1e}{worst:9.4f}{own.flipped:7}{rougher:7.2f}",
                flush=True,
            )
            conditions.check(f"{pose.name}: a foot is {off['with']:.1e} off", off["with"] <= STANDING)
            conditions.check(f"{pose.name}: {worst:.4f} times the worse end", worst <= OF_THE_ENDS)
            conditions.check(f"{pose.name}: {own.flipped} flips", own.flipped == 0)
            conditions.check(f"{pose.name}: {rougher:.2f} times as rough", rougher <= AS_SMOOTH)


def rigid_keys(shapes: list[Shape], conditions: Conditions) -> None:
    print(RIGID_KEYS)
    print(f"{'shape':12}{'turn':>6}{'straight':>12}{'arc':>12}")
    times = inbetween_times(24)
    for shape, degrees in itertools.product(shapes, (30, 170)):
        turn = np.radians(degrees)
        first = shape.rest @ [1, 1j]
        pivot = first.mean() + shape.diagonal * (1 - 0.5j)
        last = pivot + np.exp(1j * turn) * (first - pivot)
        keys = [shape.rest, np.column_stack([last.real, last.imag])]
        exact = {
            "straight": np.exp(1j * turn * times)[:, None] * (first - first.mean())
            + ((1 - times) * first.mean() + times * last.mean())[:, None],
            "arc": np.exp(1j * turn * times)[:, None] * (first - pivot) + pivot,
        }
        off = {
            path: float(np.abs(between(shape, keys, times, anchor_path=path) @ [1, 1j] - motion).max())
            / shape.diagonal
            for path, motion in exact.items()
        }
        print(f"{shape.name:12}{degrees:6}{off['straight']:12.1e}{off['arc']:12.1e}")
        for path, error in off.items():
            conditions.check(f"{shape.name} turned by {degrees}, {path}: {error:.1e} off", error <= RIGID)


def rolled_bar(conditions: Conditions) -> None:
    print(ROLLED_BAR)
    print(
        f"{'degrees':>7}{'frames':>8}"
        + "".join(f"{name:>21}" for name in ("key", "midpoint", "polar", "printed"))
    )
    bar = bent_bar(60, 4)
    for degrees, frames in itertools.product((90, 400, 720), (4, 24)):
        key = rolled(bar, np.radians(degrees))
        ends = quality(bar, key[None])
        own = quality(bar, between(bar, [bar.rest, key], inbetween_times(frames - 2)))
        peers = [
            quality(bar, by_peer(method, bar.rest, key, bar, frames - 2))
            for method in (polar_poisson, printed)
        ]
        texts = [f"{short(each.area)} / {short(each.angle)} {each.flipped:2}" for each in (ends, own, *peers)]
        print(f"{degrees:7}{frames:8}" + "".join(f"{text:>21}" for text in texts), flush=True)
        check_ends(f"bar rolled by {degrees} degrees in {frames} frames", own, ends, conditions)


def inbetween_table(shapes: list[Shape]) -> bool:
    conditions = Conditions()
    consecutive, others = transitions(shapes)
    if consecutive:
        worst_frames(consecutive, conditions)
        print()
        motion(consecutive + others, conditions)
        print()
        standing(shapes, conditions)
        print()
    rigid_keys(shapes or [bent_bar()], conditions)
    print()
    rolled_bar(conditions)
    return conditions.conclude()
