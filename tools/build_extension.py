#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Build dist/planar_deform-VERSION-PLATFORM.zip: the add-on with wheels of the module that bring their libraries along.

A wheel is built for the Python that runs this and for each whose headers are in HEADERS/cpXY (tools/python_headers.py).

usage: build_extension.py HEADERS
"""

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


def run(*command: str | Path, **environment: str) -> str:
    """Run a command of this environment and return what it printed; on failure show that and stop."""
    search = f"{Path(sys.executable).parent}:/usr/bin:/bin"
    result = subprocess.run(
        [sys.executable, "-m", *command],
        cwd=PROJECT,
        env={**os.environ, "PATH": search, **environment},
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
    )
    if result.returncode:
        sys.exit(f"{result.stdout}\n{' '.join(map(str, command))}: failed")
    return result.stdout


def newest(folder: Path) -> Path:
    (wheel,) = folder.glob("*.whl")
    return wheel


def build_wheel(tag: str, headers: Path | None) -> Path:
    """A repaired wheel for CPython `tag`; headers of None: the Python that runs this."""
    raw, repaired = BUILD / tag / "raw", BUILD / tag / "repaired"
    for folder in (raw, repaired):
        shutil.rmtree(folder, ignore_errors=True)
    settings = {"build-dir": str(BUILD / tag / "cmake")}
    if headers:
        settings["cmake.define.Python_INCLUDE_DIR"] = str(headers)
        settings["cmake.define.PYTHON_MODULE_EXTENSION"] = (headers / "module-suffix").read_text()
        settings["cmake.define.PYTHON_MODULE_DEBUG_POSTFIX"] = ""
        settings["cmake.define.PYTHON_IS_DEBUG"] = "OFF"
    options = [f"--config-settings={key}={value}" for key, value in settings.items()]
    run("pip", "wheel", "--no-build-isolation", "--no-deps", *options, "--wheel-dir", raw, ".")
    if headers:  # scikit-build-core names the wheel after the Python that runs it
        run("wheel", "tags", "--remove", "--python-tag", tag, "--abi-tag", tag, newest(raw))
    # Of the BLAS libraries that may be installed side by side, the one that two threads can call at once (Debian's serial
    # build corrupts its buffers then); the library switches its own threads off.
    blas = "/usr/lib/x86_64-linux-gnu/openblas-pthread"
    run("auditwheel", "repair", "--strip", "--wheel-dir", repaired, newest(raw), LD_LIBRARY_PATH=blas)
    return newest(repaired)


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
    headers = {path.name: path for path in sorted(Path(sys.argv[1]).resolve().glob("cp*"))}
    builds = {f"cp{sys.version_info.major}{sys.version_info.minor}": None, **headers}
    wheels = []
    for tag, folder in builds.items():
        print(f"Building the wheel for {tag}", flush=True)
        wheels.append(build_wheel(tag, folder))
        print(f"  {wheels[-1].name}, {wheels[-1].stat().st_size / 1e6:.1f} MB", flush=True)
    target = pack(wheels)
    print(f"{target.relative_to(PROJECT)}, {target.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
