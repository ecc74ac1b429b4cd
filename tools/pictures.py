"""Pictures of generalized actions on the sample characters.

``python -m tools.pictures`` draws those of the documentation.
"""

import os
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
from PIL import Image

from morph_retarget.blender import registration
from morph_retarget.blender.io import load
from morph_retarget.blender.io.load import Request
from morph_retarget.blender.properties import of_rig

from . import acting, acts, sheet, stage

ROOT = Path(__file__).resolve().parent.parent
SAMPLES = ROOT / "sample_blends"
IMAGES = ROOT / "docs" / "images"
EVERYONE = ("biped", "asura", "lopside", "hound", "beetle", "bird", "snake", "sprout")
SHOWN = ("biped", "asura", "lopside", "hound", "beetle", "bird")
"""Who is seen in the documentation."""


def main() -> None:
    """Draw all pictures of the documentation."""
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


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)  # Blender 4.5 as a module may block its end by a thread of its own
