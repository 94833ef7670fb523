# SPDX-License-Identifier: GPL-3.0-or-later
"""What follows Blender's events: what is asked of whom, and what is left of a file when another one comes."""

import sys

import bpy
import numpy as np
import pytest
from sequences import filled
from support import activate, add_end_pins, bar, measured

FOREIGN = 500


@pytest.fixture
def asked():
    """The objects whose `planar` is read meanwhile; what it holds is out of reach until the test ends."""
    from planar_deform.scene import properties

    found = []
    properties.unregister()
    bpy.types.Object.planar = property(lambda obj: found.append(obj.name))
    yield found
    del bpy.types.Object.planar
    properties.register()


def foreign(count):
    mesh = bpy.data.meshes.new("Foreign")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    objects = [bpy.data.objects.new("Foreign", mesh) for _ in range(count)]
    for obj in objects:
        bpy.context.scene.collection.objects.link(obj)
    activate(objects[0])
    return objects


def test_nothing_is_asked_of_foreign_objects_that_move(asked):
    objects = foreign(FOREIGN)
    updates = []

    def count(_scene, depsgraph):
        updates.append(len(depsgraph.updates))

    bpy.app.handlers.depsgraph_update_post.append(count)
    asked.clear()
    try:
        for step in range(3):
            for obj in objects:
                obj.location.x = step + 1.0
            bpy.context.view_layer.update()
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(count)
    assert updates == [FOREIGN] * 3
    assert asked == []


def test_nothing_is_kept_for_foreign_objects_that_are_edited():
    objects = foreign(20)
    for obj in objects:
        obj.vertex_groups.new(name="Group")
    objects[0].data.vertices[0].co.x = 0.5
    objects[0].data.update()
    bpy.context.view_layer.update()
    assert not any(obj.is_property_set("planar") for obj in objects)


def test_pins_follow_their_groups_and_measures_the_mesh_among_foreign_objects():
    foreign(20)
    obj = bar()
    add_end_pins(obj)
    before = measured(obj).area
    obj.vertex_groups[0].name = "Renamed"
    bpy.context.view_layer.update()
    assert obj.planar.pins[0].group == "Renamed"
    obj.data.vertices[0].co.x -= 1.0
    obj.data.update()
    bpy.context.view_layer.update()
    from planar_deform.scene.view import snapshot

    assert snapshot.of_active(bpy.context).distortion.area > before + 1e-3


def state():
    """All that the add-on's modules keep, but what they are made of."""
    kept = {}
    for name, module in sys.modules.items():
        if name.startswith("planar_deform"):
            for variable, value in vars(module).items():
                if variable.startswith("_") and not (variable.startswith("__") or isinstance(value, type)):
                    size = len(value) if hasattr(value, "__len__") else None
                    kept[f"{name}.{variable}"] = (value if isinstance(value, bool | int) else id(value), size)
    return kept


@pytest.mark.parametrize("leave", ["load", "unregister"])
def test_nothing_of_a_file_is_kept_when_another_one_comes(leave):
    import planar_deform
    from planar_deform.operators import stiffness
    from planar_deform.scene.sequence import stretches
    from planar_deform.scene.view import onion, snapshot

    bpy.ops.wm.read_factory_settings(use_empty=True)
    before = state()
    obj = filled()
    obj.planar.show_onion = True
    bpy.ops.planar.drag_pins(offset=(0.1, 0.1))
    assert snapshot.of_active(bpy.context) is not None
    assert onion.of_active(bpy.context) is not None
    assert np.isfinite(measured(obj).area)
    stretches.stale(obj)
    stiffness._painted = obj.session_uid
    busy = {name for name, value in state().items() if before.get(name) != value}
    assert {
        "planar_deform.model.posing.solver_cache._entries",
        "planar_deform.scene.objects.triangulation._kept",
        "planar_deform.scene.storage.digests._known",
        "planar_deform.scene.view.onion._kept",
        "planar_deform.scene.view.snapshot._kept",
    } <= busy, busy
    if leave == "load":
        bpy.ops.wm.read_factory_settings(use_empty=True)
        left = {name for name, value in state().items() if before.get(name) != value}
    else:
        planar_deform.unregister()
        left = {name for name, value in state().items() if before.get(name) != value}
        planar_deform.register()
        left -= {"planar_deform.registration._undo", "planar_deform.updating._undo"}
    assert left <= {"planar_deform.scene.storage.changes._files"}, "which only counts the files"
