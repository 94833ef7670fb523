# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings with Live on, frame by frame: played, jumped to, rendered, whatever moves what is followed."""

import bpy
import carry_scenes
import numpy as np
import pytest
from follow_scenes import (
    HAND,
    TIP,
    angle,
    axes,
    empty,
    film,
    held,
    imported,
    in_poses,
    swinging,
    turned,
    with_control,
)
from sequences import pushed_down
from support import activate, add_pins, coordinates, evaluated, world

CLOSE = 4e-3
SAME = 2e-6  # of a drawing 2 long in its own space: roundings of float32


def alive(**options):
    obj, control = with_control(kind="PATCH", **options)
    swinging(control)
    obj.planar.live = True
    return obj, control


def assert_at_control(obj, control, offset, vertices=HAND):
    u, v, _ = axes(obj)
    gap = held(obj, vertices) - np.array(control.matrix_world.translation) - offset
    np.testing.assert_allclose((gap @ u, gap @ v), 0.0, atol=CLOSE)


@pytest.mark.parametrize("parented", [False, True])
def test_the_drawing_is_with_its_control_in_every_frame(parented):
    obj, control = alive(parented=parented)
    bpy.context.scene.frame_set(1)
    offset = held(obj, HAND) - np.array(control.matrix_world.translation)
    reach = []
    for frame in range(1, 18):
        bpy.context.scene.frame_set(frame)
        assert_at_control(obj, control, offset)
        reach.append(held(obj, HAND))
    assert np.ptp(reach, axis=0).max() > 0.3
    bpy.context.scene.frame_set(6, subframe=0.5)
    assert_at_control(obj, control, offset)


SCENES = {
    "drawing": lambda: alive()[0],
    "posed by hand": lambda: _posed(alive()[0]),
    "with a key": lambda: _with_a_key(alive()[0]),
    "poses": lambda: _live(in_poses()[0]),
    "AKVF": lambda: _method(alive()[0], "AKVF"),
    "ARAP": lambda: _method(alive()[0], "ARAP"),
}


def _posed(obj):
    bpy.ops.planar.drag_pins(pin=0, offset=(-0.1, 0.2))
    bpy.ops.planar.rotate_pins(pin=0, angle=-0.4)
    return obj


def _with_a_key(obj):
    obj.shape_key_add(name="Basis")
    return obj


def _live(obj):
    obj.planar.live = True
    return obj


def _method(obj, method):
    obj.planar.method = method
    return obj


@pytest.mark.parametrize("scene", SCENES)
def test_a_frame_shows_the_same_however_it_was_reached(scene):
    obj = SCENES[scene]()
    bpy.context.scene.frame_set(17)
    forward = film(obj, range(1, 18))
    assert np.abs(forward[1] - forward[9]).max() > 0.1
    backward = film(obj, range(17, 0, -1))
    jumps = film(obj, (9, 1, 17, 5, 13, 2, 16, 9))
    for frame in forward:
        np.testing.assert_allclose(backward[frame], forward[frame], atol=SAME)
    for frame, shape in jumps.items():
        np.testing.assert_allclose(shape, forward[frame], atol=SAME)


def test_poses_play_below_what_follows():
    """Pins that follow nothing are where the poses have them, and the keys stay as they were."""
    obj, control = in_poses()
    keys = obj.data.shape_keys
    before = {block.name: coordinates(block.data).tobytes() for block in keys.key_blocks}
    played = film(obj, range(1, 18))
    hands = {frame: world(obj, shape)[64] for frame, shape in played.items()}
    bpy.context.scene.frame_set(17)
    offset = world(obj, played[17])[12] - np.array(control.matrix_world.translation)
    obj.planar.live = True
    obj.planar.pins[2].follow = control
    for frame in (1, 4, 9, 12, 17, 3):
        bpy.context.scene.frame_set(frame)
        shown = world(obj, evaluated(obj))
        np.testing.assert_allclose(shown[64], hands[frame], atol=CLOSE)
        assert_at_control(obj, control, offset, [12])
    now = {block.name: coordinates(block.data).tobytes() for block in keys.key_blocks}
    assert {name: now[name] for name in before} == before
    obj.planar.live = False
    again = film(obj, range(1, 18))
    for frame in played:
        np.testing.assert_array_equal(again[frame], played[frame])


