#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print the compiled sources that differ from what has landed, themselves or in anything they include.

What has landed is where this branch left origin/main or, without that, main. On that commit itself, as in
a clean clone, it is the last one that is four hours older. Where there is none, and where the checks or the
build have changed, all sources are printed; `make nightly` reads all of them in any case.
usage: changed_sources.py FOLDER...
"""

import re
import subprocess
import sys
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1]
CONCERNS_ALL = {".clang-tidy", "CMakeLists.txt"}  # the top one, not the lists of sources
PIECE_OF_WORK = 4 * 3600  # seconds: nobody works longer on what lands at once


def git(*arguments: str) -> list[str]:
    """The lines that git prints."""
    return subprocess.run(
        ["git", *arguments], cwd=PROJECT, stdout=subprocess.PIPE, text=True, check=True
    ).stdout.splitlines()


def landed() -> str | None:
    """What the head is compared with; None if that cannot be told."""
    mains = ("refs/remotes/origin/main", "refs/heads/main")
    known = git("for-each-ref", "--sort=-refname", "--format=%(objectname)", *mains)
    try:
        bases = git("merge-base", "HEAD", known[0]) if known else []
    except subprocess.CalledProcessError:  # a clone without its history
        bases = []
    left = next((base for base in bases if [base] != git("rev-parse", "HEAD")), None)
    if left is not None:
        return left
    (now,) = git("show", "--no-patch", "--format=%ct", "HEAD")
    older = git("rev-list", "--max-count=1", f"--before={int(now) - PIECE_OF_WORK}", "HEAD")
    return older[0] if older else None


def with_includers(names: set[str], files: list[Path]) -> set[str]:
    """The names of files, and of those that include one of them, directly or not. Alike names are one."""
    included = {
        file.name: {Path(name).name for name in re.findall(r'#include "(.+)"', file.read_text())}
        for file in files
    }
    while more := {name for name, inside in included.items() if inside & names} - names:
        names = names | more
    return names


def main() -> None:
    sources = [Path(name) for name in git("ls-files", *sys.argv[1:]) if name.endswith(".cpp")]
    base = landed()
    changed = set(git("diff", "--name-only", base)) if base else CONCERNS_ALL
    if not changed & CONCERNS_ALL:
        files = [PROJECT / name for name in git("ls-files", "native") if name.endswith((".cpp", ".h"))]
        concerned = with_includers({Path(name).name for name in changed}, files)
        sources = [path for path in sources if path.name in concerned]
    print(*sources, sep="\n", end="\n" if sources else "")


if __name__ == "__main__":
    main()
