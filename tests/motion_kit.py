"""A small library of made-up motions, for laws of motion models and of the controller.

Feet of its loops stand exactly where they strike; what its motions look like means nothing.
"""

from collections.abc import Sequence
from functools import cache

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.clips.character_model import RATE, CharacterModel
from morph_retarget.core.clips.clip import ClipPrimitive
from morph_retarget.core.clips.frames import Frames
from morph_retarget.core.clips.motions.annotations import Annotations, Phase, Strike, Strokes
from morph_retarget.core.clips.motions.base_motion import BaseMotion
from morph_retarget.core.clips.motions.library import Library
from morph_retarget.core.clips.travel import Travel, turned

from .random_clips import body

SIDES = np.array([0.1, -0.1])
"""Where feet stand beside the way [m]."""
DUTY = 0.6
"""Share of a cycle for which each foot stands."""


@cache
def library() -> Library:
    """Return idling, walks and runs with starts and stops, a dance, sitting down, a wave, and jumps."""
    motions = [
        gait("walk", 1.0, 30),
        gait("walk", 1.0, 30, 0.6),
        gait("walk", 1.0, 30, -0.6),
        gait("walk", 1.8, 24),
        gait("walk", 1.2, 26, style="happy"),
        ending("walk", 1.0, 30, Phase.START),
        ending("walk", 1.0, 30, Phase.STOP),
        gait("run", 3.0, 20),
        gait("run", 5.0, 16),
        gesture("idle", 40, ("trunk",), 0.05, cycle=True),
        gesture("wave", 25, ("right arm",), 0.9, side="right"),
        gesture("dance", 30, (), 0.4, cycle=True),
        gesture("sit", 15, (), 0.7, phase=Phase.START),
        gesture("sit", 20, (), 0.1, cycle=True, phase=Phase.LOOP),
        gesture("sit", 15, (), -0.7, phase=Phase.STOP),
        gesture("jump", 21, (), 0.5, parameters={"height": 0.3}),
        gesture("jump", 27, (), 0.9, parameters={"height": 0.7}),
    ]
    return Library(body(), tuple(motions))


def gait(kind: str, speed: float, frames: int, turn: float = 0.0, style: str = "") -> BaseMotion:
    """Return a loop.

    Args:
        kind: What it is an example of.
        speed: [m/s].
        frames: Of the cycle.
        turn: To the left [rad/s].
        style: How it is done.
    """
    model, phases = body(), np.arange(frames) / frames
    frames_ = _stepping(model, speed / RATE * frames, turn / RATE * frames, phases)
    way = _arc(speed / RATE * frames, turn / RATE * frames, phases)
    known = Annotations(
        kind,
        style=style,
        cycle=True,
        strikes=(Strike(0, 0.0), Strike(1, 0.5 * frames)),
        speed=speed,
        turn_rate=turn,
        phase=Phase.LOOP,
        parts=("legs",),
        parameters={"speed": speed, "turn": turn},
    )
    name = f"{kind} {style} {speed:g} {turn:g}"
    return BaseMotion(name, ClipPrimitive(name, model, frames_, way), known)


def ending(kind: str, speed: float, period: int, phase: Phase, frames: int = 21) -> BaseMotion:
    """Return a start that leads to phase 0.25 of a cycle, or a stop that comes from there."""
    model = body()
    into = np.arange(frames) - (frames - 1.0)
    loop = _stepping(model, speed / RATE * period, 0.0, (0.25 + into / period) % 1.0)
    share = np.linspace(0.0, 1.0, frames)
    share = share * share * (3.0 - 2.0 * share)
    data = Frames.at_rest(model, frames).mixed(loop, share)
    steps = share[1:] * speed / RATE
    if phase is Phase.STOP:
        data, steps = data[::-1], steps[::-1]
        loop = _stepping(model, speed / RATE * period, 0.0, (0.25 + np.arange(frames) / period) % 1.0)
        data = loop.mixed(Frames.at_rest(model, frames), share)
    way = Travel(np.column_stack([np.zeros(frames), -np.concatenate([[0.0], np.cumsum(steps)])]), np.zeros(frames))
    known = Annotations(kind, speed=speed, phase=phase, parts=("legs",))
    name = f"{kind} {phase}"
    return BaseMotion(name, ClipPrimitive(name, model, data, way), known)


