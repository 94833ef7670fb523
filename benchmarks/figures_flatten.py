# SPDX-License-Identifier: GPL-3.0-or-later
"""Table of how surfaces are laid flat: two steps, "hold", libigl's ARAP and SLIM, Blender's own unwrap."""

from __future__ import annotations

import dataclasses
import json
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import igl
import numpy as np
from figures_conditions import Conditions
from figures_data import Shape

import planar_native

PROJECT = Path(__file__).resolve().parents[1]
BPY = PROJECT / ".venv" / "bin" / "python"
UNWRAPPING = "4.5.15"  # the oldest bpy with the unwrap of minimum stretch
ITERATIONS = 50  # of libigl's
ROUNDS = 3  # of the timings; the median counts

FLATTENING = f"""\
Flattening: area / angle distortion (2 is none), flips as float32, ms (median of {ROUNDS} rounds that take
turns). libigl's ARAP and SLIM: {ITERATIONS} iterations from its harmonic map, whose time counts. SLIM's
energy is hold's. Blender's unwrap: that of {UNWRAPPING}, scaled to the surface's area, timed afterwards."""
UNWRAPS = {"ANGLE_BASED": "Blender, angle based", "MINIMUM_STRETCH": "Blender, minimum stretch"}

# Half of Blender's monkey without its eye: the part right of the middle, subdivided and smoothed.
MONKEY = """
import bpy, bmesh, json
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_monkey_add()
monkey = bpy.context.object
monkey.modifiers.new("", "SUBSURF").levels = 1
mesh = bmesh.new()
mesh.from_object(monkey, bpy.context.evaluated_depsgraph_get())
bmesh.ops.triangulate(mesh, faces=mesh.faces)
print("MONKEY" + json.dumps([[list(v.co) for v in mesh.verts],
    [[v.index for v in f.verts] for f in mesh.faces if min(v.co.x for v in f.verts) >= -1e-6]]))
"""


@dataclasses.dataclass(frozen=True)
class Surface:
    name: str
    vertices: np.ndarray
    triangles: np.ndarray


def cap(degrees: float, rings: int) -> Surface:
    """The unit sphere within so many degrees of a pole, in rings of six more vertices each."""
    polar = np.concatenate([np.full(max(1, 6 * ring), ring) for ring in range(rings + 1)])
    polar = polar * np.radians(degrees) / rings
    turn = np.concatenate([[0.0]] + [np.arange(6 * r) * 2 * np.pi / (6 * r) for r in range(1, rings + 1)])
    vertices = np.column_stack([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)])
    triangles = []
    for ring in range(1, rings + 1):
        outer, inner = 1 + 3 * ring * (ring - 1), 1 + 3 * (ring - 1) * (ring - 2) if ring > 1 else 0
        around = max(1, 6 * (ring - 1))
        for sector in range(6):
            for step in range(ring):
                i, below = sector * ring + step, inner + (sector * (ring - 1) + step) % around
                triangles.append((below, outer + i, outer + (i + 1) % (6 * ring)))
                if step + 1 < ring:
                    triangles.append(
                        (below, outer + i + 1, inner + (sector * (ring - 1) + step + 1) % around)
                    )
    return Surface(f"cap {degrees:g} deg", vertices, np.array(triangles))


def rugged(seed: int, size: int = 40) -> Surface:
    random = np.random.default_rng(seed)
    u, v = np.meshgrid(np.linspace(0, 1, size), np.linspace(0, 1, size))
    height = sum(
        random.normal() * np.sin(k * random.normal() * 4 * u + k * random.normal() * 4 * v) / k
        for k in (1, 2, 3)
    )
    corner = (np.arange(size - 1) + size * np.arange(size - 1)[:, None]).ravel()
    triangles = np.concatenate(
        [
            np.column_stack([corner, corner + 1, corner + size + 1]),
            np.column_stack([corner, corner + size + 1, corner + size]),
        ]
    )
    noise = random.uniform(-0.01, 0.01, u.size)
    return Surface(
        f"rugged {seed}", np.column_stack([u.ravel(), v.ravel(), 0.3 * height.ravel() + noise]), triangles
    )


