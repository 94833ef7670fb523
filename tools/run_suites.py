#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run the test suites of `make test` or `make matrix` one after another and print a table of what they did.

Each suite is a command that prints a runner's closing line; its whole output goes to out/logs/. A suite that
fails or runs no test fails the command. Only a suite that needs the newest Debian room may be left out, only
when the room cannot be made, and the table says so.

usage: tools/run_suites.py test|matrix [--after-test]
--after-test: without the suites of the matrix that `make test` runs on this machine, which come before it.
"""

import dataclasses
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import IO

PROJECT = Path(__file__).resolve().parents[1]
LOGS = PROJECT / "out" / "logs"
TAIL = 80  # lines of a failed suite's log that are printed


@dataclasses.dataclass(frozen=True)
class Suite:
    name: str
    command: tuple[str, ...]


@dataclasses.dataclass(frozen=True)
class Outcome:
    suite: Suite
    passed: int
    failed: int
    seconds: float
    left_out: bool = False


PYTHON = ".venv/bin/python"
NEWEST = "sid"  # the Debian room that may turn out not to be installable
BPY_VERSIONS = ("4.2.23", "4.5.15", "5.0.1", "5.2.3")
SUITES = {
    "test": (
        Suite("native-release", ("tools/native_tests.sh", "release")),
        Suite("native-eigen", ("tools/native_tests.sh", "eigen")),
        Suite("native-asan", ("tools/native_tests.sh", "asan")),
        Suite("python", (PYTHON, "-m", "pytest", "tests/python")),
        Suite("data", (PYTHON, "-m", "pytest", "blender_tests/data")),
        Suite("extension", ("tools/extension_tests.sh",)),
        Suite("window", ("tools/window_tests.sh",)),
    ),
    "matrix": (
        *(
            Suite(f"data-{bpy}", ("tools/with_bpy.sh", bpy, "-m", "pytest", "blender_tests/data"))
            for bpy in BPY_VERSIONS
        ),
        *(
            Suite(f"extension-{blender}", ("tools/extension_tests.sh", blender))
            for blender in (*BPY_VERSIONS, "trixie", NEWEST)
        ),
        *(Suite(f"window-{room}", ("tools/window_tests.sh", "--room", room)) for room in ("trixie", NEWEST)),
    ),
}


def in_test() -> set[str]:
    """The suites of the matrix that are in the test command on this machine, under shorter names."""
    default = subprocess.run(
        ["tools/default_bpy.sh"], cwd=PROJECT, stdout=subprocess.PIPE, text=True, check=True
    )
    names = {f"{suite}-{default.stdout.strip()}" for suite in ("data", "extension")}
    if not os.environ.get("BLENDER") and shutil.which("blender") is None:  # see tools/window_tests.sh
        names.add("window-trixie")
    return names


def counts(log: str) -> tuple[int, int]:
    """(passed, failed) from the closing lines of pytest, ctest and our own runners."""
    ctest = re.findall(r"(\d+) tests failed out of (\d+)", log)
    if ctest:
        failed, total = map(int, ctest[-1])
        return total - failed, failed
    closing = [line for line in log.splitlines() if re.search(r"\b\d+ (passed|failed|errors?)\b", line)]
    words = re.findall(r"(\d+) (passed|failed|error)", closing[-1]) if closing else []
    found = {word: int(number) for number, word in words}
    return found.get("passed", 0), found.get("failed", 0) + found.get("error", 0)


def call(command: tuple[str, ...], log: IO[str]) -> int:
    return subprocess.run(
        command, cwd=PROJECT, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, check=False
    ).returncode


def run(suite: Suite) -> Outcome:
    print(f"{suite.name:17} ", end="", flush=True)
    start = time.monotonic()
    log_path = LOGS / f"{suite.name}.log"
    with log_path.open("w") as log:
        if NEWEST in suite.command and call(("tools/room.sh", NEWEST), log) != 0:
            print(f"left out: the {NEWEST} room cannot be made here, see {log_path.relative_to(PROJECT)}")
            return Outcome(suite, 0, 0, time.monotonic() - start, left_out=True)
        code = call(suite.command, log)
    text = log_path.read_text(errors="replace")
    passed, failed = counts(text)
    if failed == 0 and (code != 0 or passed == 0):
        failed = 1  # it broke off, or ran nothing
    outcome = Outcome(suite, passed, failed, time.monotonic() - start)
    print(f"{passed:5} passed {failed:5} failed {outcome.seconds:7.0f} s", flush=True)
    if failed:
        print(f"---- end of {log_path.relative_to(PROJECT)}")
        print("\n".join(text.splitlines()[-TAIL:]))
        print("----", flush=True)
    return outcome


def main() -> int:
    LOGS.mkdir(parents=True, exist_ok=True)
    left_out = in_test() if "--after-test" in sys.argv[2:] else set()
    outcomes = [run(suite) for suite in SUITES[sys.argv[1]] if suite.name not in left_out]
    print(f"\n{'suite':17} {'passed':>6} {'failed':>6} {'seconds':>8}")
    for o in outcomes:
        what = f"{'left out':>13}" if o.left_out else f"{o.passed:6} {o.failed:6}"
        print(f"{o.suite.name:17} {what} {o.seconds:8.0f}")
    failed = sum(outcome.failed for outcome in outcomes)
    print(f"\n{sum(outcome.passed for outcome in outcomes)} passed, {failed} failed", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
