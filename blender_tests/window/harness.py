# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs files of window tests in Blender: `blender --enable-event-simulate --python harness.py -- test_x.py`.

A test is a generator function `test_...(window)`: it simulates events, and each `yield` lets Blender handle
them and redraw. Every test starts from the factory scene without its objects, with the add-on enabled; every
file from factory settings and with the add-on's modules as if Blender had just started.
"""

import ctypes
import importlib.util
import inspect
import itertools
import os
import subprocess
import sys
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import ModuleType

import addon_utils
import bpy
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Quaternion, Vector

HERE = Path(__file__).resolve().parent
PICTURES = HERE.parents[1] / "out" / "window"
TOOL = "planar.pose_tool"
EXTENSION = "bl_ext.user_default.planar_deform"

Test = Callable[["Window"], Iterator[None]]


class Window:
    """The user's hands and eyes: moves, presses, keys and pictures in Blender's main window."""

    def __init__(self) -> None:
        self.mouse = (0, 0)
        self._button = 10_000  # how high one was found last in the sidebar: above it at first
        self._buttons: dict[str, int] = {}  # and how high each one

    # ---- what is there; looked up each time, as loading a file replaces all of it
    @property
    def window(self) -> bpy.types.Window:
        return bpy.context.window_manager.windows[0]

    @property
    def area(self) -> bpy.types.Area:
        return max(
            (a for a in self.window.screen.areas if a.type == "VIEW_3D"), key=lambda a: a.width * a.height
        )

    def region(self, kind: str = "WINDOW") -> bpy.types.Region:
        return next(region for region in self.area.regions if region.type == kind)

    @property
    def view(self) -> bpy.types.RegionView3D:
        return self.area.spaces.active.region_3d

    def context(self, kind: str = "WINDOW"):
        """The context that the view's own buttons and keys would have."""
        return bpy.context.temp_override(window=self.window, area=self.area, region=self.region(kind))

    def pixel(self, world: Sequence[float]) -> tuple[int, int]:
        """Window coordinates of a world position."""
        region = self.region()
        place = location_3d_to_region_2d(region, self.view, Vector(world))
        assert place is not None, f"{tuple(world)} is behind the view"
        return region.x + round(place.x), region.y + round(place.y)

    # ---- events; each helper ends with a yield, so that Blender has handled them
    def wait(self, seconds: float) -> Iterator[None]:
        until = time.monotonic() + seconds
        for step in itertools.count():  # a few steps at least, however long a redraw takes
            if step >= 4 and time.monotonic() >= until:
                return
            yield

    def event(self, kind: str, value: str, **modifiers: bool) -> Iterator[None]:
        self._simulate(kind, value, **modifiers)
        yield

    def _simulate(self, kind: str, value: str, **more: bool | str) -> None:
        x, y = self.mouse
        self.window.event_simulate(type=kind, value=value, x=x, y=y, **more)

    def move(self, place: tuple[int, int], *, steps: int = 1, **modifiers: bool) -> Iterator[None]:
        """Move the mouse there on a straight line of so many events."""
        start = self.mouse
        for step in range(1, steps + 1):
            self.mouse = tuple(round(a + (b - a) * step / steps) for a, b in zip(start, place, strict=True))
            yield from self.event("MOUSEMOVE", "NOTHING", **modifiers)

    def hover(self, place: tuple[int, int]) -> Iterator[None]:
        """Arrive there as a hand does: a gizmo lights up under a moving mouse, and is drawn after that."""
        yield from self.move((place[0] + 2, place[1] + 1))
        yield from self.move(place)
        yield

    def press(self, kind: str = "LEFTMOUSE", **modifiers: bool) -> Iterator[None]:
        yield from self.event(kind, "PRESS", **modifiers)

    def release(self, kind: str = "LEFTMOUSE", **modifiers: bool) -> Iterator[None]:
        yield from self.event(kind, "RELEASE", **modifiers)

    def click(self, place: tuple[int, int], kind: str = "LEFTMOUSE", **modifiers: bool) -> Iterator[None]:
        yield from self.hover(place)
        yield from self.press(kind, **modifiers)
        yield from self.release(kind, **modifiers)
        yield

    def drag(self, start: tuple[int, int], end: tuple[int, int], *, steps: int = 8) -> Iterator[None]:
        yield from self.hover(start)
        yield from self.press()
        yield from self.move(end, steps=steps)
        yield from self.release()
        yield from self.settled()

    def confirm(self, kind: str = "RET") -> Iterator[None]:
        """Confirm what G or R began."""
        yield from self.key(kind)
        yield from self.settled()

    def settled(self, seconds: float = 20.0) -> Iterator[None]:
        """Until all that a drag asked for is solved and shown; after a release, until the drag has ended."""
        yield  # the last event is handled by then
        until = time.monotonic() + seconds
        running, session = addon("operators.modal.running").now, addon("operators.modal.session").Session
        while isinstance(drag := running(), session) and (drag.released or not drag.settled):
            assert time.monotonic() < until, f"the drawing does not settle within {seconds} s"
            yield
        yield

    def key(self, kind: str, **modifiers: bool) -> Iterator[None]:
        yield from self.press(kind, **modifiers)
        yield from self.release(kind, **modifiers)
        if modifiers.get("ctrl"):
            yield from self.release("LEFT_CTRL")  # else Blender's own mouse events still have it

    def type(self, text: str) -> Iterator[None]:
        names = dict(
            zip("0123456789", "ZERO ONE TWO THREE FOUR FIVE SIX SEVEN EIGHT NINE".split(), strict=True)
        )
        for character in text:
            kind = {**names, ".": "PERIOD", "-": "MINUS"}[character]
            self._simulate(kind, "PRESS", unicode=character)
            yield
            yield from self.release(kind)

    def undo(self) -> Iterator[None]:
        yield from self.key("Z", ctrl=True)
        yield

    def redo(self) -> Iterator[None]:
        yield from self.key("Z", ctrl=True, shift=True)
        yield

    # ---- the sidebar
    def sidebar(self, tab: str = "Planar") -> Iterator[None]:
        """Open it at a tab."""
        self.area.spaces.active.show_region_ui = True
        yield from self.wait(0.3)  # it knows its tabs once it has been drawn
        self.region("UI").active_panel_category = tab
        self.region("UI").tag_redraw()
        yield from self.wait(0.3)

    def push(self, operator: str) -> Iterator[None]:
        """Click the sidebar's button of an operator, such as planar.key_pose, wherever it is."""
        region = self.region("UI")
        columns = [region.x + round(region.width * share) for share in (0.25, 0.6, 0.82)]
        rows = range(region.y + 7, region.y + region.height, 14)
        last = self._buttons.get(operator, self._button)  # the next one is often near
        places = sorted(((x, y) for y in rows for x in columns), key=lambda place: abs(place[1] - last))
        manager = bpy.context.window_manager
        for slowly, place in itertools.product((False, True), places):
            self.mouse, manager.clipboard = place, ""
            self._simulate("MOUSEMOVE", "NOTHING")
            if slowly:  # some buttons know the mouse after a redraw only
                yield
            self._simulate("C", "PRESS", ctrl=True)  # copies the command of the button under the mouse
            self._simulate("C", "RELEASE", ctrl=True)
            yield
            if manager.clipboard.startswith(f"bpy.ops.{operator}("):
                yield from self.release("LEFT_CTRL")  # as after each key with it
                self._button = self._buttons[operator] = place[1]
                yield from self.click(place)
                return
        raise AssertionError(f"the sidebar shows no button of {operator}")

    # ---- the view and the tool
    def look(self, direction: str = "FRONT", distance: float = 8.0) -> Iterator[None]:
        """An orthographic look at the origin: FRONT sees the XZ plane, TOP the XY, RIGHT the YZ plane."""
        turns = {"TOP": (1, 0, 0, 0), "FRONT": (0.7071068, 0.7071068, 0, 0), "RIGHT": (0.5, 0.5, 0.5, 0.5)}
        self.view.view_perspective = "ORTHO"
        self.view.view_rotation = Quaternion(turns[direction])
        self.view.view_location = (0, 0, 0)
        self.view.view_distance = distance
        yield from self.wait(0.1)

    def use_tool(self, name: str = TOOL) -> Iterator[None]:
        with self.context():
            bpy.ops.wm.tool_set_by_id(name=name)
        yield from self.wait(0.1)

    @property
    def tool(self) -> str:
        return bpy.context.workspace.tools.from_space_view3d_mode("OBJECT", create=False).idname

    @property
    def busy(self) -> list[str]:
        """The modal operators that are running."""
        return [operator.bl_idname for operator in self.window.modal_operators]

    def reports(self) -> str:
        """All that operators have reported so far, as the Info editor lists it."""
        area = min(self.window.screen.areas, key=lambda a: a.width * a.height)
        kind, area.type = area.type, "INFO"
        region = next(region for region in area.regions if region.type == "WINDOW")
        with bpy.context.temp_override(window=self.window, area=area, region=region):
            bpy.ops.info.select_all(action="SELECT")
            bpy.ops.info.report_copy()
            bpy.ops.info.select_all(action="DESELECT")
        area.type = kind
        return bpy.context.window_manager.clipboard

    def colours(self, place: tuple[int, int], radius: int = 12) -> list[tuple[int, int, int]]:
        """The pixels on the screen in a square about a place."""
        x, y = place[0] - radius, self.window.height - 1 - place[1] - radius
        crop = f"{2 * radius + 1}x{2 * radius + 1}+{x}+{y}"
        command = ["import", "-window", "root", "-crop", crop, "-depth", "8", "rgb:-"]
        raw = subprocess.run(command, check=True, capture_output=True).stdout
        return [(raw[i], raw[i + 1], raw[i + 2]) for i in range(0, len(raw), 3)]

    def picture(self, name: str) -> Path:
        """Everything on the screen, as a PNG."""
        PICTURES.mkdir(parents=True, exist_ok=True)
        path = PICTURES / f"{name}.png"
        subprocess.run(["import", "-window", "root", str(path)], check=True)
        return path


