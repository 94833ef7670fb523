#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Build dist/repository/, which any web server offers as a repository of extensions.

In it are the archives, the index that Blender reads, made by its own tool, and a page with pictures to drag
into Blender's window. Of the archives in dist/ those of the present version are taken, for each platform the
one that serves fewest others.

usage: build_repository.py
"""

import html
import json
import shutil
import subprocess
import sys
import tomllib
import urllib.parse
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

PROJECT = Path(__file__).resolve().parents[1]
DIST = PROJECT / "dist"
TEMPLATE = Path(__file__).with_name("repository.html")
MANIFEST = "blender_manifest.toml"
PLATFORMS = {
    "windows-x64": "Windows",
    "macos-arm64": "macOS, Apple silicon",
    "macos-x64": "macOS, Intel",
    "linux-x64": "Linux",
}
# What a dropped address tells Blender, so that it can say why an archive is not for it.
TOLD = ("blender_version_min", "blender_version_max", "platforms", "python_versions")


def manifest_of(archive: Path) -> dict[str, Any]:
    with zipfile.ZipFile(archive) as content:
        return tomllib.loads(content.read(MANIFEST).decode())


def chosen(archives: Sequence[Path], version: str) -> list[Path]:
    """Those of a version, without any whose platforms others serve who serve fewer."""
    manifests = {path: manifest_of(path) for path in archives}
    ours = [path for path in archives if manifests[path]["version"] == version]
    served: set[str] = set()
    taken = []
    for path in sorted(ours, key=lambda path: (len(manifests[path].get("platforms", PLATFORMS)), path.name)):
        platforms = set(manifests[path].get("platforms", PLATFORMS))
        if not platforms <= served:
            served |= platforms
            taken.append(path)
    return taken


def build(archives: Sequence[Path], folder: Path, generate: Sequence[str]) -> list[dict[str, Any]]:
    """Make the repository in place of what the folder held; `generate` is Blender's command for the index.

    Returns the index's entries. Raises CalledProcessError; ValueError where Blender did not take an archive.
    """
    partial = folder.with_name(f".{folder.name}.partial")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir(parents=True)
    for archive in archives:
        shutil.copy2(archive, partial)
    result = subprocess.run(
        [*generate, "--repo-dir", str(partial)], check=True, capture_output=True, text=True
    )
    path = partial / "index.json"
    index = json.loads(path.read_text(encoding="utf-8"))
    entries: list[dict[str, Any]] = sorted(index["data"], key=lambda entry: str(entry["archive_url"]))
    if len(entries) != len(archives):
        raise ValueError(f"Blender lists {len(entries)} of {len(archives)} archives:\n{result.stdout}")
    path.write_text(json.dumps({**index, "data": entries}, indent=1) + "\n", encoding="utf-8")
    (partial / "index.html").write_text(page(entries), encoding="utf-8")
    shutil.rmtree(folder, ignore_errors=True)
    partial.replace(folder)
    return entries


def page(entries: Sequence[dict[str, Any]]) -> str:
    first = entries[0]
    text = TEMPLATE.read_text(encoding="utf-8")
    for name, value in {
        "NAME": first["name"],
        "TAGLINE": first["tagline"],
        "VERSION": first["version"],
        "BLENDER": first["blender_version_min"].removesuffix(".0"),
    }.items():
        text = text.replace(f"@{name}@", html.escape(value))
    order = list(PLATFORMS)
    by_platform = sorted(entries, key=lambda entry: order.index(entry.get("platforms", order)[0]))
    return text.replace("@ARCHIVES@", "\n".join(map(picture, by_platform)))


def picture(entry: dict[str, Any]) -> str:
    """A link to drag: the address of an archive, and what Blender has to know of it."""
    told = {name: entry[name] for name in TOLD if entry.get(name)}
    query = {name: value if isinstance(value, str) else ",".join(value) for name, value in told.items()}
    address = f"{entry['archive_url']}?{urllib.parse.urlencode({'repository': './index.json', **query})}"
    label = " and ".join(PLATFORMS[platform] for platform in entry.get("platforms", PLATFORMS))
    size = f"{entry['archive_size'] / 1e6:.1f} MB"
    return (
        f'<a class="archive" href="{html.escape(address)}"><svg viewBox="0 0 64 64" aria-hidden="true">'
        f'<use href="#cutout"/></svg><b>{html.escape(label)}</b><span>{size}</span></a>'
    )


def blender_s_tool(subcommand: str) -> list[str]:
    """A command of the bpy module in the .venv for extensions."""
    (tool,) = (PROJECT / ".venv").glob(
        "lib/python*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py"
    )
    return [str(PROJECT / ".venv" / "bin" / "python"), str(tool), subcommand]


def main() -> None:
    version = tomllib.loads((PROJECT / "addon" / "planar_deform" / MANIFEST).read_text())["version"]
    archives = chosen(sorted(DIST.glob("planar_deform-*.zip")), version)
    if not archives:
        sys.exit(f"No extension of version {version} in dist/: run 'make extension' first.")
    entries = build(archives, DIST / "repository", blender_s_tool("server-generate"))
    print(f"dist/repository: {', '.join(entry['archive_url'].removeprefix('./') for entry in entries)}")


if __name__ == "__main__":
    main()
