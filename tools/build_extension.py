#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Build dist/planar_deform-VERSION-PLATFORM.zip: the add-on and wheels of the module with their libraries.

A wheel is built for each Python whose headers are in HEADERS/cpXY (tools/python_headers.py), unless the last
one is still up to date.

usage: build_extension.py HEADERS
"""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1]
ADDON = PROJECT / "addon" / "planar_deform"
BUILD = PROJECT / "build" / "extension"
PLATFORM = "linux-x64"
NO_WHEELS = "wheels = []"
# Of the BLAS libraries that may be installed side by side, the one that two threads can call at once
# (Debian's serial build corrupts its buffers then); we switch its own threads off.
BLAS = "/usr/lib/x86_64-linux-gnu/openblas-pthread"
# The compiler's own libraries, whose functions carry versions.
RUNTIME = ("libgfortran", "libgomp", "libquadmath")


def run(*command: str | Path) -> str:
    """What a command prints, of this environment or the system; if it fails, show that and stop."""
    search = f"{Path(sys.executable).parent}:/usr/bin:/bin"
    result = subprocess.run(
        command,
        cwd=PROJECT,
        env={**os.environ, "PATH": search, "LD_LIBRARY_PATH": BLAS},
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
    )
    if result.returncode:
        sys.exit(f"{result.stdout}\n{' '.join(map(str, command))}: failed")
    return result.stdout


def only_wheel(folder: Path) -> Path:
    (wheel,) = folder.glob("*.whl")
    return wheel


def fingerprint(headers: Path) -> str:
    """Changes with anything that a wheel is made from."""
    sources = [PROJECT / "CMakeLists.txt", PROJECT / "pyproject.toml", Path(__file__)]
    for folder in (PROJECT / "native", PROJECT / "tools" / "requirements", headers):
        sources += sorted(path for path in folder.rglob("*") if path.is_file())
    digest = hashlib.sha256(Path("/etc/debian_version").read_bytes())
    for path in sources:
        digest.update(str(path).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def seclude(wheel: Path) -> None:
    """Give every function of the bundled numerical libraries a name of its own.

    A Blender that is linked to another version of one of them (Debian's 5.2 is, to SuiteSparse 7) would put
    its functions in the place of ours: the first of a name in the process is taken, from whatever file.
    """
    folder = wheel.parent / "unpacked"
    run("wheel", "unpack", "--dest", folder, wheel)
    (content,) = folder.iterdir()
    bundled = [path for path in content.glob("*.libs/*") if not path.name.startswith(RUNTIME)]
    table = run("nm", "--dynamic", "--defined-only", "--format=posix", *bundled)
    names = {line.split()[0] for line in table.splitlines() if len(line.split()) > 1}
    renaming = folder / "names"
    renaming.write_text("".join(f"{name} planar_{name}\n" for name in sorted(names)))
    for library in [*content.glob("*/_core.*.so"), *bundled]:
        run("patchelf", "--rename-dynamic-symbols", renaming, library)
    run("wheel", "pack", "--dest-dir", wheel.parent, content)
    shutil.rmtree(folder)


def build_wheel(tag: str, headers: Path) -> Path:
    """A wheel for CPython `tag`, from its headers alone, that brings the libraries it needs along."""
    raw, repaired = BUILD / tag / "raw", BUILD / tag / "repaired"
    stamp, wanted = BUILD / tag / "stamp", fingerprint(headers)
    if stamp.exists() and stamp.read_text() == wanted:
        return only_wheel(repaired)
    print(f"Building the wheel for {tag}", flush=True)
    shutil.rmtree(BUILD / tag, ignore_errors=True)
    settings = {
        "build-dir": BUILD / "cmake",  # one for all: the library itself does not depend on Python
        "cmake.define.Python_INCLUDE_DIR": headers,
        "cmake.define.PYTHON_MODULE_EXTENSION": (headers / "module-suffix").read_text(),
        "cmake.define.PYTHON_MODULE_DEBUG_POSTFIX": "",
        "cmake.define.PYTHON_IS_DEBUG": "OFF",
    }
    options = [f"--config-settings={key}={value}" for key, value in settings.items()]
    run(
        "python", "-m", "pip", "wheel", "--no-build-isolation", "--no-deps", *options, "--wheel-dir", raw, "."
    )
    # scikit-build-core names the wheel after the Python that runs it.
    run("wheel", "tags", "--remove", "--python-tag", tag, "--abi-tag", tag, only_wheel(raw))
    run("auditwheel", "repair", "--strip", "--wheel-dir", repaired, only_wheel(raw))
    seclude(only_wheel(repaired))
    stamp.write_text(wanted)
    return only_wheel(repaired)


def notices(wheel: Path) -> dict[str, str]:
    """The licences of the Debian libraries in a wheel, by package."""
    with zipfile.ZipFile(wheel) as archive:
        (parts,) = (name for name in archive.namelist() if name.endswith("sboms/auditwheel.cdx.json"))
        components = json.loads(archive.read(parts))["components"]
    packages = {part["name"] for part in components if part["purl"].startswith("pkg:deb/")}
    return {name: Path(f"/usr/share/doc/{name}/copyright").read_text() for name in sorted(packages)}


def manifest_with(wheels: list[Path]) -> str:
    manifest = (ADDON / "blender_manifest.toml").read_text()
    names = "".join(f'  "./wheels/{wheel.name}",\n' for wheel in wheels)
    filled = re.sub(f"^{re.escape(NO_WHEELS)}$", f"wheels = [\n{names}]", manifest, flags=re.MULTILINE)
    if filled == manifest:
        sys.exit(f"blender_manifest.toml has no line '{NO_WHEELS}' to fill in")
    return filled


def pack(wheels: list[Path]) -> Path:
    manifest = manifest_with(wheels)
    version = tomllib.loads(manifest)["version"]
    target = PROJECT / "dist" / f"planar_deform-{version}-{PLATFORM.replace('-', '_')}.zip"
    target.parent.mkdir(exist_ok=True)
    partial = target.with_suffix(".partial")
    with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("blender_manifest.toml", manifest)
        archive.write(PROJECT / "LICENSE", "LICENSE")
        for name, text in notices(wheels[0]).items():
            archive.writestr(f"licenses/{name}.txt", text)
        for path in sorted(ADDON.rglob("*")):
            inside = path.relative_to(ADDON)
            if (
                path.is_file()
                and "__pycache__" not in inside.parts
                and inside.name != "blender_manifest.toml"
            ):
                archive.write(path, inside)
        for wheel in wheels:
            archive.write(wheel, f"wheels/{wheel.name}", zipfile.ZIP_STORED)
    partial.replace(target)
    return target


def main() -> None:
    folders = sorted(Path(sys.argv[1]).resolve().glob("cp*"))
    wheels = [build_wheel(folder.name, folder) for folder in folders]
    target = pack(wheels)
    size = target.stat().st_size / 1e6
    print(f"{target.relative_to(PROJECT)}, {size:.0f} MB, for {', '.join(folder.name for folder in folders)}")


if __name__ == "__main__":
    main()