def test_a_pose_keyed_while_live_is_what_the_frame_begins_with():
    obj, control = in_poses()
    obj.planar.live = True
    bpy.context.scene.frame_set(5)
    shown = evaluated(obj)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert [pose.frame for pose in obj.planar.poses] == [1, 5, 9, 17]
    film(obj, (9, 5))
    np.testing.assert_allclose(evaluated(obj), shown, atol=2e-3)
    assert control.name


def compared(obj, control, frames=(1, 5, 9, 13, 17)):
    """What Live shows at frames is what Follow Now shows of a still drawing with an Empty put there."""
    shapes = film(obj, frames)
    places = {}
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        places[frame] = control(), shapes[frame]
    obj.planar.live = False
    for pin in obj.planar.pins:
        if pin.follow is not None:
            still, offset, axis = empty((0, 0, 0)), tuple(pin.follow_offset), tuple(pin.follow_axis)
            pin.follow, pin.follow_bone = still, ""
            pin.follow_offset, pin.follow_axis = offset, axis
    activate(obj)
    for matrix, shape in places.values():
        still.matrix_world = matrix
        bpy.context.view_layer.update()
        bpy.ops.planar.follow_now()
        np.testing.assert_allclose(evaluated(obj), shape, atol=1e-5)
    spread = np.ptp([shape for _, shape in places.values()], axis=0).max()
    assert spread > 0.05, "it has moved"


def test_what_keys_move():
    obj, control = alive()
    compared(obj, lambda: control.matrix_world.copy())


def test_what_a_driver_moves():
    obj, control = with_control(kind="PATCH", live=True)
    start = control.location.copy()
    for index, factor in ((0, -0.01), (2, 0.02)):
        curve = control.driver_add("location", index)
        curve.driver.expression = f"{start[index]} + {factor} * frame"
    compared(obj, lambda: control.matrix_world.copy())


def test_what_a_constraint_moves():
    obj, control = with_control(kind="PATCH", live=True)
    leader = empty(control.location, "Leader")
    leader.location.z += 0.0
    constraint = control.constraints.new("COPY_LOCATION")
    constraint.target = leader
    swinging(leader)
    compared(obj, lambda: control.matrix_world.copy())


def test_what_inverse_kinematics_move():
    obj = imported()
    add_pins(obj, [26], HAND, kind="PATCH")
    data = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", data)
    bpy.context.scene.collection.objects.link(rig)
    activate(rig)
    bpy.ops.object.mode_set(mode="EDIT")
    left, right = held(obj, [26]), held(obj, HAND)
    elbow = (left + right) / 2 + (0.0, 0.0, 0.1)
    upper, lower = data.edit_bones.new("Upper"), data.edit_bones.new("Lower")
    upper.head, upper.tail, lower.head, lower.tail = left, elbow, elbow, right
    lower.parent, lower.use_connect = upper, True
    bpy.ops.object.mode_set(mode="OBJECT")
    goal = empty(right, "Goal")
    constraint = rig.pose.bones["Lower"].constraints.new("IK")
    constraint.target, constraint.chain_count = goal, 2
    obj.planar.pins[1].follow, obj.planar.pins[1].follow_bone = rig, "Lower"
    swinging(goal, offsets=((0, 0, 0), (-0.1, 0, 0.2), (-0.2, 0, -0.2)))
    obj.planar.live = True
    compared(obj, lambda: rig.matrix_world @ rig.pose.bones["Lower"].matrix)


