# SPDX-License-Identifier: GPL-3.0-or-later
"""The headless command: in-betweens and bakes of a .blend without a window, as a render farm's job.

    blender -b shot.blend --command planar --list
    blender -b shot.blend --command planar --object Hero --generate --bake POINT_CACHE --save
    blender -b shot.blend --command planar --play --save //shot_baked.blend
    blender -b shot.blend --python-exit-code 1 --python-expr \
        "from bl_ext.user_default.planar_deform import batch; batch.main(['--object', 'Hero', '--generate'])"

Exit code 0: all done; 1: refused or failed, with the reason on stderr and nothing saved; 2: wrong usage.
"""

from __future__ import annotations

import argparse
import json
import sys
import traceback
from collections.abc import Callable, Iterable, Sequence

import bpy

from . import native
from .errors import ObjectGone, Refusal
from .scene.inbetweens import planning, writing
from .scene.motion import bake, point_cache
from .scene.objects.any_object import read_shape
from .scene.objects.lattice_object import in_space
from .scene.sequence import pose_state
from .scene.storage import points

COMMAND = "planar"
DONE, FAILED, USAGE = 0, 1, 2


def main(arguments: Sequence[str] | None = None) -> None:
    """Do what the arguments say (by default those of Blender's command line behind --), and end Blender."""
    if arguments is None:
        arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    sys.exit(run(arguments))


def run(arguments: Sequence[str]) -> int:
    """Do what the arguments say, in the file that is open; the exit code."""
    try:
        options = _parsed(arguments)
    except SystemExit as end:  # argparse has said why, or has shown its help
        return DONE if end.code in (None, DONE) else USAGE
    try:
        if not hasattr(bpy.types.Object, "planar"):  # --factory-startup, or the preferences of another user
            raise Refusal(
                "The extension Planar Deform is not enabled in this Blender: enable it in the preferences"
            )
        names = _objects(options.object)
        if options.list:
            print(json.dumps([name for name in names if bpy.data.objects[name].type == "MESH"]), flush=True)
        for name in names:
            scene = _scene_of(bpy.data.objects[name])
            with bpy.context.temp_override(scene=scene, view_layer=scene.view_layers[0]):
                bpy.context.view_layer.update()
                _work(name, options)
        if options.save is not None:
            _save(options.save)
    except Refusal as refusal:
        print(f"{COMMAND}: {refusal}", file=sys.stderr, flush=True)
        return FAILED
    except Exception:
        traceback.print_exc()
        return FAILED
    return DONE


