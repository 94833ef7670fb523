# SPDX-License-Identifier: GPL-3.0-or-later
"""The scripts in docs/ do what their pages say."""

import re
from pathlib import Path

import bpy
import numpy as np
from support import PLANES, activate, coordinates, evaluated, grid, make_object

DOCS = Path(__file__).parents[2] / "docs"


def script_of(page: str) -> str:
    (script,) = re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)
    return script.strip()


def standing_sheet():
    vertices, faces = grid(8, 8, width=1.0, height=1.0, origin=(-0.5, 0.0))
    return make_object(vertices @ PLANES["XZ"].T, faces.tolist())


def test_script_of_the_posing_page():
    obj = standing_sheet()
    obj.vertex_groups.new(name="Hand").add([79, 80, 71, 70], 1.0, "REPLACE")
    rest = coordinates(obj.data.vertices)

    *posing, reset = script_of("posing.md").splitlines()
    exec("\n".join(posing), {})
    hand = obj.planar.pins["Hand"]
    moved = (coordinates(obj.data.vertices) - rest)[[79, 80, 71, 70]].mean(axis=0)
    assert np.allclose(moved, (0.4, 0.0, 1.3), atol=0.02)  # pins are soft: near their targets
    assert np.isclose(hand.angle, 0.5)
    exec(f"import bpy\n{reset}", {})
    assert np.array_equal(coordinates(obj.data.vertices), rest)
    assert bpy.context.object == obj


def test_script_of_the_page_of_several_objects():
    objects = []
    for name in ("Body", "Arm"):
        obj = standing_sheet()
        obj.name = name
        for place in ((-0.5, 0.0, 0.0), (0.5, 0.0, 1.0)):
            bpy.ops.planar.add_pin(location=place)
        objects.append(obj)
    exec(script_of("several.md"), {})
    assert bpy.context.object.name == "Arm"
    assert [[pose.frame for pose in obj.planar.poses] for obj in objects] == [[1, 9], [1, 9]]
    assert [obj.planar.poses[0].generated for obj in objects] == [7, 7]
    body, arm = (evaluated(obj) for obj in objects)
    assert np.abs(body - arm).max() > 0.1, "the second drag was of the arm alone"


def test_script_of_the_lattices_page():
    obj = standing_sheet()
    data = bpy.data.lattices.new("Cage")
    data.points_u, data.points_v, data.points_w = 5, 3, 5
    cage = bpy.data.objects.new("Cage", data)
    bpy.context.scene.collection.objects.link(cage)
    cage.location, cage.scale = (0.0, 0.0, 0.5), (2.0, 1.0, 2.0)
    obj.modifiers.new("Lattice", "LATTICE").object = cage
    activate(cage)
    corner = coordinates(data.points, "co_deform")[0]
    exec(script_of("lattices.md"), {})
    assert np.allclose(evaluated(obj)[80], (0.8, 0.0, 1.1), atol=0.02)
    assert np.allclose(coordinates(data.points, "co_deform")[0], corner, atol=0.02)


def test_script_of_the_follow_page():
    obj = standing_sheet()
    for place in ((-0.5, 0.0, 0.0), (0.5, 0.0, 1.0)):
        bpy.ops.planar.add_pin(location=place)  # the new pin is the selected one
    exec(script_of("follow.md").replace("pins[0]", "pins[1]"), {})
    assert [pose.frame for pose in obj.planar.poses] == list(range(1, 14))
    bpy.context.scene.frame_set(13)
    assert np.allclose(evaluated(obj)[80], (0.5, 0.0, 1.4), atol=0.02)
    assert not obj.planar.live


def test_script_of_the_poses_page():
    obj = standing_sheet()
    bpy.ops.planar.add_pin(location=(-0.5, 0.0, 0.5))
    bpy.ops.planar.add_pin(location=(0.5, 0.0, 0.5))  # the new pin is the selected one
    exec(script_of("poses.md"), {})

    def shown(frame):
        bpy.context.scene.frame_set(frame)
        return evaluated(obj)

    rest, stretched, mirrored = shown(1), shown(25), shown(49)
    assert np.isclose(stretched[:, 0].max(), rest[:, 0].max() + 0.4, atol=0.05)
    assert np.isclose(mirrored[:, 0].min(), rest[:, 0].min() - 0.4, atol=0.05)
    assert len(obj.planar.poses) == 3


