# SPDX-License-Identifier: GPL-3.0-or-later
"""What run.py has done inside of a Blender, each step in a process of its own:

    blender --background --python steps.py -- STEP [ARGUMENT]      or      python steps.py -- STEP [ARGUMENT]

A step prints one line of JSON after "RESULT "; an exception is a failure.
"""

import json
import sys
from pathlib import Path

import bpy

MODULE = "bl_ext.user_default.planar_deform"


def registered():
    """Everything of ours that Blender knows about now."""
    from bl_ui.space_toolsystem_toolbar import VIEW3D_PT_tools_active

    def classes(parent):
        for child in parent.__subclasses__():
            yield child
            yield from classes(child)

    def ours(thing):
        return getattr(thing, "__module__", "").startswith(MODULE)

    handlers = [getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)]
    # Not the user's key configuration: Blender merges it from these when a window next gets an event.
    configs = bpy.context.window_manager.keyconfigs
    keymaps = [keymap for config in (configs.default, configs.addon) for keymap in config.keymaps]
    owners = ("Object", "Scene", "Mesh", "WindowManager", "AddonPreferences")
    return {
        "add-ons": [addon.module for addon in bpy.context.preferences.addons if addon.module == MODULE],
        "classes": sorted(
            c.__name__
            for c in classes(bpy.types.bpy_struct)
            if ours(c) and getattr(c, "is_registered", False)
        ),
        "operators": sorted(dir(bpy.ops.planar)),
        "properties": [
            f"{owner}.{name}"
            for owner in owners
            for name in getattr(bpy.types, owner).bl_rna.properties.keys()  # noqa: SIM118  not a dict
            if "planar" in name
        ],
        "handlers": sorted(
            f.__name__ for entry in handlers if isinstance(entry, list) for f in entry if ours(f)
        ),
        "keys": sorted(
            {i.idname for km in keymaps for i in km.keymap_items if i.idname.startswith("planar.")}
        ),
        "tools": ["planar"] if "planar." in repr(VIEW3D_PT_tools_active._tools) else [],
    }


def install(archive):
    """What Install from Disk does."""
    bpy.ops.extensions.package_install_files(
        filepath=archive, repo="user_default", enable_on_install=True, overwrite=True
    )
    bpy.ops.wm.save_userpref()
    return registered()


def look():
    return registered()


def drag():
    """Pins on a bar, one of them dragged by AKVF, as a person would from a script."""
    import numpy as np

    import planar_native

    columns, rows = 24, 8
    x, y = np.meshgrid(np.linspace(0, 3, columns + 1), np.linspace(0, 1, rows + 1))
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    faces = np.column_stack([corner, corner + 1, corner + columns + 2, corner + columns + 1])
    mesh = bpy.data.meshes.new("Bar")
    mesh.from_pydata(np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()]).tolist(), [], faces.tolist())
    bar = bpy.data.objects.new("Bar", mesh)
    bpy.context.collection.objects.link(bar)
    bpy.context.view_layer.objects.active = bar
    bar.select_set(True)

    def positions():
        flat = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", flat)
        return flat.reshape(-1, 3)

    before = positions()
    for place in ((0, 0.5, 0), (1.5, 0.5, 0), (3, 0.5, 0)):
        if bpy.ops.planar.add_pin(location=place) != {"FINISHED"}:
            raise AssertionError(f"no pin at {place}")
    if bpy.ops.planar.drag_pins(offset=(-0.4, 0.8)) != {"FINISHED"}:
        raise AssertionError("the drag did not finish")
    after = positions()
    dragged = int(np.argmin(np.hypot(before[:, 0] - 3, before[:, 1] - 0.5)))
    held = int(np.argmin(np.hypot(before[:, 0], before[:, 1] - 0.5)))
    return {
        "dragged": (after[dragged] - before[dragged]).tolist(),
        "held": float(np.linalg.norm(after[held] - before[held])),
        "finite": bool(np.isfinite(after).all()),
        "module": planar_native.__file__,
        "backend": planar_native.build_info()["backend"],
    }


def shot(path):
    """A file with a bar that is posed at three frames, for the headless command."""
    bar = posed_bar("Bar")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    return len(bar.planar.poses)


def show(path, count):
    """A file with so many of them, for a farm."""
    for number in range(int(count)):
        posed_bar(f"Bar {number + 1}")
    bpy.ops.wm.save_as_mainfile(filepath=path)


def posed_bar(name):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)], [], [(0, 1, 2, 3)])
    bar = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(bar)
    bpy.context.view_layer.objects.active = bar
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 9
    bpy.ops.planar.add_pin(location=(1.0, 0.0, 0.5))
    for frame, offset in ((1, 0.0), (5, 1.0), (9, -1.0)):
        scene.frame_set(frame)
        if offset:
            bpy.ops.planar.drag_pins(offset=(offset, 0.0))
        bpy.ops.planar.key_pose()
    return bar


def played(path):
    """By how much that which a point cache plays moves from frame 1 to 5, of each object that has one."""
    bpy.ops.wm.open_mainfile(filepath=path)
    caches = [obj for obj in bpy.data.objects if any(m.type == "MESH_CACHE" for m in obj.modifiers)]
    places = {}
    for frame in (1, 5):
        bpy.context.scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        places[frame] = [obj.evaluated_get(graph).data.vertices[1].co.copy() for obj in caches]
    return {obj.name: (b - a).length for obj, a, b in zip(caches, places[1], places[5], strict=True)}


def evaluate(path, expression):
    """What Flamenco's add-on makes of a setting of a job type when it is submitted from an open file."""
    bpy.ops.wm.open_mainfile(filepath=path)
    return eval(expression, {}, {"bpy": bpy, "C": bpy.context, "Path": Path})


def batch(path, *arguments):
    """The headless command in the bpy module; the program is told it on its command line."""
    import importlib

    bpy.ops.wm.open_mainfile(filepath=path)
    return importlib.import_module(f"{MODULE}.batch").run(arguments)


def disable():
    import addon_utils  # there once bpy is

    addon_utils.disable(MODULE, default_set=True)
    bpy.ops.wm.save_userpref()
    return registered()


def uninstall():
    repos = [repo.module for repo in bpy.context.preferences.extensions.repos]
    bpy.ops.extensions.package_uninstall(repo_index=repos.index("user_default"), pkg_id="planar_deform")
    bpy.ops.wm.save_userpref()
    return registered()


if __name__ == "__main__":
    step, *arguments = sys.argv[sys.argv.index("--") + 1 :]
    if not bpy.app.binary_path and step in ("drag", "shot", "show", "batch", "disable"):
        # A module starts with factory settings, where the program has what its user enabled.
        import addon_utils

        addon_utils.enable(MODULE, default_set=True)
    print("RESULT", json.dumps(globals()[step](*arguments)), flush=True)
