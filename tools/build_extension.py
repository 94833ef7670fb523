#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Build dist/planar_deform-VERSION-PLATFORM.zip: the add-on and a wheel of the module for each platform.

The wheel serves every Python whose headers tools/cross/sources.py has: it has a module for each, linked to
nothing but the platform's own libraries. It is built unless the last one is up to date. The zip is named as
Blender's `extension build --split-platforms` does; of all platforms planar_deform-VERSION.zip is made, too.
The same sources give the same bytes: files are sorted and have one date.

usage: build_extension.py PLATFORM...
"""

import base64
import csv
import dataclasses
import hashlib
import io
import os
import re
import shutil
import stat
import subprocess
import sys
import tomllib
import zipfile
from collections.abc import Mapping
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1]
ADDON = PROJECT / "addon" / "planar_deform"
PACKAGE = PROJECT / "native" / "python" / "planar_native"
BUILD = PROJECT / "build" / "extension"
CROSS = PROJECT / "build" / "cross"
SOURCES = CROSS / "sources"
DIST = PROJECT / "dist"
DATE = (1980, 1, 1, 0, 0, 0)  # the first that a zip can tell


@dataclasses.dataclass(frozen=True)
class Platform:
    name: str  # Blender's
    wheel: str  # Python's
    suffix: str  # of a module, by the digits of a Python's version
    pythons: tuple[str, ...] = ("cp311", "cp313")


PLATFORMS = {
    platform.name: platform
    for platform in (
        Platform(
            "linux-x64",
            "manylinux_2_28_x86_64",
            ".cpython-{}-x86_64-linux-gnu.so",
            ("cp311", "cp313", "cp314"),
        ),
        Platform("windows-x64", "win_amd64", ".cp{}-win_amd64.pyd"),
        Platform("macos-arm64", "macosx_11_0_arm64", ".cpython-{}-darwin.so"),
        Platform("macos-x64", "macosx_10_15_x86_64", ".cpython-{}-darwin.so"),
    )
}


def run(*command: str | Path) -> str:
    """What a command of this environment or the system prints; if it fails, show that and stop."""
    search = f"{Path(sys.executable).parent}:/usr/bin:/bin"
    result = subprocess.run(
        command,
        cwd=PROJECT,
        env={**os.environ, "PATH": search},
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
    )
    if result.returncode:
        sys.exit(f"{result.stdout}\n{' '.join(map(str, command))}: failed")
    return result.stdout


def version() -> str:
    """The project's, which stands in CMakeLists.txt."""
    (found,) = re.findall(r"project\(\w+ VERSION ([0-9.]+)", (PROJECT / "CMakeLists.txt").read_text())
    return str(found)


def sources() -> list[Path]:
    """What a wheel is made from, but for the headers of Python."""
    files = [PROJECT / "CMakeLists.txt", PROJECT / "pyproject.toml", Path(__file__)]
    for folder in (PROJECT / "native", PROJECT / "tools" / "cross", PROJECT / "tools" / "requirements"):
        files += (path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return sorted(files)


def headers_of(platform: Platform, python: str) -> Path:
    return SOURCES / "python" / python / ("windows" if platform.name.startswith("windows") else "unix")


def pythons_of(platform: Platform) -> list[str]:
    """Those of the platform's whose headers are there."""
    return [python for python in platform.pythons if headers_of(platform, python).exists()]


def fingerprint(platform: Platform) -> str:
    """Changes with anything that the wheel of a platform is made from."""
    digest = hashlib.sha256(Path("/etc/debian_version").read_bytes())
    headers = (headers_of(platform, python) / "patchlevel.h" for python in pythons_of(platform))
    for path in [*sources(), *headers]:
        digest.update(str(path).encode() + b"\0" + path.read_bytes())
    digest.update(repr(platform).encode())
    return digest.hexdigest()


def compile_module(platform: Platform, python: str) -> Path:
    """The module for one Python, in the platform's build folder: the library is compiled once for all."""
    folder = PROJECT / "build" / f"cross-{platform.name}"
    headers = headers_of(platform, python)
    suffix = platform.suffix.format(python.removeprefix("cp"))
    settings = {
        "CMAKE_TOOLCHAIN_FILE": PROJECT / "tools" / "cross" / "toolchain.cmake",
        "PLANAR_PLATFORM": platform.name,
        "PLANAR_PYTHON": "ON",
        "PLANAR_CHOLMOD_SOURCE": SOURCES / "suitesparse",
        "CGAL_INCLUDE_DIR": SOURCES / "include",
        "EIGEN3_INCLUDE_DIR": "/usr/include/eigen3",
        "pybind11_DIR": run(sys.executable, "-m", "pybind11", "--cmakedir").strip(),
        "PYBIND11_FINDPYTHON": "ON",
        "Python_INCLUDE_DIR": headers,
        "PYTHON_MODULE_EXTENSION": suffix,
        "PYTHON_MODULE_DEBUG_POSTFIX": "",
        "PYTHON_IS_DEBUG": "OFF",
    }
    if headers.name == "windows":
        settings["Python_LIBRARY"] = headers / f"lib{python.replace('cp', 'python')}.a"
    options = [f"-D{name}={value}" for name, value in settings.items()]
    # What CMake has found for the last Python is forgotten.
    run("cmake", "-S", PROJECT, "-B", folder, "-G", "Ninja", "-U", "Python_*", "-U", "_Python_*", *options)
    jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL") or str(os.cpu_count())
    run("cmake", "--build", folder, "--target", "_core", "--parallel", jobs)
    return folder / "native" / "python" / f"_core{suffix}"


def write_zip(target: Path, files: Mapping[str, bytes]) -> None:
    """An archive of these files; what is compressed already (wheels) is stored."""
    partial = target.with_suffix(".partial")
    with zipfile.ZipFile(partial, "w") as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, DATE)
            entry.external_attr = (stat.S_IFREG | 0o644) << 16
            kind = zipfile.ZIP_STORED if name.endswith(".whl") else zipfile.ZIP_DEFLATED
            archive.writestr(entry, data, kind)
    partial.replace(target)


