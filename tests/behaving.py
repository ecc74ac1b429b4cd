"""Characters that behave, for tests: as they stand, what they are told, and what comes out of the solver."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache

import numpy as np

from morph_retarget.core import play, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.clips.behaviours import acting
from morph_retarget.core.clips.behaviours.acting import Acted
from morph_retarget.core.clips.behaviours.actor import Actor
from morph_retarget.core.clips.behaviours.arms import Arm, arms_of
from morph_retarget.core.clips.behaviours.behaviour import Scene
from morph_retarget.core.clips.behaviours.hands import Hand
from morph_retarget.core.clips.behaviours.posture import Posture
from morph_retarget.core.clips.commands.command import Command, Value, Verb
from morph_retarget.core.clips.track import Track
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.solve import posing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.plan import Plan
from tests.skeletons import skeleton_of
from tools.creatures import CREATURES
from tools.figure import Build, humanoid

RATE = 30.0


@dataclass(frozen=True, eq=False)
class Subject:
    """A character that stands, its arms hanging down."""

    character: Character

    @cached_property
    def actor(self) -> Actor:
        """What behaviours read of it."""
        bodies = Bodies.of(self.character)
        return Actor(self.character, bodies, play.root_of(bodies))

    @cached_property
    def hands(self) -> Sequence[Hand]:
        """What it reaches with and the solver can move."""
        return [arm.hand for arm in arms_of(self.actor) if arm.joints]

    def arm(self, hand: Hand) -> Arm:
        """Return the limb of a hand."""
        return next(arm for arm in arms_of(self.actor) if arm.hand.body == hand.body)

    def standing(self, count: int) -> Posture:
        """Return how it stands, over some frames."""
        rest, actor = self.actor.rest, self.actor
        still = Posture(quat.identity(count, len(rest)), np.broadcast_to(rest, (count, *rest.shape)).copy())
        changes: dict[int, Array] = {}
        for hand in self.hands:
            if hand.is_arm:
                first = self.arm(hand).joints[0]
                down = np.array([0.15 * hand.side, -0.05, -1.0])
                changes[first] = np.broadcast_to(quat.between(rest[hand.body] - rest[first], down), (count, 4))
        return still.turned(actor.tree, changes)

    def act(
        self,
        commands: Sequence[Command],
        targets: Mapping[str, Track | Array] | None = None,
        seconds: float = 3.0,
        posture: Posture | None = None,
    ) -> "Shown":
        """Return what it does when it is told something."""
        times = np.arange(round(seconds * RATE) + 1) / RATE
        tracks = {n: t if isinstance(t, Track) else Track.at_place(t) for n, t in (targets or {}).items()}
        base = self.standing(len(times)) if posture is None else posture
        scene = Scene(times, tracks)
        return Shown(self, scene, base, acting.act(self.actor, scene, base, commands))


@dataclass(frozen=True, eq=False)
class Shown:
    """What a character does."""

    subject: Subject
    scene: Scene
    base: Posture
    acted: Acted

    @cached_property
    def posture(self) -> Posture:
        """The pose that the solver makes of it, with goals for the turns of all bodies as the director gives them."""
        actor, acted = self.subject.actor, self.acted
        above = {actor.root, *actor.tree.ancestors[actor.root]}
        bodies = [actor.root, *(body for body in range(len(actor.rest)) if body not in above)]
        hands = acted.bodies.tolist()
        plan = _plan(actor, tuple((body, body == actor.root or body in hands, True) for body in bodies))
        places = acted.posture.positions[:, bodies].copy()
        counts = np.zeros(places.shape[:2])
        counts[:, 0] = 1.0
        for k, hand in enumerate(hands):
            places[:, bodies.index(hand)], counts[:, bodies.index(hand)] = acted.places[:, k], acted.influence[:, k]
        turns = acted.posture.turns[:, bodies]
        pose = posing.solve(plan, Goals(np.array(bodies), places, turns, counts, np.ones_like(counts)))
        return Posture(pose.turns, pose.positions)

    def frame(self, time: float) -> int:
        """Return the frame that is shown at a time [s]."""
        return round(time * RATE)

    def point(self, hand: Hand, rest: Array) -> Array:
        """Return where a point of a hand is [m], from its joint at rest, shape (3,) to (n, 3)."""
        return self.posture.point(hand.body, rest)


@lru_cache(maxsize=16)
def _plan(actor: Actor, wanted: tuple[tuple[int, bool, bool], ...]) -> Plan:
    return posing.prepare(actor.character, actor.rest, actor.root, wanted)


def start(time: float, model: str, **parameters: Value) -> Command:
    """Return a command to start something."""
    return Command(time, Verb.START, model, parameters)


def stop(time: float, model: str, **parameters: Value) -> Command:
    """Return a command to stop something."""
    return Command(time, Verb.STOP, model, parameters)


def reset(time: float, model: str) -> Command:
    """Return a command to stop something at once."""
    return Command(time, Verb.RESET, model)


@cache
def figure(build: Build | None = None) -> Subject:
    """Return a humanoid with five fingers to a hand, in a T-pose unless told otherwise."""
    return Subject(analyze(skeleton_of(humanoid(build=build or Build(fingers=5)), np.random.default_rng(0))))


@cache
def creature(name: str) -> Subject:
    """Return one of the sample characters."""
    return Subject(analyze(skeleton_of(CREATURES[name](), np.random.default_rng(0))))
