#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run the test suites of one of the project's commands, two at a time, and print a table of what they did.

Each suite is a command that prints a runner's closing line; its whole output goes to out/logs/. A suite that
fails or runs no test fails the command. Only a suite that needs the newest Debian room may be left out, only
when the room cannot be made, and the table says so.

usage: run_suites.py test|matrix|landing|nightly
test      the suites of this machine
matrix    the Blender suites in every supported Blender
landing   both and lint, each suite once; native builds beside the release as far as they differ from it, and
          each window test once: what is core in the newest Blender, the rest in the other; what is cheap of
          Windows' under wine
nightly   the same, all of it whole: every window test in every Blender, every file in one of its own
"""

import concurrent.futures
import dataclasses
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import IO, Any

PROJECT = Path(__file__).resolve().parents[1]
LOGS = PROJECT / "out" / "logs"
TAIL = 80  # lines of a failed suite's log that are printed
AT_A_TIME = 2  # suites; most use one core for most of their time


@dataclasses.dataclass(frozen=True)
class Suite:
    name: str
    command: tuple[str, ...]
    instead: tuple[str, ...] | None = None  # what is run where the newest room cannot be made


@dataclasses.dataclass(frozen=True)
class Outcome:
    suite: Suite
    passed: int
    failed: int
    seconds: float
    cpu: float  # seconds of all its processes
    left_out: bool = False


PYTHON = ".venv/bin/python"
NEWEST = "sid"  # the Debian room that may turn out not to be installable
BPY_VERSIONS = ("4.2.23", "4.5.15", "5.0.1", "5.2.3")
NEVER_RUN = {
    "window-windows": "PyPI and Debian have Windows' bpy, but no Windows' Blender with a window",
    "macos": "nothing here runs a module for macOS: its files are checked",
}
LONG_TERM = ("4.2.23", "4.5.15", "5.2.3")  # what most animators work with; a landing is tested in these
PYTEST = (PYTHON, "-m", "pytest")


def native(preset: str, *tests: str) -> Suite:
    """The tests of a build, or those whose names match a regular expression."""
    return Suite(f"native-{preset}", ("tools/native_tests.sh", preset, *tests))


def data(bpy: str) -> Suite:
    return Suite(f"data-{bpy}", ("tools/with_bpy.sh", bpy, "-m", "pytest", "blender_tests/data"))


def python(bpy: str) -> Suite:
    """The tests without a Blender, in the Python and with the NumPy of one."""
    return Suite(f"python-{bpy}", ("tools/with_bpy.sh", bpy, "-m", "pytest", "tests/python"))


def extension(blender: str, *, whole: bool) -> Suite:
    return Suite(
        f"extension-{blender}", ("tools/extension_tests.sh", blender, *(["--whole"] if whole else []))
    )


def extension_files(*, whole: bool) -> Suite:
    """The files of every platform's extension; not `whole`: Linux' and, so that it links, Windows'."""
    return Suite("extension-files", ("tools/extension_files.sh", *([] if whole else ["linux", "windows"])))


def wine(what: str, bpy: str) -> Suite:
    """Tests in Windows' Python and a version of Windows' bpy."""
    return Suite(f"wine-{what}-{bpy}", ("tools/wine_tests.sh", what, bpy))


def under_wine(*, whole: bool) -> list[Suite]:
    """What is Windows'; not `whole`: the extension's use and the tests without a Blender, once.

    Those are cheap: 40 and 80 s of processor time, and on a fresh machine 20 more to unpack Debian's wine
    (110 MB to fetch) and Windows' bpy (320 MB). The data tests take 250 to 400 s a bpy, and the native ones
    compile for some 1000 s where ccache knows none of them.
    """
    oldest, newest = BPY_VERSIONS[0], BPY_VERSIONS[-1]
    if not whole:
        return [wine("extension", oldest), wine("python", oldest)]
    return [
        native("zig-windows"),
        *(wine("python", bpy) for bpy in (oldest, newest)),  # Python 3.11 and 3.13
        wine("update", oldest),
        wine("exchange", oldest),
        *(wine("extension", bpy) for bpy in BPY_VERSIONS),
        *(wine("data", bpy) for bpy in BPY_VERSIONS),
    ]


