"""How feet stand, how steps come out and how fast bones turn when characters of any shape walk, and what that costs.

``python -m tests.bench.gait [NAME…] [--speed U] [--no-clips]`` measures some characters alone.
"""

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from morph_retarget.core import play
from morph_retarget.core.arrays import Flags
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.errors import FileError
from morph_retarget.core.locomotion.settings import GaitSettings
from morph_retarget.core.locomotion.stepping import gait, legs
from morph_retarget.core.solve import posing
from tests import gait_courses, gait_measures, goal_sets
from tests.conftest import DATA, ROOT
from tests.gait_courses import Size, Trial
from tests.goal_sets import Subject
from tests.legged import crawler
from tests.morph_bodies import real_characters
from tests.skeletons import skeleton_of

from . import gait_clips, gait_plots
from .figures import Figure, medians, seconds, table

WALKS = 0.3
"""Dimensionless speed at which all are measured."""
FEET = (3, 5, 6, 7, 8, 12, 24)
"""Of generated bodies."""
FRAMES, REPETITIONS = 250, 15
"""Of the clip whose cost is measured."""
COSTS = ("biped", "hound", "beetle", "12 feet")
MOST_FRAMES = 1500
"""No way is looked at at more times: large bodies walk slowly."""
LIKE = 0.2
"""By how much a gait may differ from a clip."""
OUTPUT = ROOT / "build"
SETTINGS = GaitSettings()


@dataclass(frozen=True)
class Row:
    """What one walk comes to."""

    name: str
    course: str
    slip: float
    """Of what stands [% of leg length]."""
    gap: float
    """Between standing soles and the ground [% of leg length]."""
    sink: float
    """Of flying feet under the ground [% of leg length]."""
    jump: float
    """Most that a bone turns in a frame [deg]."""
    bone: str
    """Which."""
    often: float
    """Cycles of the first group [1/s]."""
    flips: int
    """Frames with knees bent to the other side."""
    duty: float
    """Largest error [cycles]; NaN where the way is not steady, as those that follow."""
    triggers: float
    """Largest error [cycles]."""
    jerk: float
    """Most that a bone turns in a very short time, for a frame [deg]."""

    @property
    def line(self) -> str:
        """The row to read."""
        steps = [f"{value:8.3f}" for value in (self.duty, self.triggers)]
        shares = [f"{value:8.3f}" for value in (self.slip, self.gap, self.sink)]
        turns = [f"{self.jump:7.1f}", f"{self.jerk:7.1f}", f"{self.often:6.2f}", f"{self.flips:5d}"]
        return " ".join([f"{self.name:28}{self.course:13}", *shares, *steps, *turns, self.bone])


HEAD = f"{'':28}{'':13}   slip %    gap %   sink %     duty triggers  °/frame    jerk     Hz flips"


def run() -> list[Figure]:
    """Return the worst of all walks, costs, and how near gaits are to real ones."""
    if not DATA.is_dir():
        print(f"no real rigs at {DATA}: only characters of our own (set MORPH_RETARGET_DATA to their folder)")
    figures = [*_figures(_rows(characters(), WALKS)), *_costs()]
    return [*figures, *_beside_clips(DATA)] if DATA.is_dir() else figures


def characters() -> Mapping[str, Character]:
    """Return all characters that have legs: samples, generated ones, and the real rigs."""
    made = {f"{feet} feet": analyze(skeleton_of(crawler(feet))) for feet in FEET}
    everyone = {**goal_sets.creatures(), **made, **(real_characters(DATA) if DATA.is_dir() else {})}
    return {name: character for name, character in everyone.items() if character.legs}


# --- walks ---


def _rows(chosen: Mapping[str, Character], speed: float) -> list[Row]:
    print(
        f"u = {speed}; jerk is what bones turn in 1/{gait_measures.SAMPLES} of a cycle, for a frame of 1/24 s\n{HEAD}"
    )
    out: list[Row] = []
    for name, character in chosen.items():
        subject, size = Subject(character), Size.of(legs.find(character))
        for course, trial in gait_courses.all_of(size, speed).items():
            row = _measured(name, course, subject, trial)
            out.append(row)
            print(row.line, flush=True)
    return out


