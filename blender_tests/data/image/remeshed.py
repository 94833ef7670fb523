# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings to remesh, and what of them has to stay."""

import os
import time

import bpy
import numpy as np
from drawings import extremes
from pictures import cutout, letter, save
from support import activate, add_pins, bar

SAME = 1e-6  # of the size: pins stay in place


def remesh(obj=None, **options):
    if obj is not None:
        activate(obj)
    options = {"source": "OUTLINE", **options}
    assert bpy.ops.planar.remesh(**options) == {"FINISHED"}
    bpy.context.view_layer.update()


def held(obj):
    """Where the usable pins are at rest, by name, in the world's lengths."""
    from planar_deform.model.posing.pins import Holder
    from planar_deform.scene.objects.cutout_object import begin
    from planar_deform.scene.pins import pin_list

    activate(obj)
    drawing = begin(bpy.context)
    pins = pin_list.model_pins(obj, drawing)
    names = [obj.planar.pins[pin.key].name for pin in pins]
    places = [Holder(pin, drawing.cutout).place(drawing.cutout.rest) for pin in pins]
    return dict(zip(names, np.array(places), strict=True))


def assert_in_place(obj, before, within=SAME, patches=0.05):
    """Pins are where they were, to a share of the size; the middle of a patch nearly."""
    from planar_deform.scene.objects.cutout_object import begin

    now, size = held(obj), begin(bpy.context).diagonal
    assert list(now) == list(before)
    for pin in obj.planar.pins:
        gap = np.abs(now[pin.name] - before[pin.name]).max()
        assert gap < size * (within if pin.kind == "POINT" else patches), pin.name


def area(obj):
    return sum(face.area for face in obj.data.polygons)


def coarse_bar(**options):
    """A bar of 12 x 4 quads, with pins at its ends, in a face and on the rim, and a patch in the middle."""
    obj = bar(**options)
    add_pins(obj, [0], [12, 25, 38], [26, 27, 40], [58])
    add_pins(obj, [30, 31, 32, 43, 44, 45], kind="PATCH")
    for pin in obj.planar.pins:
        pin.select = pin.name == "Pin.001"
    return obj


def group(obj, name, weight):
    """A vertex group whose weights are a function of the place."""
    made = obj.vertex_groups.new(name=name)
    for vertex in obj.data.vertices:
        made.add([vertex.index], weight(vertex.co), "REPLACE")
    return made


def weights(obj, name):
    index = obj.vertex_groups[name].index
    return [next((g.weight for g in v.groups if g.group == index), None) for v in obj.data.vertices]


def painted(folder):
    """A cutout of an F, turned and scaled and parented, and its file."""
    path = save(folder, "hero.png", letter())
    obj = cutout(path, vertices=300)
    parent = bpy.data.objects.new("Root", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.rotation_euler, obj.parent = (0.1, 0.2, np.pi / 2), parent
    obj.rotation_euler.y, obj.scale = 0.5, (3.0, 3.0, 3.0)
    activate(obj)
    add_pins(obj, *([row] for row in extremes(obj)))
    return obj, path


def repaint(path, art):
    """Write the file again, later and larger, as a paint program does."""
    save(path.parent, path.name, art)
    later = time.time() + 5.0
    os.utime(path, (later, later))
    from planar_deform.scene.image import file_state

    file_state.forget()
