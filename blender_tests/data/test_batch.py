# SPDX-License-Identifier: GPL-3.0-or-later
"""The headless command: what it does, what it says, and its exit codes."""

import bpy
import numpy as np
import pytest
from outlines import lines
from sequences import key, same, shown_at, stored
from support import activate, add_end_pins, bar, make_object


def run(capsys, *arguments):
    """The exit code, and the lines of stdout and stderr."""
    from planar_deform import batch

    capsys.readouterr()
    code = batch.run([str(argument) for argument in arguments])
    output = capsys.readouterr()
    ours = [line for line in output.out.splitlines() if line.startswith("planar: ")]
    return code, ours, output.err.splitlines()


@pytest.fixture
def shot(tmp_path):
    """A saved file in which two bars have three poses each, and a third one has none."""
    for name in ("One", "Two"):
        obj = bar(name=name)
        add_end_pins(obj)
        for seed, frame in enumerate((1, 9, 17)):
            key(obj, frame, seed)
    bar(name="Still")
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 17
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    return tmp_path / "shot.blend"


def opened(path):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return bpy.data.objects


def test_all_objects_with_poses_are_generated_baked_and_saved(shot, capsys):
    code, lines, errors = run(capsys, "--generate", "--bake", "point_cache", "--save")
    assert (code, errors) == (0, [])
    for line in (
        "planar: One: solving in-betweens: 100 %",
        "planar: Two: writing in-betweens: 100 %",
        "planar: Two: baking frames 1 to 17: 50 %",
        f"planar: saved {shot}",
    ):
        assert line in lines
    objects = opened(shot)
    for name in ("One", "Two"):
        assert len(objects[name].data.shape_keys.key_blocks) == 2 + 3 + 14
        assert objects[name].modifiers[0].filepath == f"//{name}_planar.pc2"
    assert not objects["Still"].modifiers
    assert len(list(shot.parent.glob("*.pc2"))) == 2


def test_of_all_objects_one_with_a_single_pose_is_baked_and_one_that_is_refused_fails(shot, capsys):
    still = bpy.data.objects["Still"]
    key(still, 5)
    assert run(capsys, "--generate", "--bake", "POINT_CACHE")[0] == 0
    assert still.modifiers[0].filepath == "//Still_planar.pc2"
    twin = still.copy()
    bpy.context.scene.collection.objects.link(twin)
    code, _, errors = run(capsys, "--bake", "SHAPES")
    assert code == 1
    assert "Still: The mesh is shared" in errors[0]


def test_it_does_what_the_operators_do(shot, capsys):
    obj = opened(shot)["One"]
    activate(obj)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    shown = [shown_at(obj, frame) for frame in range(1, 18)]
    opened(shot)
    bpy.context.view_layer.objects.active = None
    assert run(capsys, "--object", "One", "--generate")[0] == 0
    obj = bpy.data.objects["One"]
    assert all(same(shown_at(obj, frame), shape) for frame, shape in enumerate(shown, 1))


def test_an_object_of_another_scene_is_baked_with_the_timeline_of_that(shot, capsys):
    """The file is saved with a scene in front that the object is not in."""
    obj = opened(shot)["One"]
    other = bpy.data.scenes.new("Other")
    other.frame_start, other.frame_end = 5, 13
    other.frame_set(9)
    for collection in obj.users_collection:
        collection.objects.unlink(obj)
    other.collection.objects.link(obj)
    arguments = ["--object", "One", "--generate", "--bake", "POINT_CACHE"]
    code, lines, _ = run(capsys, *arguments)
    assert code == 0
    assert "planar: One: baking frames 5 to 13: 100 %" in lines
    assert obj.modifiers[0].frame_start == 5
    obj.modifiers[0].show_viewport = False
    eval_time = obj.data.shape_keys.eval_time
    other.frame_set(9)
    assert obj.data.shape_keys.eval_time == eval_time  # it was left as its own scene shows it
    assert run(capsys, "--object", "One", "--bake", "SHAPES")[0] == 0
    frames = [pose.frame for pose in obj.planar.poses]
    assert frames == [1, *range(5, 14), 17]


def test_an_object_of_several_scenes_is_baked_with_the_one_in_front(shot, capsys):
    obj = opened(shot)["One"]
    other = bpy.data.scenes.new("Another")  # comes first by name
    other.frame_start, other.frame_end = 5, 13
    other.collection.objects.link(obj)
    assert (
        "planar: One: baking frames 1 to 17: 100 %" in run(capsys, "--object", "One", "--bake", "SHAPES")[1]
    )


