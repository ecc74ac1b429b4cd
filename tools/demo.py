"""The demo: a clip onto rigs, as .blend files and one contact sheet, and one action on bodies of all kinds.

``python -m tools.demo [CLIP [RIG…]]``: a sample clip onto Rigify's human metarig and a sample character, or your own.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np

from morph_retarget.blender import actions
from morph_retarget.blender.cli.program import main as morph_retarget
from morph_retarget.blender.io import addons, load
from morph_retarget.blender.io.load import Request
from morph_retarget.core.errors import MorphError

from . import bodies, pictures, sheet

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "build" / "demo"
CLIP, CHARACTER = ROOT / "sample_blends" / "walk_and_wave.bvh", ROOT / "sample_blends" / "sprout.blend"
PICTURES = 8
MOVEMENT, MOVERS, MOMENTS = "Dance", ("biped", "asura", "hound", "beetle", "bird"), 6
"""What is shown of generalized actions: on whom, and in how many pictures."""
COLORS = ((0.75, 0.45, 0.2), (0.25, 0.45, 0.75), (0.3, 0.6, 0.35))


def main(arguments: Sequence[str]) -> int:
    """Run the demo and return the exit status."""
    clip = arguments[0] if arguments else str(CLIP)
    OUT.mkdir(parents=True, exist_ok=True)
    rigs = list(arguments[1:]) or [_metarig(), str(CHARACTER)]
    results: list[Path] = []
    for target in rigs:
        result = OUT / f"{Path(clip).stem} on {Path(target).stem}.blend"
        print(f"{Path(clip).name} -> {Path(target).name}", flush=True)
        report = result.with_suffix(".json")
        status = morph_retarget(["retarget", clip, target, "-o", str(result), "--report", str(report)])
        if status:
            return status
        results.append(result)
    try:
        drawn = _draw(clip, results)
    except MorphError as error:
        print(error, file=sys.stderr)
        return 2
    print(f"{MOVEMENT}, one action -> {', '.join(MOVERS)}", flush=True)
    generalized = pictures.draw(OUT / f"{MOVEMENT}.png", MOVEMENT, MOVERS, MOMENTS)
    print("\nDone. Open these in Blender and press Space:")
    for result in results:
        print(f"  {result}")
    print(f"Contact sheet, the clip above and the results below:\n  {drawn}")
    print(f"The same generalized action on bodies of all kinds:\n  {generalized}")
    print(
        f"To play and change it, open {pictures.SAMPLES / 'stage.blend'} with the extension installed and press Space."
    )
    return 0


def _metarig() -> str:
    """Return a file with the human rig that ships inside Blender."""
    path = OUT / "human metarig.blend"
    bpy.ops.wm.read_homefile(use_empty=True)
    addons.enable("rigify")
    bpy.ops.object.armature_human_metarig_add()
    bpy.context.object.name = "Human Metarig"
    bodies.clothe(bpy.context.object, (0.45, 0.5, 0.6))
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return str(path)


def _draw(clip: str, results: Sequence[Path]) -> Path:
    """Draw the clip and the results at the same times, and return the picture."""
    path = OUT / f"{Path(clip).stem}.png"
    shown = [(Path(clip).stem, _moving(load.load(Request.parse(clip))))]
    shown += [(target.stem, _moving(load.add(Request.parse(str(target))))) for target in results]
    for i, (_, armature) in enumerate(shown):
        if not any(child.type == "MESH" for child in armature.children_recursive):
            bodies.clothe(armature, COLORS[i % len(COLORS)])
    rows = [sheet.Row(title, armature, _times(armature)) for title, armature in shown]
    sheet.contact_sheet(path, rows)
    return path


def _times(armature: bpy.types.Object) -> list[float]:
    """Return frames spread over what an armature plays; files of several rates stand side by side."""
    return np.linspace(*armature.animation_data.action.frame_range, PICTURES).round().tolist()


def _moving(armatures: Sequence[bpy.types.Object]) -> bpy.types.Object:
    return next((ob for ob in armatures if actions.assigned(ob)[0] is not None), armatures[0])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
