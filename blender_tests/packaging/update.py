# SPDX-License-Identifier: GPL-3.0-or-later
"""Update the extension in a running Blender for Windows, and start that again.

    tools/wine_tests.sh update 4.2.23

The compiled module is a stand-in in two versions, a package that loads some DLL of Python's: Windows lets
nobody replace or remove that as long as it is loaded, no more than the real one. Each step is a process of
its own.
"""

import json
import os
import subprocess
import sys
import tempfile
import zipfile
from importlib.util import find_spec
from pathlib import Path

from installed import result_in

ADDON = Path(__file__).resolve().parents[2] / "addon" / "planar_deform"
MODULE = "bl_ext.user_default.planar_deform"
OLD, NEW = "8.0.0", "8.0.1"
STAND_IN = """
import ctypes, pathlib
loaded = ctypes.CDLL(str(pathlib.Path(__file__).with_name("_core.pyd")))
def build_info(): return {{"version": "{version}"}}
def __getattr__(name):
    if name.startswith("__"): raise AttributeError(name)
    return type(name, (Exception,), {{}})
"""


def write_wheel(folder: Path, version: str) -> Path:
    title = f"planar_deform_native-{version}"
    info = f"{title}.dist-info"
    files = {
        "planar_native/__init__.py": STAND_IN.format(version=version).encode(),
        "planar_native/_core.pyd": Path(find_spec("_queue").origin).read_bytes(),
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: {title}\nVersion: {version}\n".encode(),
        f"{info}/WHEEL": b"Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    files[f"{info}/RECORD"] = "".join(f"{name},,\n" for name in [*files, f"{info}/RECORD"]).encode()
    target = folder / f"{title}-py3-none-any.whl"
    with zipfile.ZipFile(target, "w") as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return target


def write_extension(folder: Path, version: str) -> Path:
    wheel = write_wheel(folder, version)
    own = {"version": f'"{version}"', "wheels": f'["./wheels/{wheel.name}"]', "platforms": '["windows-x64"]'}
    lines = (ADDON / "blender_manifest.toml").read_text(encoding="utf-8").splitlines()
    lines = [line for line in lines if line.split(" = ")[0] not in own]
    lines += [f"{name} = {value}" for name, value in own.items()]
    target = folder / f"planar_deform-{version}.zip"
    with zipfile.ZipFile(target, "w") as archive:
        archive.writestr("blender_manifest.toml", "\n".join(lines))
        archive.write(wheel, f"wheels/{wheel.name}")
        for path in ADDON.rglob("*.py"):
            archive.write(path, path.relative_to(ADDON).as_posix())
    return target


def state() -> dict:
    import bpy

    import planar_native

    return {
        "enabled": MODULE in bpy.context.preferences.addons,
        "asks": hasattr(bpy.types, "PLANAR_PT_restart"),
        "works": hasattr(bpy.types, "PLANAR_OT_add_pin"),
        "module": planar_native.build_info()["version"],
    }


def update(*archives: str) -> list[dict]:
    """Install from Disk, one after the other."""
    import bpy

    states = []
    for archive in archives:
        try:
            bpy.ops.extensions.package_install_files(
                filepath=archive, repo="user_default", enable_on_install=True, overwrite=True
            )
        except RuntimeError as error:  # what Blender tells of the file that it cannot replace
            print(error)
        states.append(state())
    return states


def restart() -> list[dict]:
    """A bpy module starts with factory settings, where the program enables what its user did."""
    import bpy  # noqa: F401  knows where the next is

    import addon_utils  # isort: skip

    addon_utils.enable(MODULE, default_set=True, refresh_handled=True)
    return [state()]


def run(step: str, home: Path, *arguments: Path) -> list[dict]:
    done = subprocess.run(
        [sys.executable, __file__, step, *map(str, arguments)],
        env={**os.environ, "BLENDER_USER_RESOURCES": str(home)},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )
    return result_in(done.stdout, f"{step}, exit code {done.returncode}")


def main() -> int:
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        work = Path(name)
        (work / "home").mkdir()
        states = run("update", work / "home", *(write_extension(work, version) for version in (OLD, NEW)))
        states += run("restart", work / "home")
    runs = {"enabled": True, "asks": False, "works": True}
    expected = {
        "is installed": {**runs, "module": OLD},
        "asks for a restart when it is updated": {
            "enabled": True,
            "asks": True,
            "works": False,
            "module": OLD,
        },
        "is the new one after the restart": {**runs, "module": NEW},
    }
    failed = 0
    for (title, wanted), found in zip(expected.items(), states, strict=True):
        failed += found != wanted
        print(f"PASS {title}" if found == wanted else f"FAIL {title}: {found}", flush=True)
    print(f"{len(expected) - failed} passed, {failed} failed", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    steps = {"update": update, "restart": restart}
    if len(sys.argv) > 1:
        print("RESULT", json.dumps(steps[sys.argv[1]](*sys.argv[2:])), flush=True)
    else:
        sys.exit(main())