def test_of_one_pose_there_is_nothing_to_generate_before_it_is_baked(shot, capsys):
    obj = bar(name="Held")
    shown = key(obj, 5, 3)
    assert run(capsys, "--object", "Held", "--generate", "--bake", "POINT_CACHE")[0] == 0
    assert np.allclose(shown_at(obj, 9), shown, atol=1e-6)


def test_one_object_into_a_file_of_its_own(shot, capsys):
    untouched = stored(bpy.data.objects["Two"])
    before = shot.read_bytes()
    folder = shot.parent / "out"
    folder.mkdir()
    arguments = ["--object", "One", "--bake", "SHAPES", "--start", 3, "--end", 9, "--step", 2]
    assert run(capsys, *arguments, "--save", folder / "one.blend")[0] == 0
    assert shot.read_bytes() == before
    objects = opened(folder / "one.blend")
    assert len(objects["One"].planar.poses) == 6  # at 1, 3, 5, 7, 9, 17
    assert stored(objects["Two"]) == untouched


def test_a_point_cache_where_it_is_told(shot, capsys, monkeypatch):
    monkeypatch.chdir(shot.parent)
    (shot.parent / "caches").mkdir()
    arguments = ["--object", "One", "--bake", "POINT_CACHE", "--filepath", "caches/one", "--free"]
    assert run(capsys, *arguments)[0] == 0
    obj = bpy.data.objects["One"]
    assert obj.modifiers[0].filepath == "//caches/one.pc2"
    assert obj.data.shape_keys is None
    assert np.isfinite(shown_at(obj, 9)).all()
    opened(shot)
    code, _, errors = run(capsys, *arguments)  # the file of another run, which was not saved
    assert code == 1
    assert "choose another name" in errors[0]
    assert run(capsys, *arguments, "--replace")[0] == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--object", "Nobody", "--generate"], "There is no object 'Nobody'"),
        (["--object", "One", "--object", "Still", "--generate"], "Still: Key two poses first"),
        (["--object", "Still", "--bake", "SHAPES"], "Still: No poses are keyed"),
        (["--bake", "SHAPES", "--start", "9", "--end", "3"], "One: The last frame is before"),
        (["--object", "One", "--bake", "POINT_CACHE", "--filepath", f"//{'x' * 240}"], "cannot be written"),
        (["--generate", "--save", "//nowhere/x.blend"], "x.blend"),
    ],
)
def test_a_refusal_is_exit_code_1_with_its_reason_and_nothing_saved(shot, capsys, arguments, message):
    before = shot.read_bytes()
    code, lines, errors = run(capsys, *arguments, *([] if "--save" in arguments else ["--save"]))
    assert code == 1
    assert any(line.startswith("planar: ") and message in line for line in errors)
    assert not any("saved" in line for line in lines)
    assert shot.read_bytes() == before
    assert [path.name for path in shot.parent.iterdir()] == ["shot.blend"]


def test_the_meshes_with_poses_are_listed(shot, capsys):
    from planar_deform import batch

    key(lines("2D curve", name="Line"), 1, 1)
    before = shot.read_bytes()
    assert batch.run(["--list"]) == 0
    assert '["One", "Two"]' in capsys.readouterr().out.splitlines()
    assert shot.read_bytes() == before


def test_jobs_of_an_object_each_and_one_that_gathers_what_they_baked(shot, capsys):
    """What one job does with all objects, done by one for each that saves nothing, and a last one."""
    run(capsys, "--generate", "--bake", "POINT_CACHE", "--step", "2")
    together = {name: [shown_at(bpy.data.objects[name], f) for f in (1, 4, 17)] for name in ("One", "Two")}
    for path in shot.parent.glob("*.pc2"):
        path.unlink()
    before = shot.read_bytes()
    for name in (*together, "One"):  # and a job that is tried again
        opened(shot)
        job = ["--object", name, "--generate", "--bake", "POINT_CACHE", "--step", "2", "--replace"]
        assert run(capsys, *job)[0] == 0
    assert shot.read_bytes() == before
    opened(shot)
    code, lines, errors = run(capsys, "--play", "--save", "//shot_baked.blend")
    assert (code, errors) == (0, [])
    assert "planar: One: playing frames 1 to 17" in lines
    assert shot.read_bytes() == before
    objects = opened(shot.parent / "shot_baked.blend")
    for name, shapes in together.items():
        assert objects[name].modifiers[0].filepath == f"//{name}_planar.pc2"
        for frame, shape in zip((1, 4, 17), shapes, strict=True):
            assert np.allclose(shown_at(objects[name], frame), shape, atol=1e-6)
    assert not objects["Still"].modifiers


