"""How faithful the transfer is and how firmly feet stand: every real clip onto every real humanoid."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import bpy

from morph_retarget.blender import actions, retarget, rig
from morph_retarget.blender.io import load
from morph_retarget.blender.retarget import Options, Source
from morph_retarget.blender.rig import Rig
from morph_retarget.core import pipeline, quat
from morph_retarget.core.character.character import Character
from morph_retarget.core.mocap.measure import Measures, measure
from morph_retarget.core.mocap.motion import Motion
from morph_retarget.core.mocap.plan import Plan, RetargetSettings
from morph_retarget.core.pipeline import Result
from tests.conftest import DATA
from tests.skeletons import play

from .figures import Figure

HUMAN = 1.75
"""Lengths are given as if every target were as high [m]."""


@dataclass(frozen=True)
class Target:
    """A rig and what it is."""

    file: Path
    rig: Rig
    character: Character


@dataclass(frozen=True)
class Quantity:
    """Something that is judged about each pair."""

    name: str
    unit: str
    goal: float


DIRECTION = Quantity("direction error, no constraints", "° mean", 1.0)
PLANTED = Quantity("direction error, feet planted", "° median", 5.0)
SLIDE = Quantity("slide beyond the source's", "mm a frame", 2.0)
DEPTH = Quantity("feet below the ground", "cm", 1.0)
JUMP = Quantity("largest turn in a frame over the source's", "", 1.5)
QUANTITIES = (DIRECTION, PLANTED, SLIDE, DEPTH, JUMP)


def run() -> list[Figure]:
    """Return the worst pair and the number of pairs that fail, for each quantity."""
    if not DATA.is_dir():
        print(f"skipped: no real rigs and clips at {DATA} (set MORPH_RETARGET_DATA to their folder)")
        return []
    targets = [_read_target(file) for file in _humanoids()]
    results: list[dict[Quantity, float]] = []
    for file in sorted((DATA / "mocap").iterdir()):
        source = _read_source(file)
        for target in targets:
            values = _values(source, target)
            results.append(values)
            print(f"{file.stem:42} {target.file.stem:30} {_line(values)}", flush=True)
    return [figure for quantity in QUANTITIES for figure in _figures(quantity, results)]


def _humanoids() -> Iterator[Path]:
    """Yield the rig files that the tables say are humanoids."""
    index = json.loads((DATA / "skeletons" / "index.json").read_text(encoding="utf-8"))
    for entry in index:
        if entry["kind"] == "humanoid" and (entry["file"] or "").startswith("rigs/"):
            yield DATA / entry["file"]


def _read_target(file: Path) -> Target:
    own = rig.read(load.choose(load.load(load.Request(file)), file, None))
    return Target(file, own, retarget.character_of(own))


def _read_source(file: Path) -> Source:
    ob = load.choose(load.load(load.Request(file)), file, None)
    action, slot = actions.assigned(ob)
    return retarget.run(retarget.read_source(rig.read(ob), action, slot, bpy.context.scene))


def _values(source: Source, target: Target) -> dict[Quantity, float]:
    """Return all quantities of a pair; the files of both may be closed."""
    scale = HUMAN / target.character.frame.height
    free, planted = (_measure(source, target, plants) for plants in (False, True))
    return {
        DIRECTION: free.direction.mean,
        PLANTED: planted.direction.median,
        SLIDE: 1000.0 * scale * planted.slide_step,
        DEPTH: 100.0 * scale * planted.penetration,
        JUMP: planted.jump_target / max(planted.jump_source, 1e-9),
    }


def _measure(source: Source, target: Target, plant_feet: bool) -> Measures:
    plan = retarget.make_plan(source, target.rig, target.character, Options(RetargetSettings(plant_feet=plant_feet)))
    result = pipeline.evaluate(plan, source.clip.pose, source.clip.seconds_per_frame)
    return measure(plan, result.source, _played(plan, result))


def _played(plan: Plan, result: Result) -> Motion:
    """Return what the keys make of the target, by forward kinematics alone, whatever the steps meant it to do."""
    target, bones = plan.target, plan.links.target
    pose = play(target, result)
    turns = quat.multiply(pose.rotations[:, bones], quat.conjugate(target.skeleton.rest_rotations[bones]))
    to_character = target.local_to_character
    return Motion(to_character.turns(turns), to_character.points(pose.positions[:, bones]))


def _line(values: dict[Quantity, float]) -> str:
    direction, planted, slide, depth, jump = (values[quantity] for quantity in QUANTITIES)
    failed = [quantity.name for quantity in QUANTITIES if values[quantity] > quantity.goal]
    numbers = (
        f"dir {direction:4.2f}° planted {planted:4.2f}° slide {slide:4.2f} mm deep {depth:4.2f} cm jump {jump:4.2f}"
    )
    return f"{numbers}  {', '.join(failed)}".rstrip()


def _figures(quantity: Quantity, results: list[dict[Quantity, float]]) -> list[Figure]:
    values = [result[quantity] for result in results]
    failed = sum(value > quantity.goal for value in values)
    return [
        Figure(f"transfer: {quantity.name}, worst pair", max(values), quantity.unit, quantity.goal),
        Figure(f"transfer: {quantity.name}, pairs that fail", failed, f"of {len(values)}", 0.0),
    ]