def _measured(name: str, course: str, subject: Subject, trial: Trial) -> Row:
    times = gait_measures.frames_of(trial.course)[:MOST_FRAMES]
    walked = gait_measures.walk(subject, trial, times=times)
    jumps = gait_measures.jumps(walked)
    pace = walked.gait.paces[0]
    often = float(np.interp(trial.course.times.mean(), pace.times, pace.frequency))
    duty = triggers = jerk = np.nan
    if trial.steady:
        duty = triggers = jerk = 0.0
        for group in range(len(walked.gait.legs.groups)):
            close = gait_measures.steady_times(walked.gait, group)
            closely = gait_measures.walk(subject, trial, times=close, made=walked.gait)
            found, wanted = gait_measures.steps_of(closely, group), gait_measures.wanted_steps(closely, group)
            duty = max(duty, float(np.abs(found.duty - wanted.duty).max()))
            triggers = max(triggers, float(gait_measures.apart(found.triggers, wanted.triggers).max()))
            frames = 1.0 / (gait_measures.FPS * (close[1] - close[0]))
            jerk = max(jerk, float(gait_measures.jumps(closely).max()) * frames)
    return Row(
        name,
        course,
        100.0 * float(gait_measures.slips(walked).max()),
        100.0 * float(gait_measures.gaps(walked).max()),
        100.0 * float(gait_measures.sinks(walked).max()),
        float(jumps.max()),
        subject.bodies.names[int(jumps.max(axis=0).argmax())],
        often,
        int(gait_measures.flips(walked).sum()),
        duty,
        triggers,
        jerk,
    )


def _figures(rows: Sequence[Row]) -> Iterator[Figure]:
    """Yield the worst of each measure, and how many walks miss its goal."""
    level = [row for row in rows if row.course not in ("stairs", "hill")]
    steady = [row for row in rows if not np.isnan(row.duty)]
    yield from _worst("feet move in stance", level, [row.slip for row in level], "% of a leg", 0.1)
    uneven = [row for row in rows if row not in level]
    yield from _worst("the same on stairs and hill", uneven, [row.slip for row in uneven], "% of a leg", 0.1)
    yield from _worst("soles off the ground in stance", rows, [row.gap for row in rows], "% of a leg", 0.5)
    yield from _worst("duty factor off the style's", steady, [row.duty for row in steady], "cycles", 0.02)
    yield from _worst("steps off the style's", steady, [row.triggers for row in steady], "cycles", 0.02)
    yield from _worst("turn in a frame of 1/24 s", level, [row.jump for row in level], "°", 25.0)
    yield from _worst("frames with a knee flipped", rows, [float(row.flips) for row in rows], "frames", 0.0)
    yield from _worst("flying feet under the ground", rows, [row.sink for row in rows], "% of a leg", 1.0)


def _worst(title: str, rows: Sequence[Row], values: Sequence[float], unit: str, goal: float | None) -> Iterator[Figure]:
    # A walk whose steps are never seen at all counts as one that is wrong by a whole cycle.
    known = np.nan_to_num(np.array(values), nan=1.0)
    i = int(known.argmax())
    yield Figure(f"gait: {title}, {rows[i].name}, {rows[i].course} (worst)", float(known[i]), unit, goal)
    if goal is not None:
        missed = int((known > goal).sum())
        yield Figure(f"gait: walks that miss that, of {len(rows)}", missed, "walks", 0.0)
        over: dict[str, tuple[float, Row]] = {}
        for row, value in zip(rows, known.tolist(), strict=True):
            if value > max(goal, over.get(row.name, (goal, row))[0]):
                over[row.name] = value, row
        worst = [f"{name} {value:.3g} ({row.course}, {row.often:.2f} Hz)" for name, (value, row) in over.items()]
        if worst:
            print(f"{title}: over {goal} {unit}: {', '.join(worst)}")