def largest_part(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    label = np.arange(len(vertices))
    while True:
        before = label.copy()
        np.minimum.at(label, triangles.ravel(), np.repeat(label[triangles].min(axis=1), 3))
        if np.array_equal(label, before):
            break
    of = label[triangles[:, 0]]
    triangles = triangles[of == np.bincount(of).argmax()]
    used, triangles = np.unique(triangles, return_inverse=True)
    return vertices[used], triangles.reshape(-1, 3)


def half_monkey() -> list[Surface]:
    if not BPY.exists():
        return []
    done = subprocess.run([BPY, "-c", MONKEY], capture_output=True, text=True, check=False)
    found = [line for line in done.stdout.splitlines() if line.startswith("MONKEY")]
    if not found:
        return []
    vertices, triangles = json.loads(found[0].removeprefix("MONKEY"))
    return [Surface("half Suzanne", *largest_part(np.array(vertices), np.array(triangles)))]


def distortion(surface: Surface, flat: np.ndarray) -> tuple[float, float, int]:
    rest, now = surface.vertices[surface.triangles], flat[surface.triangles]
    u, v = rest[:, 1] - rest[:, 0], rest[:, 2] - rest[:, 0]
    length = np.linalg.norm(u, axis=1)
    zero = np.zeros_like(length)
    height = np.linalg.norm(np.cross(u, v), axis=1) / length
    edges = np.array([[length, (u * v).sum(axis=1) / length], [zero, height]]).transpose(2, 0, 1)
    jacobian = np.stack([now[:, 1] - now[:, 0], now[:, 2] - now[:, 0]], axis=2) @ np.linalg.inv(edges)
    det, weight = np.linalg.det(jacobian), length * height
    area, angle = np.abs(det) + 1 / np.abs(det), (jacobian**2).sum(axis=(1, 2)) / np.abs(det)
    stored = flat.astype(np.float32).astype(float)[surface.triangles]
    sides = np.stack([stored[:, 1] - stored[:, 0], stored[:, 2] - stored[:, 0]], axis=2)
    return (
        float((weight * area).sum() / weight.sum()),
        float((weight * angle).sum() / weight.sum()),
        int((np.linalg.det(sides) <= 0).sum()),
    )


def area_of(points: np.ndarray, triangles: np.ndarray) -> float:
    """Of triangles in space, or in the plane."""
    space = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
    sides = np.diff(space[triangles], axis=1).transpose(1, 0, 2)
    return 0.5 * float(np.linalg.norm(np.cross(*sides), axis=1).sum())


def harmonic(surface: Surface) -> np.ndarray:
    boundary = max(igl.boundary_loop_all(surface.triangles), key=len)
    boundary = np.asarray(boundary, dtype=np.int64)
    circle = igl.map_vertices_to_circle(surface.vertices, boundary)
    radius = np.sqrt(area_of(surface.vertices, surface.triangles) / np.pi)
    return igl.harmonic(surface.vertices, surface.triangles, boundary, circle * radius, 1)


def libigl_arap(surface: Surface) -> np.ndarray:
    start = harmonic(surface)
    data = igl.ARAPData()
    data.max_iter = ITERATIONS
    fixed = np.array([surface.triangles[len(surface.triangles) // 2, 0]], dtype=np.int32)
    igl.arap_precomputation(surface.vertices, surface.triangles, 2, fixed, data)
    return igl.arap_solve(start[fixed], data, start)


def libigl_slim(surface: Surface) -> np.ndarray:
    data = igl.slim_precompute(
        np.asfortranarray(surface.vertices),
        np.asfortranarray(surface.triangles, dtype=np.int32),
        np.asfortranarray(harmonic(surface)),
        igl.MappingEnergyType.SYMMETRIC_DIRICHLET,
        np.zeros(0, dtype=np.int32),
        np.asfortranarray(np.zeros((0, 2))),
        0.0,
    )
    return np.ascontiguousarray(igl.slim_solve(data, ITERATIONS)[:, :2])


METHODS: dict[str, Callable[[Surface], np.ndarray]] = {
    "two steps": lambda s: planar_native.flatten(s.vertices, s.triangles, method="two_step"),
    "hold": lambda s: planar_native.flatten(s.vertices, s.triangles),
    "libigl ARAP": libigl_arap,
    "libigl SLIM": libigl_slim,
}


Found = tuple[float, float, int, float]  # area and angle distortion, flips, ms


def blender_unwraps(surfaces: list[Surface]) -> list[dict[str, Found]]:
    """What Blender's own unwrap makes of each surface; nothing where there is no such Blender."""
    with tempfile.TemporaryDirectory(dir=PROJECT / "build") as folder:  # a Debian room has it, too
        place = Path(folder)
        for number, surface in enumerate(surfaces):
            np.savez(place / f"{number}.npz", vertices=surface.vertices, triangles=surface.triangles)
        inside = str(place.relative_to(PROJECT))
        command = ["tools/with_bpy.sh", UNWRAPPING, "benchmarks/blender_unwrap.py", inside, inside]
        done = subprocess.run(command, cwd=PROJECT, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            print(f"Blender {UNWRAPPING} cannot be had here: {done.stderr.strip().splitlines()[-1:]}")
            return [{} for _ in surfaces]
        seconds = json.loads((place / "seconds.json").read_text())

        def found(surface: Surface, name: str) -> Found:
            flat = np.load(place / f"{name}.npy")
            scale = area_of(surface.vertices, surface.triangles) / area_of(flat, surface.triangles)
            return *distortion(surface, np.sqrt(scale) * flat), 1e3 * seconds[name]

        return [
            {title: found(surface, f"{number}-{method}") for method, title in UNWRAPS.items()}
            for number, surface in enumerate(surfaces)
        ]


def flatten_table(_: list[Shape]) -> bool:
    print(FLATTENING)
    conditions = Conditions()
    surfaces = [cap(60, 41), cap(120, 41), *half_monkey(), *(rugged(seed) for seed in range(3))]
    for surface, unwraps in zip(surfaces, blender_unwraps(surfaces), strict=True):
        flat, seconds = {}, {name: [] for name in METHODS}
        for _round in range(ROUNDS):
            for name, method in METHODS.items():
                start = time.perf_counter()
                flat[name] = method(surface)
                seconds[name].append(time.perf_counter() - start)
        found: dict[str, Found] = {
            name: (*distortion(surface, flat[name]), 1e3 * float(np.median(seconds[name])))
            for name in METHODS
        }
        print(f"{surface.name}, {len(surface.triangles)} triangles")
        for name, (area, angle, flips, ms) in (found | unwraps).items():
            print(f"  {name:25}{area:8.4f} /{angle:8.4f}{flips:5}{ms:8.0f}", flush=True)
        hold, arap, slim = found["hold"], found["libigl ARAP"], found["libigl SLIM"]
        conditions.check(f"{surface.name}: {hold[2]} flips with hold", hold[2] == 0)
        conditions.check(
            f"{surface.name}: hold distorts more than SLIM", sum(hold[:2]) <= 1.0005 * sum(slim[:2])
        )
        conditions.check(f"{surface.name}: hold is slower than ARAP", hold[3] <= arap[3])
    return conditions.conclude()
