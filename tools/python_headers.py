#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fetch the headers of the Pythons of Debian's releases to DIRECTORY/cpXY, with the suffix of their modules.

Nothing is installed, and no root is needed: apt keeps lists of its own and downloads one package a release. A
release that cannot be had is named and left out; what is there already is kept.

usage: python_headers.py DIRECTORY RELEASE...
"""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

KEYS = "/usr/share/keyrings/debian-archive-keyring.gpg"


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


def fetch(release: str, target: Path, work: Path) -> str:
    """Put the headers of a release's Python into target/cpXY; returns cpXY."""
    for folder in ("lists/partial", "archives/partial", "content"):
        (work / folder).mkdir(parents=True)
    # A mirror may serve an sid that it has not renewed for a while.
    sources = work / "sources.list"
    sources.write_text(f"deb [signed-by={KEYS} check-valid-until=no] {mirror()} {release} main\n")
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
    names = re.findall(r"Depends: (libpython3\.\d+-dev)", run("apt-cache", *apt, "depends", "libpython3-dev"))
    run("apt-get", *apt, "--quiet=2", "download", names[0], cwd=work)
    (package,) = work.glob("*.deb")
    run("dpkg-deb", "--extract", package, work / "content")

    (include,) = (work / "content/usr/include").glob("python3.*")
    version = include.name.removeprefix("python").replace(".", "")
    # Debian's pyconfig.h only chooses among those of several machines, which are elsewhere.
    (configuration,) = (work / "content/usr/include").glob(f"*-linux-gnu/{include.name}/pyconfig.h")
    shutil.copy(configuration, include / "pyconfig.h")
    machine = configuration.parents[1].name
    (include / "module-suffix").write_text(f".cpython-{version}-{machine}.so")
    (include / "debian-release").write_text(release)
    shutil.rmtree(target / f"cp{version}", ignore_errors=True)
    shutil.copytree(include, target / f"cp{version}")
    return f"cp{version}"


def main() -> None:
    target = Path(sys.argv[1])
    target.mkdir(parents=True, exist_ok=True)
    there = {mark.read_text() for mark in target.glob("*/debian-release")}
    for release in sys.argv[2:]:
        if release in there:
            continue
        with tempfile.TemporaryDirectory() as work:
            try:
                print(f"Python headers of Debian {release}: {fetch(release, target, Path(work))}", flush=True)
            except subprocess.CalledProcessError:
                print(f"No headers of Debian {release}'s Python, hence no wheel for it.", file=sys.stderr)


if __name__ == "__main__":
    main()
