#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print the compiled sources that differ from what has landed, and of those that include it one a header.

What has landed is where this branch left origin/main or, without that, main. On that commit itself, as in
a clean clone, it is the last one that is three hours older. Where there is none, and where the checks or the
build have changed, all sources are printed; `make nightly` reads all of them in any case.
usage: changed_sources.py FOLDER...
"""

import re
import subprocess
import sys
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1]
CONCERNS_ALL = {".clang-tidy", "CMakeLists.txt"}  # the top one, not the lists of sources
PIECE_OF_WORK = 3 * 3600  # seconds: nobody works longer on what lands at once


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


def readers(changed: set[str], files: list[Path]) -> set[str]:
    """The names of those sources whose reading reads all changed files: themselves, and one for each header.

    That is the source of the header's own name, or the first one that includes it, directly or not. Alike
    names are one.
    """
    including = {
        file.name: {Path(name).name for name in re.findall(r'#include "(.+)"', file.read_text())}
        for file in sorted(files)
    }
    sources = [name for name in including if name.endswith(".cpp")]
    found = changed.intersection(sources)
    for header in changed.intersection(including) - found:
        own = Path(header).with_suffix(".cpp").name
        names = {header}
        while own not in including and names:
            own = next((name for name in sources if including[name] & names), own)
            names = {name for name, inside in including.items() if inside & names} - names
        found.update({own}.intersection(including))
    return found


def main() -> None:
    sources = [Path(name) for name in git("ls-files", *sys.argv[1:]) if name.endswith(".cpp")]
    base = landed()
    changed = set(git("diff", "--name-only", base)) if base else CONCERNS_ALL
    if not changed & CONCERNS_ALL:
        files = [PROJECT / name for name in git("ls-files", "native") if name.endswith((".cpp", ".h"))]
        concerned = readers({Path(name).name for name in changed}, files)
        sources = [path for path in sources if path.name in concerned]
    print(*sources, sep="\n", end="\n" if sources else "")


if __name__ == "__main__":
    main()
