# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes meshes (.obj) and poses (.json) of the characters into tests/native/data, for characters.h there.

A pose has the vertices that are handles, where they are at rest ("src") and where they go ("dst").

usage: .venv/bin/python examples/draw_characters.py (after make demo; where the drawings change)
"""

import json
import sys
from pathlib import Path

import numpy as np

PROJECT = Path(__file__).resolve().parents[1]
DATA = PROJECT / "tests" / "native" / "data"
sys.path[:0] = [str(PROJECT / "examples"), str(PROJECT / "addon")]

import dragon  # noqa: E402
import fox  # noqa: E402
from even_mesh import silhouette, triangulate  # noqa: E402

DIGITS = 4  # of a drawing some four units tall


def draw(name, layers, pins, poses, spacing):
    points, triangles, first = [], [], {}
    for layer in layers:
        first[layer.name] = sum(map(len, points))
        x, t = triangulate(silhouette(layer), spacing)
        points.append(x.round(DIGITS))
        triangles.append(t + first[layer.name])
    lines = [f"v {x:.{DIGITS}f} {z:.{DIGITS}f} 0" for x, z in np.concatenate(points)]
    lines += ["f {} {} {}".format(*(t + 1)) for t in np.concatenate(triangles)]
    (DATA / f"{name}.obj").write_text("\n".join(lines) + "\n")
    layer_points = dict(zip(first, points, strict=True))
    handles = {pin.name: _handles(pin, layer_points[pin.layer]) for pin in pins}
    rows = [
        {
            "src": np.concatenate([handles[pin.name] for pin in pins]).tolist(),
            "dst": np.concatenate(_posed(pins, handles, pose)).round(DIGITS).tolist(),
        }
        for pose in poses
    ]
    (DATA / f"{name}.json").write_text(json.dumps({"poses": rows}) + "\n")


def _handles(pin, points):
    """The vertex next to a point; for a patch two more, which set its angle."""
    wanted = np.array(pin.at) + np.outer([0.0, -pin.radius, pin.radius][: 3 if pin.radius else 1], [1.0, 0.0])
    return np.array([points[np.hypot(*(points - at).T).argmin()] for at in wanted])


def _posed(pins, handles, pose):
    """Where the handles of each pin go. See puppet.strike, which asks the add-on for the same."""
    rest = {name: points @ [1.0, 1.0j] for name, points in handles.items()}
    moved, turn = {}, {None: 0.0}
    for pin in pins:
        first = rest[pin.name][0]
        turn[pin.name] = np.radians(pose.turns[pin.name]) if pin.name in pose.turns else turn[pin.parent]
        if pin.parent:
            arm = first - rest[pin.parent][0]
            to = moved[pin.parent][0] + np.exp(1j * turn[pin.name]) * arm
        else:
            to = first + complex(*pose.step)
        moved[pin.name] = to + np.exp(1j * turn[pin.name]) * (rest[pin.name] - first)
    for name, offset in pose.stands.items():
        moved[name] = rest[name] + complex(*offset)
    return [np.column_stack([moved[pin.name].real, moved[pin.name].imag]) for pin in pins]


if __name__ == "__main__":
    draw("fox", fox.layers(), fox.PINS, fox.POSES, spacing=0.08)
    # "Coil" turns the tail by 180 degrees: straight ways of its pins do not tell which way round.
    poses = [pose for pose in dragon.POSES if pose.name != "Coil"]
    draw("dragon", dragon.layers(), dragon.PINS, poses, spacing=0.1)