def test_what_falls():
    obj, control = with_control(kind="PATCH")
    bpy.ops.mesh.primitive_cube_add(size=0.2, location=control.location)
    cube = bpy.context.object
    bpy.ops.rigidbody.object_add()
    activate(obj)
    obj.planar.pins[1].follow = cube
    obj.planar.live = True
    bpy.context.scene.frame_end = 8
    start = held(obj, HAND)
    for frame in range(1, 7):
        bpy.context.scene.frame_set(frame)
    fallen = cube.matrix_world.translation.z - control.location.z
    assert fallen < -0.02
    np.testing.assert_allclose((held(obj, HAND) - start)[2], fallen, atol=CLOSE)


def test_a_drawing_that_moves_itself_keeps_its_pins_at_what_they_follow():
    obj, control = alive(parented=True)
    offset = held(obj, HAND) - np.array(control.matrix_world.translation)
    for frame, shift in ((1, 0.0), (17, 0.4)):
        obj.location.x = 0.3 + shift
        obj.keyframe_insert("location", frame=frame)
    for frame in (1, 7, 17):
        bpy.context.scene.frame_set(frame)
        u, v, _ = axes(obj)
        gap = held(obj, HAND) - np.array(control.matrix_world.translation) - offset
        np.testing.assert_allclose((gap @ u, gap @ v), 0.0, atol=CLOSE)


def test_turns_go_on_past_half_a_turn():
    obj, control = with_control(kind="PATCH", offset=(0.0, -0.4, 0.0))
    normal = axes(obj)[2]
    control.rotation_mode = "QUATERNION"
    for frame, degrees in ((1, 0.0), (5, 100.0), (9, 100.0)):
        turned(control, normal, degrees)
        control.keyframe_insert("rotation_quaternion", frame=frame)
    obj.planar.live = True
    bpy.context.scene.frame_set(9)
    assert angle(obj) == pytest.approx(-160.0, abs=3.0), "200 degrees are the same direction"
    bpy.context.scene.frame_set(5)
    assert angle(obj) == pytest.approx(100.0, abs=3.0)


def test_nothing_is_solved_while_nothing_moves(monkeypatch):
    from planar_deform.scene.motion import to_controls

    obj, _ = with_control(kind="PATCH", live=True)
    bpy.context.scene.frame_set(2)
    solved, solve = [], to_controls.solve
    monkeypatch.setattr(to_controls, "solve", lambda *of: solved.append(of) or solve(*of))
    film(obj, range(3, 9))
    assert not solved


def test_what_is_refused_turns_live_off_and_changes_nothing(capsys):
    obj, control = alive()
    bpy.context.scene.frame_set(5)
    before = coordinates(obj.data.vertices)
    control.hide_viewport = True
    bpy.context.scene.frame_set(6)
    assert not obj.planar.live
    assert "'Control', which pin 'Pin.001' follows, is disabled in the viewport" in capsys.readouterr().out
    np.testing.assert_array_equal(coordinates(obj.data.vertices), before)


def test_poses_that_are_pushed_down_while_live_play_again(capsys):
    obj, _ = in_poses()
    played = film(obj, (1, 5, 9, 13))
    obj.planar.live = True
    bpy.context.scene.frame_set(5)
    pushed_down(obj)
    bpy.context.scene.frame_set(9)
    assert not obj.planar.live
    assert "A strip in the Nonlinear Animation editor plays the poses" in capsys.readouterr().out
    np.testing.assert_array_equal(evaluated(obj), played[9])
    for frame, shape in film(obj, (1, 5, 13)).items():
        np.testing.assert_array_equal(shape, played[frame])


def test_other_objects_and_scenes_do_not_matter():
    obj, control = alive()
    shapes = film(obj, (1, 9))
    other = bpy.data.scenes.new("Other")
    other.frame_set(9)
    np.testing.assert_array_equal(coordinates(obj.data.vertices), shapes[9])
    obj.name = "Renamed"
    bpy.context.view_layer.update()
    np.testing.assert_allclose(film(obj, (1,))[1], shapes[1], atol=SAME)
    bpy.data.objects.remove(obj)
    bpy.context.scene.frame_set(9)
    assert control.name


