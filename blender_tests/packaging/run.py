#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Install the built extension as a user does, use it, disable it, uninstall it; nothing may be left behind.

    python3 blender_tests/packaging/run.py --blender /usr/bin/blender    by Blender's command line
    build/farm/bin/python ... --blender /usr/bin/blender --farm          and the jobs of examples/farm
    .venv/bin/python blender_tests/packaging/run.py                      by the operators of this Python's bpy
    tools/wine_tests.sh extension 4.2.23                                 the same in Windows' Python

Blender runs with a home of its own, each step in a new process, as after a restart. A planar_native that this
Python has is hidden from it (Windows' has none), so that only the extension's own wheel can be found. Exit
code 0 only if all passed.
"""

import argparse
import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from installed import MODULE, PLATFORM, PROJECT, Blender, check


def is_ours(path: Path) -> bool:
    """In the folder of the extension itself, or in that of the wheels that Blender unpacked for it."""
    place = path.as_posix()
    return "/extensions/user_default/planar_deform/" in place or (
        "/extensions/.local/" in place and "planar" in place
    )


def check_installed(blender: Blender, archive: Path) -> None:
    before = blender.files()
    check(
        not any(blender.step("look").values()), "something of ours is registered before anything is installed"
    )
    blender.run(*blender.validator, str(archive))
    there = blender.install(archive)
    check(there["add-ons"] == [MODULE], f"not enabled: {there}")
    check(
        all(there[kind] for kind in ("classes", "operators", "properties", "tools")),
        f"not registered: {there}",
    )
    new = blender.files() - before
    check(any(path.name.startswith("_core.") for path in new), "the wheel was not unpacked")


def check_drag(blender: Blender) -> None:
    before = blender.files()
    result = blender.step("drag")
    x, y, z = result["dragged"]
    check(abs(x + 0.4) < 0.15 and abs(y - 0.8) < 0.15 and z == 0, f"the dragged end went by {x, y, z}")
    check(result["held"] < 0.15 and result["finite"], f"the held end moved by {result['held']}")
    module = Path(result["module"])
    check(module.is_relative_to(blender.home), f"the module is not the extension's: {module}")
    check("CHOLMOD" in result["backend"], f"built with {result['backend']}")
    stray = [
        path for path in blender.files() - before if not is_ours(path) and "__pycache__" not in path.parts
    ]
    check(not stray, f"written outside of the extension's folders: {stray}")


def check_batch(blender: Blender) -> None:
    folder = blender.cwd / "shot"
    folder.mkdir()
    shot = str(folder / "shot.blend")
    check(blender.step("shot", shot) == 3, "the poses are not keyed")
    bake = ("--object", "Bar", "--generate", "--bake", "POINT_CACHE", "--save")
    jobs = {
        bake: 0,
        ("--object", "Nobody", *bake[2:]): 1,
        ("--object", "Bar", "--bake", "GIF"): 2,
    }
    for arguments, expected in jobs.items():
        for form in blender.batch_forms:
            code, output = blender.batch(form, shot, *arguments)
            check(code == expected, f"{form} {arguments}: exit code {code}, not {expected}\n{output}")
    size = (folder / "Bar_planar.pc2").stat().st_size
    check(size == 32 + 9 * 4 * 12, f"the point cache has {size} bytes")
    shutil.rmtree(folder)


def check_disabled(blender: Blender) -> None:
    left = blender.step("disable")
    check(not any(left.values()), f"left registered after disabling: {left}")
    left = blender.step("look")
    check(not any(left.values()), f"registered after disabling and a restart: {left}")


def check_uninstalled(blender: Blender) -> None:
    blender.uninstall()
    left = blender.step("look")
    check(not any(left.values()), f"registered after uninstalling: {left}")
    files = [path for path in blender.files() if is_ours(path)]
    check(not files, f"left on disk after uninstalling: {files[:5]}")


def farm_steps() -> dict[str, Callable[[Blender], None]]:
    import farm  # whose libraries are not everywhere

    return {
        "runs a job by its Open Job Description, one task an object": farm.check_openjd,
        "has a Flamenco job type with the same commands": farm.check_flamenco,
    }


def window_steps(archive: Path) -> dict[str, Callable[[Blender], None]]:
    import repository

    title = "is installed, updated and removed from a repository, in the window"
    return {title: lambda blender: repository.check_repository(blender, archive)}


def main() -> int:
    parser = argparse.ArgumentParser(description="Packaging tests of Planar Deform.")
    parser.add_argument("--blender", help="a Blender 4.2 or newer (default: the bpy of this Python)")
    parser.add_argument("--window", action="store_true", help="and from a repository, in a window (Xvfb)")
    parser.add_argument("--farm", action="store_true", help="run the jobs of examples/farm, too (farm.txt)")
    options = parser.parse_args()
    archives = sorted(
        (PROJECT / "dist").glob(f"planar_deform-*-{PLATFORM}.zip"), key=lambda path: path.stat().st_mtime
    )
    if not archives:
        raise SystemExit("No extension in dist/: run 'make extension' first.")

    steps = {
        "is valid, installs and is enabled": lambda blender: check_installed(blender, archives[-1]),
        "drags a pin with its own module": check_drag,
        "generates and bakes without a window, with exit codes": check_batch,
        **(farm_steps() if options.farm else {}),
        "leaves nothing registered when disabled": check_disabled,
        "leaves no file when uninstalled": check_uninstalled,
        **(window_steps(archives[-1]) if options.window else {}),
    }
    passed = failed = 0
    with tempfile.TemporaryDirectory(prefix="planar-packaging-", ignore_cleanup_errors=True) as name:
        blender = Blender(options.blender, Path(name))
        for title, step in steps.items():
            try:
                step(blender)
            except Exception as error:
                print(f"FAIL {title}\n{error}", flush=True)
                failed += 1
                break  # the next step starts from what this one should have done
            print(f"PASS {title}", flush=True)
            passed += 1
    print(f"{passed} passed, {failed} failed", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
