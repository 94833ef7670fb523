# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers of what is stored: files from before there were any, files of the future, and all between."""

import bpy
import numpy as np
import pytest
from sequences import go_to, key, stored
from support import activate, add_end_pins, bar, coordinates, pose

FUTURE = 99


def numbers(obj):
    return obj.planar.version, obj.data.planar_version


def keyed_bar():
    obj = bar()
    add_end_pins(obj)
    for seed, frame in enumerate((1, 25, 49)):
        key(obj, frame, seed)
    go_to(1)  # where any other file is, too
    return obj


def pinned_bar():
    obj = bar()
    add_end_pins(obj)
    pose(obj, offset=(0.1, 0.3))
    return obj


def raw(owner):
    """What Blender stores of us for a data-block, known to this version or not."""
    system = getattr(owner, "bl_system_properties_get", None)  # from 5.0
    held = owner if system is None else system()
    return {
        name: value.to_dict() if hasattr(value, "to_dict") else value
        for name in ("planar", "planar_version")
        if held is not None and (value := held.get(name)) is not None
    }


def everything(obj):
    """All that is ours, and all that we could write to."""
    attributes = [
        coordinates(obj.data.attributes[name].data, "vector").tobytes()
        for name in ("planar_rest",)
        if name in obj.data.attributes
    ]
    shapes = None if obj.data.shape_keys is None else stored(obj)
    groups = [group.name for group in obj.vertex_groups]
    active = obj.active_shape_key_index
    return (
        raw(obj),
        raw(obj.data),
        attributes,
        shapes,
        coordinates(obj.data.vertices).tobytes(),
        groups,
        active,
    )


def save_as_it_is(path, monkeypatch):
    """Without what the add-on does on save."""
    from planar_deform.scene.storage import migration

    with monkeypatch.context() as patched:
        patched.setattr(migration, "migrate_all", lambda: None)
        bpy.ops.wm.save_as_mainfile(filepath=path)


@pytest.fixture(params=["keyed", "pinned"])
def old_file(request, tmp_path, monkeypatch):
    """A file as it was saved before there were numbers, and what was in it."""
    obj = {"keyed": keyed_bar, "pinned": pinned_bar}[request.param]()
    obj.planar.property_unset("version")
    obj.data.property_unset("planar_version")
    assert "version" not in raw(obj)["planar"]
    assert raw(obj.data) == {}
    path = str(tmp_path / "old.blend")
    save_as_it_is(path, monkeypatch)
    held = everything(obj)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return path, held


def test_what_is_stored_has_its_numbers_at_once():
    from planar_deform.scene.storage.migration import VERSION

    obj = bar()
    assert numbers(obj) == (0, 0)
    obj.planar.method = "AKVF"
    assert numbers(obj) == (VERSION, 0), "a setting"
    obj = bar()
    bpy.ops.planar.add_pin(location=(0.5, 0.5, 0.0))
    assert numbers(obj) == (VERSION, VERSION), "a pin, and the rest shape"
    obj = bar()
    bpy.ops.planar.key_pose()
    assert obj.planar.version == VERSION, "a pose"
    assert raw(bar()) == {}, "nothing"


def test_a_file_from_before_there_were_numbers_is_migrated_when_it_is_loaded(old_file):
    from planar_deform.scene.storage.migration import VERSION

    path, held = old_file
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Cutout"]
    assert obj.planar.version == VERSION
    assert obj.data.planar_version == (VERSION if "planar_rest" in obj.data.attributes else 0)
    now = everything(obj)
    assert now[2:] == held[2:]
    assert {**now[0]["planar"], "version": None} == {**held[0]["planar"], "version": None}
    activate(obj)
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.1)) == {"FINISHED"}
    assert bpy.ops.planar.key_pose() == {"FINISHED"}


@pytest.mark.parametrize("link", [False, True])
def test_what_comes_from_an_old_file_is_migrated_at_the_latest_when_it_is_saved(old_file, link, tmp_path):
    from planar_deform import compat
    from planar_deform.scene.storage.migration import VERSION

    path, held = old_file
    getattr(bpy.ops.wm, "link" if link else "append")(directory=f"{path}/Object/", filename="Cutout")
    obj = bpy.data.objects["Cutout"]
    if compat.AFTER_IMPORT and not link:
        assert obj.planar.version == VERSION
    if link:
        assert obj.planar.version == 0, "it is not ours to change"
        activate(obj)
        bpy.ops.object.make_local(type="ALL")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "new.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "new.blend"))
    obj = bpy.data.objects["Cutout"]
    assert obj.planar.version == VERSION
    assert obj.data.planar_version == (VERSION if "planar_rest" in obj.data.attributes else 0)
    assert everything(obj)[2:] == held[2:]