# --- what it costs ---


def _costs() -> Iterator[Figure]:
    chosen = characters()
    for name in COSTS:
        taken = _cost(Subject(chosen[name]))
        goal = 15.0 if name == "beetle" else None
        for part, cost in taken.items():
            yield Figure(f"gait: {name}, {FRAMES} frames, {part}", cost, "µs a frame")
        yield Figure(f"gait: {name}, all of it", sum(taken.values()), "µs a frame", goal)


def _cost(subject: Subject) -> Mapping[str, float]:
    """Return what the parts of a gait cost [µs a frame]."""
    character, root = subject.character, play.root_of(subject.bodies)
    size = Size.of(legs.find(character))
    far = size.speed(WALKS) * (FRAMES - 1) / gait_measures.FPS / size.height
    way, times = gait_courses.straight(size, WALKS, far=far), np.arange(FRAMES) / gait_measures.FPS
    made = gait.prepare(character, root, way, SETTINGS)
    goals = made.evaluate(times)
    plan = posing.prepare(character, subject.bodies.positions, made.wanted[0][0], list(made.wanted))
    parts: Mapping[str, Callable[[], object]] = {
        "prepare": lambda: gait.prepare(character, root, way, SETTINGS),
        "evaluate": lambda: made.evaluate(times),
        "solve": lambda: posing.solve(plan, goals),
    }
    taken = medians([partial(seconds, work) for work in parts.values()], REPETITIONS)
    return {part: 1e6 * time / FRAMES for part, time in zip(parts, taken, strict=True)}


# --- beside real motion ---


def _beside_clips(data: Path) -> Iterator[Figure]:
    """Yield how near strides, frequencies and duty factors are; write a picture of each clip beside our walk."""
    OUTPUT.mkdir(exist_ok=True)
    print(f"\nbeside clips, ours over theirs; pictures are in {OUTPUT.name}\n{'':28}     u  stride   often    duty")
    near: list[Flags] = []
    for example in gait_clips.EXAMPLES:
        try:
            pair = gait_clips.compared(data, example)
        except FileError as error:
            print(f"{example.title}: left out: {error}")
            continue
        ratios = pair.ratios
        near.append(np.abs(ratios - 1.0) <= LIKE)
        told = f" ({'; '.join(pair.warnings)})" if pair.warnings else ""
        print(
            f"{example.title:28}{pair.clip.speed:6.2f}{ratios[0]:8.2f}{ratios[1]:8.2f}{ratios[2]:8.2f}{told}",
            flush=True,
        )
        words = "".join(c if c.isalnum() else "_" for c in example.title.lower())
        gait_plots.draw(OUTPUT / f"gait_{words}.png", pair)
    for title, share in zip(("strides", "frequencies", "duty factors"), np.mean(near, axis=0), strict=True):
        yield Figure(f"gait: {title} within 20 % of {len(near)} clips", 100.0 * float(share), "%", 100.0, at_least=True)


def main(arguments: Sequence[str]) -> int:
    """Measure some characters."""
    everyone = characters()
    parser = argparse.ArgumentParser(prog="gait", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help="all when none is named")
    parser.add_argument("--speed", type=float, default=WALKS, metavar="U", help="dimensionless (%(default)s)")
    parser.add_argument("--no-clips", action="store_true", help="leave out real motion")
    asked = parser.parse_args(arguments)
    unknown = [name for name in asked.names if name not in everyone]
    if unknown:
        print(f"no character {unknown[0]!r}: choose from {', '.join(everyone)}", file=sys.stderr)
        return 2
    figures = list(_figures(_rows({name: everyone[name] for name in asked.names or everyone}, asked.speed)))
    if not asked.no_clips and DATA.is_dir():
        figures += _beside_clips(DATA)
    print(table(figures))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
