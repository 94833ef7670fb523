#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check that everything states the same version and the same Blenders, and build what is to be published.

The version is that of CMakeLists.txt, the Blenders are those of the tests (tools/requirements/bpy-*.txt): the
manifest, the head of CHANGELOG.md, README.md and the pages say the same, a file of the version is kept for
later ones to open, and the commit has the version's tag. Then dist/repository/ is made (build_repository.py).

usage: release.py [--check]      with --check only what holds for any commit, and nothing is built
"""

import hashlib
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import build_repository

PROJECT = Path(__file__).resolve().parents[1]
BLENDERS = re.compile(r"Blender (\d+\.\d+)(?: LTS)? to (\d+\.\d+)(?: LTS)?")
KEPT = Path("blender_tests", "data", "storage", "files")


def version_of(project: Path) -> str:
    found = re.search(
        r"^project\(\w+ VERSION ([\d.]+)", (project / "CMakeLists.txt").read_text(), re.MULTILINE
    )
    if found is None:
        raise ValueError("CMakeLists.txt has no project(... VERSION ...)")
    return found[1]


def tested_blenders(project: Path) -> tuple[str, str]:
    """The oldest and the newest, as 4.2."""
    names = [path.stem for path in (project / "tools" / "requirements").glob("bpy-*.txt")]
    versions = sorted(tuple(map(int, name.removeprefix("bpy-").split("."))) for name in names)
    oldest, newest = (f"{version[0]}.{version[1]}" for version in (versions[0], versions[-1]))
    return oldest, newest


def disagreements(project: Path) -> list[str]:
    """What states another version or other Blenders than the project has, and what to do."""
    version, blenders = version_of(project), tested_blenders(project)
    found = []
    path = project / "addon" / "planar_deform" / "blender_manifest.toml"
    manifest = tomllib.loads(path.read_text(encoding="utf-8"))
    if manifest["version"] != version:
        found.append(
            f"{path.name} has version {manifest['version']}: make it {version}, as CMakeLists.txt has it"
        )
    if manifest["blender_version_min"] != f"{blenders[0]}.0":
        least = manifest["blender_version_min"]
        found.append(f"{path.name} begins with Blender {least}, the tests with {blenders[0]}: make them one")
    heads = re.split(r"^## ", (project / "CHANGELOG.md").read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    if not heads or heads[0].split("\n")[0].strip() != version:
        found.append(f"CHANGELOG.md begins with another version: give it an entry '## {version}'")
    texts = {"CHANGELOG.md": heads[0] if heads else ""}
    for path in (project / "README.md", *sorted((project / "docs").glob("*.md"))):
        texts[path.relative_to(project).as_posix()] = path.read_text(encoding="utf-8")
    for name, text in texts.items():
        stated = BLENDERS.findall(text)
        if any(each != blenders for each in stated) or (name in ("CHANGELOG.md", "README.md") and not stated):
            found.append(
                f"{name} does not say 'Blender {blenders[0]} to {blenders[1]}', which is what is tested"
            )
    for suffix in (".blend", ".json"):
        kept = KEPT / f"{version}{suffix}"
        if not (project / kept).exists():
            found.append(f"There is no {kept}: make it by {KEPT.parent / 'make_kept_file.py'}")
    return found


def unpublishable(project: Path) -> list[str]:
    """Why the commit is not the one that has the version's tag, and what to do."""
    tag = f"v{version_of(project)}"

    def git(*arguments: str) -> str:
        result = subprocess.run(["git", *arguments], cwd=project, capture_output=True, text=True, check=False)
        return result.stdout.strip()

    found = []
    if git("status", "--porcelain"):
        found.append("There are changes that are in no commit: commit or remove them")
    if git("rev-list", "-n", "1", tag) != git("rev-parse", "HEAD"):
        found.append(
            f"The tag {tag} is not on this commit: git tag {tag}, or raise the version if it is published"
        )
    return found


def publish() -> None:
    """Build all, and say what is to be copied to the web server."""
    subprocess.run(["make", "--silent", "repository"], cwd=PROJECT, check=True)
    folder = build_repository.DIST / "repository"
    version = version_of(PROJECT)
    archives = sorted(folder.glob("*.zip"))
    for archive in archives:
        subprocess.run([*build_repository.blender_s_tool("validate"), str(archive)], check=True)
        if build_repository.manifest_of(archive)["version"] != version:
            sys.exit(f"{archive.name} has another version than {version}")
        print(hashlib.sha256(archive.read_bytes()).hexdigest(), archive.name)
    served = {name for archive in archives for name in build_repository.manifest_of(archive)["platforms"]}
    print(f"{folder.relative_to(PROJECT)} is version {version}, for {', '.join(sorted(served))}")


def main() -> None:
    only_check = sys.argv[1:] == ["--check"]
    reasons = disagreements(PROJECT) + ([] if only_check else unpublishable(PROJECT))
    if reasons:
        sys.exit("\n".join(reasons))
    if not only_check:
        publish()


if __name__ == "__main__":
    main()
