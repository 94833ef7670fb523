# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of earlier versions open as they were, and can be gone on with; make_kept_file.py makes them."""

import json

import bpy
import kept
import numpy as np
import pytest
from sequences import write
from support import activate, evaluated

STORED = 2e-6  # of what is written in a file, against how large the object is
SOLVED = 2e-4  # of what is solved when a frame is shown: the pins that follow something
LAST = 31  # a frame behind all poses


@pytest.fixture(params=sorted(kept.FILES.glob("*.blend")), ids=lambda path: path.stem)
def before(request, tmp_path):
    """What the open file showed in the version that saved it."""
    path = tmp_path / request.param.name  # nothing is written beside the file that is kept
    path.write_bytes(request.param.read_bytes())
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return json.loads(request.param.with_suffix(".json").read_text(encoding="utf-8"))


def compare(now, before):
    assert now.keys() == before.keys()
    for name, then in before.items():
        found = dict(now[name])
        shapes, depths = found.pop("shapes"), found.pop("depths")
        pins = [{**pin, "target": None} for pin in found.pop("pins")]
        assert pins == [{**pin, "target": None} for pin in then["pins"]], name
        for pin, other in zip(now[name]["pins"], then["pins"], strict=True):
            near(pin["target"], other["target"], STORED, f"{name}: target of {pin['name']}")
        for frame, values in then["shapes"].items():
            near(shapes[frame], values, SOLVED if then["live"] else STORED, f"{name} in frame {frame}")
        near(depths, then["depths"], 1e-3, f"depths of {name}")
        assert found == {field: then[field] for field in found}, name


def near(now, before, tolerance, what):
    assert (now is None) == (before is None), what
    if before:
        np.testing.assert_allclose(
            now, before, rtol=0, atol=tolerance * max(1.0, np.ptp(before)), err_msg=what
        )


def test_it_shows_what_it_showed_and_does_so_saved_again(before, tmp_path):
    from planar_deform.scene.storage.migration import VERSION

    compare(kept.record(), before)
    again = str(tmp_path / "again.blend")
    bpy.ops.wm.save_as_mainfile(filepath=again)
    bpy.ops.wm.open_mainfile(filepath=again)
    compare(kept.record(), before)
    assert {obj.planar.version for obj in kept.ours()} == {VERSION}
    rests = [obj.data for obj in kept.ours() if obj.type == "MESH" and "planar_rest" in obj.data.attributes]
    assert {mesh.planar_version for mesh in rests} == {VERSION}


def test_work_goes_on_in_it(before):
    """Each object is dragged behind its last pose, keyed and filled; its other poses stay as they were."""
    for obj in kept.ours():
        activate(obj)
        poses = len(obj.planar.poses)
        bpy.context.scene.frame_set(LAST)
        if obj.planar.pins:
            drag(obj)
        else:
            write(obj, 7)
        assert bpy.ops.planar.key_pose() == {"FINISHED"}, obj.name
        assert len(obj.planar.poses) == poses + 1
        if poses:
            assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}, obj.name
            assert obj.planar.poses[poses - 1].generated > 0, obj.name
    now = kept.record()
    for name, then in before.items():
        assert [pose[:2] for pose in now[name]["poses"]][:-1] == [pose[:2] for pose in then["poses"]], name
        for pose in then["poses"] if not then["live"] else ():
            frame = f"{pose[1]:.0f}"
            near(now[name]["shapes"][frame], then["shapes"][frame], STORED, f"{name} in frame {frame}")


def drag(obj):
    """Drag the last pin, and see what it holds move."""
    last = max(i for i, pin in enumerate(obj.planar.pins) if pin.enabled and pin.kind in {"POINT", "PATCH"})
    seen = bpy.data.objects["Front"] if obj.type == "LATTICE" else obj
    held = evaluated(seen)
    assert bpy.ops.planar.drag_pins(pin=last, offset=(0.02, 0.03)) == {"FINISHED"}, obj.name
    assert not np.array_equal(evaluated(seen), held), obj.name