def windows(*options: str, whole: bool) -> tuple[str, ...]:
    return ("tools/window_tests.sh", *options, *(["--whole"] if whole else []))


def default_bpy() -> str:
    output = subprocess.run(
        ["tools/default_bpy.sh"], cwd=PROJECT, stdout=subprocess.PIPE, text=True, check=True
    )
    return output.stdout.strip()


def blender_here() -> bool:
    """Whether tools/window_tests.sh has a Blender of this machine to look at before the trixie room."""
    return bool(os.environ.get("BLENDER") or shutil.which("blender"))


def matrix(*, whole: bool, tested: bool) -> list[Suite]:
    """The Blender suites, without those that on_this_machine() has when it is `tested`."""
    landing = tested and not whole
    wheels, rooms = list(LONG_TERM if landing else BPY_VERSIONS), ["trixie", NEWEST]
    core = ["--only", "core"] if landing else []
    screens = [
        Suite("window-trixie", windows("--room", "trixie", whole=whole)),
        Suite(
            f"window-{NEWEST}",
            windows("--room", NEWEST, *core, whole=whole),
            instead=windows(*core, whole=False) if landing else None,
        ),
    ]
    if tested:
        wheels.remove(default_bpy())
    if tested and not blender_here():
        del screens[0]
    newest = [bpy for bpy in wheels if bpy == BPY_VERSIONS[-1]]
    installed = [extension(blender, whole=whole) for blender in (*wheels, *rooms)]
    return [*screens, *map(data, wheels), *map(python, newest), *installed]


def on_this_machine(*, whole: bool, core: bool = True) -> list[Suite]:
    """What `make test` runs; not `whole`: of the builds beside the release what differs there.

    With or without the window tests that are core.
    """
    return [
        # First, as they take long, and the others find in ccache what they compile.
        native("asan-whole" if whole else "asan"),
        native("release"),
        *([native("tsan")] if whole else []),
        native("eigen", *([] if whole else ["BuildInfo|Solver|Poser"])),
        Suite("window", windows(*([] if core else ["--only", "rest"]), whole=whole)),
        Suite("data", (*PYTEST, "blender_tests/data")),
        Suite("python", (*PYTEST, "tests/python")),
        Suite("python-malloc", ("env", "PYTHONMALLOC=debug", *PYTEST, "tests/python")),
        Suite("extension", ("tools/extension_tests.sh",)),
        extension_files(whole=whole),
    ]


def suites(name: str) -> list[Suite]:
    if name == "test":
        return on_this_machine(whole=False)
    if name == "matrix":
        return matrix(whole=False, tested=False)
    whole = name == "nightly"
    lint = Suite("lint", ("tools/lint.sh", *([] if whole else ["--changed"])))
    compilers = map(native, ("clang", "zig")) if whole else ()
    here = [*on_this_machine(whole=whole, core=whole), *matrix(whole=whole, tested=True)]
    return [*here, lint, *compilers, *under_wine(whole=whole)]


def counts(log: str) -> tuple[int, int]:
    """(passed, failed) from the closing lines of pytest, ctest, GoogleTest and our own runners."""
    ctest = re.findall(r"(\d+) tests failed out of (\d+)", log)
    if ctest:
        failed, total = map(int, ctest[-1])
        return total - failed, failed
    gtest = dict(re.findall(r"\[  (PASSED|FAILED)  \] (\d+) tests?[.,]", log))
    if gtest:
        return int(gtest.get("PASSED", 0)), int(gtest.get("FAILED", 0))
    closing = [line for line in log.splitlines() if re.search(r"\b\d+ (passed|failed|errors?)\b", line)]
    words = re.findall(r"(\d+) (passed|failed|error)", closing[-1]) if closing else []
    found = {word: int(number) for number, word in words}
    return found.get("passed", 0), found.get("failed", 0) + found.get("error", 0)