def test_script_of_the_in_betweens_page():
    obj = standing_sheet()
    bpy.ops.planar.add_pin(location=(-0.5, 0.0, 0.5))
    bpy.ops.planar.add_pin(location=(0.5, 0.0, 0.5))  # the new pin is the selected one
    before, after = script_of("inbetweens.md").split("bpy.ops.planar.retime_pose")

    def shown(frame):
        bpy.context.scene.frame_set(frame)
        return evaluated(obj)

    names = {}
    exec(before, names)
    pulled = 4 * 9 + 8  # the vertex of the second pin
    assert np.allclose((shown(25) - shown(1))[pulled], (-0.3, 0.0, 0.9), atol=0.01)
    assert obj.planar.poses[0].generated == 23
    halfway, posed = shown(13), shown(49)
    assert not np.allclose(halfway, (shown(1) + shown(25)) / 2, atol=0.01)  # an arc

    exec("bpy.ops.planar.retime_pose" + after, names)
    assert np.array_equal(shown(61), posed)
    sides = shown(43) - shown(43).mean(axis=0), shown(25) - shown(25).mean(axis=0)
    assert np.vdot(*sides) < 0  # halfway through an extra turn it is upside down
    assert len(obj.planar.poses) == 4  # with the breakdown
    assert obj.planar.show_onion


def test_script_of_the_page_on_baking(tmp_path):
    obj = standing_sheet()
    obj.name = "Cutout"
    bpy.ops.planar.add_pin(location=(-0.5, 0.0, 0.5))
    bpy.ops.planar.add_pin(location=(0.5, 0.0, 0.5))
    for frame, offset in ((1, 0.0), (25, 0.3), (49, -0.2)):
        bpy.context.scene.frame_set(frame)
        if offset:
            bpy.ops.planar.drag_pins(offset=(offset, 0.0))
        bpy.ops.planar.key_pose()

    def shown():
        shapes = []
        for frame in range(1, 50, 4):
            bpy.context.scene.frame_set(frame)
            shapes.append(evaluated(obj))
        return np.stack(shapes)

    before = shown()
    script = script_of("bake.md").replace("/tmp/shot", (tmp_path / "shot").as_posix())
    cached, baked = script.split("bpy.context.object")
    exec(cached, {})
    assert (tmp_path / "Cutout_planar.pc2").stat().st_size == 32 + 49 * 81 * 12
    assert np.allclose(shown(), before, atol=1e-6)
    exec(f"import bpy\nbpy.context.object{baked}", {})
    assert len(obj.data.shape_keys.key_blocks) == 1 + 49
    assert np.allclose(shown(), before, atol=1e-6)


def test_script_of_the_motion_page():
    twin = standing_sheet()
    twin.name = "Twin"
    obj = standing_sheet()
    bpy.ops.planar.add_pin(location=(-0.5, 0.0, 0.5))
    bpy.ops.planar.add_pin(location=(0.5, 0.0, 0.5))  # the new pin is the selected one
    for frame, offset in (
        (1, (0.0, 0.0)),
        (13, (-0.3, 0.6)),
        (25, (0.1, -0.9)),
        (29, (0.05, 0.0)),
        (33, (0.05, 0.0)),
    ):
        bpy.context.scene.frame_set(frame)
        bpy.ops.planar.drag_pins(offset=offset)
        bpy.ops.planar.key_pose()
    bpy.ops.planar.generate_inbetweens()

    def shown(thing, frame):
        bpy.context.scene.frame_set(frame)
        return evaluated(thing)

    before = {frame: shown(obj, frame) for frame in (1, 7, 13, 20, 29, 31)}
    exec(script_of("motion.md"), {})
    change = {frame: np.abs(shown(obj, frame) - shape).max() for frame, shape in before.items()}
    assert change[7] > 0.05
    assert all(change[frame] < 0.015 for frame in (1, 13, 20, 29, 31)), "thinned at most"
    assert all(np.allclose(shown(twin, frame), shown(obj, frame), atol=0.03) for frame in before)
    assert len(obj.planar.poses) < len(twin.planar.poses) == 5


def test_script_of_the_flatten_page():
    exec(script_of("flatten.md"), {})
    flat = bpy.context.object
    assert len(flat.data.polygons) == 24
    assert max(item.value for item in flat.data.attributes["planar_edge_number"].data) == 1
    assert flat.planar.surface.data.uv_layers.active is not None
    width, _, height = flat.dimensions
    assert np.allclose((width, height), (24 * 2 * np.sin(np.pi / 24), 2.0), atol=1e-5)


def test_script_of_the_cutouts_page(tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    (tmp_path / "layers").mkdir()
    art = np.zeros((60, 40, 4), np.float32)
    art[10:50, 10:30] = 1.0
    for name in ("1 legs", "2 body"):
        image = bpy.data.images.new(name, 40, 60, alpha=True)
        image.pixels.foreach_set(art.ravel())
        image.filepath_raw, image.file_format = str(tmp_path / "layers" / f"{name}.png"), "PNG"
        image.save()
        bpy.data.images.remove(image)
    exec(script_of("cutouts.md"), {})
    obj = bpy.context.object
    assert obj.data.materials.keys() == ["1 legs", "2 body"]
    assert 1200 < len(obj.data.vertices) < 2000
    assert bpy.data.images[0].filepath.startswith("//layers")