def test_it_goes_on_in_a_file_that_is_opened(tmp_path):
    obj, _ = alive()
    name, shapes = obj.name, film(obj, (3, 9, 1))
    path = str(tmp_path / "live.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    for frame, shape in film(bpy.data.objects[name], (9, 3)).items():
        np.testing.assert_allclose(shape, shapes[frame], atol=SAME)


SIDE = 96  # pixels of a picture
WIDE = 4.0  # that it shows


def rendered(obj, tmp_path, frames=(1, 9)):
    """Where frames rendered in background show the drawing."""
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    camera.data.type, camera.data.ortho_scale = "ORTHO", WIDE
    camera.location, camera.rotation_euler = (0.9, -10.0, 2.3), (np.pi / 2, 0.0, 0.0)
    scene.camera = camera
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.render.film_transparent = True
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = SIDE, SIDE, 100
    scene.render.image_settings.color_mode = "RGBA"
    scene.frame_start, scene.frame_end, scene.frame_step = frames[0], frames[1], frames[1] - frames[0]
    scene.render.filepath = str(tmp_path / "frame_")
    bpy.ops.render.render(animation=True)
    masks = {}
    for frame in frames:
        image = bpy.data.images.load(str(tmp_path / f"frame_{frame:04}.png"))
        pixels = np.empty(SIDE * SIDE * 4, np.float32)
        image.pixels.foreach_get(pixels)
        masks[frame] = pixels.reshape(SIDE, SIDE, 4)[..., 3] > 0.5
    return masks


def covered(obj, shape):
    """The pixels whose middles faces cover in the world's x and z."""
    steps = (np.arange(SIDE) + 0.5) / SIDE * WIDE - WIDE / 2
    x, z = np.meshgrid(steps + 0.9, steps + 2.3)
    places = world(obj, shape)[:, [0, 2]]
    mask = np.zeros((SIDE, SIDE), bool)
    for face in obj.data.polygons:
        corners = places[list(face.vertices)]
        sides = [
            (b[0] - a[0]) * (z - a[1]) - (b[1] - a[1]) * (x - a[0])
            for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)
        ]
        mask |= (np.min(sides, axis=0) >= 0) | (np.max(sides, axis=0) <= 0)
    return mask


@pytest.mark.parametrize("poses", [False, True])
def test_a_film_rendered_in_background_shows_it(tmp_path, poses):
    obj, _ = in_poses() if poses else alive()
    obj.planar.live = True
    shapes = film(obj, (1, 9))
    bpy.context.scene.frame_set(17)
    masks = rendered(obj, tmp_path)
    wanted = {frame: covered(obj, shape) for frame, shape in shapes.items()}
    assert (wanted[1] ^ wanted[9]).sum() > 100, "the frames differ"
    for frame in masks:
        assert (masks[frame] ^ wanted[frame]).sum() < 0.06 * wanted[frame].sum()


def test_what_a_drawing_carries_is_rendered_with_it(tmp_path):
    carrier, obj = carry_scenes.body(), carry_scenes.lantern()
    for one in (carrier, obj):
        one.location.z = 2.2
    carry_scenes.choose(obj, 0, 1)
    carry_scenes.attach(obj, to=carrier)
    for frame, turn in ((1, 0.0), (9, 0.7)):
        bpy.context.scene.frame_set(frame)
        carry_scenes.drag(carrier, 1, angle=turn)
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
    wanted = {}
    for frame in (1, 9):
        bpy.context.scene.frame_set(frame)
        wanted[frame] = covered(carrier, evaluated(carrier)) | covered(obj, evaluated(obj))
    assert (wanted[1] ^ wanted[9]).sum() > 100, "the frames differ"
    bpy.context.scene.frame_set(1)
    for frame, mask in rendered(obj, tmp_path).items():
        assert (mask ^ wanted[frame]).sum() < 0.06 * wanted[frame].sum()


def test_what_is_disabled_in_renders_is_told_there(tmp_path, capsys):
    obj, control = alive()
    control.hide_render = True
    rendered(obj, tmp_path)
    assert "'Control', which pin 'Pin.001' follows, is disabled in renders" in capsys.readouterr().out


