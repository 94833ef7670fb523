#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fetch from Debian's archive what the extension is compiled with, to build/cross/sources.

    suitesparse/              the sources of CHOLMOD and what it includes
    include/                  CGAL and boost, without all else that lies in /usr/include
    python/cpXY/unix/         Python's headers for Linux and macOS
    python/cpXY/windows/      for Windows, with libpythonXY.a, by which the linker knows Python's functions

No package is installed, and no root is needed: apt keeps lists of its own. Sources are pinned by their
sha256. Of Python's headers each release of Debian has one version; those of a release that cannot be had are
named and left out. What is there already is kept.

usage: sources.py PLATFORM...        what these platforms need
       sources.py archive NAME       print where a source package lies, fetched if need be
"""

import hashlib
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
CROSS = PROJECT / "build" / "cross"
SOURCES = CROSS / "sources"
KEYS = "/usr/share/keyrings/debian-archive-keyring.gpg"
# Debian's release, source package, and the sha256 of upstream's files in it.
ARCHIVES = {
    "suitesparse": (
        "bookworm",
        "suitesparse_5.12.0+dfsg.orig.tar.xz",
        "bb106c43049138c19675cd70322e72ff8e4fd8bdcab3a096307fd78488913faf",
    ),
    "python3.11": (
        "bookworm",
        "python3.11_3.11.2.orig.tar.gz",
        "2411c74bda5bbcfcddaf4531f66d1adc73f247f529aee981b029513aefdbf849",
    ),
    "python3.13": (
        "trixie",
        "python3.13_3.13.5.orig.tar.xz",
        "93e583f243454e6e9e4588ca2c2662206ad961659863277afcdb96801647d640",
    ),
}
# Whose Python the Blenders have: 4.2 to 5.0, 5.1 and newer, Debian's own newest.
PYTHON_RELEASES = ("bookworm", "trixie", "sid")
SUITESPARSE_PARTS = ("AMD", "CAMD", "CCOLAMD", "CHOLMOD", "COLAMD", "LICENSE.txt", "SuiteSparse_config")


def run(*command: str | Path, cwd: Path | None = None) -> str:
    return subprocess.run(command, cwd=cwd, check=True, text=True, stdout=subprocess.PIPE).stdout


def mirror() -> str:
    """Where this machine has its Debian from."""
    targets = run(
        "apt-get", "indextargets", "--format", "$(LABEL) $(COMPONENT) $(REPO_URI)", "Created-By: Packages"
    )
    for label, component, address in (line.split() for line in targets.splitlines()):
        if (label, component) == ("Debian", "main"):
            return address
    raise SystemExit("apt has no list of Debian's packages: run apt-get update first.")


def fetch(release: str, kind: str, work: Path, command: str, *names: str) -> None:
    """Have apt-get download packages (kind deb) or their sources (deb-src) of a release into `work`."""
    for folder in ("lists/partial", "archives/partial"):
        (work / folder).mkdir(parents=True, exist_ok=True)
    # A mirror may serve an sid that it has not renewed for a while.
    sources = work / "sources.list"
    sources.write_text(f"{kind} [signed-by={KEYS} check-valid-until=no] {mirror()} {release} main\n")
    options = {
        "Dir::Etc::SourceList": sources,
        "Dir::Etc::SourceParts": "-",
        "Dir::State::Lists": work / "lists",
        "Dir::State::Status": "/dev/null",
        "Dir::Cache": work,
        "APT::Update::Error-Mode": "any",
        "APT::Sandbox::User": "root",
    }
    apt = [f"--option={name}={value}" for name, value in options.items()]
    run("apt-get", *apt, "--quiet=2", "update")
    if not names:  # the newest Python of the release
        depends = run("apt-cache", *apt, "depends", "libpython3-dev")
        names = tuple(re.findall(r"Depends: (libpython3\.\d+-dev)", depends)[:1])
    run("apt-get", *apt, "--quiet=2", *command.split(), *names, cwd=work)


def archive(name: str) -> Path:
    """The pinned file of a source package in build/cross/archives."""
    release, file, wanted = ARCHIVES[name]
    target = CROSS / "archives" / file
    if target.exists():
        return target
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        print(f"Sources of {name} from Debian {release}", flush=True)
        fetch(release, "deb-src", work, "source --download-only --tar-only", name)
        found = hashlib.sha256((work / file).read_bytes()).hexdigest()
        if found != wanted:
            raise SystemExit(f"{file} has sha256 {found}, not {wanted} as tools/cross/sources.py tells.")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.move(work / file, target)
    return target


def extract(name: str, parts: tuple[str, ...], target: Path) -> None:
    """Those parts of a source package, without the folder that holds them all."""
    partial = target.with_name(f"{target.name}.partial")
    shutil.rmtree(partial, ignore_errors=True)
    with tarfile.open(archive(name)) as content:
        for member in content:
            inside = Path(*Path(member.name).parts[1:])
            if member.isfile() and inside.parts and inside.parts[0] in parts:
                file = content.extractfile(member)  # extract() is safe from Python 3.11.4 on
                if file is None or ".." in inside.parts:
                    raise SystemExit(f"{name}: {member.name} is no plain file")
                (partial / inside).parent.mkdir(parents=True, exist_ok=True)
                (partial / inside).write_bytes(file.read())
    partial.rename(target)


def suitesparse() -> None:
    target = SOURCES / "suitesparse"
    if not target.exists():
        extract("suitesparse", SUITESPARSE_PARTS, target)


def includes() -> None:
    """Links to the installed headers of CGAL and boost."""
    folder = SOURCES / "include"
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("CGAL", "boost"):
        if not (folder / name).is_symlink():
            (folder / name).symlink_to(Path("/usr/include") / name)


def python_headers(release: str) -> None:
    """The headers of a release's Python in python/cpXY/unix, with the release's name."""
    if any(mark.read_text() == release for mark in SOURCES.glob("python/*/debian-release")):
        return
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        try:
            fetch(release, "deb", work, "download")
        except subprocess.CalledProcessError:
            print(f"No headers of Debian {release}'s Python, hence no module for it.", file=sys.stderr)
            return
        (package,) = work.glob("*.deb")
        run("dpkg-deb", "--extract", package, work / "content")
        (include,) = (work / "content/usr/include").glob("python3.*")
        # Debian's pyconfig.h only chooses among those of several machines, which are elsewhere. macOS takes
        # that of Linux, too: pymacconfig.h corrects what differs.
        (configuration,) = (work / "content/usr/include").glob(f"*-linux-gnu/{include.name}/pyconfig.h")
        shutil.copy(configuration, include / "pyconfig.h")
        tag = "cp" + include.name.removeprefix("python").replace(".", "")
        target = SOURCES / "python" / tag
        shutil.rmtree(target, ignore_errors=True)
        shutil.copytree(include, target / "unix")
        (target / "debian-release").write_text(release)
        print(f"Python headers of Debian {release}: {tag}", flush=True)


def windows_python(tag: str) -> None:
    """Headers and import library of a Python for Windows."""
    target = SOURCES / "python" / tag / "windows"
    if target.exists():
        return
    partial = target.with_name("windows.partial")
    shutil.rmtree(partial, ignore_errors=True)
    extract(f"python{tag[2]}.{tag[3:]}", ("Include", "PC"), partial)
    headers = partial / "Include"
    # From 3.13 on the build makes it of a template, which it changes for free threads only.
    (template,) = (partial / "PC").glob("pyconfig.h*")
    shutil.copy(template, headers / "pyconfig.h")
    # All that the headers declare. What a module does not use is not imported, be it in the DLL or not.
    declared = re.compile(r"PyAPI_(FUNC|DATA)\([^)]*\)\s*(?:_Py_NO_RETURN\s+)?(\w+)")
    text = "\n".join(path.read_text(errors="replace") for path in sorted(headers.rglob("*.h")))
    names = {name: " DATA" if kind == "DATA" else "" for kind, name in declared.findall(text)}
    library = f"python{tag[2:]}"
    definition = partial / f"{library}.def"
    lines = [f"{name}{data}" for name, data in sorted(names.items())]
    definition.write_text("\n".join([f"LIBRARY {library}.dll", "EXPORTS", *lines, ""]))
    zig = Path(__file__).with_name("zig-dlltool")
    run(zig, "-m", "i386:x86-64", "-d", definition, "-l", headers / f"lib{library}.a", "-D", f"{library}.dll")
    headers.rename(target)
    shutil.rmtree(partial)


def main() -> None:
    match sys.argv[1:]:
        case ["archive", name]:
            print(archive(name))
        case platforms if platforms:
            suitesparse()
            includes()
            for release in PYTHON_RELEASES:
                python_headers(release)
            if "windows-x64" in platforms:
                for tag in ("cp311", "cp313"):
                    windows_python(tag)
        case _:
            raise SystemExit(__doc__)


if __name__ == "__main__":
    main()
