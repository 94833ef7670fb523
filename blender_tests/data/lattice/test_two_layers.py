# SPDX-License-Identifier: GPL-3.0-or-later
"""Two layers count as one while all poses have them equal, which buttons ask in every redraw."""

import base64

import bpy
import numpy as np
import pytest
from lattice_poses import keyed, two_layers
from lattice_scenes import lattice, points
from sequences import go_to
from support import activate, coordinates

from planar_deform.scene.objects import any_object
from planar_deform.scene.objects.lattice_object import in_space
from planar_deform.scene.storage import points as storage

POLLED = (
    *("generate_inbetweens", "copy_pose", "paste_pose", "mirror_pose", "record_pins", "breakdown"),
    *("thin_poses", "edit_sequence", "transfer_motion", "bake_pins", "key_pose"),
)
PATH = base64.b64encode(np.array([(0.0, 0.0, 0.0), (0.1, 0.0, 0.0)], "<f4").tobytes()).decode()


def test_no_button_reads_all_keys_to_know_whether_it_can_be_pressed(monkeypatch):
    cage, _ = two_layers()
    drawing = any_object.begin_shape(bpy.context)
    any_object.key_poses(drawing, {float(frame): drawing.positions + 0.01 * frame for frame in range(1, 101)})
    assert len(cage.data.shape_keys.key_blocks) >= 100
    read, counted = storage.read_block, []
    monkeypatch.setattr(storage, "read_block", lambda *of: counted.append(of) or read(*of))
    for name in POLLED:
        counted.clear()
        getattr(bpy.ops.planar, name).poll()
        assert len(counted) <= 1, f"{name} reads {len(counted)} keys"


def in_space_in_one_pose():
    """Two layers that are equal in the pose that is active, and not in another one."""
    cage, drawing = two_layers()
    keyed(cage, [drawing], {1: 0.3, 9: -0.8})
    block = cage.data.shape_keys.key_blocks[1]
    shape = coordinates(block.data)
    shape[-1] += (0.3, 0.1, 0.0)
    block.data.foreach_set("co", shape.ravel())
    cage.data.update_tag()
    go_to(9)
    activate(cage)
    return cage


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("generate_inbetweens", {}),
        ("copy_pose", {}),
        ("mirror_pose", {}),
        ("record_pins", {"path": PATH}),
        ("transfer_motion", {}),
    ],
)
def test_one_pose_in_space_is_found_when_the_button_is_pressed(name, options):
    cage = in_space_in_one_pose()
    other = lattice((9, 8, 2), (1, 1, 1), (9, 0, 0), "Other")
    other.select_set(True)
    shapes = [coordinates(block.data).tobytes() for block in cage.data.shape_keys.key_blocks]
    with pytest.raises(RuntimeError, match="is a lattice in space"):
        getattr(bpy.ops.planar, name)(**options)
    assert [coordinates(block.data).tobytes() for block in cage.data.shape_keys.key_blocks] == shapes


def test_a_corner_of_a_lattice_with_two_layers_in_two_axes_makes_it_one_in_space():
    cage = lattice((2, 2, 4), (1, 1, 1), (0, 0, 0))
    assert not in_space(cage)
    shape = points(cage)
    shape[0] += (0.3, 0.2, 0.1)
    cage.data.points.foreach_set("co_deform", shape.ravel())
    activate(cage)
    assert in_space(cage)
    with pytest.raises(RuntimeError, match="is a lattice in space"):
        bpy.ops.planar.copy_pose()