def gesture(
    kind: str,
    frames: int,
    parts: Sequence[str],
    size: float,
    side: str = "",
    cycle: bool = False,
    phase: Phase = Phase.WHOLE,
    parameters: dict[str, float] | None = None,
) -> BaseMotion:
    """Return a motion on the spot in which some parts of the body turn and come back, by a size [rad]."""
    model = body()
    joints = model.part(*parts) if parts else model.part("all")
    rng = np.random.default_rng(len(kind) + frames)
    axes = quat.unit(rng.normal(size=(len(model), 3))) * joints[:, None]
    phases = np.arange(frames) / (frames if cycle else frames - 1)
    swing = size * 0.5 * (1.0 - np.cos(2.0 * np.pi * phases))
    rest = Frames.at_rest(model, frames)
    data = Frames(quat.from_rotation_vector(swing[:, None, None] * axes), rest.translations, rest.feet, rest.contacts)
    known = Annotations(
        kind,
        cycle=cycle,
        phase=phase,
        side=side,
        parts=tuple(parts),
        strokes=None if cycle else Strokes(0.0, 0.2 * frames, 0.5 * frames, 0.7 * frames, frames - 1.0),
        parameters=parameters or {},
    )
    name = f"{kind} {phase} {frames}"
    return BaseMotion(name, ClipPrimitive(name, model, data, Travel.still(frames)), known)


def _stepping(model: CharacterModel, stride: float, turn: float, phases: Array) -> Frames:
    """Return frames of a gait at phases, whose cycle leads by a stride [m] and turns [rad]."""
    rest = Frames.at_rest(model, len(phases))
    feet, contacts = rest.feet.copy(), rest.contacts.copy()
    vectors = np.zeros((len(phases), len(model), 3))
    for foot, side in enumerate(SIDES):
        own = (phases - 0.5 * foot) % 1.0
        standing = own < DUTY
        fly = (own - DUTY) / (1.0 - DUTY)
        fly = np.clip(fly * fly * (3.0 - 2.0 * fly), 0.0, 1.0)
        last, first = (_stood(stride, turn, np.full(len(phases), p), side) for p in (DUTY, 0.0))
        places = np.where(standing[:, None], _stood(stride, turn, own, side), last + fly[:, None] * (first - last))
        feet[:, foot, :2] = places
        feet[:, foot, 2] += 0.1 * np.where(standing, 0.0, np.sin(np.pi * (own - DUTY) / (1.0 - DUTY)))
        contacts[:, foot] = standing
        leg = model.character.legs[foot]
        vectors[:, leg.bones[0], 0] = 0.4 * stride * np.cos(2.0 * np.pi * own)
    spine = model.part("trunk")
    vectors[:, spine, 2] = 0.02 * np.sin(2.0 * np.pi * phases)[:, None]
    return Frames(quat.from_rotation_vector(vectors), rest.translations, feet, contacts)


def _stood(stride: float, turn: float, phases: Array, side: float) -> Array:
    """Return where a foot is, as seen from the travel, that stood under the body in the middle of its stance."""
    middle = _arc(stride, turn, np.array([0.5 * DUTY])).then(Travel(np.array([[side, 0.0]]), np.zeros(1)))
    return middle.since(_arc(stride, turn, phases)).places


def _arc(stride: float, turn: float, phases: Array) -> Travel:
    headings = turn * phases
    chord = np.sinc(headings / (2.0 * np.pi)) * stride * phases
    return Travel(turned(np.column_stack([np.zeros(len(phases)), -chord]), 0.5 * headings), headings)