def addon(name: str) -> ModuleType:
    """A module of the installed extension."""
    return next(module for path, module in sys.modules.items() if path.endswith(f".planar_deform.{name}"))


def fresh_file() -> None:
    bpy.ops.wm.read_homefile(app_template="")
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    set_views()


def start_anew() -> None:
    """What another start of Blender does: factory settings and the extension, imported again."""
    addon_utils.disable(EXTENSION)
    for name in [name for name in sys.modules if name == EXTENSION or name.startswith(f"{EXTENSION}.")]:
        del sys.modules[name]
    bpy.ops.wm.read_factory_settings()
    addon_utils.enable(EXTENSION, default_set=True)
    set_preferences()


def set_preferences() -> None:
    preferences = bpy.context.preferences
    preferences.view.show_splash = False
    preferences.view.smooth_view = 0
    preferences.use_preferences_save = False
    preferences.edit.keyframe_new_interpolation_type = "LINEAR"  # a frame tells its share of the way
    # Most of a redraw's time without a graphics card.
    preferences.system.viewport_aa = "OFF"
    preferences.system.use_overlay_smooth_wire = False


def set_views() -> None:
    """What takes most of a redraw's time without a graphics card, and what nothing of ours depends on."""
    views = [
        area.spaces.active for screen in bpy.data.screens for area in screen.areas if area.type == "VIEW_3D"
    ]
    for view in views:
        view.shading.show_object_outline = False
        view.overlay.show_outline_selected = False
        view.overlay.show_floor = view.overlay.show_ortho_grid = False