def measured(command: tuple[str, ...], **options: Any) -> tuple[int, float]:
    """The exit code and the seconds of processor time of a command, with options of Popen."""
    process = subprocess.Popen(command, cwd=PROJECT, stdin=subprocess.DEVNULL, **options)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, usage.ru_utime + usage.ru_stime


def call(command: tuple[str, ...], log: IO[str]) -> tuple[int, float]:
    """The same of a suite beside others."""
    # CMake's own variable: the share of a suite that builds.
    jobs = max(1, (os.cpu_count() or 1) // AT_A_TIME)
    environment = {**os.environ, "CMAKE_BUILD_PARALLEL_LEVEL": str(jobs)}
    return measured(command, env=environment, stdout=log, stderr=subprocess.STDOUT)


def row(outcome: Outcome) -> str:
    what = f"{'left out':>13}" if outcome.left_out else f"{outcome.passed:6} {outcome.failed:6}"
    return f"{outcome.suite.name:22} {what} {outcome.seconds:8.0f} {outcome.cpu:8.0f}"


def run(suite: Suite) -> Outcome:
    start = time.monotonic()
    log_path = LOGS / f"{suite.name}.log"
    with log_path.open("w") as log:
        command = suite.command
        if NEWEST in command and call(("tools/room.sh", NEWEST), log)[0] != 0:
            reason = f"the {NEWEST} room cannot be made here, see {log_path.relative_to(PROJECT)}"
            if suite.instead is None:
                outcome = Outcome(suite, 0, 0, time.monotonic() - start, 0.0, left_out=True)
                print(f"{row(outcome)}  {reason}", flush=True)
                return outcome
            print(f"{suite.name:22} {reason}; in another Blender instead", flush=True)
            command = suite.instead
        code, cpu = call(command, log)
    text = log_path.read_text(errors="replace")
    passed, failed = counts(text)
    if failed == 0 and (code != 0 or passed == 0):
        failed = 1  # it broke off, or ran nothing
    outcome = Outcome(suite, passed, failed, time.monotonic() - start, cpu)
    lines = [row(outcome)]
    if failed:
        lines += [f"---- end of {log_path.relative_to(PROJECT)}", *text.splitlines()[-TAIL:], "----"]
    print("\n".join(lines), flush=True)  # at once, as another suite may end
    return outcome


def set_up(name: str) -> Outcome:
    """What all suites of a command need; what it does is seen as it goes."""
    start = time.monotonic()
    suite = Suite("setup", ("tools/setup.sh", "lint" if name in ("landing", "nightly") else "test"))
    code, cpu = measured(suite.command)
    return Outcome(suite, 0, int(code != 0), time.monotonic() - start, cpu)


def main() -> int:
    if sys.argv[1:] not in (["test"], ["matrix"], ["landing"], ["nightly"]):
        raise SystemExit(__doc__)
    start = time.monotonic()
    LOGS.mkdir(parents=True, exist_ok=True)
    chosen = suites(sys.argv[1])
    head = f"{'suite':22} {'passed':>6} {'failed':>6} {'seconds':>8} {'cpu':>8}"
    ready = set_up(sys.argv[1])
    print(head, row(ready), sep="\n", flush=True)
    if sys.argv[1] == "nightly":
        for what, reason in NEVER_RUN.items():
            print(f"{what:22} {'left out':>13}  {reason}", flush=True)
    if ready.failed:
        print("\n0 passed, 1 failed", flush=True)
        return 1
    with concurrent.futures.ThreadPoolExecutor(AT_A_TIME) as pool:
        outcomes = [ready, *pool.map(run, chosen)]
    print(f"\n{head}", *map(row, outcomes), sep="\n")
    failed = sum(outcome.failed for outcome in outcomes)
    every = Suite("in all", ())
    passed, cpu = sum(outcome.passed for outcome in outcomes), sum(outcome.cpu for outcome in outcomes)
    print(row(Outcome(every, passed, failed, time.monotonic() - start, cpu)))
    print(f"\n{passed} passed, {failed} failed", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