def of_the_future(owner):
    """Give what is stored a number of the future, and something that nobody knows yet."""
    system = getattr(owner, "bl_system_properties_get", None)
    held = owner if system is None else system(do_create=True)
    if isinstance(owner, bpy.types.Mesh):
        owner.planar_version = FUTURE
    else:
        owner.planar.version = FUTURE
        held["planar"]["flying_pins"] = [1.0, 2.0, 3.0]


OPERATORS = (
    *("add_pin", "add_pins_from_selected", "add_pins_from_all_groups", "add_pin_from_group", "remove_pins"),
    *("select_pins", "box_select_pins", "set_pin_kind", "set_pin_radius", "disable_pins", "enable_pins"),
    *("set_depth", "dither_materials", "attach", "add_joint", "detach", "set_weld_radius"),
    *("attach_to", "detach_from"),
    *("add_pin_path", "remove_pin_path"),
    *("drag_pins", "rotate_pins", "spread_pins", "settle_pose", "paint_stiffness"),
    *("set_rest_to_current", "reset_to_rest", "reset_selected_pins", "mirror_pose", "paste_pose"),
    *("key_pose", "delete_pose", "jump_to_pose", "clear_poses", "update_pose", "duplicate_pose"),
    *("retime_pose", "step_poses", "generate_inbetweens", "remove_inbetweens", "breakdown", "record_pins"),
    *("edit_sequence", "thin_poses", "transfer_motion", "bake", "refine_mesh", "remesh"),
    *("fit_lattice", "add_to_lattice", "apply_lattice", "follow_now", "bake_pins", "add_controls"),
    *("follow_bones", "set_follow_offset", "clear_follow_offset"),
    *("flatten", "push_to_uv_map", "refresh_from_surface", "export_pattern"),
    *("cutout_from_image", "choose_images", "make_cutout"),
)


def refused(operator):
    """Whether it does nothing: its poll fails, or it reports an error or a warning."""
    try:
        return getattr(bpy.ops.planar, operator)() == {"CANCELLED"}
    except RuntimeError:
        return True


def test_every_operator_that_changes_anything_is_tried_below():
    free = {"click", "guard_key", "pin_menu", "copy_pose", "select_lattice"}
    assert set(dir(bpy.ops.planar)) - free == set(OPERATORS)


@pytest.mark.parametrize("newer", ["object", "mesh"])
@pytest.mark.parametrize("make", [keyed_bar, pinned_bar])
def test_what_has_a_number_of_the_future_is_refused_and_left_as_it_is(make, newer, tmp_path):
    from planar_deform.errors import Refusal
    from planar_deform.scene.objects.any_object import read_shape, shape_refusal

    obj = make()
    obj.planar.stiffness_group = obj.vertex_groups.new(name="Stiffness").name
    go_to(13)
    of_the_future(obj if newer == "object" else obj.data)
    before = everything(obj)
    path = str(tmp_path / "future.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Cutout"]
    activate(obj)
    assert everything(obj) == before
    assert "newer Planar Deform: update the extension" in shape_refusal(obj)
    with pytest.raises(Refusal, match="newer"):
        read_shape(obj)
    for name in OPERATORS:
        assert refused(name), name
        assert everything(obj) == before, name
    go_to(25)
    go_to(13)
    obj.vertex_groups[0].name = "Another"
    obj.data.update()
    bpy.context.view_layer.update()
    assert raw(obj) == before[0]
    obj.vertex_groups[0].name = before[5][0]
    bpy.context.view_layer.update()
    assert everything(obj) == before
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert everything(bpy.data.objects["Cutout"]) == before


def test_a_joined_rest_shape_has_its_number_when_it_is_saved(tmp_path):
    from planar_deform.scene.storage.migration import VERSION

    obj = pinned_bar()
    plain = bar(name="Plain")
    obj.select_set(True)
    bpy.context.view_layer.update()
    bpy.ops.object.join()
    assert plain.data.planar_version == VERSION
    assert "planar_rest" in plain.data.attributes
    path = str(tmp_path / "joined.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert bpy.data.objects["Plain"].data.planar_version == VERSION


def test_a_farm_s_job_refuses_what_is_newer(capfd):
    from planar_deform import batch

    obj = keyed_bar()
    of_the_future(obj)
    before = everything(obj)
    assert batch.run(["--object", "Cutout", "--generate"]) == batch.FAILED
    assert "newer Planar Deform" in capfd.readouterr().err
    assert everything(obj) == before
    assert np.isfinite(coordinates(obj.data.vertices)).all()
