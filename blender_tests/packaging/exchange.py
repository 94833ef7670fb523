#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A file goes from Windows to here and back.

    tools/wine_tests.sh exchange 4.2.23

It is keyed, generated and baked on the one system, played, posed and baked again on the other; here is the
bpy of the same version. Each step is a process of its own, which tells what the file shows: what was saved,
and what is opened on the other system, are the same to a rounding.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from installed import PROJECT, result_in

FRAMES = range(1, 10)
CHOSEN, KEPT = r"//caches\bar.pc2", "//caches/bar.pc2"  # as Windows' file browser tells it, and as it is kept
CLOSE = 1e-6


def state() -> dict:
    import bpy

    from planar_deform.scene.motion import cache_age, point_cache

    obj = bpy.data.objects["Bar"]
    shown = {}
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        drawn = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices
        shown[str(frame)] = [list(vertex.co) for vertex in drawn]
    modifier = point_cache.modifier_of(obj)
    path = point_cache.file_at(modifier.filepath)
    return {
        "kept": modifier.filepath,
        "there": path.is_file() and path.parent.name == "caches",
        "old": cache_age.is_out_of_date(obj),
        "poses": len(obj.planar.poses),
        "shown": shown,
    }


def bake() -> dict:
    from planar_deform import batch

    if batch.run(["--object", "Bar", "--generate", "--bake", "POINT_CACHE", "--filepath", CHOSEN, "--save"]):
        raise SystemExit("not generated, baked and saved")
    return state()


def make(path: str) -> dict:
    import bpy
    from steps import posed_bar

    Path(path).with_name("caches").mkdir()
    posed_bar("Bar")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    return bake()


def look(path: str) -> dict:
    """Opened and saved by Blender alone, which on Windows gives paths its own slashes."""
    import bpy

    bpy.ops.wm.open_mainfile(filepath=path)
    bpy.ops.wm.save_mainfile()
    return state()


def change(path: str) -> dict:
    import bpy

    bpy.ops.wm.open_mainfile(filepath=path)
    bar = bpy.data.objects["Bar"]
    bpy.context.view_layer.objects.active = bar
    bar.modifiers[0].show_viewport = False  # the cache; the pose is shown
    bpy.context.scene.frame_set(5)
    bpy.ops.planar.drag_pins(offset=(0.25, 0.5))
    bpy.ops.planar.key_pose()
    return bake()


def far(one: dict, other: dict) -> float:
    """The largest distance along an axis between what two of them show."""
    pairs = (
        (a, b)
        for frame in one["shown"]
        for a, b in zip(one["shown"][frame], other["shown"][frame], strict=True)
    )
    return max(abs(x - y) for a, b in pairs for x, y in zip(a, b, strict=True))


def check(title: str, saved: dict, opened: dict) -> bool:
    wrong = [] if saved["there"] and not saved["old"] else ["saved"]
    wrong += [name for name in ("there", "old", "poses") if opened[name] != saved[name]]
    wrong += [] if far(saved, opened) <= CLOSE else ["shown"]
    print(f"FAIL {title}: {wrong}\n{saved}\n{opened}" if wrong else f"PASS {title}", flush=True)
    return not wrong


def run(command: list[str], step: str, path: str) -> dict:
    done = subprocess.run(
        [*command, __file__, step, path],
        cwd=PROJECT,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return result_in(done.stdout, f"{step}, exit code {done.returncode}")


def main() -> int:
    version, *here = sys.argv[1:]
    systems = {"Windows": ["tools/wine/with_bpy.sh", version], "Linux": here}
    results = []
    for first, second in (("Windows", "Linux"), ("Linux", "Windows")):
        with tempfile.TemporaryDirectory() as folder:
            path = str(Path(folder, "shot.blend"))
            made = run(systems[first], "make", path)
            results.append(
                check(f"what {first} saves, {second} shows", made, run(systems[second], "look", path))
            )
            results.append(check("saved there, it is the same here", made, run(systems[first], "look", path)))
            changed = run(systems[second], "change", path)
            results.append(
                check("and so is what is changed there", changed, run(systems[first], "look", path))
            )
            kept = made["kept"] == changed["kept"] == KEPT and far(made, changed) > 0.2
            print(
                f"{'PASS' if kept else 'FAIL'} the bake's path has slashes, and the change is one", flush=True
            )
            results.append(kept)
    print(f"{sum(results)} passed, {len(results) - sum(results)} failed", flush=True)
    return 0 if all(results) else 1


if __name__ == "__main__":
    steps = {"make": make, "look": look, "change": change}
    if sys.argv[1] in steps:
        sys.path.insert(0, str(PROJECT / "addon"))
        import bpy

        import planar_deform

        bpy.ops.wm.read_factory_settings(use_empty=True)
        planar_deform.register()
        # Under wine /tmp/shot.blend is a path without its drive.
        print("RESULT", json.dumps(steps[sys.argv[1]](str(Path(sys.argv[2]).absolute()))), flush=True)
    else:
        sys.exit(main())
