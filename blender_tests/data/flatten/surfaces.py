# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces in space to lay flat, and what their flat meshes and UV maps hold."""

import bpy
import numpy as np
from support import activate, coordinates, make_object, world


def tube(around=24, along=6, *, radius=0.5, length=2.0, share=1.0, name="Tube"):
    """A tube of quads along Z, or a share of it. All round, it has a seam along its first column of edges."""
    columns = around + (share < 1.0)
    angles = 2.0 * np.pi * share * np.arange(columns) / around
    rows = np.linspace(0.0, length, along + 1)
    vertices = [(radius * np.cos(a), radius * np.sin(a), z) for z in rows for a in angles]
    faces = [
        (
            j * columns + i,
            j * columns + (i + 1) % columns,
            (j + 1) * columns + (i + 1) % columns,
            (j + 1) * columns + i,
        )
        for j in range(along)
        for i in range(around)
    ]
    obj = make_object(vertices, faces, name=name)
    if share == 1.0:
        mark(obj, [(j * columns, (j + 1) * columns) for j in range(along)])
    return obj


def cap(rings=8, around=24, *, angle=1.0, name="Cap"):
    """A cap of the unit sphere up to an angle from the pole: it cannot be unrolled. n-gon at the pole."""
    vertices = [
        (np.sin(t) * np.cos(a), np.sin(t) * np.sin(a), np.cos(t))
        for t in np.linspace(angle / rings, angle, rings)
        for a in 2.0 * np.pi * np.arange(around) / around
    ]
    faces = [tuple(range(around))]
    faces += [
        (
            j * around + i,
            (j + 1) * around + i,
            (j + 1) * around + (i + 1) % around,
            j * around + (i + 1) % around,
        )
        for j in range(rings - 1)
        for i in range(around)
    ]
    return make_object(vertices, faces, name=name)


def cube(*, seams=True, name="Cube"):
    """All its edges are seams, or none."""
    vertices = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    obj = make_object(vertices, faces, name=name)
    obj.data.edges.foreach_set("use_seam", [seams] * len(obj.data.edges))
    return obj


def mark(obj, pairs):
    wanted = {tuple(sorted(pair)) for pair in pairs}
    for edge in obj.data.edges:
        edge.use_seam = edge.use_seam or tuple(sorted(edge.vertices)) in wanted


def flatten(obj, **options):
    """Its flat mesh."""
    activate(obj)
    assert bpy.ops.planar.flatten(**options) == {"FINISHED"}
    assert bpy.context.object != obj
    return bpy.context.object


def numbers(mesh, name):
    return np.array([item.value for item in mesh.attributes[name].data])


def surface_vertices(flat):
    return numbers(flat.data, "planar_surface_vertex") - 1


def stretches(obj, flat):
    """The length of each edge of faces in the flat mesh against that on the surface, as both are seen."""
    there, here = world(obj)[surface_vertices(flat)], world(flat)
    ends = np.array([edge.vertices[:] for edge in flat.data.edges])
    lengths = [np.linalg.norm(places[ends[:, 0]] - places[ends[:, 1]], axis=1) for places in (here, there)]
    return lengths[0] / lengths[1]


def uvs(obj, name=None):
    layer = obj.data.uv_layers[name] if name else obj.data.uv_layers.active
    found = np.empty(2 * len(layer.uv), np.float32)
    layer.uv.foreach_get("vector", found)
    return found.reshape(-1, 2)


def uv_ratios(obj, matrix=None):
    """UV length against length as seen, of each edge of each face."""
    places, uv = world(obj), uvs(obj)
    ratios = []
    for face in obj.data.polygons:
        corners = list(face.loop_indices)
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            ends = [obj.data.loops[corner].vertex_index for corner in (a, b)]
            ratios.append(np.linalg.norm(uv[a] - uv[b]) / np.linalg.norm(places[ends[0]] - places[ends[1]]))
    return np.array(ratios)


def signed_area(uv):
    x, y = uv[:, 0], uv[:, 1]
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def all_of(*objects):
    """All that a refusal must leave as it is."""
    found = [sorted(bpy.data.objects.keys()), sorted(bpy.data.meshes.keys()), bpy.context.mode]
    found.append(bpy.context.object.name)
    found.append(sorted(obj.name for obj in bpy.context.selected_objects))
    for obj in objects:
        mesh = obj.data
        found.append(coordinates(mesh.vertices).tobytes())
        found.append([(layer.name, uvs(obj, layer.name).tobytes()) for layer in mesh.uv_layers])
        found.append([(item.name, item.data_type, len(item.data)) for item in mesh.attributes])
        found.append([(pin.name, pin.has_target, tuple(pin.target)) for pin in obj.planar.pins])
        found.append((obj.planar.uv_scale, tuple(obj.planar.uv_offset), obj.planar.live_uv))
    return found


def pushed(flat):
    activate(flat)
    assert bpy.ops.planar.push_to_uv_map() == {"FINISHED"}


def pin_at(flat, *vertices):
    activate(flat)
    for vertex in vertices:
        assert bpy.ops.planar.add_pin(location=world(flat)[vertex].tolist()) == {"FINISHED"}


def linked(obj, flat):
    """Whether each corner of the surface has its flat mesh's place, in one scale."""
    places = coordinates(flat.data.vertices)[:, [0, 2]]
    corners = numbers(flat.data, "planar_surface_corner") - 1
    of_flat = np.array([loop.vertex_index for loop in flat.data.loops])
    expected = places[of_flat] * flat.planar.uv_scale + np.array(flat.planar.uv_offset)
    return np.abs(uvs(obj)[corners] - expected).max() < 1e-6


def live(obj):
    flat = flatten(obj)
    flat.planar.live_uv = True
    pin_at(flat, 0, len(flat.data.vertices) - 1)
    return flat


def refreshed(flat, **options):
    activate(flat)
    assert bpy.ops.planar.refresh_from_surface(**options) == {"FINISHED"}
