#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Build dist/planar_deform-VERSION-PLATFORM.zip: the add-on and a wheel of the module with its libraries.

The wheel serves every Python whose headers are in HEADERS/cpXY (tools/python_headers.py): it has a module for
each, and once the libraries. CHOLMOD brings the BLAS and LAPACK that the system has chosen, though its
analysis, which is all we use, never calls them: with the reference ones the archive has 7 MB, with OpenBLAS
18. The wheel is built unless the last one is up to date.

usage: build_extension.py HEADERS
"""

import hashlib
import json
import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1]
ADDON = PROJECT / "addon" / "planar_deform"
BUILD = PROJECT / "build" / "extension"
CMAKE = PROJECT / "build" / "extension-cmake"
PLATFORM = "linux-x64"
NO_WHEELS = "wheels = []"
# The compiler's own libraries, whose functions carry versions.
RUNTIME = ("libgfortran", "libgomp", "libquadmath")


def run(*command: str | Path) -> str:
    """What a command prints, of this environment or the system; if it fails, show that and stop."""
    search = f"{Path(sys.executable).parent}:/usr/bin:/bin"
    result = subprocess.run(
        command,
        cwd=PROJECT,
        env={**os.environ, "PATH": search, "CXX": "/usr/bin/c++"},  # as CMake names it elsewhere, for ccache
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
    """Changes with anything that the wheel is made from."""
    sources = [PROJECT / "CMakeLists.txt", PROJECT / "pyproject.toml", Path(__file__)]
    for folder in (PROJECT / "native", PROJECT / "tools" / "requirements", headers):
        sources += sorted(path for path in folder.rglob("*") if path.is_file())
    digest = hashlib.sha256(Path("/etc/debian_version").read_bytes())
    for path in sources:
        digest.update(str(path).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def compile_module(headers: Path, folder: Path) -> Path:
    """A wheel with the module for the Python of these headers, named after the Python that runs this."""
    settings = {
        "build-dir": CMAKE,  # one for all: the library itself does not depend on Python
        "cmake.define.Python_INCLUDE_DIR": headers,
        "cmake.define.PYTHON_MODULE_EXTENSION": (headers / "module-suffix").read_text(),
        "cmake.define.PYTHON_MODULE_DEBUG_POSTFIX": "",
        "cmake.define.PYTHON_IS_DEBUG": "OFF",
    }
    options = [f"--config-settings={key}={value}" for key, value in settings.items()]
    run(
        "python",
        "-m",
        "pip",
        "wheel",
        "--no-build-isolation",
        "--no-deps",
        *options,
        "--wheel-dir",
        folder,
        ".",
    )
    return only_wheel(folder)


def unpack(wheel: Path) -> Path:
    folder = wheel.with_suffix(".unpacked")
    run("wheel", "unpack", "--dest", folder, wheel)
    (content,) = folder.iterdir()
    return content


def merge(wheels: dict[str, Path], folder: Path) -> Path:
    """One wheel with the modules of all these wheels, by their Python tags."""
    first, *others = wheels.values()
    content = unpack(first)
    for wheel in others:
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(content, [name for name in archive.namelist() if "/_core.cpython" in name])
    folder.mkdir()
    run("wheel", "pack", "--dest-dir", folder, content)
    tags = ".".join(wheels)
    run("wheel", "tags", "--remove", "--python-tag", tags, "--abi-tag", tags, only_wheel(folder))
    return only_wheel(folder)


def seclude(wheel: Path) -> None:
    """Give every function of the bundled numerical libraries a name of its own.

    A Blender that is linked to another version of one of them (Debian's 5.2 is, to SuiteSparse 7) would put
    its functions in the place of ours: the first of a name in the process is taken, from whatever file.
    """
    content = unpack(wheel)
    bundled = [path for path in content.glob("*.libs/*") if not path.name.startswith(RUNTIME)]
    table = run("nm", "--dynamic", "--defined-only", "--format=posix", *bundled)
    names = {line.split()[0] for line in table.splitlines() if len(line.split()) > 1}
    renaming = content.with_name("names")
    renaming.write_text("".join(f"{name} planar_{name}\n" for name in sorted(names)))
    for library in [*content.glob("*/_core.*.so"), *bundled]:
        run("patchelf", "--rename-dynamic-symbols", renaming, library)
    run("wheel", "pack", "--dest-dir", wheel.parent, content)


def build_wheel(headers: Path) -> Path:
    pythons = {path.name: path for path in sorted(headers.glob("cp*"))}
    folder, stamp = BUILD / "wheel", BUILD / "wheel" / "stamp"
    wanted = fingerprint(headers)
    if not stamp.exists() or stamp.read_text() != wanted:
        print(f"Building the wheel for {', '.join(pythons)}", flush=True)
        shutil.rmtree(folder, ignore_errors=True)
        wheels = {tag: compile_module(path, folder / tag) for tag, path in pythons.items()}
        merged = merge(wheels, folder / "merged")
        run("auditwheel", "repair", "--strip", "--wheel-dir", folder / "repaired", merged)
        seclude(only_wheel(folder / "repaired"))
        stamp.write_text(wanted)
    return only_wheel(folder / "repaired")


def notices(wheel: Path) -> dict[str, str]:
    """The licences of the Debian libraries in a wheel, by package."""
    with zipfile.ZipFile(wheel) as archive:
        (parts,) = (name for name in archive.namelist() if name.endswith("sboms/auditwheel.cdx.json"))
        components = json.loads(archive.read(parts))["components"]
    packages = {part["name"] for part in components if part["purl"].startswith("pkg:deb/")}
    return {name: Path(f"/usr/share/doc/{name}/copyright").read_text() for name in sorted(packages)}


def pack(wheel: Path) -> Path:
    template = (ADDON / "blender_manifest.toml").read_text()
    manifest = template.replace(f"\n{NO_WHEELS}\n", f'\nwheels = ["./wheels/{wheel.name}"]\n')
    if manifest == template:
        sys.exit(f"blender_manifest.toml has no line '{NO_WHEELS}' to fill in")
    version = tomllib.loads(manifest)["version"]
    if wheel.name.split("-")[1] != version:
        sys.exit(f"blender_manifest.toml has version {version}, CMakeLists.txt another: {wheel.name}")
    target = PROJECT / "dist" / f"planar_deform-{version}-{PLATFORM.replace('-', '_')}.zip"
    target.parent.mkdir(exist_ok=True)
    partial = target.with_suffix(".partial")
    with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("blender_manifest.toml", manifest)
        archive.write(PROJECT / "LICENSE", "LICENSE")
        for name, text in notices(wheel).items():
            archive.writestr(f"licenses/{name}.txt", text)
        for path in sorted(ADDON.rglob("*")):
            inside = path.relative_to(ADDON)
            if (
                path.is_file()
                and "__pycache__" not in inside.parts
                and inside.name != "blender_manifest.toml"
            ):
                archive.write(path, inside)
        archive.write(wheel, f"wheels/{wheel.name}", zipfile.ZIP_STORED)
    partial.replace(target)
    return target


def main() -> None:
    target = pack(build_wheel(Path(sys.argv[1]).resolve()))
    print(f"{target.relative_to(PROJECT)}, {target.stat().st_size / 1e6:.0f} MB")


if __name__ == "__main__":
    main()
