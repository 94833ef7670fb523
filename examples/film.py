# SPDX-License-Identifier: GPL-3.0-or-later
"""The film: characters act from keyed pose to keyed pose, rendered by Blender, and a sheet of its frames."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import bpy
import numpy as np
from PIL import Image, ImageDraw, ImageFilter, ImageFont

from contact_sheet import GAP, INK, PAPER, PIN, View, place_camera, silenced_blender
from cutout import material
from planar_deform.scene.sequence.pose_blocks import own_curve

FPS = 24
ON = 2  # on twos, as drawn films are: a picture for so many frames
SAMPLES = 4
HOLD = 5  # frames for which a pose stands
CELL = 0.4  # of the film's size
SKY = ((172, 212, 214), (250, 226, 196))  # above, at the horizon
GROUND = ((214, 190, 152), (190, 160, 122))  # at the horizon, below
HORIZON = 0.30  # world units above the ground line on which the characters stand


def time_poses(obj: bpy.types.Object) -> None:
    """Lets every keyed pose stand for a moment and eases out of it and into the next one.

    This is what an animator does in the Dope Sheet: duplicates each key a few frames later, and chooses an
    interpolation for those that are left.
    """
    curve = own_curve(obj.data.shape_keys)
    for frame, value in [tuple(point.co) for point in curve.keyframe_points]:
        curve.keyframe_points.insert(frame + HOLD, value, options={"FAST"})
    for point in curve.keyframe_points:
        point.interpolation, point.easing = "SINE", "EASE_IN_OUT"
    curve.update()


def build_stage(view: View, standing: Mapping[float, float]) -> bpy.types.Object:
    """A painted backdrop that fills the view, with the shadows of those who stand on it: widths by x."""
    size = (view.width, view.height)
    line = view.pixels(np.array([[0.0, HORIZON]]))[0, 1]
    rows = np.arange(view.height)[:, None]
    high = rows / line
    low = (rows - line) / (view.height - line)
    colours = np.where(rows < line, _blend(*SKY, high), _blend(*GROUND, low))
    paper = Image.fromarray(np.repeat(np.rint(colours).astype(np.uint8)[:, None], view.width, axis=1), "RGB")
    shadows = Image.new("L", size)
    for x, width in standing.items():
        start, middle = view.pixels(np.array([[x - 0.5 * width, 0.03]]))[0]
        end = start + width / view.unit
        ImageDraw.Draw(shadows).ellipse((start, middle - 8, end, middle + 8), fill=110)
    paper.paste(Image.new("RGB", size, INK), mask=shadows.filter(ImageFilter.GaussianBlur(5)))

    return picture_of(view, "Stage", paper)


def picture_of(view: View, name: str, paper: Image.Image) -> bpy.types.Object:
    """A picture behind all, that fills the view."""
    bleed = 2 * view.unit  # two pixels all round, for samples beside the frame's last ones
    left, right = view.left - bleed, view.left + view.width * view.unit + bleed
    bottom, top = view.bottom - bleed, view.bottom + view.height * view.unit + bleed
    return picture(name, paper.convert("RGBA"), (left, bottom, right, top), 1.0)


def picture(
    name: str, image: Image.Image, box: tuple[float, float, float, float], depth: float
) -> bpy.types.Object:
    """An image as a flat object that shines by itself, in a box (left, bottom, right, top) at y = depth."""
    left, bottom, right, top = box
    corners = [(left, depth, bottom), (right, depth, bottom), (right, depth, top), (left, depth, top)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1])
    mesh.materials.append(material(name, image))
    return bpy.data.objects.new(name, mesh)


def prepare(scene: bpy.types.Scene, view: View) -> None:
    """Sets the scene up so that Render Animation makes the film: MP4, H.264."""
    place_camera(scene, view)
    scene.cycles.samples = SAMPLES
    render = scene.render
    render.film_transparent = False
    scene.frame_step, render.fps = ON, FPS // ON
    settings = render.image_settings
    if hasattr(settings, "media_type"):  # from 5.0
        settings.media_type = "VIDEO"
    settings.file_format, settings.color_mode = "FFMPEG", "RGB"
    render.ffmpeg.format, render.ffmpeg.codec = "MPEG4", "H264"
    render.ffmpeg.constant_rate_factor, render.ffmpeg.ffmpeg_preset = "HIGH", "GOOD"
    render.ffmpeg.gopsize = FPS // ON


def shoot(scene: bpy.types.Scene, path: Path, every: int) -> dict[int, Image.Image]:
    """Renders the animation to `path`, telling how far it is. Gives frames, so many apart, small."""
    scene.render.filepath = str(path)
    kept: dict[int, Image.Image] = {}
    first, last = scene.frame_start, scene.frame_end
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder, silenced_blender() as screen:

        def written(scene: bpy.types.Scene, *_: object) -> None:
            frame = scene.frame_current
            if (frame - first) % every == 0:
                picture = Path(folder) / "frame.png"
                bpy.data.images["Render Result"].save_render(str(picture))
                with Image.open(picture) as image:
                    size = (round(CELL * image.width), round(CELL * image.height))
                    kept[frame] = image.convert("RGB").resize(size, Image.Resampling.LANCZOS)
            if (frame - first) % FPS == 0 or frame + ON > last:
                seconds = time.perf_counter() - start
                print(f"  film: frame {frame} of {last}, {seconds:.0f} s", file=screen, flush=True)

        bpy.app.handlers.render_write.append(written)
        try:
            bpy.ops.render.render(animation=True)
        finally:
            bpy.app.handlers.render_write.remove(written)
    scene.frame_step, scene.render.fps = 1, FPS  # the timeline is that of the poses
    scene.render.filepath = f"//{path.name}"  # beside the file that is saved
    return kept


def sheet(
    title: str, frames: Mapping[int, Image.Image], marks: Mapping[int, str], columns: int
) -> Image.Image:
    """The frames in rows, each with its number; those with a mark, the keyed poses, framed and named."""
    cells = list(frames.items())
    width, height = cells[0][1].size
    caption = 26
    rows = -(-len(cells) // columns)
    page = Image.new("RGB", (columns * (width + GAP) + GAP, 84 + rows * (height + caption + GAP // 2)), PAPER)
    draw = ImageDraw.Draw(page)
    draw.text((GAP + 2, 24), title, font=ImageFont.load_default(34), fill=INK)
    for index, (frame, picture) in enumerate(cells):
        x = GAP + (index % columns) * (width + GAP)
        y = 84 + (index // columns) * (height + caption + GAP // 2)
        page.paste(picture, (x, y))
        keyed = frame in marks
        if keyed:
            draw.rectangle((x - 4, y - 4, x + width + 3, y + height + 3), outline=PIN, width=4)
        text = f"{frame}  {marks[frame]}" if keyed else str(frame)
        draw.text((x + 2, y + height + 5), text, font=ImageFont.load_default(16), fill=PIN if keyed else INK)
    return page


def _blend(start: Sequence[int], end: Sequence[int], share: np.ndarray) -> np.ndarray:
    return np.array(start) + (np.array(end) - start) * np.clip(share, 0, 1)