def baked(shot, capsys):
    """The file of One's point cache, which the open file knows nothing of."""
    assert run(capsys, "--object", "One", "--bake", "POINT_CACHE")[0] == 0
    opened(shot)
    return shot.parent / "One_planar.pc2"


def cut_off(path):
    path.write_bytes(path.read_bytes()[:-12])


def of_another_mesh(path):
    path.write_bytes(path.read_bytes()[:16] + b"\7\0\0\0" + path.read_bytes()[20:])


def something_else(path):
    path.write_bytes(b"a page of a diary, and long enough for a header")


def played_already(path):
    bpy.data.objects["Two"].modifiers.new("Cache", "MESH_CACHE").filepath = f"//{path.name}"


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda path: path.unlink(), "There is no point cache"),
        (cut_off, "is not complete"),
        (of_another_mesh, "of another mesh, of 7 vertices and not 65"),
        (something_else, "is not a point cache"),
        (played_already, "is the point cache of 'Two'"),
    ],
)
def test_what_is_no_whole_cache_of_the_object_is_not_played(shot, capsys, spoil, message):
    spoil(baked(shot, capsys))
    before = shot.read_bytes()
    code, _, errors = run(capsys, "--object", "One", "--play", "--save")
    assert code == 1
    assert message in errors[0]
    assert "One" in errors[0]
    assert not bpy.data.objects["One"].modifiers
    assert shot.read_bytes() == before


def test_a_cache_that_is_played_is_out_of_date_when_poses_change(shot, capsys):
    from planar_deform.scene.motion import cache_age

    baked(shot, capsys)
    assert run(capsys, "--play")[0] == 0
    obj = bpy.data.objects["One"]
    assert not cache_age.is_out_of_date(obj)
    obj.modifiers[0].show_viewport = False
    key(obj, 5, 3)
    assert cache_age.is_out_of_date(obj)


def test_a_file_without_poses_is_refused(capsys):
    make_object([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    code, _, errors = run(capsys, "--generate")
    assert code == 1
    assert "key some" in errors[0]


def test_a_file_that_was_never_saved_needs_a_path(capsys):
    obj = bar()
    key(obj, 1)
    key(obj, 5, 1)
    code, _, errors = run(capsys, "--generate", "--save")
    assert code == 1
    assert "give --save a path" in errors[0]


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["--save"],
        ["--object", "One"],
        ["--bake", "GIF"],
        ["--bake", "SHAPES", "--filepath", "x.pc2"],
        ["--bake", "SHAPES", "--free"],
        ["--bake", "POINT_CACHE", "--filepath", "x.pc2"],
        ["--generate", "--step", "0"],
        ["--generate", "--start", "one"],
        ["--generate", "--colour"],
        ["--bake", "SHAPES", "--play"],
        ["--play", "--replace"],
        ["--generate", "--filepath", "x.pc2", "--object", "One"],
        ["One", "--generate"],
    ],
)
def test_wrong_usage_is_exit_code_2(shot, capsys, arguments):
    before = stored(bpy.data.objects["One"])
    code, lines, errors = run(capsys, *arguments)
    assert code == 2
    assert lines == []
    assert errors[0].startswith("usage: blender -b FILE.blend --command planar")
    assert stored(bpy.data.objects["One"]) == before


def test_an_error_of_our_own_is_exit_code_1_with_its_traceback(shot, capsys, monkeypatch):
    from planar_deform.scene.inbetweens import planning

    monkeypatch.delattr(planning, "plan")
    code, _, errors = run(capsys, "--generate", "--save")
    assert code == 1
    assert "Traceback" in errors[0]


def test_main_ends_blender_with_the_code(shot, monkeypatch):
    from planar_deform import batch

    with pytest.raises(SystemExit) as end:
        batch.main(["--help"])
    assert end.value.code == 0
    monkeypatch.setattr("sys.argv", ["blender", "-b", "x.blend", "--", "--object", "One", "--generate"])
    with pytest.raises(SystemExit) as end:
        batch.main()
    assert end.value.code == 0
    assert len(bpy.data.objects["One"].data.shape_keys.key_blocks) == 2 + 3 + 14
