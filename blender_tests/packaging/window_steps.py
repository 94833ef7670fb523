# SPDX-License-Identifier: GPL-3.0-or-later
"""What a person does in Blender's window with the repository that repository.py serves:

    blender ... --python window_steps.py -- update DROPPED SERVED NEXT VERSION LATER
    blender ... --python window_steps.py -- remove LATER

DROPPED is the address of the archive that is dropped into the window, SERVED the link to the folder that is
served, which is to lead to NEXT for the update. After that Blender is started again.
"""

import importlib
import sys
import time
import tomllib
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import addon_utils
import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "window"))
from harness import Window, leave

PATIENCE = 180.0  # seconds


def repository() -> int:
    """The place of ours in the preferences."""
    repos = bpy.context.preferences.extensions.repos
    found = [i for i, repo in enumerate(repos) if repo.remote_url.startswith("http://127.0.0.1:")]
    assert len(found) == 1, f"{len(found)} repositories of ours: {[repo.remote_url for repo in repos]}"
    return found[0]


def folder() -> Path:
    return Path(bpy.context.preferences.extensions.repos[repository()].directory) / "planar_deform"


def installed() -> str | None:
    """The version that is installed and enabled, whether it works or asks for a restart."""
    manifest = folder() / "blender_manifest.toml"
    name = f"bl_ext.{bpy.context.preferences.extensions.repos[repository()].module}.planar_deform"
    if not manifest.exists() or not addon_utils.check(name)[1]:
        return None
    return tomllib.loads(manifest.read_text(encoding="utf-8"))["version"]


def works() -> bool:
    return hasattr(bpy.types.Object, "planar") and bool(dir(bpy.ops.planar))


def asks_for_restart() -> bool:
    return hasattr(bpy.types, "PLANAR_PT_restart")


def until(window: Window, done: Callable[[], bool], what: str) -> Iterator[None]:
    end = time.monotonic() + PATIENCE
    while not done():
        if time.monotonic() > end:
            window.picture(f"failed-repository-{bpy.app.version_string}")
            raise AssertionError(f"{what} did not happen")
        yield
    yield from window.wait(0.5)


def drop(window: Window, address: str) -> Iterator[None]:
    """What Blender does with an address that is let go over its window: it looks for it, and asks."""
    yield from window.hover((640, 400))
    with window.context():
        bpy.ops.extensions.package_install("INVOKE_DEFAULT", url=address)
    yield from window.wait(1.0)
    yield from until(window, lambda: not notify().update_in_progress(), "the look at the repositories")
    for step in range(20):  # the dialog goes on when it is drawn
        yield from window.move((640 + step % 2, 400))
        yield from window.wait(0.1)


def notify() -> ModuleType:
    """Blender's own, of what it asks repositories in the background."""
    return next(module for name, module in sys.modules.items() if name.endswith("bl_pkg.bl_extension_notify"))


def update(window: Window, dropped: str, served: str, following: str, *versions: str) -> Iterator[None]:
    repos = bpy.context.preferences.extensions.repos
    for repo in [repo for repo in repos if repo.use_remote_url]:
        repos.remove(repo)  # Blender's own is not on this machine
    known = len(repos)
    yield from drop(window, dropped)
    window.picture("repository-1-unknown")
    yield from window.key("RET")  # Add Repository...
    yield from window.wait(1.0)
    window.picture("repository-2-add")
    yield from window.key("RET")  # with the address that came with the drop, which is open to be edited
    yield from window.wait(0.5)
    yield from window.key("RET")
    yield from until(window, lambda: len(repos) == known + 1, "the repository's being added")
    address = repos[repository()].remote_url
    assert address == dropped.partition("?")[0].rpartition("/")[0] + "/index.json", address
    yield from until(window, lambda: not window.busy, "the end of what the dialog began")
    yield from drop(window, dropped)
    window.picture("repository-3-install")
    yield from window.key("RET")
    yield from until(window, lambda: installed() == versions[0], "the installation")
    yield from until(window, lambda: not window.busy, "the end of the installation")

    assert works()
    assert not asks_for_restart()
    solves(versions[0])

    link = Path(served).with_name("next")
    link.symlink_to(following)
    link.replace(served)
    yield from run(window, "repo_sync_all")
    yield from run(window, "package_upgrade_all")
    assert installed() == versions[1], f"{installed()} is installed after the update"
    assert asks_for_restart()
    assert not works(), "operators of the new version are there with the old module"
    yield from window.wait(0.5)
    window.picture("repository-4-restart")
    bpy.ops.wm.save_userpref()


def remove(window: Window, version: str) -> Iterator[None]:
    known = len(bpy.context.preferences.extensions.repos)
    assert installed() == version, f"{installed()} is installed after the restart"
    assert works()
    assert not asks_for_restart()
    solves(version)
    yield from run(window, "package_uninstall", repo_index=repository(), pkg_id="planar_deform")
    assert not folder().exists(), "it is still there after the removal"
    assert not hasattr(bpy.types.Object, "planar"), "what was removed is still registered"
    assert not dir(bpy.ops.planar), dir(bpy.ops.planar)
    bpy.ops.preferences.extension_repo_remove(index=repository(), remove_files=True)
    assert len(bpy.context.preferences.extensions.repos) == known - 1


def run(window: Window, name: str, **options: int | str) -> Iterator[None]:
    """One of the buttons of Get Extensions."""
    with window.context():
        getattr(bpy.ops.extensions, name)("INVOKE_DEFAULT", **options)
    yield from window.wait(1.0)
    yield from until(window, lambda: not window.busy, name)


def solves(version: str) -> None:
    """The module of this version does."""
    native = importlib.import_module("planar_native")
    assert native.build_info()["version"] == version, native.build_info()
    poser = native.Poser([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])
    poser.set_handles([0, 1])
    assert abs(poser.move([[0, 0], [1, 0.5]])).max() > 0.4


def main() -> None:
    preferences = bpy.context.preferences
    preferences.view.show_splash = False
    preferences.system.use_online_access = True
    name, *arguments = sys.argv[sys.argv.index("--") + 1 :]
    running = {"update": update, "remove": remove}[name](Window(), *arguments)

    def tick() -> float:
        try:
            next(running)
        except StopIteration:
            print("GONE THROUGH", flush=True)
            leave(0)
        except BaseException:
            traceback.print_exc()
            leave(1)
        return 0.02

    bpy.app.timers.register(tick, first_interval=1.0, persistent=True)


if __name__ == "__main__":
    main()
