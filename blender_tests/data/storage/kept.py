# SPDX-License-Identifier: GPL-3.0-or-later
"""Files kept from each version, in files/, and what each showed there: VERSION.blend and VERSION.json.

What is read here is what an animator would miss.
"""

import json
from pathlib import Path

import bpy
import numpy as np
from support import activate, evaluated

FILES = Path(__file__).with_name("files")
FRAMES = (1, 4, 7, 10, 13, 16, 20)
EVERY = 5  # of the vertices of a shape


def ours():
    """The objects with pins or poses, by name."""
    held = [obj for obj in bpy.data.objects if obj.is_property_set("planar")]
    return sorted((obj for obj in held if obj.planar.pins or obj.planar.poses), key=lambda obj: obj.name)


def record():
    """What every object of ours holds and shows, as JSON has it, by name."""
    found = {}
    for obj in ours():
        found[obj.name] = {
            **_settings(obj),
            "pins": _pins(obj),
            "shapes": _shapes(obj),
            "depths": _depths(obj),
        }
    return found


def _settings(obj):
    settings = obj.planar
    return {
        "method": settings.method,
        "stiffness": settings.stiffness_group,
        "path": settings.anchor_path,
        "smooth": settings.smooth,
        "live": settings.live,
        "surface": settings.surface.name if settings.surface else None,
        "poses": [[p.name, p.frame, p.generated, p.turns] for p in settings.poses],
        "stale": _stale(obj),
        "materials": [material.name for material in getattr(obj.data, "materials", ())],
    }


def _stale(obj):
    """Stretches whose in-betweens are said to be out of date."""
    from planar_deform.scene.sequence import stretches

    return [list(stretch) for stretch in stretches.stale(obj)] if obj.planar.poses else []


def _pins(obj):
    return [
        {
            "name": pin.name,
            "kind": pin.kind,
            "enabled": pin.enabled,
            "weight": _short(pin.weight),
            "angle": _short(pin.angle),
            "target": [_short(value) for value in pin.target] if pin.has_target else None,
            "object": pin.object.name if pin.object else None,
            "point": pin.lattice_point,
            "follow": pin.follow.name if pin.follow else None,
            "paths": [
                [path.pose, path.kind, path.ease, path.curve and path.curve.name] for path in pin.paths
            ],
        }
        for pin in obj.planar.pins
    ]


def _shapes(obj):
    """Some points at some frames; of a lattice its own points are not shown, but those of what it bends."""
    if obj.type == "LATTICE":
        shown = [other for other in bpy.data.objects if any(m.object == obj for m in _lattices(other))]
    else:
        shown = [obj]
    activate(obj)
    found = {}
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        points = np.concatenate([evaluated(other)[::EVERY] for other in shown])
        found[str(frame)] = [_short(value) for value in points.ravel()]
    return found


def _depths(obj):
    """Of the pins, in the last frame."""
    return [_short(pin.depth) for pin in obj.planar.pins]


def _lattices(obj):
    return [modifier for modifier in obj.modifiers if modifier.type == "LATTICE"]


def _short(value):
    return round(float(value), 6)


def written(found):
    """The record as a text with a line for each object."""
    lines = [f"{json.dumps(name)}: {json.dumps(value)}" for name, value in found.items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"
