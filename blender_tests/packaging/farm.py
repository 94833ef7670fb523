# SPDX-License-Identifier: GPL-3.0-or-later
"""The jobs of examples/farm, run as a farm runs them, by a Blender in which the extension is installed."""

import json
import shutil
import sys
from pathlib import Path
from typing import Any

from installed import PROJECT, Blender, check
from py_mini_racer import MiniRacer

TEMPLATE = PROJECT / "examples" / "farm" / "openjd" / "template.yaml"
JOB_TYPE = PROJECT / "examples" / "farm" / "flamenco" / "planar_deform_bake.js"
SHOW = 20  # objects
FRAMES = 9
SIZE = 32 + FRAMES * 4 * 12  # bytes of a point cache of four vertices

# What Flamenco Manager has for a job type, see its "Job Types" page.
MANAGER = """
const tasks = [];
const author = {
    Task: (name, type) => ({
        name, type, commands: [], dependencies: [],
        addCommand(command) { this.commands.push(command); },
        addDependency(task) { this.dependencies.push(task.name); },
    }),
    Command: (name, parameters) => ({ name, parameters }),
};
const print = () => {};
"""


def shot(blender: Blender, name: str, objects: int) -> tuple[Path, list[str]]:
    """A .blend in which so many objects are posed, and their names as the command lists them."""
    folder = blender.cwd / name
    folder.mkdir()
    file = folder / "shot.blend"
    blender.step("show", str(file), str(objects))
    code, output = blender.batch("command", str(file), "--list")
    check(code == 0, output)
    (line,) = (line for line in output.splitlines() if line.startswith("["))
    return file, json.loads(line)


def check_baked(blender: Blender, file: Path, before: bytes, objects: list[str]) -> None:
    """Each object has its cache, which the baked file plays; the shot itself is as it was."""
    folder = file.parent
    found = {path.name: path.stat().st_size for path in folder.glob("*.pc2")}
    wanted = {f"{name.replace(' ', '_')}_planar.pc2": SIZE for name in objects}
    check(found == wanted, f"the point caches are {found}")
    check(file.read_bytes() == before, "the shot was written to")
    played = blender.step("played", str(folder / "shot_baked.blend"))
    check(sorted(played) == sorted(objects), f"the baked file plays {sorted(played)}")
    check(all(moved > 0.1 for moved in played.values()), f"what it plays stands still: {played}")


def check_openjd(blender: Blender) -> None:
    file, objects = shot(blender, "openjd", SHOW)
    check(len(objects) == SHOW, f"the command lists {objects}")
    before = file.read_bytes()
    run(blender, file, objects)
    check_baked(blender, file, before, objects)
    baked = file.with_name("shot_baked.blend")
    baked.unlink()
    failed = blender.call(command(blender, file, ["Nobody"]))
    check(failed.returncode != 0, f"a task of no object did not fail:\n{failed.stdout}")
    check("There is no object 'Nobody'" in failed.stdout, f"no reason is told:\n{failed.stdout}")
    check(not baked.exists(), "a file was saved though a task had failed")
    shutil.rmtree(file.parent)


def command(blender: Blender, file: Path, objects: list[str]) -> list[str]:
    parameters = {
        "Blender": blender.program[0],
        "Shot": str(file),
        "Baked": str(file.with_name("shot_baked.blend")),
        "Objects": objects,
    }
    arguments = ["--step", "Gather", "--run-dependencies", "--job-param", json.dumps(parameters)]
    return [sys.executable, "-m", "openjd", "run", str(TEMPLATE), *arguments]


def run(blender: Blender, file: Path, objects: list[str]) -> None:
    result = blender.call(command(blender, file, objects), timeout=1200)
    tasks = result.stdout.count("Running Task")
    check(result.returncode == 0 and tasks == len(objects) + 1, f"{tasks} tasks:\n{result.stdout}")


def check_flamenco(blender: Blender) -> None:
    """Its tasks are the commands that the other job runs."""
    file, objects = shot(blender, "flamenco", 2)
    baked = str(file.with_name("shot_baked.blend"))
    settings = {"shot": str(file), "baked": baked, "generate": True}
    (choice,) = (setting for setting in job_type()["settings"] if setting["key"] == "objects")
    settings["objects"] = blender.step("evaluate", str(file), choice["eval"])
    tasks = compiled(settings)
    work = ["--generate", "--bake", "POINT_CACHE", "--replace"]
    wanted = {f"bake {name}": [f"--object={name}", *work] for name in objects}
    wanted["gather"] = ["--play", "--save", baked]
    check({task["name"]: arguments_of(task, str(file)) for task in tasks} == wanted, f"the tasks are {tasks}")
    check(tasks[-1]["name"] == "gather", "the last task is another")
    check(tasks[-1]["dependencies"] == list(wanted)[:-1], "the last task does not wait for all others")
    only_bake = compiled({**settings, "generate": False})[0]
    check("--generate" not in arguments_of(only_bake, str(file)), "it generates though that is off")
    shutil.rmtree(file.parent)


def arguments_of(task: dict[str, Any], file: str) -> list[str]:
    """What a task gives to our command."""
    (command,) = task["commands"]
    given = command["parameters"]
    program = [command["name"], given["exe"], given["exeArgs"], *given["argsBefore"], given["blendfile"]]
    check(program == ["blender-render", "{blender}", "{blenderArgs}", file], f"it starts {program}")
    check(given["args"][:2] == ["--command", "planar"], f"it is given {given['args']}")
    return given["args"][2:]


def engine() -> MiniRacer:
    made = MiniRacer()
    made.eval(MANAGER + JOB_TYPE.read_text(encoding="utf-8"))
    return made


def job_type() -> Any:
    return json.loads(engine().eval("JSON.stringify(JOB_TYPE)"))


def compiled(settings: dict[str, Any]) -> Any:
    """The tasks of a job with these settings."""
    add = "addTask(task) { tasks.push(task); }"
    script = f"compileJob({{ settings: {json.dumps(settings)}, {add} }}); JSON.stringify(tasks)"
    return json.loads(engine().eval(script))
