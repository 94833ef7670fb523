# SPDX-License-Identifier: GPL-3.0-or-later
"""Table of how drawings are meshed: vertices, angles, lost pixels, rows in thin parts, time and memory."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from figures_conditions import Conditions
from PIL import Image
from scipy import ndimage

import planar_native

PROJECT = Path(__file__).resolve().parents[1]
BPY = PROJECT / ".venv" / "bin" / "python"
WISH = 1500
ROUNDS = 3  # of the timings; the median counts

CUTOUT = f"""\
Cutouts: {WISH} vertices wished, all options as they are by default. Angles are the smallest of triangles.
lost: pixels of alpha > 0.5, and of any art, with a corner outside. thin: of the medial axis, in triangles
without an inner vertex."""

# Our own characters, drawn by the Python that has Blender.
DRAW = """
import importlib, sys
import numpy as np
images = {}
for name in ("fox", "dragon"):
    for layer in importlib.import_module(name).layers():
        left, bottom, right, top = layer.silhouette.bounds
        scale = 900 / max(right - left, top - bottom)
        edge = 8 / scale
        image = layer.paint((left - edge, bottom - edge, right + edge, top + edge), scale)
        images[f"{name} {layer.name}"] = np.asarray(image.getchannel("A"))
np.savez(sys.argv[1], **images)
"""

# What a process of its own needs for it, beyond the image.
MEMORY = """
import resource, time
import numpy as np, planar_native
alpha = np.zeros((4096, 4096), np.float32)
x = np.arange(4096) - 2048
for y, row in enumerate(alpha):
    row[:] = np.hypot(x, y - 2048) < 1500 + 200 * np.sin(12 * np.arctan2(y - 2048, x))
