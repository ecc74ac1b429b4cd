"""Writes the recipes of the starter library: ``python -m tools.make_recipes``.

They are the sample acts and some gestures, as data that the extension reads without Blender's help.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.directing.recipes.recipe import Recipe, Tracks, to_text
from morph_retarget.core.directing.recipes.shelf import FOLDER

from . import acts
from .acting import Act, Track, Vector
from .acts import gestures

HANDS = ("Hand", "Palms")
WHOLE = ()
SAMPLES: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "Wave by Hand": ("wave", HANDS),
    "Wave by Paw": ("wave", ("Paw",)),
    "Wave by Wing": ("wave", ("Wings",)),
    "Bow": ("bow", ("Spine",)),
    "Bow on All Fours": ("bow", ("Chest",)),
    "Clap": ("clap", ("Graspers",)),
    "Jump": ("jump", WHOLE),
    "Sit": ("sit", WHOLE),
    "Sit on Haunches": ("sit", WHOLE),
    "Dance": ("dance", WHOLE),
    "Pick Up by Hand": ("pick_up", WHOLE),
    "Pick Up by Mouth": ("pick_up", WHOLE),
}
"""Acts that are samples too: what commands call them, and the channels that they cannot do without."""
OWN: Mapping[str, tuple[Act, tuple[str, ...]]] = {
    "beat": (gestures.beat(), ("Graspers",)),
    "shrug": (gestures.shrug(), ("Graspers",)),
    "cheer": (gestures.cheer(), ("Graspers",)),
    "idle": (gestures.idle_on_feet(), WHOLE),
}
STROKES: Mapping[str, Mapping[str, float]] = {
    "Wave by Hand": {"ready": 1, "stroke_start": 18, "stroke": 30, "stroke_end": 54, "relax": 72},
    "Wave by Paw": {"ready": 1, "stroke_start": 16, "stroke": 28, "stroke_end": 48, "relax": 66},
    "Wave by Wing": {"ready": 1, "stroke_start": 16, "stroke": 28, "stroke_end": 50, "relax": 66},
    "Bow": {"ready": 1, "stroke_start": 7, "stroke": 30, "stroke_end": 51, "relax": 78},
    "Bow on All Fours": {"ready": 1, "stroke_start": 7, "stroke": 30, "stroke_end": 51, "relax": 78},
    "Clap": {"ready": 1, "stroke_start": 15, "stroke": 20, "stroke_end": 46, "relax": 66},
    "Jump": {"ready": 1, "stroke_start": 23, "stroke": 31, "stroke_end": 39, "relax": 66},
    "Sit": {"ready": 1, "stroke_start": 6, "stroke": 30, "stroke_end": 52, "relax": 78},
    "Sit on Haunches": {"ready": 1, "stroke_start": 6, "stroke": 28, "stroke_end": 52, "relax": 78},
    "Pick Up by Hand": {"ready": 1, "stroke_start": 20, "stroke": 34, "stroke_end": 52, "relax": 90},
    "Pick Up by Mouth": {"ready": 1, "stroke_start": 20, "stroke": 34, "stroke_end": 54, "relax": 78},
}
"""Named times of the samples [frames]; those of gestures are their events."""
NEAR_REST = 0.2
"""Keys of hands that are nearer to rest than this, at both ends of an act, only lead from there and back."""


def main() -> None:
    """Write all recipes."""
    for old in FOLDER.glob("*.json"):
        old.unlink()
    for name, text in texts().items():
        (FOLDER / name).write_text(text, encoding="utf-8")


def texts() -> dict[str, str]:
    """Return what all files hold, by their names."""
    found = [recipe_of(acts.named(name), *own, STROKES.get(name, {})) for name, own in SAMPLES.items()]
    found += [recipe_of(act, kind, crucial, act.events) for kind, (act, crucial) in OWN.items()]
    found.append(recipe_of(gestures.idle_without_feet(), "idle", WHOLE, {}))
    return {f"{recipe.name.lower().replace(' ', '_')}.json": to_text(recipe) for recipe in found}


def recipe_of(act: Act, kind: str, crucial: tuple[str, ...], strokes: Mapping[str, float]) -> Recipe:
    """Return an act as a recipe."""
    tracks = act.tracks if act.cyclic else [_from_where_it_hangs(track, act.frames) for track in act.tracks]
    feet = any(track.channel.context.capability is Capability.FOOT for track in tracks)
    return Recipe(
        act.name,
        kind,
        act.frames,
        tuple(track.channel for track in tracks),
        tuple(map(_tracks, tracks)),
        act.branch,
        act.cyclic,
        not feet,
        crucial,
        dict(strokes),
    )


def _tracks(own: Track) -> Tracks:
    return Tracks(
        {float(frame): place for frame, place in own.position.items()},
        {float(frame): turn for frame, turn in own.turn.items()},
        {float(frame): (weight,) for frame, weight in own.weight.items()},
    )


def _from_where_it_hangs(track: Track, last: int) -> Track:
    """Return hands that come from where they hang, and not from where the rest pose has them, by weights."""
    if track.channel.context.capability is not Capability.GRASPER or not track.position or track.weight:
        return track
    frames = sorted(track.position)
    kept = [frame for frame in frames if np.linalg.norm(track.position[frame]) > NEAR_REST]
    position: dict[int, Vector] = {f: p for f, p in track.position.items() if kept[0] <= f <= kept[-1]}
    first = kept[0] if kept[0] > 1 else _second(track, kept[0])
    end = kept[-1] if kept[-1] < last else frames[-2]
    return replace(track, position=position, weight={1: 0.0, first: 1.0, end: 1.0, last: 0.0})


def _second(track: Track, first: int) -> int:
    return next(frame for frame in sorted(track.position) if frame > first)


if __name__ == "__main__":
    main()
