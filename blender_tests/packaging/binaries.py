#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What can be told of the built extension's files without running them: tools/extension_files.sh.

Each platform's zip holds a wheel with a module for each Python; every module needs the platform's own
libraries alone, in versions that its oldest systems have, shows nothing but its init function and has the
kernels for AVX2. Blender's own tool says of each zip that it is valid. Exit code 0 only if all passed.

usage: binaries.py BLENDER_EXT PLATFORM...        BLENDER_EXT: blender_ext.py of a Blender
"""

import hashlib
import io
import re
import struct
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import lief

PROJECT = Path(__file__).resolve().parents[2]
PYTHONS = {
    "linux-x64": {"cp311", "cp313", "cp314"},
    "windows-x64": {"cp311", "cp313"},
    "macos-arm64": {"cp311", "cp313"},
    "macos-x64": {"cp311", "cp313"},
}
INIT = "PyInit__core"
NEWEST_GLIBC = (2, 28)
NEWEST_MACOS = {"macos-arm64": (11, 0), "macos-x64": (10, 15)}
LINUX_LIBRARIES = {"libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2", "ld-linux-x86-64.so.2"}
# Of Windows 10 and newer: its C library is ucrtbase, which programs know by the names of its parts.
WINDOWS_LIBRARIES = re.compile(r"kernel32\.dll|ntdll\.dll|advapi32\.dll|api-ms-win-crt-[a-z]+-l1-1-0\.dll")
MACOS_LIBRARIES = {"/usr/lib/libSystem.B.dylib"}
MACOS_LINKER = {"___dso_handle", "__mh_dylib_header"}  # where the file itself lies; zig's linker shows it
# The operators new and delete of LLVM's C++ library, which the linker cannot hide: weak ones, of which macOS
# takes one for a whole process.
MACOS_ALLOCATION = re.compile(r"__Z(n[aw]m|d[al]Pvm?)(St11align_val_t)?")
# vfmadd132pd, 213, 231 and vfnmadd of 256 bits: VEX with the map 0F38; W1, L1; opcode. By chance: 1 in 5 MB.
WIDE_FMA = re.compile(
    b"\xc4[\x02\x22\x42\x62\x82\xa2\xc2\xe2]"
    b"[\x85\x8d\x95\x9d\xa5\xad\xb5\xbd\xc5\xcd\xd5\xdd\xe5\xed\xf5\xfd][\x98\x9c\xa8\xac\xb8\xbc]"
)
KERNELS = 50  # as many such instructions, at least


def check(condition: object, message: str) -> None:
    if not condition:
        raise AssertionError(message)


def code(binary: lief.Binary, section: str) -> bytes:
    return bytes(next(part.content for part in binary.sections if part.name == section))


def check_kernels(text: bytes) -> None:
    found = len(WIDE_FMA.findall(text))
    check(found >= KERNELS, f"{found} fused products of 256 bits: the AVX2 kernels are missing")


def check_linux(data: bytes, _platform: str, _python: str) -> None:
    binary = lief.ELF.parse(data)
    libraries = set(binary.libraries)
    check(libraries <= LINUX_LIBRARIES, f"needs {libraries - LINUX_LIBRARIES}")
    shown = {symbol.name for symbol in binary.exported_symbols}
    check(shown == {INIT}, f"shows {sorted(shown)[:20]}")
    needed = {
        tuple(map(int, version.name.removeprefix("GLIBC_").split(".")))
        for library in binary.symbols_version_requirement
        for version in library.get_auxiliary_symbols()
    }
    check(max(needed)[:2] <= NEWEST_GLIBC, f"needs glibc {max(needed)}")
    tags = {entry.tag for entry in binary.dynamic_entries}
    check(
        not tags & {lief.ELF.DynamicEntry.TAG.RPATH, lief.ELF.DynamicEntry.TAG.RUNPATH}, "has a search path"
    )
    check_kernels(code(binary, ".text"))


def check_windows(data: bytes, _platform: str, python: str) -> None:
    binary = lief.PE.parse(list(data))
    libraries = {entry.name.lower() for entry in binary.imports}
    check(f"python{python.removeprefix('cp')}.dll" in libraries, f"is not for {python}: {libraries}")
    strange = {
        name for name in libraries if not name.startswith("python") and not WINDOWS_LIBRARIES.fullmatch(name)
    }
    check(not strange, f"needs {strange}")
    shown = {entry.name for entry in binary.exported_functions}
    check(shown == {INIT}, f"shows {sorted(shown)[:20]}")
    check_kernels(code(binary, ".text"))


def check_pages(signature: bytes, data: bytes) -> None:
    """An ad-hoc signature's hashes (xnu, osfmk/kern/cs_blobs.h): macOS ends a process whose pages differ."""
    magic, _, count = struct.unpack_from(">III", signature)
    check(magic == 0xFADE0CC0, f"a signature starts with {magic:#x}")
    starts = dict(struct.unpack_from(">II", signature, 12 + 8 * i) for i in range(count))
    directory = signature[starts[0] :]
    magic, _, _, flags, hashes, _, _, slots, limit = struct.unpack_from(">9I", directory)
    size, kind, _, page = struct.unpack_from(">4B", directory, 36)
    check(magic == 0xFADE0C02 and kind == 2 and size == 32, "the signature is not by sha256")
    check(flags & 2, f"the signature is not ad hoc: {flags:#x}")
    step = 1 << page
    check(slots == -(-limit // step), f"{slots} pages are signed of {limit} bytes")
    for slot in range(slots):
        part = data[slot * step : min((slot + 1) * step, limit)]
        wanted = directory[hashes + size * slot :][:size]
        check(hashlib.sha256(part).digest() == wanted, f"page {slot} is not what was signed")


def check_macos(data: bytes, platform: str, _python: str) -> None:
    architectures = lief.MachO.parse(list(data))  # the files of one, which live no longer
    (binary,) = architectures
    libraries = {library.name for library in binary.libraries} - {binary_name(binary)}
    check(libraries <= MACOS_LIBRARIES, f"needs {libraries - MACOS_LIBRARIES}")
    weak = lief.MachO.ExportInfo.FLAGS.WEAK_DEFINITION
    shown = {
        symbol.name
        for symbol in binary.exported_symbols
        if not (MACOS_ALLOCATION.fullmatch(symbol.name) and symbol.export_info.has(weak))
    } - MACOS_LINKER
    check(shown == {f"_{INIT}"}, f"shows {len(shown)}: {sorted(shown)[:20]}")
    least = binary.build_version.minos if binary.has_build_version else binary.version_min.version
    check(tuple(least)[:2] == NEWEST_MACOS[platform], f"needs macOS {least}")
    check(not binary.has_rpath, "has a search path")
    processor = {"macos-arm64": "ARM64", "macos-x64": "X86_64"}[platform]
    check(binary.header.cpu_type.name == processor, f"is for {binary.header.cpu_type.name}")
    if platform == "macos-arm64":
        check(binary.has_code_signature, "is not signed")
        start, length = binary.code_signature.data_offset, binary.code_signature.data_size
        check_pages(data[start : start + length], data)
    else:
        check_kernels(code(binary, "__text"))


def binary_name(binary: lief.MachO.Binary) -> str | None:
    """How a dynamic library calls itself."""
    kind = lief.MachO.LoadCommand.TYPE.ID_DYLIB
    return next((command.name for command in binary.commands if command.command == kind), None)


def check_wheel(platform: str, data: bytes) -> None:
    judge = {"linux": check_linux, "windows": check_windows, "macos": check_macos}[platform.split("-")[0]]
    found = set()
    with zipfile.ZipFile(io.BytesIO(data)) as wheel:
        for name in wheel.namelist():
            module = re.fullmatch(r"planar_native/_core\.(?:cpython-|cp)(\d+)-.*\.(?:so|pyd)", name)
            if module:
                python = f"cp{module[1]}"
                try:
                    judge(wheel.read(name), platform, python)
                except AssertionError as error:
                    raise AssertionError(f"{name}: {error}") from error
                found.add(python)
    check(found == PYTHONS[platform], f"modules for {sorted(found)}")


def archive_of(platform: str) -> Path:
    (archive,) = (PROJECT / "dist").glob(f"planar_deform-*-{platform.replace('-', '_')}.zip")
    return archive


def check_archive(blender_ext: str, archive: Path, platforms: list[str]) -> None:
    result = subprocess.run(
        [sys.executable, blender_ext, "validate", str(archive)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    check(result.returncode == 0, result.stdout)
    with zipfile.ZipFile(archive) as content:
        manifest = tomllib.loads(content.read("blender_manifest.toml").decode())
        check(manifest["platforms"] == platforms, f"is for {manifest['platforms']}")
        check(len(manifest["wheels"]) == len(platforms), f"has {manifest['wheels']}")
        for platform, wheel in zip(platforms, manifest["wheels"], strict=True):
            check_wheel(platform, content.read(wheel.removeprefix("./")))
        check(len({entry.date_time for entry in content.infolist()}) == 1, "files have dates of their own")


def main() -> int:
    blender_ext, *platforms = sys.argv[1:]
    lief.logging.disable()
    archives = {archive_of(platform): [platform] for platform in platforms}
    if set(platforms) == set(PYTHONS):
        (whole,) = (
            path for path in archive_of("linux-x64").parent.glob("*.zip") if path.stem.count("-") == 1
        )
        archives[whole] = platforms
    failed = 0
    for archive, contents in archives.items():
        try:
            check_archive(blender_ext, archive, contents)
        except AssertionError as error:
            print(f"FAIL {archive.name}: {error}", flush=True)
            failed += 1
        else:
            print(f"PASS {archive.name}, {archive.stat().st_size / 1e6:.2f} MB", flush=True)
    print(f"{len(archives) - failed} passed, {failed} failed", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
