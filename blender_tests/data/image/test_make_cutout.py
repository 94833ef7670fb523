# SPDX-License-Identifier: GPL-3.0-or-later
"""Make Cutout: image planes as they are found in files, however they stand and whatever they show."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from pictures import (
    blobs,
    blocks,
    corner_places,
    corner_uvs,
    covered,
    letter,
    new_image,
    pixels_of,
    plane,
    save,
)
from support import TRANSFORMS, activate, add_pins, make_object

CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
TURNS = {
    "upright": CORNERS,
    "turned": CORNERS[[1, 2, 3, 0]],
    "mirrored": CORNERS[[1, 0, 3, 2]],
    "a part": CORNERS * [0.6, 0.5] + [0.1, 0.4],
}


def make(*objects, vertices=300, **options):
    bpy.context.view_layer.update()
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in objects)
    bpy.context.view_layer.objects.active = objects[0]
    return bpy.ops.planar.make_cutout(vertices=vertices, **options)


def shown_map(obj):
    """The affine map from the UV map to the world, 3 x 3, and how far it is off."""
    rows = np.insert(corner_uvs(obj.data).astype(np.float64), 2, 1.0, axis=1)
    places = corner_places(obj)
    linear = np.linalg.lstsq(rows, places, rcond=None)[0]
    return linear, np.abs(rows @ linear - places).max()


def image_plane(image, uvs=CORNERS, *, name="Plane"):
    """A plane somebody made: a quad with a material that shows the image."""
    width, height = image.size
    obj = make_object(
        np.insert((CORNERS - 0.5) * [width / 100, height / 100], 2, 0.0, axis=1), [[0, 1, 2, 3]], name=name
    )
    obj.data.uv_layers.new(name="Map").data.foreach_set("uv", uvs.astype(np.float32).ravel())
    material = bpy.data.materials.new(name)
    if material.node_tree is None:  # from 5.0 each has one
        material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.links.new(
        node.outputs["Color"], material.node_tree.nodes["Principled BSDF"].inputs["Base Color"]
    )
    obj.data.materials.append(material)
    return obj


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("transform", ["none", "rotated", "mirrored", "sheared", "huge and far"])
def test_every_pixel_stays_where_it_is_seen(turn, transform):
    obj = image_plane(new_image(letter()), TURNS[turn])
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.matrix_world = TRANSFORMS[transform]
    obj.parent = parent
    obj.matrix_parent_inverse = Matrix.Translation((0.5, 0, 0))
    obj.rotation_euler = (1.0, 0.2, 0.3)
    bpy.context.view_layer.update()
    matrix, before, normal = obj.matrix_world.copy(), shown_map(obj)[0], obj.data.polygons[0].normal.copy()
    assert make(obj) == {"FINISHED"}
    after, miss = shown_map(obj)
    pixel = np.linalg.norm(before[:2], axis=1) / [80, 120]
    assert max(np.abs(after - before).max(), miss) < 0.05 * pixel.max(), "to half a pixel, and rather better"
    assert obj.matrix_world == matrix
    assert obj.parent == parent
    assert all((face.normal - normal).length < 1e-3 for face in obj.data.polygons)
    shown = covered(obj, letter().shape)
    window = np.zeros_like(shown)
    low, high = TURNS[turn].min(axis=0) * [80, 120], TURNS[turn].max(axis=0) * [80, 120]
    window[round(low[1]) : round(high[1]), round(low[0]) : round(high[0])] = True
    assert shown[letter() & window].all()
    assert np.count_nonzero(shown) < 1.6 * np.count_nonzero(letter() & window)


def test_a_render_of_it_is_the_plane_s(tmp_path):
    obj = plane(tmp_path)
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    camera.location, camera.rotation_euler = (0.0, -2.0, 0.0), (np.pi / 2, 0.0, 0.0)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 0.24
    scene.camera, scene.render.engine, scene.cycles.samples = camera, "CYCLES", 1
    scene.render.resolution_x = scene.render.resolution_y = 96
    scene.render.film_transparent = True
    scene.cycles.max_bounces = scene.cycles.transparent_max_bounces = 4

    def picture(name):
        scene.render.filepath = str(tmp_path / name)
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        return np.array(image.pixels).reshape(96, 96, 4)[..., 3]

    before = picture("before.png")
    assert 0.1 < before.mean() < 0.9
    make(obj)
    assert np.abs(picture("after.png") - before).max() < 0.02


def test_it_stays_the_same_object_with_its_material(tmp_path):
    obj = plane(tmp_path)
    material, name = obj.active_material, obj.data.name
    constraint = obj.constraints.new("LIMIT_LOCATION")
    before = blocks()
    make(obj)
    assert (obj.active_material, obj.data.name, obj.constraints[0]) == (material, name, constraint)
    assert blocks() == before
    assert bpy.context.object == obj


def test_copies_that_share_the_mesh_keep_it(tmp_path):
    obj = plane(tmp_path)
    copy = obj.copy()
    bpy.context.scene.collection.objects.link(copy)
    make(obj)
    assert len(copy.data.polygons) == 1
    assert len(obj.data.polygons) > 100


def test_all_uv_maps_show_what_they_showed():
    obj = image_plane(new_image(letter()))
    other = obj.data.uv_layers.new(name="Light")
    other.data.foreach_set("uv", (CORNERS[[1, 2, 3, 0]] * 0.5 + 0.25).astype(np.float32).ravel())
    obj.data.uv_layers.active = other
    make(obj)
    assert obj.data.uv_layers.keys() == ["Map", "Light"]
    assert obj.data.uv_layers.active.name == "Light"
    first, light = (np.array([corner.uv for corner in layer.data]) for layer in obj.data.uv_layers)
    turned = np.stack([1.0 - first[:, 1], first[:, 0]], axis=1) * 0.5 + 0.25
    assert np.abs(light - turned).max() < 1e-6


def test_the_uv_map_that_the_texture_uses_counts():
    obj = image_plane(new_image(letter()), CORNERS * 0.1)
    mine = obj.data.uv_layers.new(name="Mine")
    mine.data.foreach_set("uv", CORNERS.astype(np.float32).ravel())
    nodes = obj.active_material.node_tree
    uv_node = nodes.nodes.new("ShaderNodeUVMap")
    uv_node.uv_map = "Mine"
    nodes.links.new(uv_node.outputs["UV"], nodes.nodes["Image Texture"].inputs["Vector"])
    make(obj)
    obj.data.uv_layers.active = obj.data.uv_layers["Mine"]
    assert covered(obj, letter().shape)[letter()].all()


def test_the_material_that_the_faces_have_counts():
    """Not that of the active slot, which a click in the list chooses."""
    obj = image_plane(new_image(blobs((40, 60))), name="First")
    other = image_plane(new_image(letter()), name="Second")
    obj.data.materials.append(other.active_material)
    obj.data.polygons[0].material_index, obj.active_material_index = 1, 0
    make(obj)
    assert covered(obj, letter().shape)[letter()].all()
    assert {face.material_index for face in obj.data.polygons} == {1}
    assert obj.data.materials.keys() == ["First", "Second"]


def test_faces_that_show_no_image_or_several_are_refused():
    obj = image_plane(new_image(letter()))
    obj.data.materials.append(bpy.data.materials.new("Plain"))
    obj.data.polygons[0].material_index, obj.active_material_index = 1, 0
    with pytest.raises(RuntimeError, match="'Plane' shows no image: give its material an Image Texture"):
        make(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide(number_cuts=1)
    bpy.ops.object.mode_set(mode="OBJECT")
    obj.data.polygons[2].material_index = 0
    with pytest.raises(RuntimeError, match="A face of 'Plane' shows no image"):
        make(obj)
    obj.data.materials[1] = image_plane(new_image(letter()), name="Other").active_material
    with pytest.raises(RuntimeError, match="The faces of 'Plane' have several materials: separate them"):
        make(obj)
    assert len(obj.data.polygons) == 4


def test_a_texture_that_leads_nowhere_does_not_hide_the_one_that_is_shown():
    obj = image_plane(new_image(letter()))
    tree = obj.active_material.node_tree
    stray = tree.nodes.new("ShaderNodeTexImage")
    stray.image, tree.nodes.active = new_image(blobs((40, 60)), name="Stray"), stray
    make(obj)
    assert covered(obj, letter().shape)[letter()].all()


def test_a_texture_behind_other_nodes_is_found():
    obj = image_plane(new_image(letter()))
    tree = obj.active_material.node_tree
    shown, shader = tree.nodes["Image Texture"], tree.nodes["Principled BSDF"]
    invert, bend = tree.nodes.new("ShaderNodeInvert"), tree.nodes.new("NodeReroute")
    tree.links.new(shown.outputs["Color"], invert.inputs["Color"])
    tree.links.new(invert.outputs["Color"], bend.inputs[0])
    tree.links.new(bend.outputs[0], shader.inputs["Base Color"])
    stray = tree.nodes.new("ShaderNodeTexImage")
    stray.image, tree.nodes.active = new_image(blobs((40, 60)), name="Stray"), stray
    make(obj)
    assert covered(obj, letter().shape)[letter()].all()


def test_where_no_texture_is_linked_the_active_one_counts():
    obj = image_plane(new_image(blobs((40, 60))))
    tree = obj.active_material.node_tree
    tree.links.clear()
    chosen = tree.nodes.new("ShaderNodeTexImage")
    chosen.image, tree.nodes.active = new_image(letter(), name="Chosen"), chosen
    make(obj)
    assert covered(obj, letter().shape)[letter()].all()


def test_attributes_and_custom_properties_stay_where_they_can(capfd):
    obj = image_plane(new_image(letter()), TURNS["turned"])
    mesh = obj.data
    mesh["layer"] = "arm"
    places = np.array([vertex.co for vertex in mesh.vertices])
    low, size = places.min(axis=0), np.ptp(places, axis=0)
    for domain, kind, rows in (("POINT", "FLOAT_COLOR", places), ("CORNER", "FLOAT_COLOR", places)):
        colours = np.insert(((rows - low) / np.maximum(size, 1e-9)), 3, 1.0, axis=1).astype(np.float32)
        mesh.attributes.new(f"Colour {domain}", kind, domain).data.foreach_set("color", colours.ravel())
    mesh.attributes.new("Number", "INT", "FACE").data[0].value = 7
    mesh.attributes.new("Thread", "FLOAT", "EDGE")
    mesh.color_attributes.active_color_name = "Colour CORNER"
    make(obj)
    mesh = obj.data
    assert mesh["layer"] == "arm"
    assert mesh.color_attributes.active_color_name == "Colour CORNER"
    places = np.array([vertex.co for vertex in mesh.vertices])
    corners = np.array([loop.vertex_index for loop in mesh.loops])
    for domain, rows in (("POINT", places), ("CORNER", places[corners])):
        colours = np.array([item.color for item in mesh.attributes[f"Colour {domain}"].data])
        assert (
            np.abs(colours[:, :2] - np.clip((rows - low) / np.maximum(size, 1e-9), 0, 1)[:, :2]).max() < 1e-3
        )
    assert {item.value for item in mesh.attributes["Number"].data} == {7}
    assert "'Plane': without its attributes Thread" in capfd.readouterr().out


def test_the_margin_shows_nothing_of_a_texture_that_repeats():
    obj = image_plane(new_image(np.ones((40, 40), bool) & ~blobs((20, 20), size=(40, 40), radius=8)))
    make(obj)
    assert obj.active_material.node_tree.nodes["Image Texture"].extension == "CLIP"
    inside = image_plane(new_image(letter()))
    make(inside)
    assert inside.active_material.node_tree.nodes["Image Texture"].extension == "REPEAT"


def test_packed_and_painted_images(tmp_path):
    packed = plane(tmp_path)
    image = bpy.data.images["plane.png"]
    image.pack()
    (tmp_path / "plane.png").unlink()
    make(packed)
    assert covered(packed, letter().shape)[letter()].all()
    image.pixels.foreach_set(pixels_of(blobs((40, 60))).ravel())
    again = image_plane(image)
    make(again)
    assert not covered(again, letter().shape)[letter() & ~blobs((40, 60), radius=24)].any()


def test_several_planes_at_once_and_their_islands(tmp_path):
    first = image_plane(new_image(letter()), name="First")
    second = image_plane(new_image(blobs((20, 60), (60, 60), radius=10)), name="Second")
    second.location = (3.0, 0.0, 0.0)
    make(first, second, separate_islands=True)
    assert {obj.name for obj in bpy.context.selected_objects} == {"First", "Second", "Second.001"}
    assert bpy.data.objects["Second.001"].location.x == 3.0
    assert bpy.context.object == first


def test_islands_are_in_all_collections_of_the_plane():
    obj = image_plane(new_image(blobs((20, 60), (60, 60), radius=10)))
    names = {collection.name for collection in obj.users_collection}
    for name in ("Characters", "Render"):
        collection = bpy.data.collections.new(name)
        bpy.context.scene.collection.children.link(collection)
        collection.objects.link(obj)
    make(obj, separate_islands=True)
    for island in bpy.data.objects:
        assert {found.name for found in island.users_collection} == names | {"Characters", "Render"}
    assert len(bpy.data.objects) == 2


def test_an_image_plane_of_a_sequence(tmp_path):
    for number, place in enumerate([(20, 40), (60, 80)], start=1):
        save(tmp_path, f"run{number}.png", blobs(place))
    image = bpy.data.images.load(str(tmp_path / "run1.png"))
    obj = image_plane(image)
    image.source = "SEQUENCE"
    obj.active_material.node_tree.nodes["Image Texture"].image_user.frame_duration = 2
    make(obj)
    assert covered(obj, (120, 80))[blobs((20, 40), (60, 80))].all()
    assert len(bpy.data.images) == 1
    (tmp_path / "run2.png").unlink()
    (tmp_path / "run1.png").unlink()
    with pytest.raises(RuntimeError, match="There is no file .*run1.png"):
        make(image_plane(image))


def test_a_plane_lying_with_vertices_of_its_own_stays_flat_and_can_be_posed(tmp_path):
    obj = plane(tmp_path)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide(number_cuts=3)
    bpy.ops.object.mode_set(mode="OBJECT")
    make(obj)
    assert all(len(face.vertices) == 3 for face in obj.data.polygons)
    add_pins(obj, [0])
    assert bpy.ops.planar.drag_pins(offset=(0.02, 0.0)) == {"FINISHED"}


# ---- what is refused


def _tiled(obj):
    texture(obj).image.source = "TILED"


def _movie(obj):
    texture(obj).image.source = "MOVIE"


def _generated(obj):
    texture(obj).image = bpy.data.images.new("Blank", 64, 64)


def _gone(obj):
    texture(obj).image.source = "FILE"
    texture(obj).image.filepath = "//none.png"
    texture(obj).image.reload()


def _bent(obj):
    obj.data.vertices[0].co.z += 1.0
    obj.data.vertices[1].co.x -= 0.4


def _no_map(obj):
    obj.data.uv_layers.remove(obj.data.uv_layers[0])


def _no_image(obj):
    texture(obj).image = None


def _mapped(obj):
    nodes = obj.active_material.node_tree
    mapping = nodes.nodes.new("ShaderNodeMapping")
    nodes.links.new(mapping.outputs[0], texture(obj).inputs["Vector"])


def _pinned(obj):
    add_pins(obj, [0])


def _keyed(obj):
    obj.shape_key_add(name="Basis")


def texture(obj):
    return obj.active_material.node_tree.nodes["Image Texture"]


NOT_PLANES = {
    "UDIM": (_tiled, "several tiles .UDIM.: give the material a single image"),
    "movie": (_movie, "is a movie: render it to images"),
    "generated": (_generated, "generated by Blender and plain: paint on it, or open a file"),
    "file is gone": (_gone, "There is no file .*none.png"),
    "bent": (_bent, "is no image plane, its faces do not lie in a plane .*: add the image with Add > Image"),
    "no UV map": (_no_map, "has no UV map: unwrap it"),
    "no image": (_no_image, "shows no image: give its material an Image Texture"),
    "mapped by a node": (_mapped, "laid on by the node 'Mapping': disconnect it"),
    "pins": (_pinned, "has pins, .*: use Object > Planar > Cutout > Remesh Cutout, which"),
    "shape keys": (_keyed, "has pins, .*: use Object > Planar > Cutout > Remesh Cutout, which"),
}


@pytest.mark.parametrize("kind", NOT_PLANES)
def test_what_is_no_image_plane_is_told_with_a_remedy_and_stays(kind):
    spoil, told = NOT_PLANES[kind]
    obj = image_plane(new_image(letter()))
    good = image_plane(new_image(letter()), name="Good")
    spoil(obj)
    before = blocks()
    with pytest.raises(RuntimeError, match=told):
        make(good, obj)
    assert blocks() == before
    assert len(obj.data.polygons) == len(good.data.polygons) == 1


def test_a_pinned_plane_is_cut_out_by_the_operator_that_the_refusal_names(tmp_path):
    obj = plane(tmp_path)
    place, corner = obj.location.copy(), obj.matrix_world @ obj.data.vertices[0].co
    add_pins(obj, [0])
    with pytest.raises(RuntimeError, match="Object > Planar > Cutout > Remesh Cutout"):
        make(obj)
    assert bpy.ops.planar.remesh(vertices=300) == {"FINISHED"}
    assert covered(obj, letter().shape)[letter()].all()
    assert np.count_nonzero(covered(obj, letter().shape)) < 1.6 * np.count_nonzero(letter())
    assert (obj.location, len(obj.planar.pins)) == (place, 1)
    assert min((obj.matrix_world @ vertex.co - corner).length for vertex in obj.data.vertices) < 0.03
    assert bpy.ops.planar.drag_pins(offset=(0.02, 0.0)) == {"FINISHED"}


def test_a_result_of_rendering_is_refused():
    from planar_deform.errors import Refusal
    from planar_deform.scene.image.reading import size_of

    with pytest.raises(Refusal, match="'Render Result' is a result of rendering: save it, and use the file"):
        size_of(SimpleNamespace(name="Render Result", source="VIEWER"))


def test_things_that_are_no_meshes_are_refused():
    empty = bpy.data.objects.new("Reference", None)
    empty.empty_display_type, empty.data = "IMAGE", new_image(letter())
    bpy.context.scene.collection.objects.link(empty)
    activate(empty)
    with pytest.raises(RuntimeError, match="is an image empty: convert it first, with Object > Convert"):
        make(empty)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    with pytest.raises(RuntimeError, match="'Camera' is no mesh: select planes that show an image"):
        make(camera)
    camera.select_set(False)
    with pytest.raises(RuntimeError, match="Select planes that show an image"):
        bpy.ops.planar.make_cutout()


def test_a_linked_object_is_refused(tmp_path):
    obj = plane(tmp_path)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "library.blend"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (found, wanted):
        wanted.objects = found.objects
    obj = wanted.objects[0]
    bpy.context.scene.collection.objects.link(obj)
    activate(obj)
    with pytest.raises(RuntimeError, match="is linked from a library: make it local"):
        make(obj)


@pytest.fixture
def shown(monkeypatch):
    """The preview as a window would draw it, in which the operator has been the last one."""
    from planar_deform.scene.image import preview

    layer = bpy.context.view_layer
    done = SimpleNamespace(operators=[SimpleNamespace(bl_idname="PLANAR_OT_make_cutout")])
    yield lambda: preview.now(SimpleNamespace(window_manager=done, view_layer=layer))
    preview.forget()


def test_the_preview_goes_with_its_object_and_with_a_refusal(shown):
    for vanish in (bpy.data.objects.remove, _back_to_a_quad, _refused):
        obj = image_plane(new_image(letter()))
        make(obj)
        assert shown() is not None
        vanish(obj)
        assert shown() is None, vanish


def _back_to_a_quad(obj):
    obj.data = image_plane(new_image(letter()), name="Quad").data


def _refused(obj):
    with pytest.raises(RuntimeError, match="cannot be cut out"):
        make(image_plane(new_image(letter() & False), name="Clear"))
    assert len(obj.data.polygons) > 1


def test_undo(tmp_path):
    obj = plane(tmp_path)
    bpy.ops.ed.undo_push(message="Start")
    make(obj)
    bpy.ops.ed.undo_push(message="Cutout")
    bpy.ops.ed.undo()
    assert len(bpy.data.objects["plane"].data.polygons) == 1
    bpy.ops.ed.redo()
    assert len(bpy.data.objects["plane"].data.polygons) > 100
