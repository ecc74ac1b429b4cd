"""Directing by commands: how transitions between motion models come out, and what random commands do.

``python -m tests.bench directing``
"""

from collections.abc import Iterator, Sequence

import numpy as np

from morph_retarget.core.clips.commands.command import Command, Verb
from morph_retarget.core.clips.models.controller import perform
from morph_retarget.core.clips.motions.library import Library
from morph_retarget.core.directing import starter
from tests import goal_sets
from tests.command_lists import random_commands
from tests.motion_kit import library as small_library
from tests.random_clips import apart, difference
from tests.transition_measures import LASTS, MOMENTS, Measured, measured, pairs, shown_slides

from .figures import Figure, medians, seconds

CHARACTERS = ("biped", "hound", "beetle", "snake")
FASTER, SLIDE = 1.5, 2.0
"""Goals: of the speed of joints over that of what is blended, and of standing feet [mm a frame, human size]."""
SEQUENCES, MOST = 10_000, 6
"""Random lists of commands, and how many each has at most."""
SECONDS = 10.0
WORST = 5
"""So many are printed."""


def run() -> list[Figure]:
    """Return the worst of all transitions, what random commands come to, and costs."""
    figures: list[Figure] = []
    for name in CHARACTERS:
        library = starter.starter(goal_sets.creatures()[name])
        figures += _transitions(name, library, MOMENTS if name == CHARACTERS[0] else MOMENTS[::2])
        if name == CHARACTERS[0]:
            figures += [*_alone(library), *_costs(library)]
    return [*figures, *_random()]


def _transitions(name: str, library: Library, moments: tuple[float, ...]) -> Iterator[Figure]:
    found = list(measured(library, moments))
    print(f"{name}: {len(found)} transitions between {len(library.kinds)} kinds")
    _print("turn fastest", sorted(found, key=lambda own: -own.faster)[:WORST])
    _print("slide furthest", sorted(found, key=lambda own: -own.slide)[:WORST])
    yield Figure(f"{name}: turns of joints", max(own.faster for own in found), "× sources", FASTER)
    if len(library.model.feet):
        yield Figure(f"{name}: slide of what is blended", max(own.slide for own in found), "mm/frame")
        kept = [own.slide for own in found if own.slide <= SLIDE]
        yield Figure(f"{name}: transitions within {SLIDE:g} mm", 100.0 * len(kept) / len(found), "%")
        yield Figure(f"{name}: slide as it is shown", max([*kept, *_shown(library, found)]), "mm/frame", SLIDE)


def _shown(library: Library, found: Sequence[Measured]) -> Iterator[float]:
    """Yield the slides with planted feet of those transitions that slide too far without."""
    far = {(own.first, own.second, own.moment) for own in found if own.slide > SLIDE}
    for first, second, moment, commands in pairs(library, tuple(dict.fromkeys(own.moment for own in found))):
        if (first, second, moment) in far:
            yield float(shown_slides(library, commands, moment + LASTS).max(initial=0.0))


def _print(title: str, rows: Sequence[Measured]) -> None:
    print(f"  {title}")
    for own in rows:
        what = f"{own.first} → {own.second} at {own.moment:g} s"
        print(f"    {what:32}{own.faster:7.2f} × {own.joint:16}{own.slide:8.2f} mm/frame")


def _commands() -> list[Command]:
    return [
        Command(0.5, Verb.START, "walk"),
        Command(2.0, Verb.START, "wave"),
        Command(4.0, Verb.START, "walk", {"speed": 1.8}),
        Command(5.0, Verb.START, "run"),
        Command(7.0, Verb.STOP, "run"),
        Command(8.0, Verb.START, "pick_up"),
    ]


def _alone(library: Library) -> Iterator[Figure]:
    performance = perform(library, _commands())
    times = np.random.default_rng(0).uniform(0.0, 30.0 * SECONDS, 200)
    frames, way = performance.frame(times), performance.travel(times)
    worst = 0.0
    for i, time in enumerate(times):
        one = np.array([time])
        other = difference(performance.frame(one), frames[i : i + 1]), apart(performance.travel(one), way[i : i + 1])
        worst = max(worst, *other)
    yield Figure("a frame alone, difference from the batch", worst, "rad, m", 1e-12)


def _costs(library: Library) -> Iterator[Figure]:
    times = np.arange(0.0, 30.0 * SECONDS)
    performance = perform(library, _commands())

    def all_frames() -> object:
        return performance.frame(times), performance.travel(times)

    made, shown = medians([lambda: seconds(lambda: perform(library, _commands())), lambda: seconds(all_frames)], 7)
    yield Figure("commands to trees, each command", 1e3 * made / len(_commands()), "ms")
    yield Figure(f"frames of {len(library.model)} joints", 1e6 * shown / len(times), "µs/frame", 50.0)


def _random() -> Iterator[Figure]:
    failed = 0
    for seed in range(SEQUENCES):
        performance = perform(small_library(), random_commands(seed, MOST))
        end = performance.segments[-1].start
        times = np.random.default_rng(seed).uniform(-30.0, end + 60.0, 6)
        frames, way = performance.frame(times), performance.travel(times)
        values = (frames.rotations, frames.translations, frames.feet, frames.contacts, way.places, way.headings)
        whole = all(np.isfinite(own).all() for own in values)
        released = not any(token.is_finite for token in performance.tokens_at(end + 1e6))
        failed += not (whole and released)
    yield Figure(f"of {SEQUENCES} random command lists go wrong", float(failed), "", 0.0)
