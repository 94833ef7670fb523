# SPDX-License-Identifier: GPL-3.0-or-later
"""An arm across the body, in one drawing, rendered: clean with a depth, from both sides."""

from pathlib import Path

import bpy
import numpy as np
from support import activate, add_end_pins, bar

ARM, BODY = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
PIXELS = 160


def curled(positions):
    """The bar rolled by 210 degrees between 1.6 and 2.6 of its length of 4: its end lies across it."""
    along = np.linspace(0.0, 4.0, 4001)
    turns = np.radians(210.0) * np.clip(along - 1.6, 0.0, 1.0)
    middle = np.cumsum(np.exp(1j * turns)) * (along[1] - along[0]) + 0.25j
    row = np.rint(positions[:, 0] * 1000.0).astype(int)
    placed = middle[row] + 1j * (positions[:, 1] - 0.25) * np.exp(1j * turns[row])
    return np.stack([placed.real, placed.imag], axis=1)


def crossed(depth):
    """A long bar, half of it red and half blue, bent so that its red end lies across the blue one."""
    obj = bar(plane="XZ", nx=40, ny=6)
    obj.scale = (2.0, 1.0, 0.5)
    activate(obj)
    bpy.ops.object.transform_apply()
    for colour, name in ((BODY, "Body"), (ARM, "Arm")):
        material = bpy.data.materials.new(name)
        material.diffuse_color = (*colour, 1.0)
        if material.node_tree is None:  # from Blender 5.0 on each has one
            material.use_nodes = True
        nodes = material.node_tree.nodes
        nodes.clear()
        emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
        emission.inputs["Color"].default_value = (*colour, 1.0)
        material.node_tree.links.new(emission.outputs[0], output.inputs[0])
        obj.data.materials.append(material)
    for face in obj.data.polygons:
        face.material_index = int(face.center.x > 2.1)
    add_end_pins(obj, nx=40, count=287, kind="PATCH")
    from planar_deform.scene.objects.cutout_object import begin

    activate(obj)
    drawing = begin(bpy.context)
    drawing.write(curled(drawing.positions))
    if depth:
        activate(obj)
        assert bpy.ops.planar.set_depth(depth=depth) == {"FINISHED"}
    return obj


def rendered(behind, path):
    """The picture that Cycles makes, rows x columns x rgb. Workbench is looked at in window/test_depth.py."""
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 3.2
    camera.location = (1.2, 8.0 if behind else -8.0, 0.3)
    camera.rotation_euler = (np.pi / 2, 0.0, np.pi if behind else 0.0)
    scene.camera = camera
    render = scene.render
    render.engine, render.resolution_x, render.resolution_y = "CYCLES", PIXELS, PIXELS
    render.filter_size, render.film_transparent = 0.01, True
    scene.view_settings.view_transform = "Standard"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.device = 1, False, "CPU"
    render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    pixels = np.empty(4 * PIXELS * PIXELS, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(PIXELS, PIXELS, 4)[:, :, :3]


def shreds(picture):
    """How many pixels differ in colour from both neighbours, in their row or column, which are alike."""
    arm = picture[:, :, 0] > picture[:, :, 2]
    drawn = picture.max(axis=2) > 0.2
    found = 0
    for kind, there in ((arm, drawn), (arm.T, drawn.T)):
        inside = there[:, :-2] & there[:, 1:-1] & there[:, 2:]
        found += np.count_nonzero(inside & (kind[:, :-2] == kind[:, 2:]) & (kind[:, 1:-1] != kind[:, 2:]))
    return found, arm & drawn


def test_an_arm_across_the_body_is_drawn_in_one_piece():
    out = Path("out/depth")
    out.mkdir(parents=True, exist_ok=True)
    seen = {}
    for depth in (0.0, 3.0, -3.0):
        crossed(depth)
        for behind in (False, True):
            picture = rendered(behind, out / f"cycles{depth:+.0f}{behind:d}.png")
            seen[depth, behind] = shreds(picture)
        bpy.ops.wm.read_factory_settings(use_empty=True)
    assert seen[0.0, False][0] > 40  # this tells shreds
    for depth in (3.0, -3.0):
        for behind in (False, True):
            assert seen[depth, behind][0] <= 4, (depth, behind)
    in_front, hidden = seen[3.0, False][1], seen[-3.0, False][1]
    assert in_front.sum() > hidden.sum() + 200
    assert (in_front | hidden == in_front).all()
    # From behind it is the other way round, as with paper.
    assert np.array_equal(seen[-3.0, True][1], in_front[:, ::-1]) or (
        seen[-3.0, True][1].sum() > seen[3.0, True][1].sum() + 200
    )
