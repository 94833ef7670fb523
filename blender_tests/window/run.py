#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run the window tests: real events in a real Blender window on a virtual screen.

    python3 blender_tests/window/run.py --blender /usr/bin/blender [file ...]
    tools/room.sh trixie python3 blender_tests/window/run.py --blender /usr/bin/blender [file ...]

The built extension is installed as a user would install it, into a throw-away set of user folders; then the
test files run, a few in each Blender process. Where anything fails, each file of that process runs again in
one of its own, which decides. A failed test, a Python error that Blender printed, a crash, a time-out and a
file in which no test ran are all failures. Exit code 0 only if nothing failed.
"""

import argparse
import os
import re
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
SCREEN = "1280x800x24"
TIMEOUT = 600  # seconds a file: a minute on two idle cores, but they may be busy
TOGETHER = 5  # files in a Blender process
# What hands do in every shot, and what depends on Blender's windows most: with --only core these files, with
# --only rest all others.
CORE = ("cameras", "drag", "first_shot", "keys", "pins", "poses", "record", "ring", "tool_keys", "views")


def environment(work: Path) -> dict[str, str]:
    """Nothing of the user's own settings, and all that Blender writes goes below `work`."""
    keep = {key: os.environ[key] for key in ("PATH", "LANG", "PLANAR_WHOLE") if key in os.environ}
    own = {"HOME": str(work), "BLENDER_USER_RESOURCES": str(work / "resources"), "LIBGL_ALWAYS_SOFTWARE": "1"}
    return {**keep, **own, "PYTHONDONTWRITEBYTECODE": "1"}


def run(work: Path, arguments: list[str], timeout: int) -> tuple[int, str]:
    """The exit code and everything printed; a process that hangs is killed with its children (code -9)."""
    process = subprocess.Popen(
        arguments,
        env=environment(work),
        cwd=PROJECT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    try:
        output, _ = process.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        output, _ = process.communicate()
        output += f"\nkilled: still running after {timeout} s\n"
    return process.returncode, output


def install(blender: str, work: Path, extension: Path) -> None:
    arguments = [blender, "--background", "--command", "extension", "install-file"]
    code, output = run(work, [*arguments, "--repo", "user_default", "--enable", str(extension)], 120)
    if code != 0:
        raise SystemExit(f"Blender could not install {extension}:\n{output}")


def run_files(blender: str, work: Path, files: Sequence[Path]) -> tuple[int, int, str]:
    """(passed, failed, what was printed and what else is wrong) of test files in one Blender."""
    names = " ".join(file.name for file in files)
    screen = ["xvfb-run", "-a", "-s", f"-screen 0 {SCREEN}"]
    window = [blender, "--enable-event-simulate", "--window-geometry", "0", "0", "1280", "800"]
    script = ["--python-exit-code", "1", "--python", str(HERE / "harness.py"), "--", *map(str, files)]
    code, output = run(work, [*screen, *window, *script], TIMEOUT * len(files))
    closing = re.search(r"^(\d+) passed, (\d+) failed$", output, re.MULTILINE)
    passed, failed = (int(closing[1]), int(closing[2])) if closing else (0, 0)
    if re.search(r"^Traceback|Error: Python: Traceback", output, re.MULTILINE):
        output += f"FAIL {names}: Blender printed a Python error\n"
        failed += 1
    if failed == 0 and (code != 0 or passed == 0):
        output += f"FAIL {names}: exit code {code}, {passed} tests passed\n"
        failed += 1
    return passed, failed, output


def show(output: str, *, everything: bool) -> None:
    for line in output.splitlines():
        if everything or line.startswith(("PASS ", "FAIL ", "     ", "NOTE ")):
            print(line, flush=True)


def runner_notices_failures(blender: str, work: Path) -> bool:
    """A file with a failing test must be reported as failed; else no other result here means anything."""
    passed, failed, output = run_files(blender, work, [HERE / "broken" / "broken.py"])
    noticed = passed == 2 and failed == 2
    print(f"{'PASS' if noticed else 'FAIL'} run.py: failing tests and printed errors are noticed")
    if not noticed:
        show(output, everything=True)
    return noticed


def files_are_apart(blender: str, work: Path) -> bool:
    """What a file leaves behind must not be there for the next file in the same Blender."""
    files = [HERE / "broken" / "leaves_traces.py", HERE / "broken" / "finds_none.py"]
    passed, failed, output = run_files(blender, work, files)
    apart = passed == 2 and failed == 0
    print(f"{'PASS' if apart else 'FAIL'} run.py: a file leaves nothing to the next in the same Blender")
    if not apart:
        show(output, everything=True)
    return apart


def default_extension() -> Path:
    found = sorted((PROJECT / "dist").glob("planar_deform-*-linux_x64.zip"), key=lambda path: path.stat().st_mtime)
    if not found:
        raise SystemExit("No extension in dist/: run 'make extension' first, or name one with --extension.")
    return found[-1]


def main() -> int:
    parser = argparse.ArgumentParser(description="Window tests of Planar Deform.")
    parser.add_argument("--blender", required=True, help="a Blender 4.2 or newer")
    parser.add_argument("--extension", type=Path, help="the zip to install (default: the newest in dist/)")
    parser.add_argument("--only", choices=("core", "rest"), help="only the files that are named CORE, or not")
    parser.add_argument(
        "--whole", action="store_true", help="every file in a process of its own, and long stories to the end"
    )
    parser.add_argument("--verbose", action="store_true", help="print all that Blender prints")
    parser.add_argument("files", nargs="*", type=Path, help="test files (default: all)")
    options = parser.parse_args()

    if options.whole:
        os.environ["PLANAR_WHOLE"] = "1"
    files = [file.resolve() for file in options.files] or sorted(HERE.glob("test_*.py"))
    if options.only:
        wanted = options.only == "core"
        files = [file for file in files if (file.stem.removeprefix("test_") in CORE) == wanted]
    passed = failed = 0
    with tempfile.TemporaryDirectory(prefix="planar-window-") as name:
        work = Path(name)
        install(options.blender, work, (options.extension or default_extension()).resolve())
        if not options.files:
            own = [check(options.blender, work) for check in (runner_notices_failures, files_are_apart)]
            passed, failed = own.count(True), own.count(False)
        together = 1 if options.whole else TOGETHER
        groups = [files[i : i + together] for i in range(0, len(files), together)]
        while groups:
            group = groups.pop(0)
            group_passed, group_failed, output = run_files(options.blender, work, group)
            show(output, everything=options.verbose or group_failed > 0)
            if group_failed and len(group) > 1:
                print("NOTE these files again, each in a Blender of its own", flush=True)
                groups[:0] = [[file] for file in group]
                continue
            passed += group_passed
            failed += group_failed
    print(f"{passed} passed, {failed} failed", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
