# SPDX-License-Identifier: GPL-3.0-or-later
"""What Remesh would lose, it refuses, with nothing changed."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from pictures import blobs, letter
from remeshed import painted, repaint
from sequences import key, pull, stored
from support import activate, add_pins, bar, coordinates


def unchanged(obj, match, **options):
    activate(obj)
    before = bits(obj)
    with pytest.raises(RuntimeError, match=match):
        bpy.ops.planar.remesh(**{"source": "OUTLINE", **options})
    assert bits(obj) == before


def bits(obj):
    keys = obj.data.shape_keys
    return (
        coordinates(obj.data.vertices).tobytes(),
        [tuple(face.vertices) for face in obj.data.polygons],
        [] if keys is None else [(b.name, b.frame, coordinates(b.data).tobytes()) for b in keys.key_blocks],
    )


def shared(obj):
    other = bpy.data.objects.new("Other", obj.data)
    bpy.context.scene.collection.objects.link(other)


def foreign_keys(obj):
    obj.shape_key_add(name="Basis")
    obj.shape_key_add(name="Smile")


def pushed_down(obj):
    key(obj, 1)
    pull(obj, 5, (0.1, 0.2))
    animation = obj.data.shape_keys.animation_data
    action = animation.action
    animation.nla_tracks.new().strips.new("Strip", 1, action)
    animation.action = None


def bound(obj):
    other = bar(name="Driver", nx=20, ny=20)
    other.location.z = 0.1
    activate(obj)
    obj.modifiers.new("Follow", "SURFACE_DEFORM").target = other
    assert bpy.ops.object.surfacedeform_bind(modifier="Follow") == {"FINISHED"}
    assert obj.modifiers["Follow"].is_bound


def bound_to(obj):
    other = bar(name="Follower")
    other.modifiers.new("Follow", "SURFACE_DEFORM").target = obj
    activate(other)
    obj.data.transform(Matrix.Scale(2.0, 4))
    assert bpy.ops.object.surfacedeform_bind(modifier="Follow") == {"FINISHED"}
    assert other.modifiers["Follow"].is_bound


def hooked(obj):
    obj.modifiers.new("Hook", "HOOK").vertex_indices_set([0, 1])


def cached(obj):
    obj.modifiers.new("Cache", "MESH_CACHE")


def loose(obj):
    obj.data.vertices.add(1)


def edited(obj):
    bpy.ops.object.mode_set(mode="EDIT")


def folded(obj):
    places = coordinates(obj.data.vertices)
    places[:, 0] = np.abs(places[:, 0] - 1.0)
    obj.data.vertices.foreach_set("co", places.ravel())
    obj.data.update()
    assert bpy.ops.planar.set_rest_to_current() == {"FINISHED"}


def laid_flat(obj):
    bpy.ops.planar.flatten(to="MESH")
    flat = bpy.context.object
    assert flat != obj
    activate(obj)


REFUSED = {
    shared: "shared",
    foreign_keys: "shape keys of its own",
    pushed_down: "Nonlinear Animation",
    bound: "'Follow' is bound",
    bound_to: "'Follow' of 'Follower'",
    hooked: "hooks single vertices",
    cached: "plays a file",
    loose: "without faces",
    folded: "lies over itself",
    laid_flat: "laid flat",
}


@pytest.mark.parametrize("made", REFUSED, ids=lambda made: made.__name__)
def test_what_would_lose_something_is_refused(made):
    obj = bar(nx=6, ny=3)
    add_pins(obj, [0])
    made(obj)
    unchanged(obj, REFUSED[made])


def test_other_modes_are_refused_and_change_nothing():
    obj = bar()
    edited(obj)
    with pytest.raises(RuntimeError, match="leave the current mode"):
        bpy.ops.planar.remesh()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(obj.data.vertices) == 65


def test_a_flat_mesh_of_a_surface_is_refused():
    bar()
    bpy.ops.planar.flatten(to="MESH")
    unchanged(bpy.context.object, "surface laid flat")


def test_images_that_cannot_be_cut_out_are_refused(tmp_path):
    obj, path = painted(tmp_path)
    repaint(path, np.zeros_like(letter()))
    unchanged(obj, "cannot be cut out", source="IMAGE", reload=True)
    repaint(path, blobs((40, 60), size=(120, 80), radius=0.1))
    unchanged(obj, "cannot be cut out|no drawing any more", source="IMAGE")
    unchanged(bar(), "shows no image", source="IMAGE")


def test_what_is_refused_leaves_the_poses(tmp_path):
    obj, _ = painted(tmp_path)
    key(obj, 1)
    pull(obj, 9, (0.0, 0.05))
    before = stored(obj)
    hooked(obj)
    unchanged(obj, "hooks single vertices", source="IMAGE")
    assert stored(obj) == before
