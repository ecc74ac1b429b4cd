"""Base motions cut from any motion: at the frame rate of clips, seen from their travel, cycles closed."""

import math
from dataclasses import astuple, replace

import numpy as np

from ... import quat
from ...errors import MotionError
from ...skeleton import Pose
from ..character_model import RATE, CharacterModel
from ..clip import ClipPrimitive
from ..frames import Frames, joined
from ..operators import ways
from ..posing import frames_of, pose_of
from ..spots import spots_of
from ..travel import Travel, turned
from .annotations import Annotations, Phase, Strike, Strokes
from .base_motion import BaseMotion
from .cycles import Cycle
from .finding import Found, find
from .kinds import GOING, TURN

LEAST_FRAMES = 4
"""A cycle has no fewer frames than this."""
SAME_STRIKE = 0.15
"""Strikes of one foot that are nearer to each other than this share of a cycle are the same one, a round later."""


def motion_of(
    name: str, model: CharacterModel, pose: Pose, seconds_per_frame: float, kind: str = "", style: str = ""
) -> BaseMotion:
    """Return a motion as a base motion: its best cycle if it goes or idles in cycles, else the whole of it.

    Args:
        name: Of the base motion.
        model: The body that moves.
        pose: Armature space, shape (frame, joint, ...).
        seconds_per_frame: Time between frames [s].
        kind: What it is an example of, where somebody knows better.
        style: How it is done.

    Raises:
        MotionError: It has no frames.
    """
    if not len(pose):
        raise MotionError(f"motion {name!r} has no frames: choose one that has")
    found = find(model.character, pose, seconds_per_frame)
    motion = _cycle(name, model, found, found.cycle) if found.cycle is not None else _whole(name, model, found)
    own = motion.annotations
    return replace(motion, annotations=replace(own, kind=kind or own.kind, style=style))


def cut(name: str, model: CharacterModel, pose: Pose, seconds_per_frame: float) -> BaseMotion:
    """Return the best cycle of a motion.

    Args:
        name: Of the base motion.
        model: The body that moves.
        pose: Armature space, shape (frame, joint, ...).
        seconds_per_frame: Time between frames [s].

    Raises:
        MotionError: There is none.
    """
    found = find(model.character, pose, seconds_per_frame)
    if found.cycle is None:
        raise MotionError(f"motion {name!r} never comes back to where it was: choose one that goes in cycles")
    return _cycle(name, model, found, found.cycle)


def whole(name: str, model: CharacterModel, pose: Pose, seconds_per_frame: float) -> BaseMotion:
    """Return all of a motion, but for a lone first frame; arguments as for `cut`."""
    return _whole(name, model, find(model.character, pose, seconds_per_frame))


def _whole(name: str, model: CharacterModel, found: Found) -> BaseMotion:
    seen = found.seen
    travel = found.footfalls.way
    count = math.floor((len(seen) - 1) * seen.step * RATE + 1e-6) + 1
    rows = np.arange(count, dtype=np.float64) / (seen.step * RATE)
    way = travel.at(rows)
    clip = ClipPrimitive(name, model, _frames(model, found, travel).at(rows), way.since(way[:1]))
    own, gone = found.annotations, float(found.frames(0.0))
    strikes = [replace(strike, frame=strike.frame - gone) for strike in own.strikes]
    inside = tuple(strike for strike in strikes if 0.0 <= strike.frame <= clip.end)
    return BaseMotion(
        name, clip, replace(own, cycle=False, strikes=inside, strokes=_moved(own.strokes, gone, clip.end))
    )


def _moved(strokes: Strokes | None, by: float, last: float) -> Strokes | None:
    if strokes is None:
        return None
    return Strokes(*(float(np.clip(time - by, 0.0, last)) for time in astuple(strokes)))


def _cycle(name: str, model: CharacterModel, found: Found, cycle: Cycle) -> BaseMotion:
    count = max(round(cycle.length * found.seen.step * RATE), LEAST_FRAMES)
    start, lead = _lead(found, cycle)
    since = (np.arange(len(found.seen), dtype=np.float64) - cycle.first) / cycle.length
    frames = _frames(model, found, start.then(ways.repeated(lead, since)))
    data = _round(frames, cycle, count)
    travel = ways.repeated(lead, np.arange(count) / count)
    if not cycle.whole:
        data = _met(data, frames.at(np.array([cycle.first + cycle.length])))
    positions = model.character.local_to_character.points(pose_of(model, data, travel).positions)
    data = replace(data, feet=spots_of(model, positions, travel, data.contacts, cycle=True))
    return BaseMotion(name, ClipPrimitive(name, model, data, travel), _annotated(found, cycle, count, lead))