def _parsed(arguments: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog=f"blender -b FILE.blend --command {COMMAND}",
        description="Generate in-betweens, bake poses and play what is baked, without a window.",
        epilog="Exit code 0: all done. 1: refused or failed, nothing is saved. 2: wrong usage.",
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("--object", action="append", metavar="NAME", help="may be repeated; by default all that have poses")
    add("--list", action="store_true", help="print which of them are meshes, as a line of JSON")
    add("--generate", action="store_true", help="generate the in-betweens")
    add("--bake", choices=[form for form, _, _ in bake.FORMS], type=str.upper, help="bake to this")
    add("--play", action="store_true", help="play the point caches that are baked already")
    add("--filepath", help="file of a point cache; by default the object's own, beside the .blend")
    add("--replace", action="store_true", help="write the point cache even over another file")
    add("--free", action="store_true", help="remove the poses when they are in a point cache")
    add("--start", type=int, metavar="FRAME", help="first frame to bake; by default the scene's")
    add("--end", type=int, metavar="FRAME", help="last frame to bake; by default the scene's")
    add("--step", type=int, default=1, metavar="FRAMES", help="from one baked frame to the next")
    add("--save", nargs="?", const="", metavar="PATH", help="save the .blend, where it is or as another")
    options = parser.parse_args(list(arguments))
    if not (options.list or options.generate or options.bake or options.play):
        parser.error("there is nothing to do: give --generate, --bake, --play or --list")
    if options.bake is not None and options.play:
        parser.error("give --bake or --play, not both: what is baked is played")
    if options.bake != "POINT_CACHE" and (options.replace or options.free):
        parser.error("--replace and --free are for --bake POINT_CACHE")
    if options.bake != "POINT_CACHE" and not options.play and options.filepath is not None:
        parser.error("--filepath is for --bake POINT_CACHE and --play")
    if options.filepath is not None and len(options.object or ()) != 1:
        parser.error("--filepath is for one object: give its name with --object")
    if options.step < 1:
        parser.error("--step is at least 1")
    return options


def _objects(names: Sequence[str] | None) -> list[str]:
    """Those named, or all of the file's own that have poses."""
    if names is None:
        found = [obj.name for obj in bpy.data.objects if _has_poses(obj)]
        if not found:
            raise Refusal("No object of the file has poses: key some")
        return found
    for name in names:
        if name not in bpy.data.objects:
            raise Refusal(f"There is no object '{name}' in the file")
    return list(names)


def _has_poses(obj: bpy.types.Object) -> bool:
    ours = obj.library is None and obj.override_library is None
    return ours and obj.type in points.TYPES and pose_state.has_blocks(obj)


def _scene_of(obj: bpy.types.Object) -> bpy.types.Scene:
    """The scene whose timeline plays the object: the file's active one if it is in that, too."""
    active = bpy.context.scene
    return active if active in obj.users_scene or not obj.users_scene else obj.users_scene[0]


def _work(name: str, options: argparse.Namespace) -> None:
    obj = bpy.data.objects[name]
    try:
        needless = options.object is None or options.bake is not None
        if options.generate and not (needless and (len(obj.planar.poses) < 2 or in_space(obj))):
            drawing = read_shape(obj)
            plan = planning.plan(drawing)
            shapes = plan.solve(_reporter(f"{name}: solving in-betweens"))
            _follow(f"{name}: writing in-betweens", writing.write(drawing, plan, shapes))
        if options.bake is not None:
            _bake(obj, options)
        if options.play:
            _play(obj, options)
    except (Refusal, ObjectGone, native.SolveError) as error:
        raise Refusal(f"{name}: {error}") from error


def _bake(obj: bpy.types.Object, options: argparse.Namespace) -> None:
    reason = bake.refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    first, last = bake.frame_range(bpy.context.scene)
    frames = bake.frames_of(
        first if options.start is None else options.start,
        last if options.end is None else options.end,
        options.step,
    )
    filepath = options.filepath or point_cache.default_path(obj)
    steps = bake.to(options.bake, obj, frames, filepath, replace=options.replace, free=options.free)
    _follow(f"{obj.name}: baking frames {frames[0]} to {frames[-1]}", steps)


def _play(obj: bpy.types.Object, options: argparse.Namespace) -> None:
    """Of an object that was not asked for, the cache that it has."""
    filepath = options.filepath or point_cache.default_path(obj)
    if options.object is None and not point_cache.file_at(filepath).exists():
        return
    reason = bake.refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    frames = bake.play_point_cache(obj, filepath)
    print(f"{COMMAND}: {obj.name}: playing frames {frames[0]} to {frames[-1]}", flush=True)


def _save(path: str) -> None:
    destination = bpy.path.abspath(path or bpy.data.filepath)
    if not destination:
        raise Refusal("The file has never been saved: give --save a path")
    try:
        bpy.ops.wm.save_as_mainfile(filepath=destination, check_existing=False)
    except RuntimeError as error:
        raise Refusal(str(error).removeprefix("Error: ").strip()) from error
    print(f"{COMMAND}: saved {bpy.data.filepath}", flush=True)


def _follow(what: str, steps: Iterable[float]) -> None:
    report = _reporter(what)
    for share in steps:
        report(share)
    report(1.0)


def _reporter(what: str) -> Callable[[float], bool]:
    """Prints a line whenever a further tenth is done."""
    printed = -1

    def report(share: float) -> bool:
        nonlocal printed
        tenth = int(10.0 * share)
        if tenth > printed:
            printed = tenth
            print(f"{COMMAND}: {what}: {10 * tenth} %", flush=True)
        return True

    return report


CLASSES = ()
_command: object = None


def register() -> None:
    """Adds `blender --command planar`."""
    global _command
    _command = bpy.utils.register_cli_command(COMMAND, run)


def unregister() -> None:
    """Takes the command away."""
    bpy.utils.unregister_cli_command(_command)