def caged(*, poses=False):
    """A drawing in a lattice, whose pin at the right follows a swinging Empty."""
    obj = imported()
    bpy.ops.planar.fit_lattice(resolution=(8, 6))
    cage = bpy.context.object
    for vertex in (26, 38):
        bpy.ops.planar.add_pin(location=held(obj, [vertex]), extend=True)
    if poses:
        for frame, offset in ((1, (0.0, 0.0)), (17, (0.0, 0.1))):
            bpy.context.scene.frame_set(frame)
            bpy.ops.planar.drag_pins(pin=0, offset=offset)
            assert bpy.ops.planar.key_pose() == {"FINISHED"}
        bpy.context.scene.frame_set(1)
    bpy.ops.planar.select_pins(action="SELECT", pin=1)
    bpy.ops.planar.add_controls()
    swinging(cage.planar.pins[1].follow)
    return obj, cage


@pytest.mark.parametrize("poses", [False, True])
def test_a_lattice_follows_in_every_frame_however_it_was_reached(poses):
    obj, cage = caged(poses=poses)
    offset = held(obj, TIP) - np.array(cage.planar.pins[1].follow.matrix_world.translation)
    foot = held(obj, [26])
    forward = film(obj, range(1, 18))
    assert np.abs(forward[1] - forward[9]).max() > 0.1
    for frame in (12, 9, 1, 17, 4):
        bpy.context.scene.frame_set(frame)
        np.testing.assert_allclose(evaluated(obj), forward[frame], atol=1e-5)
        assert_at_control(obj, cage.planar.pins[1].follow, offset, TIP)
    bpy.context.scene.frame_set(17)
    assert held(obj, [26])[2] - foot[2] == pytest.approx(0.1 if poses else 0.0, abs=CLOSE)
    cage.planar.live = False
    bpy.context.scene.frame_set(1)
    if poses:
        np.testing.assert_allclose(held(obj, [26]), foot, atol=CLOSE)


def test_a_lattice_is_followed_in_renders(tmp_path, capsys):
    obj, _ = caged()
    shapes = film(obj, (1, 9))
    bpy.context.scene.frame_set(17)
    masks = rendered(obj, tmp_path)
    for frame, mask in masks.items():
        wanted = covered(obj, shapes[frame])
        assert (mask ^ wanted).sum() < 0.06 * wanted.sum()
    assert "Live Is Not Rendered" not in capsys.readouterr().out


def test_where_something_else_deforms_its_meshes_that_is_told_once(tmp_path, capsys):
    obj, cage = caged()
    obj.modifiers.new("Smooth", "SMOOTH")
    obj.modifiers.move(len(obj.modifiers) - 1, 0)
    rendered(obj, tmp_path)
    said = capsys.readouterr().out
    assert said.count("the picture does not show what the pins of this lattice follow, as something") == 1
    assert cage.planar.live


@pytest.mark.parametrize("poses", [False, True])
def test_partners_on_the_other_side_go_along(poses):
    """With Symmetry the pin at the left goes the way of the one at the right that follows, mirrored."""
    obj = imported()
    add_pins(obj, [26], [38], [6], [58])
    if poses:
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
    control = empty(held(obj, TIP))
    obj.planar.pins[1].follow = control
    swinging(control, offsets=((0, 0, 0), (0.1, 0.0, 0.25), (-0.1, 0.0, -0.2)))
    activate(obj)
    start = held(obj, [26])
    obj.planar.live, obj.planar.use_mirror_x = True, True
    for frame in (9, 17, 4, 1):
        bpy.context.scene.frame_set(frame)
        way = held(obj, TIP) - start - (1.2, 0.0, 0.0)
        np.testing.assert_allclose(held(obj, [26]) - start, way * (-1.0, 1.0, 1.0), atol=CLOSE)
    bpy.context.scene.frame_set(9)
    left = held(obj, [26])
    assert np.linalg.norm(left - start) > 0.2
    obj.planar.use_mirror_x = False
    bpy.context.scene.frame_set(17)
    np.testing.assert_allclose(held(obj, [26]), start if poses else left, atol=CLOSE)
