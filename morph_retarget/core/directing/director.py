"""Directing a character: from a list of commands to goals at any time (Grünvogel 2003 §6, Feng 2013 §5).

    commands -> controller -> frames of clips -> transfer, once -> behaviours -> goals

It is prepared for a range of frames and depends on nothing that was shown before.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np

from .. import quat
from ..arrays import Array, Indices
from ..character.character import Character
from ..clips import posing
from ..clips.behaviours import acting
from ..clips.behaviours.acting import Acted
from ..clips.behaviours.actor import Actor
from ..clips.behaviours.arms import Arm
from ..clips.behaviours.behaviour import Scene
from ..clips.behaviours.hands import hands_of
from ..clips.behaviours.posture import Posture
from ..clips.character_model import RATE, CharacterModel
from ..clips.commands.command import Command
from ..clips.frames import Frames
from ..clips.models import controller
from ..clips.models.performance import Performance
from ..clips.motions.library import Library
from ..clips.track import Track
from ..clips.travel import Travel
from ..ground import Ground, heights_on
from ..locomotion.course import Course
from ..locomotion.moving import carried_by
from ..morph.bodies import Bodies
from ..morph.specialize import Deforms
from ..solve.goals import Goals
from ..solve.settings import DEFAULT, SolverSettings
from . import performing, routes, transferring
from .moved import Moved
from .routes import Surroundings

BREADTH = 0.2
"""Half of what a body takes of the ground to go through, where nobody says [body heights]."""


@dataclass(frozen=True, eq=False)
class Directions:
    """What a character is told, and what is around it."""

    commands: Sequence[Command] = ()
    targets: Mapping[str, Track] = field(default_factory=dict[str, Track])
    """By the names that commands use."""
    ground: Ground | None = None
    """Terrain, the character frame in which it sets out; flat when None, and where there is none."""
    obstacles: Sequence[Array] = ()
    """What it goes around: what that covers of the ground, convex and counter-clockwise [m], shapes (corner, 2)."""
    solver: SolverSettings = DEFAULT
    """Of the solver that brings hands to their places."""
    warnings: tuple[str, ...] = ()
    """What the user should know of the commands as they were read."""


@dataclass(frozen=True, eq=False)
class Hands:
    """Places of hands, whether they reach for anything or not."""

    bodies: tuple[int, ...]
    places: Array
    """[m], shape (frame, hand, 3)."""
    influence: Array
    """How far these count, shape (frame, hand)."""

    @classmethod
    def of(cls, actor: Actor, moving: Indices, acted: Acted | None = None) -> "Hands":
        """Return those of a character; they are the same ones whatever it does.

        Args:
            actor: The character.
            moving: Bodies that have places of their own.
            acted: What they do, nothing when None.
        """
        able = [hand.body for hand in hands_of(actor) if Arm(actor, hand).joints and hand.body not in moving]
        count = 1 if acted is None else len(acted.posture)
        places, influence = np.zeros((count, len(able), 3)), np.zeros((count, len(able)))
        for i, body in enumerate([] if acted is None else acted.bodies.tolist()):
            if acted is not None and body in able:
                places[:, able.index(body)] = acted.places[:, i]
                influence[:, able.index(body)] = acted.influence[:, i]
        return cls(tuple(able), places, influence)


@dataclass(frozen=True, eq=False)
class Directed:
    """A character that does what it is told: a way of moving as gaits are (`locomotion.moving.Moving`)."""

    model: CharacterModel
    """The character that shows it."""
    performance: Performance | None
    """None for one that has been told nothing and stands."""
    first: float
    """Frame of the clips at which it was prepared first."""
    moved: Moved
    """What the bodies do, frame by frame from there."""
    heights: Array
    """Of the ground under the body [m], shape (frame,)."""
    hands: Hands
    """What brings hands to places."""
    shown: Deforms
    """Values of what is shown on the face, shapes (frame,)."""
    warnings: tuple[str, ...]
    """What the user should know."""

    @cached_property
    def bodies(self) -> Indices:
        """Bodies that have goals, the root first: all but those above it, shape (n,)."""
        root, tree = self.model.root, self.model.character.skeleton.tree
        above = {root, *tree.ancestors[root]}
        return np.array([root, *(body for body in range(len(tree)) if body not in above)], dtype=np.intp)

    @cached_property
    def placed(self) -> Indices:
        """Which of these have places: the root, and what nothing that turns carries, shape (m,)."""
        return np.flatnonzero(np.isin(self.bodies, self.model.moving))

    @property
    def wanted(self) -> tuple[tuple[int, bool, bool], ...]:
        """For each goal its body, and whether it has a place and a turn."""
        placed = {*self.bodies[self.placed].tolist(), *self.hands.bodies}
        return tuple((body, body in placed, True) for body in self.bodies.tolist())

    @property
    def course(self) -> Course:
        """Where it goes."""
        times = (self.first + np.arange(len(self.moved.turns), dtype=np.float64)) / RATE
        travel = self.moved.travel
        return Course(times, np.column_stack([travel.places, np.zeros(len(travel))]), travel.headings)

    def evaluate(self, times: Array, carried: Array | None = None) -> Goals:
        """Return goals for a batch of frames, held beyond what was prepared; see `Moving`."""
        low, high, part = self._rows(times)
        turns = self.moved.turns[:, self.bodies]
        turned = quat.slerp(turns[low], turns[high], part[:, None])
        own = self.moved.positions[:, self.bodies[self.placed]]
        places = np.zeros((len(times), len(self.bodies), 3))
        places[:, self.placed] = own[low] + part[:, None, None] * (own[high] - own[low])
        counts = np.zeros(turned.shape[:2])
        counts[:, self.placed] = 1.0
        rows = [self.bodies.tolist().index(body) for body in self.hands.bodies]
        reached, how = self.hands.places, self.hands.influence
        places[:, rows] = reached[low] + part[:, None, None] * (reached[high] - reached[low])
        counts[:, rows] = how[low] + part[:, None] * (how[high] - how[low])
        if carried is not None:
            places, turned = carried_by(carried, places, turned)
        return Goals(self.bodies, places, turned, counts, np.ones_like(counts))

    def floors(self, times: Array) -> Array:
        """Return how high the ground is that carries the body [m], shape (frame,)."""
        low, high, part = self._rows(times)
        return self.heights[low] + part * (self.heights[high] - self.heights[low])

    def deforms(self, times: Array) -> Deforms:
        """Return the values of what is shown on the face, by the body that has it and its name, shapes (frame,)."""
        low, high, part = self._rows(times)
        return {key: curve[low] + part * (curve[high] - curve[low]) for key, curve in self.shown.items()}

    def _rows(self, times: Array) -> tuple[Indices, Indices, Array]:
        rows = np.clip(times * RATE - self.first, 0.0, len(self.moved.turns) - 1.0)
        low = rows.astype(np.intp)
        return low, np.minimum(low + 1, len(self.moved.turns) - 1), rows - low


def prepare(character: Character, library: Library, directions: Directions, last: float) -> Directed:
    """Return a character that does what it is told.

    Args:
        character: What the rig is.
        library: What it can do; made for this body or another one.
        directions: What it is told.
        last: Up to when it is needed [s].

    Raises:
        RigError: Just one of the library's body and the character has legs.
        MappingError: They share no joints.
    """
    model = performing.model_of(character)
    scale = transferring.scale_between(library.model, character)
    first = min([0.0, *(command.time for command in directions.commands)])
    start = float(np.floor(first * RATE))
    frames = start + np.arange(max(int(np.ceil(last * RATE - start)), 0) + 1, dtype=np.float64)
    around = Surroundings(
        library, scale, Scene(frames / RATE, directions.targets), directions.obstacles, BREADTH * character.frame.height
    )
    routed = routes.routed(around, directions.commands)
    performance = controller.perform(library, routed.commands, scale)
    way = performance.travel(frames)
    way = routes.along(routed.routes, frames, Travel(scale * way.places, way.headings))
    way = Travel(way.places / scale, way.headings)
    moved = transferring.on(model, library.model, performance.frame(frames), way, directions.ground)
    heights = np.zeros(len(frames))
    if directions.ground is not None:
        points = np.column_stack([moved.travel.places, np.full(len(frames), character.frame.height)])
        heights = heights_on(directions.ground, points, 0.0)
    actor = Actor(character, Bodies.of(character), model.root)
    scene, posture = Scene(frames / RATE, directions.targets, heights), Posture(moved.turns, moved.positions)
    acted = acting.act(actor, scene, posture, directions.commands, directions.solver)
    moved = replace(moved, turns=acted.posture.turns, positions=acted.posture.positions)
    bearer = model.root if actor.head is None else actor.head
    shown = {(bearer, name): curve for name, curve in acted.shown.items()}
    warnings = (*directions.warnings, *routed.warnings, *performance.warnings, *acted.warnings)
    return Directed(model, performance, start, moved, heights, Hands.of(actor, model.moving, acted), shown, warnings)


@lru_cache(maxsize=32)  # asked for with each edit of what a character is told
def standing(character: Character) -> Directed:
    """Return a character that has been told nothing: its goals are for the same bodies as those of all others."""
    model = performing.model_of(character)
    rest = Frames.at_rest(model)
    moved = Moved.of(character, posing.pose_of(model, rest), Travel.still(), rest.contacts)
    hands = Hands.of(Actor(character, Bodies.of(character), model.root), model.moving)
    return Directed(model, None, 0.0, moved, np.zeros(1), hands, {}, ())