peak = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
before = peak()
start = time.perf_counter()
planar_native.outline(alpha)
print(time.perf_counter() - start, peak() - before)
"""


def drawings(folder: Path) -> dict[str, np.ndarray]:
    """Alpha of 0 to 255, rows from the bottom, by name."""
    found = {}
    for path in [*sorted((folder / "images").glob("*.png")), *sorted(folder.glob("*.png"))]:
        found[path.stem] = np.asarray(Image.open(path).convert("RGBA").getchannel("A"))
    with tempfile.TemporaryDirectory() as temporary:
        target = Path(temporary) / "own.npz"
        paths = f"{PROJECT / 'examples'}:{PROJECT / 'addon'}"
        command = ["env", f"PYTHONPATH={paths}", "PYTHONDONTWRITEBYTECODE=1", BPY, "-c", DRAW, target]
        done = subprocess.run(command, capture_output=True, text=True, check=False) if BPY.exists() else None
        if done is not None and done.returncode == 0:
            with np.load(target) as images:
                found |= {name: images[name] for name in images.files}
        else:
            print("Without our own characters: no .venv that can draw them (make demo makes it).")
    return {name: np.flipud(alpha) for name, alpha in found.items()}


def covered(rings: list[np.ndarray], shape: tuple[int, int], dx: float, dy: float) -> np.ndarray:
    """Whether an odd number of rings goes round (x + dx, y + dy), for each pixel."""
    height, width = shape
    crossings = np.zeros((height, width + 1), np.int32)
    for ring in rings:
        a, b = ring, np.roll(ring, -1, axis=0)
        low = np.where((a[:, 1] < b[:, 1])[:, None], a, b)
        high = np.where((a[:, 1] < b[:, 1])[:, None], b, a)
        first = np.clip(np.ceil(low[:, 1] - dy).astype(int), 0, height)
        last = np.clip(np.ceil(high[:, 1] - dy).astype(int), 0, height)
        count = last - first
        side = np.repeat(np.arange(len(a)), count)
        y = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + first[side]
        along = (y + dy - low[side, 1]) / (high[side, 1] - low[side, 1])
        x = low[side, 0] + along * (high[side, 0] - low[side, 0])
        np.add.at(crossings, (y, np.clip(np.ceil(x - dx).astype(int), 0, width)), 1)
    return (np.cumsum(crossings, axis=1) % 2)[:, :width].astype(bool)


def smallest_angles(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    corner = points[triangles]
    a, b = np.roll(corner, -1, axis=1) - corner, np.roll(corner, -2, axis=1) - corner
    cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return np.degrees(np.arctan2(cross, (a * b).sum(axis=2))).min(axis=1)


def thin_share(cutout: planar_native.Cutout) -> float:
    """Percent of the medial axis that lies in triangles all of whose vertices are on the boundary.

    The axis: pixels whose nearest places outside, and those of a neighbour, are far apart.
    """
    sample = cutout.outline.sample
    origin = cutout.points.min(axis=0) - 3 * sample
    points = (cutout.points - origin) / sample
    width, height = np.ceil(points.max(axis=0)).astype(int) + 3
    inside = covered([points[ring] for ring in cutout.rings], (height, width), 0.5, 0.5)
    distance, (fy, fx) = ndimage.distance_transform_edt(inside, return_indices=True)
    axis = np.zeros_like(inside)
    for a, b in (
        ((slice(None), slice(None, -1)), (slice(None), slice(1, None))),
        ((slice(None, -1), slice(None)), (slice(1, None), slice(None))),
    ):
        gap = np.hypot(fy[a] - fy[b], fx[a] - fx[b])
        far = (gap > 1.5 * np.maximum(distance[a], distance[b])) & (gap > 2.5)
        axis[a] |= inside[a] & inside[b] & far
    flat = np.zeros_like(inside)
    boundary = sum(len(ring) for ring in cutout.rings)
    for triangle in cutout.triangles[(cutout.triangles < boundary).all(axis=1)]:
        p = points[triangle] - 0.5
        (x0, y0), (x1, y1) = np.floor(p.min(axis=0)).astype(int), np.ceil(p.max(axis=0)).astype(int) + 1
        y, x = np.mgrid[y0:y1, x0:x1]
        hit = np.ones(x.shape, bool)
        for (ax, ay), (bx, by) in zip(p, np.roll(p, -1, axis=0), strict=True):
            hit &= (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0
        flat[y0:y1, x0:x1] |= hit
    return 100 * float((flat & axis).sum()) / max(1, int(axis.sum()))


def cutout_table(folder: Path) -> bool:
    print(CUTOUT)
    conditions = Conditions()
    head = f"{'':18}{'pixels':>11}{'vertices':>9}{'worst':>7}{'mean':>6}{'lost':>5}{'any':>5}"
    print(f"{head}{'thin %':>7}{'ms':>6}")
    for name, alpha in drawings(folder).items():
        seconds = []
        for _round in range(ROUNDS):
            start = time.perf_counter()
            cutout = planar_native.cutout(alpha, vertices=WISH)
            seconds.append(time.perf_counter() - start)
        angles = smallest_angles(cutout.points, cutout.triangles)
        rings = [cutout.points[ring] for ring in cutout.rings]
        whole = np.logical_and.reduce(
            [covered(rings, alpha.shape, x, y) for x in (0.001, 0.5, 0.999) for y in (0.001, 0.5, 0.999)]
        )
        lost, faint = int((~whole & (alpha > 127)).sum()), int((~whole & (alpha > 0.05 * 255)).sum())
        thin = thin_share(cutout)
        size = f"{alpha.shape[1]}x{alpha.shape[0]}"
        print(
            f"{name:18}{size:>11}{len(cutout.points):9}{angles.min():7.1f}{angles.mean():6.1f}{lost:5}{faint:5}"
            f"{thin:7.2f}{1e3 * np.median(seconds):6.0f}  {' '.join(cutout.said)}",
            flush=True,
        )
        conditions.check(f"{name}: {lost} lost pixels", lost == 0)
        conditions.check(f"{name}: an angle of {angles.min():.1f}", angles.min() >= 19)
        conditions.check(f"{name}: angles of {angles.mean():.1f} in the mean", angles.mean() >= 47)
        conditions.check(f"{name}: {thin:.2f} % of the axis without an inner vertex", thin <= 0.5)
        near = abs(len(cutout.points) / WISH - 1) <= 0.25
        conditions.check(f"{name}: {len(cutout.points)} vertices, not said", near == cutout.reached)

    y, x = np.ogrid[:1024, :1024]
    flower = np.hypot(x - 512, y - 512) < 375 + 50 * np.sin(12 * np.arctan2(y - 512, x - 512))
    seconds = []
    for _round in range(ROUNDS):
        start = time.perf_counter()
        count = len(planar_native.cutout(flower, vertices=3000).points)
        seconds.append(time.perf_counter() - start)
    print(f"1024x1024, {count} vertices: {np.median(seconds):.2f} s")
    conditions.check("3000 vertices from 1024x1024 take more than 0.3 s", np.median(seconds) <= 0.3)
    done = subprocess.run([sys.executable, "-c", MEMORY], capture_output=True, text=True, check=True)
    took, memory = map(float, done.stdout.split())
    print(f"4096x4096, outline: {took:.2f} s, {memory:.0f} MB beyond the image")
    conditions.check("an outline of 4096x4096 takes more than 1 s", took <= 1)
    conditions.check("an outline of 4096x4096 takes more than 500 MB", memory <= 500)
    return conditions.conclude()
