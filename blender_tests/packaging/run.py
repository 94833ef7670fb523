#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Install the built extension as a user does, use it, disable it, uninstall it; nothing may be left behind.

    python3 blender_tests/packaging/run.py --blender /usr/bin/blender    by Blender's command line
    .venv/bin/python blender_tests/packaging/run.py                      by the operators of this Python's bpy

Blender runs with a home of its own, each step in a new process, as after a restart. A planar_native that this
Python has is hidden from it, so that only the extension's own wheel can be found. Exit code 0 only if all
passed.
"""

import argparse
import json
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

PROJECT = Path(__file__).resolve().parents[2]
STEPS = Path(__file__).with_name("steps.py")
MODULE = "bl_ext.user_default.planar_deform"


class Blender:
    """A Blender with a home of its own: the program `path`, or the bpy module when that is None."""

    def __init__(self, path: str | None, work: Path) -> None:
        self.home = work / "home"
        self.cwd = work / "cwd"
        packages = work / "packages"
        for folder in (self.home, self.cwd, packages, work / "tmp"):
            folder.mkdir()
        self.environment = {
            "HOME": str(self.home),
            "TMPDIR": str(work / "tmp"),
            "PATH": "/usr/bin:/bin",
            "LANG": "C.UTF-8",
        }
        if path is None:
            for entry in Path(sysconfig.get_path("purelib")).iterdir():
                if not entry.name.startswith(("planar_", "__pycache__")):
                    (packages / entry.name).symlink_to(entry)
            self.environment["PYTHONPATH"] = str(packages)
            self.program = [sys.executable, "-S", str(STEPS), "--"]
            self.command_line = None
            (tool,) = packages.glob("bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
            self.validator = [sys.executable, str(tool), "validate"]
        else:
            self.program = [path, "--background", "--python-exit-code", "1", "--python", str(STEPS), "--"]
            self.command_line = [path, "--command", "extension"]
            self.validator = [*self.command_line, "validate"]

    def call(self, command: Sequence[str]) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            command,
            cwd=self.cwd,
            env=self.environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=300,
            check=False,
        )

    def run(self, *command: str) -> str:
        result = self.call(command)
        if result.returncode or "Traceback" in result.stdout:
            raise AssertionError(f"{' '.join(command)}: exit code {result.returncode}\n{result.stdout}")
        return result.stdout

    @property
    def batch_forms(self) -> tuple[str, ...]:
        return ("module",) if self.command_line is None else ("command", "expression")

    def batch(self, form: str, file: str, *arguments: str) -> tuple[int, str]:
        """The exit code of the headless command, called as its page tells, and what it printed."""
        if form == "module":
            return self.step("batch", file, *arguments), ""
        command = [self.program[0], "-b", file]
        if form == "command":
            command += ["--command", "planar", *arguments]
        else:
            expression = f"from {MODULE} import batch; batch.main()"
            command += ["--python-exit-code", "1", "--python-expr", expression, "--", *arguments]
        result = self.call(command)
        return result.returncode, result.stdout

    def step(self, *step: str) -> Any:
        output = self.run(*self.program, *step)
        (line,) = (line for line in output.splitlines() if line.startswith("RESULT "))
        return json.loads(line.removeprefix("RESULT "))

    def install(self, archive: Path) -> dict:
        """What is registered then: after a restart, where Blender starts with what its user enabled."""
        if self.command_line is None:
            return self.step("install", str(archive))
        self.run(*self.command_line, "install-file", "-r", "user_default", "--enable", str(archive))
        return self.step("look")

    def uninstall(self) -> None:
        if self.command_line is None:
            self.step("uninstall")
        else:
            self.run(*self.command_line, "remove", "planar_deform")

    def files(self) -> set[Path]:
        folders = (self.home, self.cwd, Path(self.environment["TMPDIR"]))
        return {path for folder in folders for path in folder.rglob("*") if not path.is_dir()}


def check(condition: bool, message: str) -> None:
    if not condition:
        raise AssertionError(message)


def is_ours(path: Path) -> bool:
    """In the folder of the extension itself, or in that of the wheels that Blender unpacked for it."""
    return "/extensions/user_default/planar_deform/" in str(path) or (
        "/extensions/.local/" in str(path) and "planar" in str(path)
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
    own = str(blender.home)
    check(result["module"].startswith(own), f"the module is not the extension's: {result['module']}")
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


def main() -> int:
    parser = argparse.ArgumentParser(description="Packaging tests of Planar Deform.")
    parser.add_argument("--blender", help="a Blender 4.2 or newer (default: the bpy of this Python)")
    options = parser.parse_args()
    archives = sorted(
        (PROJECT / "dist").glob("planar_deform-*-linux_x64.zip"), key=lambda path: path.stat().st_mtime
    )
    if not archives:
        raise SystemExit("No extension in dist/: run 'make extension' first.")

    steps = {
        "is valid, installs and is enabled": lambda blender: check_installed(blender, archives[-1]),
        "drags a pin with its own module": check_drag,
        "generates and bakes without a window, with exit codes": check_batch,
        "leaves nothing registered when disabled": check_disabled,
        "leaves no file when uninstalled": check_uninstalled,
    }
    passed = failed = 0
    with tempfile.TemporaryDirectory(prefix="planar-packaging-") as name:
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
