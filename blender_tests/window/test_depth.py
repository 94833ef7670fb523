# SPDX-License-Identifier: GPL-3.0-or-later
"""Depths by the sidebar's buttons, seen in colours for a moment; the viewport draws an arm in one piece."""

import os
from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, pin, ready, shape, sheet
from harness import PICTURES, Window

LEFT, RIGHT = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0)


def mean(window: Window, where: tuple[int, int]) -> np.ndarray:
    return np.mean(window.colours(where, 4), axis=0)


def test_a_button_a_tint_and_undo(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    bpy.ops.planar.select_pins(action="SELECT", pin=1)
    bpy.ops.ed.undo_push(message="Select")
    yield from window.sidebar()
    before, place = shape(), window.pixel((1.1, 0.0, 0.6))
    plain = mean(window, place)
    yield from window.push("planar.set_depth")
    yield from window.wait(0.3)
    depth = active().planar.pins[1].depth
    assert abs(abs(depth) - 1.0) < 1e-3
    tinted = mean(window, place)
    assert (tinted[0] - tinted[2]) * np.sign(depth) > 40.0, "warm in front, cold behind"
    window.picture("depth-tint")
    yield from window.wait(2.5)
    assert np.allclose(mean(window, place), plain, atol=3.0), "for a moment"
    yield from window.move(window.pixel((0.0, 0.0, 1.5)))
    yield from window.undo()
    assert np.array_equal(shape(), before)
    yield from window.redo()
    assert abs(active().planar.pins[1].depth - depth) < 1e-3


def arm_across() -> bpy.types.Object:
    """A strip, red from its middle on, where it turns back and lies across itself."""
    obj = sheet(columns=64, rows=8, cell=0.0625)
    for name, colour in (("Body", (0, 0, 1, 1)), ("Arm", (1, 0, 0, 1))):
        material = bpy.data.materials.new(name)
        material.diffuse_color = colour
        obj.data.materials.append(material)
    for face in obj.data.polygons:
        face.material_index = int(face.center.x > 0.25)
    pin((-1.5, 0.0, 0.0), (1.5, 0.0, 0.0))
    for item in obj.planar.pins:
        item.select = item == obj.planar.pins[1]
    points = shape(obj).astype(float)
    turned = (points[:, 0] - 0.3 + 1j * (points[:, 2] - 0.3)) * np.exp(1j * np.radians(200.0))
    right = points[:, 0] > 0.25
    points[right, 0], points[right, 2] = 0.3 + turned[right].real, 0.3 + turned[right].imag
    obj.data.vertices.foreach_set("co", points.astype(np.float32).ravel())
    obj.data.update()
    bpy.ops.ed.undo_push(message="Arm")
    return obj


def shreds(window: Window) -> tuple[int, int]:
    """Pixels unlike both neighbours in their row, which are alike; and how many are red."""
    radius = 100  # the sharp bend is outside
    width = 2 * radius + 1
    picture = np.array(window.colours(window.pixel((-0.7, 0.0, 0.0)), radius), int).reshape(width, width, 3)
    red = picture[:, :, 0] - picture[:, :, 2] > 60
    blue = picture[:, :, 2] - picture[:, :, 0] > 60
    alone = red[:, 1:-1] & blue[:, :-2] & blue[:, 2:]
    alone |= blue[:, 1:-1] & red[:, :-2] & red[:, 2:]
    return int(alone.sum()), int(red.sum())


def test_the_solid_view_draws_it_in_one_piece(window: Window) -> Iterator[None]:
    arm_across()
    space = window.area.spaces.active
    space.overlay.show_overlays, space.show_gizmo = False, False
    space.shading.type, space.shading.light, space.shading.color_type = "SOLID", "FLAT", "MATERIAL"
    found = {}
    for direction, turn in (("FRONT", None), ("BACK", (0.0, 0.0, 0.7071068, 0.7071068))):
        yield from window.look("FRONT", 5.0)
        if turn is not None:
            window.view.view_rotation = turn
        for depth in (0.0, 2.0, -2.0):
            assert bpy.ops.planar.set_depth(depth=depth) == {"FINISHED"}
            window.area.tag_redraw()
            yield from window.wait(0.5)
            found[direction, depth] = shreds(window)
            window.picture(f"depth-{direction.lower()}{depth:+.0f}")
    for direction in ("FRONT", "BACK"):
        for depth in (2.0, -2.0):
            assert found[direction, depth][0] <= 6, (direction, depth)
    in_front = found["FRONT", 2.0][1] > found["FRONT", -2.0][1]
    assert (found["BACK", 2.0][1] > found["BACK", -2.0][1]) != in_front, f"as with paper: {found}"


def glowing(obj: bpy.types.Object) -> None:
    """Its materials have their colours whatever the light; of the kind that cutouts have."""
    for material in obj.data.materials:
        if material.node_tree is None:  # from Blender 5.0 on each has one
            material.use_nodes = True
        nodes = material.node_tree.nodes
        nodes.clear()
        emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
        emission.inputs["Color"].default_value = material.diffuse_color
        material.node_tree.links.new(emission.outputs[0], output.inputs[0])
        assert material.surface_render_method == "DITHERED"


def rendered(engine: str, path: str) -> np.ndarray:
    """The picture of the scene's camera, rows x columns x rgba."""
    scene, size = bpy.context.scene, 96
    render = scene.render
    render.engine, render.filepath = engine, path
    render.resolution_x = render.resolution_y = size
    render.filter_size, render.film_transparent, render.dither_intensity = 0.01, True, 0.0
    scene.view_settings.view_transform = "Standard"
    scene.display.shading.light, scene.display.shading.color_type = "FLAT", "MATERIAL"
    scene.display.render_aa, scene.eevee.taa_render_samples = "OFF", 1
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    pixels = np.empty(4 * size * size, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(size, size, 4)


def test_eevee_draws_the_same_as_workbench(window: Window) -> Iterator[None]:
    obj = arm_across()
    glowing(obj)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", 4.0
    kinds = bpy.types.RenderSettings.bl_rna.properties["engine"].enum_items_static.keys()
    eevee = next((kind for kind in kinds if kind.startswith("BLENDER_EEVEE")), "BLENDER_EEVEE")
    red = {}
    for behind in (False, True):
        camera.location = (0.0, 8.0 if behind else -8.0, 0.0)
        camera.rotation_euler = (np.pi / 2, 0.0, np.pi if behind else 0.0)
        for depth in (2.0, -2.0):
            assert bpy.ops.planar.set_depth(depth=depth) == {"FINISHED"}
            yield
            name = f"{PICTURES}/depth-{'behind' if behind else 'front'}{depth:+.0f}"
            seen = [rendered(engine, f"{name}-{engine}.png") for engine in ("BLENDER_WORKBENCH", eevee)]
            arms = [(one[:, :, 0] > one[:, :, 2]) & (one[:, :, 3] > 0.4) for one in seen]
            assert (seen[0][:, :, 3] > 0.4).sum() > 500
            clear = np.s_[:, 46:] if behind else np.s_[:, :50]  # of the sharp bend
            assert np.count_nonzero((arms[0] != arms[1])[clear]) <= 4, (behind, depth)
            red[behind, depth] = int(arms[1].sum())
    more = {depth: red[False, depth] - red[True, depth] for depth in (2.0, -2.0)}
    assert min(map(abs, more.values())) > 50, f"one side has the arm in front: {red}"
    assert more[2.0] * more[-2.0] < 0


if not os.environ.get("PLANAR_WHOLE"):  # without a graphics card Blender makes EEVEE's shaders for a minute
    del test_eevee_draws_the_same_as_workbench