def load(path: Path) -> list[Test]:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return [
        thing
        for name, thing in vars(module).items()
        if name.startswith("test_") and inspect.isfunction(thing)
    ]


def steps(paths: Sequence[Path], results: list[bool]) -> Iterator[None]:
    """Run all tests of the files one after the other, a step at a time."""
    for number, path in enumerate(paths):
        if number > 0:
            start_anew()
        before = len(results)
        yield from steps_of_file(path, Window(), results)
        if len(results) == before:
            results.append(False)
            print(f"FAIL {path.name} has no tests", flush=True)


def steps_of_file(path: Path, window: Window, results: list[bool]) -> Iterator[None]:
    for test in load(path):
        name, started = f"{path.stem}.{test.__name__}", time.monotonic()
        fresh_file()
        yield from window.wait(0.2)
        try:
            yield from test(window)
            results.append(True)
            print(f"PASS {name} ({time.monotonic() - started:.1f} s)", flush=True)
        except Exception:
            results.append(False)
            print(f"FAIL {name}", flush=True)
            for line in traceback.format_exc().splitlines():
                print("     " + line, flush=True)
            window.picture(f"failed-{name}")
            yield from window.key("ESC")  # out of whatever modal operator the test left running
            yield from window.wait(0.2)


def leave(code: int) -> None:
    """End Blender with an exit code; what it printed itself is still in C's buffers."""
    sys.stderr.flush()
    ctypes.CDLL(None).fflush(None)
    os._exit(code)


def main() -> None:
    paths = [Path(name) for name in sys.argv[sys.argv.index("--") + 1 :]]
    set_preferences()
    results: list[bool] = []
    running = steps(paths, results)

    def tick() -> float:
        try:
            next(running)
        except StopIteration:
            print(f"{results.count(True)} passed, {results.count(False)} failed", flush=True)
            leave(0 if results and all(results) else 1)
        except BaseException:
            traceback.print_exc()
            leave(1)
        return 0.01

    bpy.app.timers.register(tick, first_interval=0.5, persistent=True)


if __name__ == "__main__":
    # Blender runs a script in a namespace that is no module; tests import this one.
    sys.path.insert(0, str(HERE))
    import harness

    harness.main()