def tree(folder: Path) -> dict[str, bytes]:
    """The files of a package by their paths in it, sorted."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and "__pycache__" not in path.parts
    }


def write_wheel(platform: Platform, modules: Mapping[str, Path], folder: Path) -> Path:
    """planar_native's wheel with a module for each of these Pythons (PyPA's binary distribution format)."""
    project = tomllib.loads((PROJECT / "pyproject.toml").read_text())["project"]
    title = f"{project['name'].replace('-', '_')}-{version()}"
    info = f"{title}.dist-info"
    files = {f"{PACKAGE.name}/{name}": data for name, data in tree(PACKAGE).items()}
    files |= {f"{PACKAGE.name}/{module.name}": module.read_bytes() for module in modules.values()}
    metadata = {
        "Metadata-Version": "2.4",
        "Name": project["name"],
        "Version": version(),
        "Summary": project["description"],
        "Requires-Python": project["requires-python"],
        "License-Expression": project["license"],
        "License-File": "LICENSE",
    }
    lines = [f"{name}: {value}" for name, value in metadata.items()]
    lines += [f"Requires-Dist: {need}" for need in project["dependencies"]]
    files[f"{info}/METADATA"] = "\n".join([*lines, ""]).encode()
    tags = [f"Tag: {python}-{python}-{platform.wheel}" for python in modules]
    head = ["Wheel-Version: 1.0", "Generator: planar_deform", "Root-Is-Purelib: false"]
    files[f"{info}/WHEEL"] = "\n".join([*head, *tags, ""]).encode()
    files[f"{info}/licenses/LICENSE"] = (PROJECT / "LICENSE").read_bytes()

    record = io.StringIO()
    rows = csv.writer(record, lineterminator="\n")
    for name, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        rows.writerow([name, f"sha256={digest}", len(data)])
    rows.writerow([f"{info}/RECORD", "", ""])
    files[f"{info}/RECORD"] = record.getvalue().encode()
    pythons = ".".join(modules)
    target = folder / f"{title}-{pythons}-{pythons}-{platform.wheel}.whl"
    write_zip(target, files)
    return target


def build_wheel(platform: Platform) -> Path:
    folder = BUILD / platform.name
    stamp = folder / "stamp"
    wanted = fingerprint(platform)
    if not stamp.exists() or stamp.read_text() != wanted:
        there = pythons_of(platform)
        print(f"Building the {platform.name} wheel for {', '.join(there)}", flush=True)
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        write_wheel(platform, {python: compile_module(platform, python) for python in there}, folder)
        stamp.write_text(wanted)
    (wheel,) = folder.glob("*.whl")
    return wheel


def notices() -> dict[str, bytes]:
    """The licences of what is compiled in, by name."""
    packages = Path(sys.executable).parents[1].joinpath("lib")
    (pybind11,) = packages.glob("python3*/site-packages/pybind11-*.dist-info")
    files = {
        "cgal": Path("/usr/share/doc/libcgal-dev/copyright"),
        "eigen": Path("/usr/share/doc/libeigen3-dev/copyright"),
        "libc++": CROSS / "zig" / "ziglang" / "lib" / "libcxx" / "LICENSE.TXT",
        "pybind11": next(pybind11.rglob("LICENSE")),
        "suitesparse": SOURCES / "suitesparse" / "LICENSE.txt",
    }
    return {f"licenses/{name}.txt": path.read_bytes() for name, path in files.items()}


def filled(template: str, line: str, values: list[str]) -> str:
    """The manifest with a list in place of that in `line`."""
    key, _ = line.split(" = ")
    listed = ", ".join(f'"{value}"' for value in values)
    if f"\n{line}\n" not in template:
        sys.exit(f"blender_manifest.toml has no line '{line}' to fill in")
    return template.replace(f"\n{line}\n", f"\n{key} = [{listed}]\n")


def pack(wheels: Mapping[str, Path], suffix: str) -> None:
    """The extension with these platforms' wheels."""
    manifest = (ADDON / "blender_manifest.toml").read_text()
    manifest = filled(manifest, "platforms = []", list(wheels))
    manifest = filled(manifest, "wheels = []", [f"./wheels/{wheel.name}" for wheel in wheels.values()])
    said = tomllib.loads(manifest)["version"]
    if said != version():
        sys.exit(f"blender_manifest.toml has version {said}, CMakeLists.txt {version()}")
    files = {"blender_manifest.toml": manifest.encode(), "LICENSE": (PROJECT / "LICENSE").read_bytes()}
    files |= notices()
    files |= {name: data for name, data in tree(ADDON).items() if name != "blender_manifest.toml"}
    files |= {f"wheels/{wheel.name}": wheel.read_bytes() for wheel in wheels.values()}
    DIST.mkdir(exist_ok=True)
    target = DIST / f"planar_deform-{said}{suffix}.zip"
    write_zip(target, files)
    print(f"{target.relative_to(PROJECT)}, {target.stat().st_size / 1e6:.1f} MB", flush=True)


def main() -> None:
    if not sys.argv[1:] or not set(sys.argv[1:]) <= set(PLATFORMS):
        sys.exit(__doc__)
    wheels = {}
    for name in sys.argv[1:]:
        wheels[name] = build_wheel(PLATFORMS[name])
        pack({name: wheels[name]}, f"-{name.replace('-', '_')}")
    if set(wheels) == set(PLATFORMS):
        pack(wheels, "")


if __name__ == "__main__":
    main()
