"""Routes: going to a place, around what stands in the way (Feng 2013 §6.2, locomotion).

Who is told to go somewhere is told to turn, to walk and to stop in the end; the way that this leads over the ground is
laid along a line to the place. So it goes in the manner of its own motions, and stops with a foot that lands.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from ..clips.behaviours.behaviour import Cue, Scene, cues_of
from ..clips.behaviours.registry import GO, is_behaviour
from ..clips.behaviours.steering import path_around
from ..clips.character_model import RATE
from ..clips.commands.command import Command, Verb
from ..clips.commands.parameters import told
from ..clips.models import controller
from ..clips.motions.library import Library
from ..clips.travel import Travel
from ..errors import MotionError
from ..locomotion import polyline
from ..locomotion.moving import eased
from ..locomotion.polyline import Polyline

TURN = "turn"
"""The motion that turns a body on the spot."""
ASIDE = np.radians(60.0)
"""A body that looks farther away from where it shall go turns first …"""
QUICK = 2.0
"""… this fast [rad/s]."""
COMES_ROUND = 0.8
"""What it looks aside by when it sets out it makes up for within this time [s]."""
ARRIVES = 1.0
"""It turns to where it shall look in the end within this time before it stands [s]."""
CORNER = 0.5
"""Corners are spread over this length [body heights]."""
HERE = 0.02
"""A place this near is where the body is [body heights]."""
SLACK = 5.0
"""A body has come to a stand so long after it was told to [s]."""
PATIENCE = 60.0
"""Nobody is on the way for longer than this, and as long as the way takes at its speed [s]."""
TRIES = 2
"""How often the speed is tuned so that a body comes to its place with a whole step …"""
TUNED = (0.75, 1.3)
"""… and by what factor at most."""


@dataclass(frozen=True, eq=False)
class Route:
    """A line over the ground that is gone along for some time."""

    start: float
    """Frame at which it begins."""
    end: float
    """Frame at which the body stands at its end."""
    line: Polyline
    factor: float
    """Length of the line over the way that the motions lead."""
    turn: float = 0.0
    """What it turns by as it arrives [rad], to the left."""


@dataclass(frozen=True, eq=False)
class Routed:
    """Commands without those to go somewhere, and the routes that these ask for."""

    commands: tuple[Command, ...]
    routes: tuple[Route, ...]
    warnings: tuple[str, ...]

    def with_more(self, commands: Iterable[Command]) -> "Routed":
        """Return the same with more commands."""
        return replace(self, commands=(*self.commands, *commands))


@dataclass(frozen=True, eq=False)
class Surroundings:
    """What a character is that goes somewhere, and what is around it."""

    library: Library
    """What it can do."""
    scale: float
    """Lengths of the ground over those of the library's body."""
    scene: Scene
    """Where targets are."""
    obstacles: Sequence[Array]
    """What stands about covers of the ground, convex and counter-clockwise [m], shapes (corner, 2)."""
    breadth: float
    """How far it keeps from these [m]."""

    def travel(self, routed: Routed, frames: Array) -> Travel:
        """Return where commands and routes lead at frames, in the lengths of the ground."""
        first = min([frames[0], *(route.start for route in routed.routes)])
        every = np.concatenate([np.arange(np.floor(first), frames[0], dtype=np.float64), frames])
        way = controller.perform(self.library, routed.commands, self.scale).travel(every)
        return along(routed.routes, every, Travel(self.scale * way.places, way.headings))[-len(frames) :]


def routed(around: Surroundings, commands: Sequence[Command]) -> Routed:
    """Return commands for motion models alone, in place of all that a character is told."""
    cues, warnings = cues_of(GO, commands, around.scene)
    out = Routed(tuple(command for command in commands if not is_behaviour(command.model)), (), tuple(warnings))
    for i, cue in enumerate(cues):
        if cue.values is None:
            out = out.with_more([_instead(cue.command, cue.at, cue.command.verb, _manner_before(cues, i))])
            continue
        until = cues[i + 1].at if i + 1 < len(cues) else np.inf
        try:
            out = _sent(around, out, cue, until)
        except MotionError as error:
            out = replace(out, warnings=(*out.warnings, told(cue.command, str(error))))
    return out


def along(routes: Sequence[Route], frames: Array, travel: Travel) -> Travel:
    """Return a travel that keeps to routes while these last, and goes on from their ends.

    Args:
        routes: In the order of time.
        frames: Of the clips, one after the other, shape (n,).
        travel: At these, in the lengths of the ground.
    """
    out = travel
    for route in routes:
        inside = np.flatnonzero((frames >= route.start - 1e-9) & (frames <= route.end + 1e-9))
        if not len(inside):
            continue
        gone, after = out[inside], np.arange(int(inside[-1]), len(frames))
        steps = np.hypot(*np.diff(gone.places, axis=0).T)
        way = route.factor * np.concatenate([[0.0], np.cumsum(steps)])
        points, headings = route.line.at(way)
        # It goes on as its motions turn it, and comes round to where the line leads.
        since = (frames[inside] - frames[inside[0]]) / RATE
        aside = _nearest(float(gone.headings[0] - headings[0]))
        full_turns = gone.headings[0] - headings[0] - aside
        away = aside * (1.0 - eased(since / COMES_ROUND))
        arriving = eased(1.0 - (route.end - frames[inside]) / (ARRIVES * RATE))
        laid = Travel(points[:, :2], headings + full_turns + away + route.turn * arriving)
        places, turns = out.places.copy(), out.headings.copy()
        on = laid[-1:].then(out[after].since(out[inside[-1:]]))
        places[inside], turns[inside] = laid.places, laid.headings
        places[after], turns[after] = on.places, on.headings
        out = Travel(places, turns)
    return out


