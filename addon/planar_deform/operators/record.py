# SPDX-License-Identifier: GPL-3.0-or-later
"""Recording: the timeline plays while pins are dragged, and their motion becomes keyed poses."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Generator, Sequence
from functools import partial

import bpy
from bpy.props import BoolProperty, FloatProperty, IntProperty, StringProperty

from ..errors import Refusal
from ..model.input.recording import Layer, Poses, Recording, smoothed
from ..model.plane.frame import Array
from ..model.posing.posing import Sample
from ..model.posing.together import SolvedTogether
from ..scene.lattice.posed import PosedObject, begin_posing, posing_refusal
from ..scene.objects import modifiers
from ..scene.objects.any_object import keying
from ..scene.objects.lattice_object import in_space
from ..scene.pins import pin_list
from ..scene.sequence import playback, pose_state
from ..scene.view import snapshot
from ..scene.view.mouse import pin_under, regions
from .drag import HIDDEN, PATH, unpack_path
from .modal import reports, running
from .modal.long_job import SLICE
from .modal.plane_mouse import PlaneMouse
from .modal.session import PASSED_ON, Interactive, Session, put_away, put_up
from .modal.several_posing import SeveralPosing, begin
from .posing_operator import Refusing

WAITING = "Drag a Pin, or Anywhere for the Selected Pins: Record   Esc or RMB: Cancel"
RECORDING = "Release or Enter: Keep the Motion   Esc or RMB: Discard   Shift: Precise   Ctrl: Snap"


class _Waiting:
    """Record, until a pin is pressed."""

    def give_way(self) -> None:
        """See running.Run."""
        put_away()

    def let_go(self) -> None:
        """See running.Run."""
        put_away()

    def conclude(self) -> None:
        """Record is pressed once more."""
        running.end()


class _Take(Session):
    """A recording under way."""

    def __init__(self, context: bpy.types.Context, posing: SeveralPosing):
        super().__init__(context, posing, RECORDING)
        self.frame = context.scene.frame_current  # of its first pose
        self.concluded = False
        self.keying: Generator[float, None, None] | None = None  # once all poses are solved

    def show(self, *, again: bool = False) -> None:
        if self.keying is None:
            super().show(again=again)

    def take_back(self) -> None:
        if self.keying is not None:
            self.keying.close()
        super().take_back()
        with contextlib.suppress(AttributeError):  # there may be no scene any more
            bpy.context.scene.frame_set(self.frame)

    def let_go(self) -> None:
        if self.keying is not None:
            self.keying.close()
        super().let_go()

    def conclude(self) -> None:
        """Record is pressed once more: the motion is complete."""
        self.concluded = True


class PLANAR_OT_record_pins(Refusing, Interactive, bpy.types.Operator):
    bl_idname = "planar.record_pins"
    bl_label = "Record"
    bl_description = "Play the timeline while a pin is dragged, and key the poses of its motion"
    bl_options = {"REGISTER", "UNDO"}

    frame_step: IntProperty(
        name="Frame Step", description="Frames from one keyed pose to the next", default=1, min=1, soft_max=12
    )
    smoothing: FloatProperty(
        name="Smoothing",
        description="Frames over which the pins' motion is smoothed; 0 keeps it as it was",
        default=1.0,
        min=0.0,
        soft_max=10.0,
    )
    overwrite: BoolProperty(
        name="Overwrite",
        description="Pins that are not dragged stay where they are, instead of moving on as they did",
        options={"SKIP_SAVE"},
    )
    pin: IntProperty(default=-1, min=-1, options=HIDDEN)  # as in planar.drag_pins
    object: StringProperty(options=HIDDEN)
    extend: BoolProperty(options=HIDDEN)
    path: StringProperty(name="Path", description=f"{PATH}; a sample for each frame", options=HIDDEN)
    frame: IntProperty(
        name="Frame", description="Frame of the first pose; by default the current one", options=HIDDEN
    )

    _session: _Take
    _recorded: Sequence[Sample] = ()  # as in planar.drag_pins

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        obj = context.object
        reason = posing_refusal(obj) or modifiers.covering(obj) or pose_state.refusal(obj)
        return reason or _space_refusal(obj, polled=True)

    def execute(self, context: bpy.types.Context) -> set[str]:
        running.end()
        if not self.properties.is_property_set("frame"):
            self.frame = context.scene.frame_current
        before = context.scene.frame_current
        try:
            poses = self._poses_of(list(self._recorded) or unpack_path(self.path))
            posing = self._begun(context)
            try:
                for layer in self._layers(context, posing):
                    layer.follow(poses)
                posing.solve(poses.samples, poses.seen)
                playback.run(self._keep(context, posing, poses))
            except Exception:
                context.scene.frame_set(before)
                posing.cancel()
                raise
        except Refusal as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if not regions(context.area):
            self.report({"ERROR"}, "Pins are recorded in a 3D view: start it there")
            return {"CANCELLED"}
        run = running.now()
        if isinstance(run, _Waiting | _Take):
            run.conclude()
            return {"CANCELLED"}
        self._poses: Poses[SolvedTogether] | None = None
        self._waiting: _Waiting | None = _Waiting()
        running.start(self._waiting)
        put_up(context, WAITING)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if self._waiting is None:
            if self._session.keying is not None:
                return self.guarded(lambda: self._key(context, event))
            return super().modal(context, event)
        try:
            return self._wait(context, event)
        except Exception as error:  # Blender would call again and again
            reports.unexpected(self, error)
            running.end()
            return {"CANCELLED"}

    def _wait(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Until a pin is pressed."""
        if running.now() is not self._waiting:
            return {"CANCELLED"}
        if event.value != "PRESS":
            return {"PASS_THROUGH"}
        if event.type in {"ESC", "RIGHTMOUSE"}:
            running.end()
            return {"CANCELLED"}
        under = _region_under(context.area, event)
        if event.type != "LEFTMOUSE" or under is None:
            return {"PASS_THROUGH"}
        self._region = under
        try:
            self._start(context, event)
        except Refusal as refusal:
            running.end()
            self.report({"WARNING"}, str(refusal))
            return {"CANCELLED"}
        return {"RUNNING_MODAL"}

    def _start(self, context: bpy.types.Context, event: bpy.types.Event) -> None:
        region, view = regions(context.area)[self._region]
        mouse = (event.mouse_x - region.x, event.mouse_y - region.y)
        pin = pin_under(region, view, snapshot.pins_in_view(context), mouse)
        self.pin, self.object = (-1, "") if pin is None else (pin.key, pin.owner)
        self.extend = event.shift
        posing = self._begun(context)
        try:
            self._mouse = PlaneMouse(posing, region, view, event)
            self._drag = self._mouse.begin("MOVE")
        except Exception:
            posing.cancel()
            raise
        if context.screen.is_animation_playing:
            bpy.ops.screen.animation_cancel(restore_frame=False)
        self._session = _Take(context, posing)
        self._waiting = None
        self.frame = self._session.frame
        self._played = self._layers(context, posing)
        self._recording = Recording(_frames_left(context.scene), loop=context.object.planar.record_loop)
        self._fps: float = context.scene.render.fps / context.scene.render.fps_base
        self._began = time.perf_counter()

    def handle(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        pressed = event.value == "PRESS"
        if event.type in {"ESC", "RIGHTMOUSE"} and pressed:
            return self.stop()
        if self._poses is not None:
            return self._solve(context, event, self._poses)
        let_go = event.type == "LEFTMOUSE" and event.value == "RELEASE"
        if let_go or (event.type == "RET" and pressed) or self._session.concluded:
            return self._end()
        if event.type == "TIMER":
            self._play(context)
            if self._recording.over(self._elapsed()):
                return self._end()
        if event.type.startswith(PASSED_ON):
            return {"PASS_THROUGH"}
        drag = self._drag.held(shift=event.shift, ctrl=event.ctrl)
        if event.type == "MOUSEMOVE":
            seen_by = regions(context.area)
            region, view = seen_by[self._region] if self._region < len(seen_by) else (None, None)
            drag = self._mouse.moved(region, view, event, drag)
        elif pressed and not event.is_repeat and event.type in drag.letters:
            drag = drag.pressed(event.type) or drag
        if drag.sample != self._drag.sample:
            self._recording.add(self._elapsed(), drag.sample)
            self._session.ask(drag.sample)
        self._drag = drag
        return {"RUNNING_MODAL"}

    def _elapsed(self) -> float:
        """Frames since the start."""
        return (time.perf_counter() - self._began) * self._fps

    def _play(self, context: bpy.types.Context) -> None:
        """Keep the timeline in step with the clock; frames for which there is no time are left out."""
        passed = self._recording.frame_at(self._elapsed())
        frame = self.frame + passed
        if frame != context.scene.frame_current:
            self._recording.add(self._elapsed(), self._drag.sample)
            context.scene.frame_set(frame)
            for layer in self._played:
                layer.show(passed)
            if self._played and not self._session.untouched:
                self._session.ask(self._drag.sample)
            self._session.show(again=True)  # the new frame may have brought a keyed pose
            if context.area is not None:
                context.area.header_text_set(f"Recording: Frame {frame}")

    def _end(self) -> set[str]:
        """The motion is complete: solve it again."""
        elapsed = self._elapsed()
        self._recording.add(elapsed, self._drag.sample)
        if elapsed < 1.0 or self._session.untouched:
            self.report({"INFO"}, "Nothing is recorded: keep the button pressed while the timeline plays")
            return self.stop()
        self._recorded = self._recording.by_frame(elapsed)
        self._poses = poses = self._poses_of(self._recorded)
        for layer in self._played:
            layer.follow(poses)
        self._session.retrace(poses.samples, poses.seen)
        return {"RUNNING_MODAL"}

    def _solve(
        self, context: bpy.types.Context, event: bpy.types.Event, poses: Poses[SolvedTogether]
    ) -> set[str]:
        """While the poses are solved."""
        if event.type == "TIMER":
            if poses.share == 1.0:
                self._session.keying = self._keep(context, self._session.posing, poses)
                return self._key(context, event)
            if context.area is not None:
                context.area.header_text_set(f"Solving the Poses: {poses.share:.0%}   Esc: Discard")
        return {"PASS_THROUGH"} if event.type.startswith(PASSED_ON) else {"RUNNING_MODAL"}

    def _key(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """While the poses are keyed, a little at each look."""
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            return self.stop()
        if event.type == "TIMER":
            steps, until = self._session.keying, time.perf_counter() + SLICE
            assert steps is not None  # or it would not have begun
            share = next(steps, None)
            while share is not None and time.perf_counter() < until:
                share = next(steps, None)
            if share is None:
                self.leave()
                return {"FINISHED"}
            if context.area is not None:
                context.area.header_text_set(f"Keying the Poses: {share:.0%}   Esc: Discard")
        return {"PASS_THROUGH"} if event.type.startswith(PASSED_ON) else {"RUNNING_MODAL"}

    def _poses_of(self, path: list[Sample]) -> Poses[SolvedTogether]:
        if not path:
            raise Refusal("There is no recorded path: start Record over the drawing and drag a pin")
        return Poses(smoothed(path, self.smoothing), self.frame_step)

    def _begun(self, context: bpy.types.Context) -> SeveralPosing:
        posing = begin(context, self.pin, self.extend, of=self.object, unkeyed=True)
        for one in posing.posings:
            obj = one.drawing.resolve()
            reason = pose_state.refusal(obj) or _space_refusal(obj) or _led_refusal(obj)
            if reason is not None:
                posing.cancel()
                raise Refusal(reason)
        return posing

    def _layers(self, context: bpy.types.Context, posing: SeveralPosing) -> list[Layer]:
        """How the pins that are not dragged move, which the posings are told; none where they stay."""
        if not self.properties.is_property_set("overwrite"):
            self.overwrite = context.object.planar.record_overwrite
        layers = []
        for one, model in zip(posing.posings, posing.model.posings, strict=True):
            if not self.overwrite and pose_state.is_ours(one.drawing.resolve()):
                model.played = layer = Layer(partial(self._shape_of, one.drawing))
                layer.show(0)
                layers.append(layer)
        return layers

    def _shape_of(self, drawing: PosedObject, frame: int) -> Array:
        """That of a frame from the first one of the recording."""
        if frame == 0:
            return drawing.positions
        return drawing.flattened(pose_state.shape_at(drawing.resolve(), self.frame + frame))

    def _keep(
        self, context: bpy.types.Context, posing: SeveralPosing, poses: Poses[SolvedTogether]
    ) -> Generator[float, None, None]:
        """Key the poses, step by step; the last one is shown, and the pins hold it."""
        drawings = [one.drawing for one in posing.posings]
        for drawing in drawings:
            drawing.restore()
        context.scene.frame_set(self.frame + max(poses.by_frame))
        steps = []
        for number, drawing in enumerate(drawings):
            by_frame = {self.frame + frame: pose[number] for frame, pose in poses.by_frame.items()}
            steps.append(keying(drawing, by_frame, throughout=True))
        yield from playback.together(steps)
        solved = poses.last
        assert solved is not None  # all of them are solved
        for name, one in zip(posing.names, solved.each, strict=True):
            obj = bpy.data.objects[name]
            pin_list.store_results(obj, begin_posing(context, obj), one.results)

    def cancel(self, context: bpy.types.Context) -> None:
        if self._waiting is None:
            super().cancel(context)
        elif running.now() is self._waiting:
            running.end()

    def keep_result(self, solved: SolvedTogether) -> None:
        pass  # the path is kept when it has been recorded

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.use_property_split = True
        column.prop(self, "frame_step")
        column.prop(self, "smoothing")
        column.prop(self, "overwrite")


def _space_refusal(obj: bpy.types.Object, *, polled: bool = False) -> str | None:
    if not in_space(obj, polled=polled):
        return None
    return f"'{obj.name}' is a lattice in space, and motion is recorded in a plane: key poses instead"


def _led_refusal(obj: bpy.types.Object) -> str | None:
    """Why the selected pins of an object, which are dragged, would not be seen to move afterwards."""
    led = (pin for pin in obj.planar.pins if obj.planar.live and pin.select and pin.enabled and pin.follow)
    pin = next(led, None)
    if pin is None:
        return None
    return (
        f"'{pin.name}' follows '{pin.follow.name}', which would take it back: animate that, or clear Follow "
        "of the pin, or turn Live off, and record then"
    )


def _frames_left(scene: bpy.types.Scene) -> int | None:
    """How many frames there are from the current one to the end of the range; None at and beyond that."""
    end = scene.frame_preview_end if scene.use_preview_range else scene.frame_end
    return end - scene.frame_current + 1 if scene.frame_current < end else None


def _region_under(area: bpy.types.Area | None, event: bpy.types.Event) -> int | None:
    """Which of the area's views the mouse is in, and in nothing that lies over it."""

    def inside(region: bpy.types.Region) -> bool:
        x, y = event.mouse_x - region.x, event.mouse_y - region.y
        return bool(0 <= x < region.width and 0 <= y < region.height)

    found = [index for index, (region, _) in enumerate(regions(area)) if inside(region)]
    if area is None or not found:
        return None
    covered = any(region.type != "WINDOW" and inside(region) for region in area.regions)
    return None if covered else found[0]


CLASSES = (PLANAR_OT_record_pins,)
