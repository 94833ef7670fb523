# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's window adds our repository from a web server on this machine, installs, updates and removes."""

import contextlib
import functools
import html
import http.server
import io
import re
import shutil
import sys
import threading
import urllib.parse
import zipfile
from collections.abc import Iterator
from pathlib import Path

from installed import PROJECT, Blender, check

sys.path.insert(0, str(PROJECT / "tools"))
import build_repository

SCREEN = ("xvfb-run", "-a", "-s", "-screen 0 1280x800x24")
WINDOW = ("--enable-event-simulate", "--window-geometry", "0", "0", "1280", "800", "--python-exit-code", "1")
STEPS = Path(__file__).with_name("window_steps.py")
BEFORE = "0.0.1"
TOLD = """
_info = build_info


def build_info():
    return _info() | {{"version": "{version}"}}
"""


def packed_as(archive: Path, version: str, folder: Path) -> Path:
    """The same extension as another version."""
    now = build_repository.manifest_of(archive)["version"]
    target = folder / archive.name.replace(now, version)
    target.write_bytes(renamed(archive.read_bytes(), now, version))
    return target


def renamed(archive: bytes, now: str, version: str) -> bytes:
    """An archive with another version in names, files and the wheel in it, whose module tells it, too."""
    target = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(archive)) as source, zipfile.ZipFile(target, "w") as copy:
        for name in source.namelist():
            content = source.read(name)
            if name.endswith(".whl"):
                content = renamed(content, now, version)
            elif name.endswith(("blender_manifest.toml", "METADATA", "RECORD")):
                content = content.replace(now.encode(), version.encode())
            elif name == "planar_native/__init__.py":
                content += TOLD.format(version=version).encode()
            copy.writestr(name.replace(now, version), content)
    return target.getvalue()


@contextlib.contextmanager
def served(folder: Path) -> Iterator[str]:
    """The address of a web server that offers a folder, and no more than any other does."""
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(folder))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield f"http://127.0.0.1:{server.server_port}/"
        finally:
            server.shutdown()


def dragged(folder: Path, address: str) -> str:
    """What a browser hands to Blender when the picture on the repository's page is dropped there."""
    page = (folder / "index.html").read_text(encoding="utf-8")
    links = re.findall(r'class="archive" href="([^"]+)"', page)
    (link,) = (link for link in links if "platforms=linux-x64" in link)
    return urllib.parse.urljoin(address, html.unescape(link))


def go_through(blender: Blender, *steps: str) -> None:
    command = [*SCREEN, blender.program[0], *WINDOW, "--python", str(STEPS), "--", *steps]
    result = blender.call(command, timeout=900)
    check(result.returncode == 0, f"exit code {result.returncode}\n{result.stdout}")
    check("GONE THROUGH" in result.stdout, f"not gone through\n{result.stdout}")
    check("Traceback" not in result.stdout, result.stdout)


def check_repository(blender: Blender, archive: Path) -> None:
    work = blender.cwd / "repository"
    work.mkdir()
    assert blender.command_line is not None
    generate = [*blender.command_line, "server-generate"]
    now = build_repository.manifest_of(archive)["version"]
    build_repository.build([archive], work / "now", generate)
    build_repository.build([packed_as(archive, BEFORE, work)], work / "before", generate)
    live = work / "served"
    live.symlink_to(work / "before")
    before = blender.files()
    with served(live) as address:
        go_through(blender, "update", dragged(live, address), str(live), str(work / "now"), BEFORE, now)
        go_through(blender, "remove", now)
    left = [path for path in blender.files() - before if "planar" in path.name]
    check(not left, f"left on disk after the removal: {left[:5]}")
    shutil.rmtree(work)
