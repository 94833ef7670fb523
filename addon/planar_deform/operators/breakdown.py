# SPDX-License-Identifier: GPL-3.0-or-later
"""A pose on the way from one keyed pose to the next, chosen by sliding the mouse, and keyed."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from functools import partial

import bpy
from bpy.props import BoolProperty, FloatProperty

from .. import native
from ..errors import ObjectGone, Refusal, naming, try_all
from ..model.input.breakdown import FURTHEST, OVERSHOOT, WIDTH, Slider, limited
from ..model.work import Progress, Work, part_of
from ..scene.inbetweens import breakdown
from ..scene.inbetweens.breakdown import Way
from ..scene.objects import modifiers
from ..scene.sequence import held, playback, pose_state
from ..scene.sequence.neighbours import around
from ..scene.sequence.playback import Steps, finder
from ..scene.storage import pin_paths
from ..scene.view import snapshot
from .keying import key_shown
from .modal import reports, running
from .modal.long_job import INSTANT, RATE
from .modal.reports import Tell
from .modal.session import CONFIRM, PASSED_ON, put_away, put_up
from .poses import PoseListOperator
from .posing_operator import left_out_told

KEYS = (
    "Move Left or Right: Slide   LMB or Enter: Key   Esc or RMB: Cancel   Shift: Precise   Ctrl: Snap   "
    "E: Overshoot   Digits: Type the Percentage"
)


class _Sliding:
    """A breakdown under way in a window: first its way is solved, then it slides."""

    def __init__(self, ways: Ways):
        self._ways = ways
        self.work = Work(ways.solve)
        self.clock: running.Clock | None = None  # until it is solved

    def solved(self) -> None:
        """Nothing has to be waited for any more."""
        if self.clock is not None:
            self.clock.stop()

    def give_way(self) -> None:
        """See running.Run."""
        try_all((self._ways.restore, self.let_go))

    def let_go(self) -> None:
        """See running.Run."""
        self.work.stop()
        try_all((self.solved, snapshot.release, put_away))


class Ways:
    """The ways of several objects, on which all are shown at the same share."""

    def __init__(self, context: bpy.types.Context, objects: Sequence[bpy.types.Object]):
        """Raises Refusal, with nothing changed."""
        self._ways: list[Way] = []
        for obj in objects:
            name = obj.name if len(objects) > 1 else None
            with naming(name), _refusing():
                self._ways.append(Way(context, obj))
        self.frame = context.scene.frame_current_final

    @property
    def start(self) -> float:
        """Where the first one is on its way."""
        return self._ways[0].start

    @property
    def objects(self) -> list[bpy.types.Object]:
        """The objects. Raises ObjectGone."""
        return [way.drawing.resolve() for way in self._ways]

    def solve(self, progress: Progress | None = None) -> None:
        """Find the ways, see Way.solve(). Raises Refusal and native.Cancelled."""
        for number, way in enumerate(self._ways):
            with naming(way.drawing.object_name if len(self._ways) > 1 else None), _refusing():
                way.solve(None if progress is None else part_of(progress, number, len(self._ways)))

    def show(self, share: float) -> None:
        """Show the shapes at a share of the ways. Raises ObjectGone and Refusal."""
        for way in self._ways:
            with naming(way.drawing.object_name if len(self._ways) > 1 else None), _refusing():
                way.show(share)

    def restore(self) -> None:
        """Put everything back as it was, to the bit, as far as it is there."""
        try_all(partial(_restore, way) for way in self._ways)


def _restore(way: Way) -> None:
    with contextlib.suppress(ObjectGone):
        way.restore()


@contextlib.contextmanager
def _refusing() -> Iterator[None]:
    """What a solver says is a refusal."""
    try:
        yield
    except native.SolveError as error:
        raise Refusal(str(error)) from error


class PLANAR_OT_breakdown(PoseListOperator, bpy.types.Operator):
    bl_idname = "planar.breakdown"
    bl_label = "Breakdown"
    bl_description = (
        "Key a pose on the way between the poses keyed before and behind the current frame; "
        "move the mouse left or right to choose how far"
    )
    bl_options = {"REGISTER", "UNDO", "GRAB_CURSOR", "BLOCKING"}

    percent: FloatProperty(
        name="Percentage",
        description="How far the pose is on its way from the one before to the one behind",
        subtype="PERCENTAGE",
        default=50.0,
        min=-100.0 * FURTHEST,
        max=100.0 * (1.0 + FURTHEST),
        soft_min=0.0,
        soft_max=100.0,
        options={"SKIP_SAVE"},
    )
    overshoot: BoolProperty(
        name="Overshoot", description="Let the percentage go beyond the two poses", options={"SKIP_SAVE"}
    )

    @classmethod
    def refusal_of(cls, context: bpy.types.Context, obj: bpy.types.Object | None) -> str | None:
        reason = super().refusal_of(context, obj)
        if obj is None or reason is not None:
            return reason
        return modifiers.covering(obj) or breakdown.refusal(obj, context.scene.frame_current_final)

    def apply(self, context: bpy.types.Context) -> None:
        self._begin(context)
        try:
            self._ways.solve()
            self._ways.show(self._share)
            self._key(context)
        except Exception:
            self._ways.restore()
            raise
        finally:
            snapshot.release()

    def _begin(self, context: bpy.types.Context) -> None:
        chosen = self.chosen(context)
        self._ways = Ways(context, chosen.objects)
        self._left_out = left_out_told(chosen)

    @property
    def _share(self) -> float:
        return limited(self.percent / 100.0, overshoot=self.overshoot)

    def _key(self, context: bpy.types.Context) -> None:
        told: list[str] = []
        playback.run(playback.together(self.steps(context, self._ways.objects, told)))
        self.tell([*told, *self._left_out])

    def begin(self, context: bpy.types.Context, obj: bpy.types.Object, tell: Tell) -> Steps:
        find, frame = finder(obj), held.shown_for(obj, context.scene.frame_current_final)
        new, before = pose_state.pose_at(obj, frame) is None, around(obj, frame)[0]
        assert before is not None  # or it was refused
        led_from = obj.planar.poses[before.pose].name
        yield from key_shown(context, obj, tell, kind="BREAKDOWN")
        obj = find()
        keyed = pose_state.pose_at(obj, frame)
        if new and keyed is not None:
            ended = pin_paths.split(obj, led_from, obj.planar.poses[keyed].name)
            if ended:
                names = ", ".join(f"'{name}'" for name in ended)
                tell(f"The curve of {names} ends at the new pose now: choose one for each half of the way")

    # ---- by mouse and keys

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if context.window is None:  # in background
            return self.execute(context)
        if context.screen.is_animation_playing:
            self.report({"ERROR"}, "A breakdown is of one frame: stop the timeline first")
            return {"CANCELLED"}
        running.end()
        try:
            self._begin(context)
        except Refusal as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self._slider: Slider | None = None
        self._confirmed = False
        self._x = event.mouse_x
        self._sliding = _Sliding(self._ways)
        running.start(self._sliding)
        put_up(context, KEYS, cursor="SCROLL_X")
        result = self._guarded(lambda: self._look(context, event, INSTANT))
        if result == {"RUNNING_MODAL"}:
            if self._slider is None:
                self._sliding.clock = running.Clock(context, RATE)
            context.window_manager.modal_handler_add(self)
        return result

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if not self._on:
            return {"CANCELLED"}
        if context.scene.frame_current_final != self._ways.frame:
            return self._leave({"CANCELLED"})  # as any unkeyed pose, it has gone with its frame
        return self._guarded(lambda: self._handle(context, event))

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender ends the operator itself: another file is loaded, the window closes."""
        self._stop()

    @property
    def _on(self) -> bool:
        """Whether nothing has ended it from outside."""
        return running.now() is self._sliding

    def _handle(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        pressed = event.value == "PRESS"
        if event.type in {"ESC", "RIGHTMOUSE"} and pressed:
            return self._stop()
        released = event.type == "LEFTMOUSE" and event.value == "RELEASE"
        confirms = released or (event.type in CONFIRM and pressed)
        if self._slider is None:
            return self._wait(context, event, confirms)
        if confirms:
            return self._keyed(context)
        if event.type.startswith(PASSED_ON):
            return {"PASS_THROUGH"}
        slider = self._slider.held(shift=event.shift, ctrl=event.ctrl)
        if event.type == "MOUSEMOVE":
            slider = slider.moved(event.mouse_x)
        elif pressed and not (event.is_repeat and event.type == OVERSHOOT):
            slider = slider.pressed(event.type) or slider
        if slider != self._slider:
            self._slider = slider
            return self._show(context)
        return {"RUNNING_MODAL"}

    def _wait(self, context: bpy.types.Context, event: bpy.types.Event, confirms: bool) -> set[str]:
        """While the way is solved. What is confirmed meanwhile is keyed as soon as it is."""
        self._confirmed |= confirms
        if event.type.startswith(PASSED_ON) and event.type != "TIMER":
            return {"PASS_THROUGH"}
        result = self._look(context, event, 0.0)
        return self._keyed(context) if self._confirmed and self._slider is not None else result

    def _keyed(self, context: bpy.types.Context) -> set[str]:
        self._key(context)
        return self._leave({"FINISHED"})

    def _look(self, context: bpy.types.Context, event: bpy.types.Event, wait: float) -> set[str]:
        """Begin to slide once the way is solved, for which this waits so many seconds.

        The mouse counts from where it was when the operator began.
        """
        if not self._sliding.work.wait(wait):
            if context.area is not None:
                context.area.header_text_set(f"Breakdown: Solving {self._sliding.work.share:.0%}")
            return {"RUNNING_MODAL"}
        self._sliding.work.result()
        self._sliding.solved()
        width = WIDTH * context.preferences.system.ui_scale
        slider = Slider.begin(self._ways.start, self._x, width, overshoot=self.overshoot)
        self._slider = slider.moved(event.mouse_x)
        return self._show(context)

    def _show(self, context: bpy.types.Context) -> set[str]:
        assert self._slider is not None
        self.overshoot = self._slider.overshoot
        self.percent = 100.0 * self._slider.share
        self._ways.show(self._share)  # as the property has it, so that the redo panel gives the same bits
        if context.area is not None:
            context.area.header_text_set(self._slider.text)
        return {"RUNNING_MODAL"}

    def _guarded(self, step: Callable[[], set[str]]) -> set[str]:
        """Do this; nothing is left half done, whatever goes wrong."""
        try:
            return step()
        except ObjectGone:
            return self._leave({"CANCELLED"})
        except Refusal as error:
            self.report({"ERROR"}, str(error))
            return self._stop()
        except Exception as error:  # Blender would call again and again
            reports.unexpected(self, error)
            return self._stop()

    def _stop(self) -> set[str]:
        """End it with everything as it was."""
        if self._on:
            running.end()
        return {"CANCELLED"}

    def _leave(self, result: set[str]) -> set[str]:
        """End it with what is shown."""
        if self._on:
            running.let_go()
        return result


CLASSES = (PLANAR_OT_breakdown,)
