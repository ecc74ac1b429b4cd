"""Performing: gaits and generalized actions on a character, taken down as clips (Grünvogel 2003 §5.3).

All takes that ask the solver for goals of the same bodies are solved in one batch.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from .. import keyed, play, quat
from ..arrays import Array
from ..character.character import Character
from ..clips import posing
from ..clips.character_model import RATE, CharacterModel
from ..clips.clip import ClipPrimitive
from ..clips.frames import Frames
from ..clips.spots import spots_of
from ..clips.travel import Travel
from ..layering import Layer, Wanted
from ..locomotion import getting_about
from ..locomotion.course import Course, from_speed
from ..locomotion.moving import Moving
from ..locomotion.settings import GaitSettings
from ..locomotion.stepping.gait import Gait
from ..morph import specialize
from ..morph.bind import Binding, GeneralizedAction, bind
from ..morph.bodies import Bodies
from ..morph.channels import Values
from ..play import Part
from ..solve.settings import DEFAULT, SolverSettings
from .takes import Take, layer_of, values_of

STILL = from_speed(np.array([0.0, 1.0]), np.zeros(2), np.zeros(2))
"""The course of what stays where it is."""
NOTHING = GeneralizedAction("nothing", ())
"""An action that leaves all to what it is laid over."""
LIFTED = 0.015, 0.04
"""A foot that leaves where its gait stands still counts as standing up to the first of these and not at all from the
second on [body heights]."""
LEAST_FRAMES = 4
"""A cycle has no fewer frames than this, however small a body is."""


@lru_cache(maxsize=32)
def model_of(character: Character) -> CharacterModel:
    """Return a character as the body of clips, the same each time: its root is what carries it as it goes.

    Raises:
        RigError: It cannot go in any way.
    """
    root = character.carrier(play.root_of(Bodies.of(character)))
    return CharacterModel(character, getting_about.prepare(character, root, STILL, GaitSettings()).wanted[0][0])


def moving_on(model: CharacterModel, course: Course, settings: GaitSettings | None = None) -> Moving:
    """Return how a body goes along a course by its own means."""
    return getting_about.prepare(model.character, model.root, course, settings or GaitSettings())


def step_of(period: float) -> tuple[int, float]:
    """Return of how many frames a cycle is, and how far they are apart in it [s].

    A clip has whole frames; a cycle that takes no whole number of them at `RATE` is shown a little faster or slower.

    Args:
        period: Of the cycle [s].
    """
    count = max(round(period * RATE), LEAST_FRAMES)
    return count, period / count


def performed(model: CharacterModel, takes: Sequence[Take], binding: Binding | None = None) -> list[ClipPrimitive]:
    """Return takes as clips.

    Args:
        model: The body.
        takes: All of one way to move.
        binding: The action on this body for which the takes have values; None without one.

    Raises:
        RigError: The solver cannot pose it.
    """
    if not takes:
        return []
    action = binding or bind(NOTHING, Bodies.of(model.character))
    moving = takes[0].moving
    wanted = moving.wanted
    assert all(take.moving.wanted == wanted for take in takes), "takes of one batch move alike"
    part = _prepared(model, action, wanted, getting_about.tuned(DEFAULT, moving))
    values = values_of(takes, len(action.action.channels))
    layer = _yielding(action, values, layer_of(model.character, takes))
    pose = keyed.played(model.character.skeleton, play.evaluate(part, values, {}, layer))
    ways = [take.way for take in takes]
    whole = Travel(np.concatenate([way.places for way in ways]), np.concatenate([way.headings for way in ways]))
    contacts = np.concatenate([_contacts(model, take.moving, take.times) for take in takes])
    frames = posing.frames_of(model, pose, whole, np.zeros_like(contacts))
    positions = model.character.local_to_character.points(pose.positions)
    out: list[ClipPrimitive] = []
    ends = np.cumsum([0, *(len(take.times) for take in takes)]).tolist()
    for take, way, (first, last) in zip(takes, ways, pairwise(ends), strict=True):
        rows = slice(first, last)
        stands = contacts[rows]
        if take.values is not None and len(model.feet):
            stands = stands * _stays(model, positions[rows])
        # Where a foot stands is a matter of the whole take, not of single frames.
        feet = spots_of(model, positions[rows], way, stands, take.cycle)
        own = replace(frames[rows], feet=feet, contacts=stands)
        out.append(ClipPrimitive(take.name, model, own, way.since(way[:1])))
    return out


def bare(model: CharacterModel, binding: Binding, values: Values) -> Frames:
    """Return an action alone, over the rest pose."""
    part = _prepared(model, binding, ())
    pose = keyed.played(model.character.skeleton, play.evaluate(part, values, {}))
    return posing.frames_of(model, pose, Travel.still(len(values)), np.zeros((len(values), len(model.feet))))


def _prepared(model: CharacterModel, binding: Binding, lower: Wanted, settings: SolverSettings = DEFAULT) -> Part:
    """Return how an action plays that may be bound to bodies in another stance than they rest in."""
    rest = model.character.local_to_character.points(model.character.skeleton.rest_positions)
    resting = replace(binding, bodies=replace(binding.bodies, positions=rest))
    return replace(play.prepare(model.character, resting, settings, lower=lower), binding=binding)


def _yielding(binding: Binding, values: Values, lower: Layer) -> Layer:
    """Return a lower layer that does not turn the hands and feet which an action over it places but leaves unturned.

    A hand that is led elsewhere goes on as its forearm points, and does not hang as it does while the body walks.
    """
    own = specialize.goals_of(binding, values, specialize.frames_of(binding, {}))
    turned = lower.goals.rotation_influence.copy()
    rows = {body: row for row, body in enumerate(lower.goals.bodies.tolist()) if row}
    for i, body in enumerate(own.bodies.tolist()):
        if body in rows:
            turned[:, rows[body]] *= 1.0 - own.position_influence[:, i] * (1.0 - own.rotation_influence[:, i])
    return replace(lower, goals=replace(lower.goals, rotation_influence=turned))


def _contacts(model: CharacterModel, moving: Moving, times: Array) -> Array:
    """Return which feet stand, 0 or 1, shape (n, foot)."""
    if isinstance(moving, Gait):
        return moving.contacts(times).astype(np.float64)
    return np.zeros((len(times), len(model.feet)))


def _stays(model: CharacterModel, positions: Array) -> Array:
    """Return how far feet are where the first frame has them, 0 … 1, shape (n, foot)."""
    feet = positions[:, model.feet]
    away = quat.length(feet - feet[:1]) / model.character.frame.height
    return np.clip((LIFTED[1] - away) / (LIFTED[1] - LIFTED[0]), 0.0, 1.0)
