"""How well and how fast the analysis finds joints and capabilities, against hand-checked truth."""

import statistics
from dataclasses import replace
from functools import partial

from morph_retarget.core.character import names
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.skeleton import Skeleton
from tests import truth
from tests.conftest import DATA
from tests.skeletons import skeleton_of
from tests.truth import CAPABILITIES, CLUTTER, Rig, Score, Tally
from tools.figure import Build, blender, humanoid

from .figures import Figure, seconds

LARGE = range(130, 201)
"""Bones of the rigs whose time has a goal …"""
LARGE_MS = 100.0
"""… which is this [ms]."""
BENT = 0.35
"""Standard deviation of the turns of bent rests [rad]."""
BUILT = Build(spine=6, fingers=5, twists=13, root=True)
"""A figure of 160 bones, timed when there are no real rigs."""


def run() -> list[Figure]:
    """Return shares of joints that are right, F1 of capabilities, and times."""
    if not DATA.is_dir():
        print(f"no real rigs at {DATA}: only a built figure is timed (set MORPH_RETARGET_DATA to their folder)")
        return _times({"built figure": skeleton_of(humanoid(build=BUILT, names=blender))})
    rigs = [truth.rig(DATA, table) for table in truth.tables(DATA)]
    people = [rig for rig in rigs if rig.table["kind"] == "humanoid"]
    creatures = [rig for rig in rigs if rig.table["kind"] == "creature"]
    times = _times({rig.table["id"]: rig.skeleton for rig in rigs})
    return [*_joints(people), *_capabilities(creatures), *_trials(people), *times]


# --- joints ---


def _joints(people: list[Rig]) -> list[Figure]:
    total, absent = Score(), 0
    for rig in people:
        score = truth.score_joints(rig, truth.find(rig))
        print(_line(rig.table["id"], score))
        total.add(score)
        absent += len(rig.table["ground_truth"]["absent"])
    print(_line(f"all {len(people)} humanoids", total))
    return [
        Figure("mapping: joints right", _percent(total), "%", 99.0, at_least=True),
        Figure("mapping: left and right swapped", len(total.swapped), "joints", 0.0),
        Figure("mapping: claimed where absent", 100.0 * len(total.claimed) / max(absent, 1), "%", 1.0),
    ]


def _trials(people: list[Rig]) -> list[Figure]:
    """Return how the same rigs do with bones added that are no part of the body, and without names."""
    figures: list[Figure] = []
    for kind in CLUTTER:
        total = _total([truth.cluttered(rig, kind) for rig in people])
        print(_line(f"with {kind}", total))
        figures.append(Figure(f"mapping: joints right, {kind} added", _percent(total), "%", 99.0, at_least=True))
    total = _total([truth.bent(rig, BENT, seed) for seed in range(3) for rig in people])
    print(_line("rests bent", total, faults=False))
    figures.append(
        Figure("mapping: joints right, rests bent by 20° about each axis", _percent(total), "%", 95.0, at_least=True)
    )
    total = _total([truth.nameless(rig) for rig in people])
    print(_line("nameless", total, faults=False))
    return [*figures, Figure("mapping: joints right without names", _percent(total), "%")]


def _total(rigs: list[Rig]) -> Score:
    total = Score()
    for rig in rigs:
        total.add(truth.score_joints(rig, truth.find(rig)))
    return total


def _percent(score: Score) -> float:
    return 100.0 * score.right / max(score.known, 1)


def _line(title: str, score: Score, faults: bool = True) -> str:
    found = f"{title:30} {score.right:5} right {len(score.wrong):3} wrong {len(score.missing):3} missing"
    return f"{found}  {'; '.join(score.faults)}".rstrip() if faults else found


# --- capabilities ---


def _capabilities(creatures: list[Rig]) -> list[Figure]:
    total = {capability: Tally() for capability in CAPABILITIES}
    for rig in creatures:
        own: dict[str, Tally] = {}
        truth.score_capabilities(rig, truth.find(rig), own)
        for capability, tally in own.items():
            total[capability].hit += tally.hit
            total[capability].extra += tally.extra
            total[capability].missed += tally.missed
        print(_tallies(rig.table["id"], own))
    print(_tallies(f"all {len(creatures)} creatures", total))
    return [Figure(f"mapping: F1 of {c}", total[c].f1, "", 0.95, at_least=True) for c in CAPABILITIES]


def _tallies(title: str, tallies: dict[str, Tally]) -> str:
    parts = (f"{c} {t.hit}/{t.hit + t.missed}" + (f" +{t.extra}" if t.extra else "") for c, t in tallies.items())
    return f"{title:30} {', '.join(parts)}"


# --- times ---


def _times(skeletons: dict[str, Skeleton]) -> list[Figure]:
    taken = {title: 1000.0 * _time(skeleton) for title, skeleton in skeletons.items()}
    slowest = max(taken, key=lambda title: taken[title])
    large = {title: ms for title, ms in taken.items() if len(skeletons[title]) in LARGE}
    for title, ms in (large | {slowest: taken[slowest]}).items():
        print(f"{title:30} {len(skeletons[title]):5} bones {ms:6.1f} ms")
    figures = [Figure("mapping: slowest rig of all", taken[slowest], "ms")]
    if large:
        title = f"mapping: slowest rig of {LARGE[0]} to {LARGE[-1]} bones"
        figures.append(Figure(title, max(large.values()), "ms", LARGE_MS))
    return figures


def _time(skeleton: Skeleton) -> float:
    """Return the time to analyse a rig that was never seen before [s]."""
    taken: list[float] = []
    for _ in range(5):
        fresh = replace(skeleton)
        names._split_known.cache_clear()
        names._read.cache_clear()
        taken.append(seconds(partial(analyze, fresh)))
    return statistics.median(taken)
