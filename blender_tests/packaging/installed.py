# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender with a home of its own, in which the extension is installed as a user does it."""

import json
import os
import subprocess
import sys
import sysconfig
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

PROJECT = Path(__file__).resolve().parents[2]
STEPS = Path(__file__).with_name("steps.py")
MODULE = "bl_ext.user_default.planar_deform"
PLATFORM = "windows_x64" if sys.platform == "win32" else "linux_x64"


class Blender:
    """A Blender with a home of its own: the program `path`, or the bpy module when that is None."""

    def __init__(self, path: str | None, work: Path) -> None:
        self.home = work / "home"
        self.cwd = work / "cwd"
        temporary = work / "tmp"
        self.folders = (self.home, self.cwd, temporary)
        for folder in self.folders:
            folder.mkdir()
        if sys.platform == "win32":  # whose home is not told by the environment
            own = {"BLENDER_USER_RESOURCES": self.home, "TEMP": temporary, "TMP": temporary}
            self.environment = {**os.environ, **{name: str(folder) for name, folder in own.items()}}
        else:
            self.environment = {
                "HOME": str(self.home),
                "TMPDIR": str(temporary),
                "PATH": "/usr/bin:/bin",
                "LANG": "C.UTF-8",
                "LIBGL_ALWAYS_SOFTWARE": "1",
            }
        if path is None:
            if sys.platform != "win32":
                self.environment["PYTHONPATH"] = str(without_module(work / "packages"))
            self.program = [sys.executable, "-S", str(STEPS), "--"]
            self.command_line = None
            tool = Path(find_spec("bpy").origin).parent.glob(
                "*/scripts/addons_core/bl_pkg/cli/blender_ext.py"
            )
            self.validator = [sys.executable, str(next(tool)), "validate"]
        else:
            self.program = [path, "--background", "--python-exit-code", "1", "--python", str(STEPS), "--"]
            self.command_line = [path, "--command", "extension"]
            self.validator = [*self.command_line, "validate"]

    def call(self, command: Sequence[str], timeout: float = 300) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            command,
            cwd=self.cwd,
            env=self.environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=timeout,
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
        return result_in(self.run(*self.program, *step), " ".join(step))

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
        return {path for folder in self.folders for path in folder.rglob("*") if not path.is_dir()}


def without_module(folder: Path) -> Path:
    """The packages of this Python, but for a planar_native: links in `folder`."""
    folder.mkdir()
    for entry in Path(sysconfig.get_path("purelib")).iterdir():
        if not entry.name.startswith(("planar_", "__pycache__")):
            (folder / entry.name).symlink_to(entry)
    return folder


def check(condition: bool, message: str) -> None:
    if not condition:
        raise AssertionError(message)


def result_in(output: str, step: str) -> Any:
    """What a step in a process of its own has told in what it printed."""
    results = [line for line in output.splitlines() if line.startswith("RESULT ")]
    check(len(results) == 1, f"{output}\n{step}: {len(results)} results")
    return json.loads(results[0].removeprefix("RESULT "))
