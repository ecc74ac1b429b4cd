"""How transitions between motion models are measured: how fast joints turn in them, and how far standing feet slide."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.clips import posing
from morph_retarget.core.clips.character_model import RATE
from morph_retarget.core.clips.commands.command import Command, Verb
from morph_retarget.core.clips.models.controller import controlled
from morph_retarget.core.clips.models.models import IDLE, models_of
from morph_retarget.core.clips.models.motion_model import MotionModel
from morph_retarget.core.clips.models.performance import Performance
from morph_retarget.core.clips.motions.library import Library
from morph_retarget.core.clips.spots import STANDS, in_world
from morph_retarget.core.directing import director
from morph_retarget.core.directing.director import Directions
from morph_retarget.core.directing.moved import Moved

HUMAN = 1.75
"""Slides are told as if every body were as high [m]."""
SLOW = np.radians(30.0)
"""A joint that is slower than this in its sources counts as this fast [rad/s]."""
MOMENTS = (2.0, 2.31, 2.57, 2.83)
"""When the second motion is started [s]."""
LASTS = 12.0
"""For how long each is looked at after that [s]."""
WORDLESS = 1.0, 6.3
"""What has no end is stopped so long after the second motion was started: the first one and the second [s]."""


@dataclass(frozen=True)
class Measured:
    """One transition and back to idling."""

    first: str
    second: str
    moment: float
    faster: float
    """Fastest turn of a joint over its fastest in what is blended."""
    joint: str
    slide: float
    """Of a foot that stands [mm a frame, human size]."""
    whole: bool
    """Whether all values are finite."""


def pairs(library: Library, moments: tuple[float, ...] = MOMENTS) -> Iterator[tuple[str, str, float, list[Command]]]:
    """Yield all pairs of models with the commands that go over from the one to the other, and then to idling."""
    models = models_of(library)
    names = [name for name in models if name != IDLE]
    for first in names:
        for second in names:
            if first == second:
                continue
            for moment in moments:
                commands = [Command(0.0, Verb.START, first), Command(moment, Verb.START, second)]
                if _goes_on(models[first]) and models[first].family != models[second].family:
                    commands.append(Command(moment + WORDLESS[0], Verb.STOP, first))
                if _goes_on(models[second]):
                    commands.append(Command(moment + WORDLESS[1], Verb.STOP, second))
                yield first, second, moment, commands


def measured(library: Library, moments: tuple[float, ...] = MOMENTS) -> Iterator[Measured]:
    """Yield all transitions of a library."""
    models, sources = models_of(library), source_speeds(library)
    for first, second, moment, commands in pairs(library, moments):
        performance = controlled(library.model, models, commands)
        times = np.arange(0.0, (moment + LASTS) * RATE)
        idle = sources.get(IDLE, sources[first])
        allowed = np.maximum(np.maximum(sources[first], sources[second]), np.maximum(idle, SLOW))
        frames = performance.frame(times)
        ratio = speeds(frames.rotations) / allowed
        joint = library.model.names[int(ratio.max(axis=0).argmax())]
        whole = bool(np.isfinite(frames.rotations).all() and np.isfinite(frames.feet).all())
        yield Measured(
            first, second, moment, float(ratio.max()), joint, float(slides(performance, times).max(initial=0.0)), whole
        )


def source_speeds(library: Library) -> Mapping[str, Array]:
    """Return for each kind how fast each joint turns at most in its base motions [rad/s], shape (joint,)."""
    out: dict[str, Array] = {}
    for name, model in models_of(library).items():
        found = [np.zeros(len(library.model))]
        for motion in getattr(model, "motions", ()):
            rotations = motion.clip.data.rotations
            if motion.annotations.cycle:
                rotations = np.concatenate([rotations, rotations[:1]])
            found.append(speeds(rotations).max(axis=0, initial=0.0))
        out[name] = np.max(found, axis=0)
    return out


def speeds(rotations: Array) -> Array:
    """Return how fast joints turn from frame to frame [rad/s], shape (n, joint, 4) to (n - 1, joint)."""
    return quat.angle_between(rotations[1:], rotations[:-1]) * RATE


def slides(performance: Performance, times: Array) -> Array:
    """Return how far standing feet move along the ground from frame to frame [mm, human size], shape (n - 1, foot)."""
    frames, way = performance.frame(times), performance.travel(times)
    places = in_world(frames.feet, way)
    stands = np.minimum(frames.contacts[1:], frames.contacts[:-1]) > STANDS
    size = HUMAN / performance.model.character.frame.height
    return 1000.0 * size * quat.length(np.diff(places[..., :2], axis=0)) * stands


def shown_slides(library: Library, commands: Sequence[Command], last: float) -> Array:
    """Return how far the same feet move once feet are planted, as the library's own character shows it; see `slides`.

    Args:
        library: Made for the character.
        commands: What it is told.
        last: Up to when it is looked at [s].
    """
    directed = director.prepare(library.model.character, library, Directions(tuple(commands)), last)
    model, moved, performance = directed.model, directed.moved, directed.performance
    assert performance is not None, "it was told something"
    frames = performance.frame(directed.first + np.arange(len(moved.turns), dtype=np.float64))
    before = Moved.of(model.character, posing.pose_of(model, frames, moved.travel), moved.travel, frames.contacts)
    # A foot rolls about its spot as its clips have it: what counts is how the spot was moved with it.
    kept = (moved.positions - before.positions)[:, model.feet] + in_world(frames.feet, moved.travel)
    stands = np.minimum(frames.contacts[1:], frames.contacts[:-1]) > STANDS
    size = HUMAN / model.character.frame.height
    return 1000.0 * size * quat.length(np.diff(kept[..., :2], axis=0)) * stands


def _goes_on(model: MotionModel) -> bool:
    """Return whether a motion has no end of its own."""
    token = model.do_command(Command(0.0, Verb.START, model.name), 0.0, None)
    return token is not None and not token.is_finite