def _lead(found: Found, cycle: Cycle) -> tuple[Travel, Travel]:
    """Return where a cycle begins on the ground, and where it leads from there."""
    last = len(found.seen) - 1.0
    ends = np.array([cycle.first, min(cycle.first + cycle.length, last)])
    own = found.footfalls.way.at(ends)
    return own[:1], ways.repeated(own[1:].since(own[:1]), np.array([cycle.length / (ends[1] - ends[0])]))


def _frames(model: CharacterModel, found: Found, travel: Travel) -> Frames:
    """Return all frames of a motion as seen from a way over the ground."""
    seen = found.seen
    points = seen.places.copy()
    points[..., :2] -= found.footfalls.gone[:, None]
    pose = Pose(seen.pose.rotations, model.character.local_to_character.inverse().points(points))
    return frames_of(model, pose, travel, found.footfalls.stands.astype(np.float64))


def _round(frames: Frames, cycle: Cycle, count: int) -> Frames:
    """Return a cycle in so many frames; after the last of a motion that is one as a whole its first comes again."""
    rows = cycle.first + cycle.length / count * np.arange(count, dtype=np.float64)
    last = len(frames) - 1.0
    if not cycle.whole or rows[-1] <= last:
        return frames.at(rows)
    after = (rows - last) / (cycle.length - last)
    return joined([frames, frames[:1]]).at(np.where(rows > last, last + after, rows))


def _met(frames: Frames, after: Frames) -> Frames:
    """Return a cycle whose ends meet, which they hardly ever do in mocap: each takes half of what is missing.

    Args:
        frames: One round.
        after: The frame after its last, which should be its first.
    """
    share = np.arange(len(frames)) / len(frames) - 0.5
    missing = quat.to_rotation_vector(quat.multiply(quat.conjugate(after.rotations), frames.rotations[:1]))
    bends = quat.from_rotation_vector(share[:, None, None] * missing)
    moves = share[:, None, None] * (frames.translations[:1] - after.translations)
    return replace(
        frames,
        rotations=quat.multiply(frames.rotations, bends),
        translations=frames.translations + moves,
    )


def _annotated(found: Found, cycle: Cycle, count: int, lead: Travel) -> Annotations:
    """Return the annotations of a cycle."""
    own = found.annotations
    heading = float(lead.headings[0])
    # The body goes along an arc of which `lead` is the chord.
    bend = float(np.sinc(0.5 * heading / np.pi))
    speed = float(np.hypot(*lead.places[0])) / max(bend, 1e-3) * RATE / count
    x, y = turned(lead.places, np.array([-0.5 * heading]))[0].tolist()
    turn_rate = heading * RATE / count
    goes, moves = own.kind in (*GOING, TURN), own.speed > 0.0
    speed, direction = (speed, float(np.arctan2(x, -y))) if moves else (0.0, 0.0)
    return replace(
        own,
        cycle=True,
        strikes=_strikes(found, cycle, count),
        speed=speed,
        turn_rate=turn_rate,
        direction=direction,
        phase=Phase.LOOP,
        strokes=own.strokes if cycle.whole else None,
        parameters={"speed": speed, "turn": turn_rate, "direction": direction} if goes else own.parameters,
    )


def _strikes(found: Found, cycle: Cycle, count: int) -> tuple[Strike, ...]:
    """Return when feet strike in a cycle: those of all rounds of the motion that are near it, taken together."""
    rounds = found.footfalls.cycle
    share = cycle.length / rounds if rounds else 1.0
    out: list[Strike] = []
    for foot in range(len(found.footfalls.seen.soles)):
        own = [share * row - cycle.first for of, row in found.footfalls.strikes if of == foot]
        near = [row for row in own if -SAME_STRIKE * cycle.length <= row <= (1.0 + SAME_STRIKE) * cycle.length]
        phases = _clustered([row / cycle.length % 1.0 for row in near])
        out.extend(Strike(foot, phase * count) for phase in phases)
    return tuple(out)


def _clustered(phases: list[float]) -> list[float]:
    """Return the middles of phases that are near to each other; 1 is 0 again."""
    out: list[list[float]] = []
    for phase in phases:
        for group in out:
            away = (phase - group[0] + 0.5) % 1.0 - 0.5
            if abs(away) < SAME_STRIKE:
                group.append(group[0] + away)
                break
        else:
            out.append([phase])
    return [float(np.mean(group)) % 1.0 for group in out]
