"""The animated picture that the documentation begins with, from the sample scenes as they are.

Each scene is rendered through its own camera, at the speed at which Blender plays it.
"""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
from PIL import Image, ImageDraw

from morph_retarget.blender import registration, rig
from morph_retarget.blender.io.quiet import quiet

from . import sheet
from .pictures import IMAGES, SAMPLES

PATH = IMAGES / "motion.gif"
STEP, COUNT = 2, 56
"""Frames of the scenes from one picture to the next, and pictures in all."""
DELAY = 70
"""Time that a picture is shown [ms]; formats of this kind know hundredths of a second."""
COLORS = 128
SIZE = (640, 436)
"""Of the whole [px]."""
TEXT = (225, 225, 225)


@dataclass(frozen=True)
class Shot:
    """A scene, and where it is in the picture."""

    name: str
    """Of the file."""
    title: str
    first: int
    """Frame of the scene that is shown first."""
    box: tuple[int, int, int, int]
    """Left, top, width and height [px]."""
    lens: float = 50.0
    """Of the scene's camera [mm]."""


SHOTS: Sequence[Shot] = (
    Shot("stage", "one action, keyed once", 1, (0, 0, 640, 240), 42.0),
    Shot("gaits_hound", "walks by itself", 185, (0, 242, 212, 194), 60.0),
    Shot("stair_spider", "on any ground", 30, (214, 242, 212, 194), 85.0),
    Shot("direct_biped", "does as it is told", 70, (428, 242, 212, 194), 50.0),
)


def draw() -> None:
    """Render all scenes and write the picture."""
    registration.register("morph_retarget")
    try:
        whole = [Image.new("RGB", SIZE, sheet.BACKGROUND) for _ in range(COUNT)]
        for shot in SHOTS:
            for picture, part in zip(whole, _rendered(shot), strict=True):
                picture.paste(part, shot.box[:2])
                ImageDraw.Draw(picture).text((shot.box[0] + 7, shot.box[1] + 6), shot.title, TEXT)
        write(PATH, whole)
    finally:
        registration.unregister()


def _rendered(shot: Shot) -> list[Image.Image]:
    """Return pictures of a scene."""
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLES / f"{shot.name}.blend"), load_ui=False)
    scene = rig.scene_of()
    sheet.engine(scene)
    scene.render.resolution_x, scene.render.resolution_y = shot.box[2:]
    scene.camera.data.lens = shot.lens
    out: list[Image.Image] = []
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder, "picture.png"))
        for i in range(COUNT):
            scene.frame_set(shot.first + i * STEP)
            with quiet(errors=True):
                bpy.ops.render.render(write_still=True)
            with Image.open(scene.render.filepath) as image:
                out.append(image.convert("RGB"))
    return out


def write(path: Path, pictures: Sequence[Image.Image]) -> None:
    """Write pictures as a loop; they share colors, so that what stands still is stored once."""
    strip = Image.new("RGB", (pictures[0].width, pictures[0].height * 6))
    for i in range(6):
        strip.paste(pictures[i * len(pictures) // 6], (0, i * pictures[0].height))
    palette = strip.quantize(COLORS, Image.Quantize.MAXCOVERAGE, kmeans=4)  # else all colors go to the background
    flat = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    flat[0].save(path, save_all=True, append_images=flat[1:], duration=DELAY, loop=0, optimize=True, disposal=1)
