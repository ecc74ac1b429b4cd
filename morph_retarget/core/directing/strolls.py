"""Strolls: how fast, how sharply and whereto a character walks and runs in its starter library.

Speeds are those at which animals of all sizes go alike: u = v / sqrt(g h) with the hip height h (Alexander & Jayes
1983). All numbers are our choice.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..character.character import Character
from ..clips.character_model import CharacterModel
from ..clips.motions.annotations import Annotations, Phase
from ..locomotion.footless.floating import Floating
from ..locomotion.footless.hopping import Hopping
from ..locomotion.settings import GaitSettings
from ..locomotion.stepping import legs
from ..locomotion.stepping.pace import GRAVITY
from .outings import Manner, Outing
from .takes import Take

TITLES = "slow", "", "fast"
"""Of the speeds of a kind, in the names of motions."""
SIDES = (0.0, ""), (1.0, "left"), (-1.0, "right")
ASIDE = (np.pi, "backward"), (0.5 * np.pi, "to the left"), (-0.5 * np.pi, "to the right")
"""Directions of walks that do not go ahead."""


@dataclass(frozen=True)
class Stroll:
    """A way to go at some speeds."""

    kind: str
    speeds: tuple[float, ...]
    """u, or for what has no feet shares of the speed that suits it; the middle one is that of starts and stops."""
    turn: float
    """How far it turns in a cycle of its turning loops [rad]; bodies with more than two feet are longer, and turn by
    `LONG` of this."""
    ramp: float
    """Within how many cycles it comes to its speed."""
    aside: float = 0.0
    """u of going backward and to the sides; 0 for not at all."""


STROLLS = (
    Stroll("walk", (0.25, 0.45, 0.65), 0.7, 0.8, 0.28),
    Stroll("run", (0.9, 1.3, 2.0), 0.45, 1.8),
    Stroll("turn", (), 0.0, 0.8),
)
LONG = 0.6
CROWD = 0.8
"""Bodies with more than four feet go slower by this factor."""
SLOW, HURRY = (0.6, 1.0, 1.5), (1.9, 2.3, 2.8)
"""What has no feet goes so much faster than suits it when it walks and runs."""
TEMPO, HOPS = 1.7, 0.95
"""A cycle that suits what crawls, and what hops, takes so many seconds where it leads by 1 m; longer ones take longer
as pendulums do."""
FLOATS = 0.3
"""u that suits what hovers, by its size."""
ROUND = 1.1
"""How far a body turns on the spot in about one cycle [rad] …"""
STEPPING = 3.6
"""… which takes so long [sqrt(hip height / gravity)]."""


def takes_of(model: CharacterModel, stroll: Stroll) -> Iterator[tuple[Take, Annotations]]:
    """Yield all loops, starts and stops of a stroll.

    Raises:
        RigError: The character cannot go.
    """
    if stroll.kind == "turn":
        yield from _on_the_spot(model, stroll)
        return
    speeds = _speeds(model, stroll)
    settings = _settings(model, stroll.kind)
    turn = stroll.turn * (1.0 if len(model.feet) in {1, 2} else LONG)
    for speed, title in zip(speeds, TITLES, strict=True):
        manner = Manner(stroll.kind, speed, ramp=stroll.ramp, settings=settings)
        straight = Outing.of(model, manner)
        for side, word in SIDES:
            own = straight
            if side:
                own = Outing.of(model, replace(manner, turn_rate=side * turn / straight.period))
            yield _loop(own, _named(stroll.kind, title, word))
        if not title:
            yield from _ends(straight)
    if stroll.aside and len(model.feet):
        unit = speeds[1] / stroll.speeds[1]
        for direction, word in ASIDE:
            manner = Manner(stroll.kind, stroll.aside * unit, direction=direction, settings=settings)
            yield _loop(Outing.of(model, manner), _named(stroll.kind, word))


def _on_the_spot(model: CharacterModel, stroll: Stroll) -> Iterator[tuple[Take, Annotations]]:
    rate = ROUND / (STEPPING * np.sqrt(_height(model.character) / GRAVITY))
    for side, word in SIDES[1:]:
        manner = Manner(stroll.kind, 0.0, side * float(rate), settings=_settings(model, "walk"))
        take, known = _loop(Outing.of(model, manner), _named(stroll.kind, word))
        yield take, replace(known, side=word)


def _loop(own: Outing, name: str) -> tuple[Take, Annotations]:
    take = own.loop(name)
    return take, own.annotations(take, Phase.LOOP)


def _ends(own: Outing) -> Iterator[tuple[Take, Annotations]]:
    """Yield how an outing starts, and how it stops as each of the feet of a row lands."""
    kind, feet = own.manner.kind, own.model.character.legs
    start = own.set_out(_named(kind, "start"))
    yield start, own.annotations(start, Phase.START)
    landing = {strike.frame: feet[strike.foot].side for strike in own.annotations(own.loop(kind), Phase.LOOP).strikes}
    count = own.step[0]
    for share in (0.0, 0.5) if len(feet) > 1 else (0.0,):
        nearest = min(
            landing, key=lambda frame: abs((frame - share * count + 0.5 * count) % count - 0.5 * count), default=None
        )
        side = "" if nearest is None else {1: "left", -1: "right"}.get(landing[nearest], "")
        stop = own.come_to_stand(_named(kind, "stop", side), share)
        yield stop, own.annotations(stop, Phase.STOP, side)


def _named(*words: str) -> str:
    return " ".join(word for word in words if word)


def _settings(model: CharacterModel, kind: str) -> GaitSettings:
    """Return how feet go: in the manner of all speeds, but that a fast walk is one."""
    return GaitSettings(styles=(("walk" if kind != "run" and len(model.feet) in {2, 4} else "auto", 1.0),))


def _height(character: Character) -> float:
    """Return what speeds are measured by [m]."""
    found = legs.find(character)
    return found.groups[0].height if found.groups else character.frame.height


def _speeds(model: CharacterModel, stroll: Stroll) -> tuple[float, ...]:
    """Return the speeds of a stroll [m/s]."""
    if len(model.feet):
        unit = float(np.sqrt(GRAVITY * _height(model.character))) * (CROWD if len(model.feet) > 4 else 1.0)
        return tuple(unit * share for share in stroll.speeds)
    unit = _suiting(model)
    return tuple(unit * share for share in (SLOW if stroll.kind == "walk" else HURRY))


def _suiting(model: CharacterModel) -> float:
    """Return the speed that suits what has no feet [m/s]."""
    tried = Outing.of(model, Manner("walk", float(np.sqrt(model.character.frame.height))))
    if isinstance(tried.moving, Floating):
        return float(FLOATS * np.sqrt(GRAVITY * tried.moving.size))
    way = tried.manner.speed * tried.period
    return float(np.sqrt(way)) / (HOPS if isinstance(tried.moving, Hopping) else TEMPO)
