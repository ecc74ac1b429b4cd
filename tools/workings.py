"""Pictures of how poses were found: a character with what the viewport's overlay draws over it."""

import tempfile
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path

import bpy
import numpy as np
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector
from PIL import Image, ImageDraw

from morph_retarget.blender import registration, rig
from morph_retarget.blender.io.quiet import quiet
from morph_retarget.blender.properties import of_rig
from morph_retarget.blender.ui import solver_overlay
from morph_retarget.blender.ui.strokes import Stroke

from . import acting, acts, pictures, sheet, stage, walks
from .figure import Point

SIZE = (560, 500)
"""Of a picture [px]."""
FINE = 2
"""Lines are drawn on a picture so many times as large."""


def draw_missed() -> None:
    """Draw a hand that is asked for too much, and the spine that it pulls over."""
    _draw("solver.png", "asura", "Eat Fruit", 26, (2.3, -3.6, 1.9), (0.0, -0.3, 1.05), fruit=(0.75, -1.15, 2.15))


def draw_swivel() -> None:
    """Draw the same goals for both hands, one elbow swivelled."""
    _draw("swivel.png", "biped", "Clap", 12, (0.5, -2.7, 1.35), (0.0, 0.0, 1.2), swivel={"Hand.L": 45.0})


def _draw(
    name: str,
    creature: str,
    act_name: str,
    frame: int,
    eye: Point,
    target: Point,
    fruit: Point | None = None,
    swivel: dict[str, float] | None = None,
) -> None:
    """Draw a character that plays a sample action.

    Args:
        name: Of the picture.
        creature: Name of a sample character.
        act_name: What it plays.
        frame: When it is seen.
        eye: Place of the camera [m].
        target: Place that it looks at [m].
        fruit: Place of what the action is about [m].
        swivel: Angles by which limbs are swivelled, by the bones at their ends [deg].
    """
    registration.register("morph_retarget")
    try:
        bpy.ops.wm.read_homefile(use_empty=True)
        ob, act = pictures.character(creature), acts.named(act_name)
        of_rig(ob).bends_spine = fruit is not None
        for bone, angle in (swivel or {}).items():
            of_rig(ob).solver.add(bone).swivel = float(np.radians(angle))
        thing = stage.fruit(ob)
        thing.hide_render = fruit is None
        if fruit is not None:
            thing.location = fruit
        acting.play(ob, acting.write(act), act, thing)
        walks.checkers("Floor", *walks.lattice((-3.0, 3.0), (-3.0, 3.0), 0.5))
        walks.light_and_camera(eye, target)
        scene = rig.scene_of()
        sheet.engine(scene)
        scene.render.resolution_x, scene.render.resolution_y = SIZE
        scene.frame_set(frame)
        with tempfile.TemporaryDirectory() as folder:
            scene.render.filepath = str(Path(folder, "picture.png"))
            with quiet(errors=True):
                bpy.ops.render.render(write_still=True)
            with Image.open(scene.render.filepath) as seen:
                whole = _over(seen.convert("RGB"), solver_overlay.strokes(ob))
        whole.quantize(128, Image.Quantize.MAXCOVERAGE, kmeans=4).save(pictures.IMAGES / name, optimize=True)
    finally:
        registration.unregister()


def _over(picture: Image.Image, strokes: Iterable[Stroke]) -> Image.Image:
    """Return a picture of the open scene with strokes over it."""
    large = picture.resize((FINE * picture.width, FINE * picture.height), Image.Resampling.LANCZOS)
    pen = ImageDraw.Draw(large, "RGBA")
    for stroke in strokes:
        color = tuple(round(255 * value) for value in stroke.color)
        places = [_seen(place, large.size) for place in stroke.places.tolist()]
        if stroke.kind == "POINTS":
            half = 0.5 * FINE * stroke.size
            for x, y in places:
                pen.rectangle((x - half, y - half, x + half, y + half), fill=color)
        else:
            ends = zip(places[::2], places[1::2], strict=True) if stroke.kind == "LINES" else pairwise(places)
            for pair in ends:
                pen.line(list(pair), color, round(FINE * (stroke.size + 0.5)))
    return large.resize(picture.size, Image.Resampling.LANCZOS)


def _seen(place: Point, size: tuple[int, int]) -> tuple[float, float]:
    """Return where a place in the world is in a picture that the scene's camera takes [px]."""
    scene = rig.scene_of()
    x, y, _ = world_to_camera_view(scene, scene.camera, Vector(place))
    return x * size[0], (1.0 - y) * size[1]
