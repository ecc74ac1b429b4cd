"""Pictures of generalized actions on the sample characters, and of those that go over the ground."""

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import bpy
import numpy as np
from PIL import Image

from morph_retarget.blender import registration, rig
from morph_retarget.blender.cli import program
from morph_retarget.blender.io import load
from morph_retarget.blender.io.load import Request
from morph_retarget.blender.morph import cast
from morph_retarget.blender.properties import of_rig

from . import acting, acts, directed, footfalls, sheet, stage

ROOT = Path(__file__).resolve().parent.parent
SAMPLES = ROOT / "sample_blends"
IMAGES = ROOT / "docs" / "images"
EVERYONE = ("biped", "asura", "lopside", "hound", "beetle", "spider", "bird", "snake", "sprout")
SHOWN = ("biped", "asura", "lopside", "hound", "beetle", "bird")
"""Who is seen in the documentation."""
GOING: Mapping[str, tuple[tuple[float, float], Sequence[float]]] = {
    "walk_biped": ((-62.0, 8.0), (56.0, 61.0, 66.0, 71.0, 76.0, 81.0)),
    "gaits_hound": ((-80.0, 8.0), (5.0, 72.0, 148.0, 217.0, 263.0, 268.0)),
    "hill_beetle": ((-60.0, 14.0), (30.0, 55.0, 80.0, 105.0, 130.0, 155.0)),
    "stair_spider": ((-65.0, 14.0), (10.0, 40.0, 70.0, 100.0, 130.0, 160.0)),
    "crawl_snake": ((-45.0, 30.0), (10.0, 40.0, 70.0, 100.0, 130.0, 160.0)),
}
"""From where sample scenes are seen [deg], and at which frames."""
GAITS_SHOWN = "gaits_hound"
"""The sample of which the footfalls are shown."""


DIRECTED: Mapping[str, Sequence[float]] = {
    "walk, wave": (1.0, 38.0, 58.0, 78.0, 92.0, 104.0, 118.0, 132.0),
    "faster, gaze, stop, pick up": (165.0, 190.0, 208.0, 235.0, 295.0, 307.0, 320.0, 345.0),
}
"""Frames of the sample of a directed character that are shown, by what it does."""
VALIDATED = ("Wave by Hand", "Wave by Paw", "Hand to Mouth", "Paw to Mouth", "Pick Up by Hand", "Bow", "Jump", "Dance")
"""The sample actions of the grid that is shown."""


def draw_actions() -> None:
    """Draw sample actions on sample characters."""
    spans = {"Hand to Mouth": (1.0, 12.0, 22.0, 34.0), "Pick Up": (16.0, 30.0, 46.0, 58.0)}
    with tempfile.TemporaryDirectory() as folder:
        halves = [
            draw(Path(folder, f"{i}.png"), movement, SHOWN, frames, (112, 124))
            for i, (movement, frames) in enumerate(spans.items())
        ]
        pictures = [Image.open(half) for half in halves]
        whole = Image.new("RGB", (sum(p.width for p in pictures), pictures[0].height))
        for i, picture in enumerate(pictures):
            whole.paste(picture, (sum(p.width for p in pictures[:i]), 0))
        whole.quantize(192).save(IMAGES / "generalized.png", optimize=True)


def draw_locomotion() -> None:
    """Draw the sample scenes of locomotion, and when the feet of one of them stand."""
    registration.register("morph_retarget")
    try:
        with tempfile.TemporaryDirectory() as folder:
            parts: list[Image.Image] = []
            for name, (view, frames) in GOING.items():
                ob, row = opened(name), Path(folder, f"{name}.png")
                if name == GAITS_SHOWN:
                    footfalls.draw(IMAGES / "footfalls.png", footfalls.of(ob))
                sheet.contact_sheet(row, [sheet.Row(name, ob, frames)], view, (160, 116))
                parts.append(Image.open(row))
            whole = Image.new("RGB", (parts[0].width, sum(part.height for part in parts)))
            for i, part in enumerate(parts):
                whole.paste(part, (0, sum(p.height for p in parts[:i])))
            whole.quantize(128, Image.Quantize.MAXCOVERAGE, kmeans=4).save(IMAGES / "locomotion.png", optimize=True)
    finally:
        registration.unregister()


def draw_directed() -> None:
    """Draw the sample scene of a directed character."""
    registration.register("morph_retarget")
    try:
        ob = opened(directed.NAME)
        with tempfile.TemporaryDirectory() as folder:
            rows = [sheet.Row(title, ob, frames) for title, frames in DIRECTED.items()]
            sheet.contact_sheet(Path(folder, "directed.png"), rows, (-62.0, 8.0), (118, 120))
            with Image.open(Path(folder, "directed.png")) as drawn:
                drawn.quantize(160).save(IMAGES / "directed.png", optimize=True)
    finally:
        registration.unregister()


def draw_validation() -> None:
    """Draw a validation grid of sample actions on sample characters."""
    with tempfile.TemporaryDirectory() as folder:
        made = [f"{SAMPLES / 'actions.blend'}#{name}" for name in VALIDATED]
        on = [str(SAMPLES / "characters" / f"{name}.blend") for name in ("biped", "asura", "hound", "beetle", "bird")]
        program.main(["validate", *made, "--on", *on, str(SAMPLES / "sprout.blend"), "--out", folder])
        with Image.open(Path(folder, "grid.png")) as grid:
            grid.convert("RGB").quantize(96).save(IMAGES / "validation.png", optimize=True)


def opened(name: str) -> bpy.types.Object:
    """Open a sample scene and return who goes in it; its ground is drawn with it."""
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLES / f"{name}.blend"))
    (ob,) = cast.performers(rig.scene_of())
    for other in bpy.data.objects:
        if other.type == "MESH" and other.parent is None:
            other["floor"] = True
    return ob


def draw(
    path: Path,
    movement: str,
    names: Sequence[str] = EVERYONE,
    frames: Sequence[float] | int = 6,
    tile: tuple[int, int] = (112, 124),
) -> Path:
    """Draw a movement on sample characters as a contact sheet; the open file is closed.

    Args:
        path: PNG to write.
        movement: Name of a movement, or of an act; each character plays the branch that is for it.
        names: Of sample characters.
        frames: Which ones, or how many.
        tile: Width and height of one picture [px].
    """
    registration.register("morph_retarget")
    try:
        bpy.ops.wm.read_homefile(use_empty=True)
        made: dict[str, bpy.types.Action] = {}
        rows: list[sheet.Row] = []
        for ob in [character(name) for name in names]:
            act = acting.fitting(acts.ACTS, movement, ob)
            if act is None:
                continue
            of_rig(ob).bends_spine = True
            if act.name not in made:
                made[act.name] = acting.write(act)
            acting.play(ob, made[act.name], act, stage.fruit(ob))
            times = np.linspace(1, act.frames, frames).round().tolist() if isinstance(frames, int) else frames
            rows.append(sheet.Row(f"{ob.name}: {act.name}", ob, times))
        sheet.contact_sheet(path, rows, tile=tile)
    finally:
        registration.unregister()
    return path


def character(name: str) -> bpy.types.Object:
    """Return a sample character, added to the open file."""
    own = SAMPLES / "characters" / f"{name}.blend"
    return load.add(Request(own if own.exists() else SAMPLES / f"{name}.blend"))[0]