def _nearest(angle: float) -> float:
    """Return an angle between -pi and pi [rad]."""
    return float((angle + np.pi) % (2.0 * np.pi) - np.pi)


def _manner_before(cues: Sequence[Cue], place: int) -> str:
    """Return in what manner a character goes that is told to stop."""
    for cue in reversed(cues[:place]):
        if cue.values is not None:
            return cue.text("manner", GO.parameters)
    return str(GO.parameters["manner"].default)


def _instead(command: Command, time: float, verb: Verb, model: str, **parameters: float) -> Command:
    """Return a command to a motion model in place of one to go somewhere."""
    return replace(command, time=time, verb=verb, model=model, parameters=dict(parameters))


def _sent(around: Surroundings, before: Routed, cue: Cue, until: float) -> Routed:
    """Return what brings a character to a place in the end.

    Args:
        around: The character.
        before: What it was told up to then.
        cue: Where it shall go.
        until: When it is told otherwise [s].

    Raises:
        MotionError: It is there already, or cannot go in that manner.
    """
    assert cue.values is not None, "it is told to go"
    manner, speed = cue.text("manner", GO.parameters), cue.number("speed", GO.parameters)
    if manner not in around.library.kinds:
        raise MotionError(f"it cannot go by {manner!r}: its library has none")
    now = around.travel(before, np.array([cue.at * RATE]))
    goal = around.scene.track(cue.values).at(np.array([cue.at]))[0, :2]
    room = cue.number("clearance", GO.parameters) or around.breadth
    way = path_around(now.places[0], goal, around.obstacles, room)
    points = way.points
    height = around.library.model.character.frame.height * around.scale
    if len(points) < 2 or float(np.hypot(*(points[-1] - points[0]))) < HERE * height:
        raise MotionError("it is there already")
    line = polyline.smoothed(points, closed=False, smoothing=CORNER * height)
    warnings = (*before.warnings, *(told(cue.command, text) for text in way.warnings))
    out, sets_out = replace(before, warnings=warnings), cue.at
    away = _nearest(float(line.headings[0] - now.headings[0]))
    if abs(away) > ASIDE and TURN in around.library.kinds:
        turn = float(np.copysign(QUICK, away))
        out = out.with_more([_instead(cue.command, cue.at, Verb.START, TURN, turn=turn)])
        sets_out += abs(away) / QUICK
    tried = [_tried(around, out, cue, sets_out, line.length, speed)]
    for _ in range(TRIES):
        # A body stops with a whole step, so it is its speed that is tuned to the way.
        fitting = speed * float(np.clip(line.length / max(tried[-1].gone, 1e-9), *TUNED))
        tried.append(_tried(around, out, cue, sets_out, line.length, speed, fitting))
    best = min(tried, key=lambda one: abs(one.gone - line.length))
    if best.gone <= 0.0 or best.stops >= until:
        # It is told otherwise before it is there, or never gets there: it goes along as far as it comes.
        end = min(until, sets_out + PATIENCE + line.length / speed)
        routed = replace(out, commands=best.commands[:-1])
        return replace(routed, routes=(*out.routes, Route(sets_out * RATE, end * RATE, line, 1.0)))
    turn = 0.0
    if "facing" in cue.values:
        faces = float(now.headings[0]) + np.radians(cue.number("facing", GO.parameters))
        turn = _nearest(float(faces - line.headings[-1]))
    route = Route(sets_out * RATE, best.end, line, line.length / best.gone, turn)
    return replace(out, commands=best.commands, routes=(*out.routes, route))


@dataclass(frozen=True, eq=False)
class _Try:
    """How far a body comes."""

    commands: tuple[Command, ...]
    """All, that to stop the last."""
    stops: float
    """When it is told to [s]."""
    end: float
    """Frame at which it stands."""
    gone: float
    """The way that it has gone [m]."""


def _tried(
    around: Surroundings, routed: Routed, cue: Cue, sets_out: float, length: float, speed: float, tuned: float = 0.0
) -> _Try:
    """Return how far a body comes that goes for as long as a way takes at its speed, at that speed or a tuned one."""
    manner = cue.text("manner", GO.parameters)
    stops = sets_out + length / speed
    start = _instead(cue.command, sets_out, Verb.START, manner, speed=tuned or speed)
    told = routed.with_more([start, _instead(cue.command, stops, Verb.STOP, manner)])
    frames = np.floor(sets_out * RATE) + np.arange(int(np.ceil((stops + SLACK - sets_out) * RATE)), dtype=np.float64)
    steps = np.hypot(*np.diff(around.travel(told, frames).places, axis=0).T)
    moving = np.flatnonzero(steps > 1e-4 * steps.max(initial=0.0))
    end = float(frames[moving[-1] + 1]) if len(moving) else float(frames[0])
    return _Try(told.commands, stops, end, float(steps.sum()))
