"""From pose goals to bones: which joints each goal moves, and the pose that meets the goals.

The root is placed, then bodies are posed from it outward: those with a goal for their rotation are turned, and
those with a goal for their position are reached by the chain of joints that leads to them from what carries the
limb, the trunk or the neck. What has no goal is carried along. The pose depends on the goals of its frame alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Indices
from ..character.character import Character
from ..character.morphology import Capability, LimbKind
from .chain import Chain
from .goals import Goals

NONE = -1


@dataclass(frozen=True, eq=False)
class BodyPose:
    """A character's pose over a clip, character frame."""

    rotations: Array
    """Turn of each leader of the plan from its rest, as matrices, shape (frame, leader, 3, 3)."""
    places: Array
    """Of the leaders' joints [m], shape (frame, leader, 3)."""
    shift: Array
    """How far the root moved from where its parents hold it, in their frame [m], shape (frame, 3)."""
    plan: "Plan"

    @cached_property
    def turns(self) -> Array:
        """Turn of each body from its rest, shape (frame, body, 4)."""
        return quat.from_matrix(self.rotations)[:, self.plan.led_by]

    @cached_property
    def positions(self) -> Array:
        """Of the bodies' joints [m], shape (frame, body, 3)."""
        plan = self.plan
        away = rotation.apply(self.rotations[:, plan.led_by], plan.rest - plan.rest[plan.leaders])
        return self.places[:, plan.led_by] + away


@dataclass(frozen=True, eq=False)
class Step:
    """One goal and the joints that serve it."""

    goal: int
    """Its place among the goals."""
    body: int
    joints: tuple[int, ...]
    """Joints that bring the body to its place, from the trunk outward; none where it can only turn."""
    chain: Chain | None
    level: bool
    """Whether the body keeps its rest orientation when it has a place but no rotation of its own: feet do."""


@dataclass(frozen=True, eq=False)
class Plan:
    """How the goals of some bodies are met on a character."""

    parents: Indices
    rest: Array
    """Rest positions of all bodies [m], character frame, shape (body, 3)."""
    root: int
    steps: tuple[Step, ...]
    """From the root outward."""
    leaders: Indices
    """For each body the nearest one upward (itself included) that turns by itself, or a root; shape (body,)."""
    order: tuple[int, ...]
    """The leaders, from the roots outward."""
    driven: tuple[int, ...]
    """Bodies that the goals turn, from the root outward; the others are carried along."""
    unreachable: tuple[int, ...]
    """Bodies whose place cannot be changed: they are fixed to what carries them, or another goal has its joints."""

    @cached_property
    def led_by(self) -> Indices:
        """For each body the place of its leader in `order`, shape (body,)."""
        place = np.empty(len(self.rest), dtype=np.intp)
        place[list(self.order)] = np.arange(len(self.order))
        return place[self.leaders]

    @cached_property
    def above(self) -> dict[int, int]:
        """For each leader the one that carries it, NONE for roots."""
        parents = {leader: int(self.parents[leader]) for leader in self.order}
        return {leader: int(self.leaders[p]) if p >= 0 else NONE for leader, p in parents.items()}


def prepare(character: Character, rest: Array, root: int, wanted: Sequence[tuple[int, bool, bool]]) -> Plan:
    """Return how goals for some bodies are met.

    Args:
        character: What the rig is.
        rest: Rest positions of all bodies [m], character frame, shape (body, 3).
        root: The body that carries all others.
        wanted: For each goal its body, and whether it has a place and a rotation.
    """
    tree = character.skeleton.tree
    order = sorted(range(len(wanted)), key=lambda i: (len(tree.ancestors[wanted[i][0]]), wanted[i][0]))
    posed = {body for body, _, rotation in wanted if rotation}
    taken: set[int] = {root}
    steps: list[Step] = []
    unreachable: list[int] = []
    for i in order:
        body, position, _ = wanted[i]
        joints: tuple[int, ...] = ()
        if position and body != root:
            joints = _joints(character, body, root, posed | taken)
            if not joints:
                unreachable.append(body)
            taken.update(joints)
        chain = Chain.make(rest[[*joints, body]], _hint(character, body)) if joints else None
        level = Capability.FOOT in character.capabilities.get(character.skeleton.names[body], ())
        steps.append(Step(i, body, joints, chain, level))
    steps.sort(key=lambda step: len(tree.ancestors[step.joints[0] if step.joints else step.body]))
    driven = {*taken, *posed, *(step.body for step in steps)}
    moving = driven | set(tree.roots) | _loose(character)
    leaders = np.empty(len(rest), dtype=np.intp)
    for body in tree.order:
        leaders[body] = body if body in moving else leaders[tree.parents[body]]
    return Plan(
        character.skeleton.parents,
        rest,
        root,
        tuple(steps),
        leaders,
        tuple(b for b in tree.order if b in moving),
        tuple(b for b in tree.order if b in driven or b in _loose(character)),
        tuple(unreachable),
    )


def _loose(character: Character) -> set[int]:
    """Return the bones that do not take over their parents' rotation, and so must be turned to be carried along."""
    inherits = character.skeleton.inherits
    return set() if inherits is None else {int(bone) for bone in np.flatnonzero(~inherits)}


def _joints(character: Character, body: int, root: int, taken: set[int]) -> tuple[int, ...]:
    """Return the joints that bring a body to a place, from the trunk outward."""
    above = character.skeleton.tree.ancestors[body]
    trunk = {*character.spine, *character.neck, root, *([] if character.head is None else [character.head])}
    of_trunk = body in trunk or (above[:1] and above[0] in trunk and not _on_limb(character, body))
    carriers = {_carrier(character, limb.bones[0]) for limb in character.legs} if of_trunk else trunk
    # What carries the root carries the whole body: feet that hang on it (IK bones) have no limb that could reach.
    stops = taken | carriers | {root, *character.skeleton.tree.ancestors[root]}
    out: list[int] = []
    for bone in above:
        if bone in stops:
            break
        out.append(bone)
    shoulders = {character.bone("leftShoulder"), character.bone("rightShoulder")}
    if len(out) > 2 and out[-1] in shoulders:
        out.pop()
    return tuple(reversed(out))


def _on_limb(character: Character, body: int) -> bool:
    return any(body in limb.bones or body in limb.digits for limb in character.limbs)


def _carrier(character: Character, bone: int) -> int:
    """Return what a limb's first bone hangs on."""
    parent = int(character.skeleton.parents[bone])
    return parent if parent >= 0 else bone


_HINTS = {
    LimbKind.LEG: np.array([0.0, -1.0, 0.2]),
    LimbKind.ARM: np.array([0.0, 1.0, -0.3]),
    LimbKind.WING: np.array([0.0, 1.0, 0.3]),
    LimbKind.FIN: np.array([0.0, 1.0, 0.0]),
    LimbKind.TENTACLE: np.array([0.0, 0.0, 1.0]),
}


def _hint(character: Character, body: int) -> Array:
    """Return where the middle of a straight chain moves when it bends: knees forward, elbows back, the rest up."""
    for limb in character.limbs:
        if body in limb.bones or body in limb.digits:
            return _HINTS[limb.kind]
    return np.array([0.0, 1.0, 0.3])


def solve(plan: Plan, goals: Goals) -> BodyPose:
    """Return the pose that meets the goals."""
    state = _State(plan, goals)
    for step in plan.steps:
        state.take(step)
    frames = len(goals)
    rotations = np.empty((frames, len(plan.order), 3, 3))
    places = np.empty((frames, len(plan.order), 3))
    for i, leader in enumerate(plan.order):
        rotations[:, i], places[:, i] = state.rotation(leader), state.place(leader)
    return BodyPose(rotations, places, np.broadcast_to(state.shift_from_parent(), (frames, 3)), plan)


class _State:
    """A pose in the making: rotations and places of the leaders, from the root outward."""

    def __init__(self, plan: Plan, goals: Goals) -> None:
        self.plan = plan
        self.goals = goals
        self.shift = np.zeros((1, 3))
        self._wanted = quat.to_matrix(goals.turns)
        self._whole = bool((goals.rotation_influence == 1.0).all())
        # The body does not follow what happens to carry its root: a snake's head may.
        self._rotations: dict[int, Array] = {plan.root: np.eye(3)[None]}
        self._places: dict[int, Array] = {}

    def take(self, step: Step) -> None:
        """Meet one goal; those nearer to the root have been met before."""
        plan, goals = self.plan, self.goals
        influence = goals.position_influence[:, step.goal, None]
        if step.body == plan.root:
            self.shift = influence * (goals.positions[:, step.goal] - plan.rest[plan.root])
        carried = self.rotation(plan.root if step.body == plan.root else plan.above[step.body])
        if step.chain is not None:
            carried = self._reach(step, step.chain, influence)
            if step.level:
                carried = _toward(carried, np.eye(3)[None], influence[:, 0])
        self._rotations[step.body] = self._turned(step, carried)

    def _reach(self, step: Step, chain: Chain, influence: Array) -> Array:
        """Turn the joints of a chain, and return the rotation of the last."""
        plan, start = self.plan, step.joints[0]
        carried, place = self.rotation(plan.above[start]), self.place(start)
        along = self.goals.positions[:, step.goal] - place
        if (influence != 1.0).any():
            rest = rotation.apply(carried, plan.rest[step.body] - plan.rest[start])
            along = rest + influence * (along - rest)
        turns, _ = chain.reach(rotation.apply(rotation.transposed(carried), along))
        turned = np.matmul(carried[:, None], turns)
        for i, joint in enumerate(step.joints):
            self._rotations[joint] = turned[:, i]
        return turned[:, -1]

    def _turned(self, step: Step, carried: Array) -> Array:
        """Return the rotation of a goal's body: as it is wanted, as far as it is, else as it is carried."""
        share = self.goals.rotation_influence[:, step.goal]
        wanted = self._wanted[:, step.goal]
        return wanted if self._whole or (share == 1.0).all() else _toward(carried, wanted, share)

    def shift_from_parent(self) -> Array:
        """Return how far the root moved from where its parents hold it, turned as they are, shape (frame or 1, 3)."""
        plan, above = self.plan, self.plan.above[self.plan.root]
        if above not in self._rotations:
            return self.shift
        turned = self.rotation(above)
        held = self.place(above) + rotation.apply(turned, plan.rest[plan.root] - plan.rest[above])
        return rotation.apply(rotation.transposed(turned), self.place(plan.root) - held)

    def rotation(self, leader: int) -> Array:
        """Return how a leader is turned, shape (frame or 1, 3, 3)."""
        if leader == NONE:
            return np.eye(3)[None]
        if leader not in self._rotations:
            return self.rotation(self.plan.above[leader])
        return self._rotations[leader]

    def place(self, leader: int) -> Array:
        """Return where a leader is [m], shape (frame or 1, 3)."""
        if leader not in self._places:
            plan = self.plan
            above = plan.above[leader]
            if leader == plan.root:
                self._places[leader] = plan.rest[leader] + self.shift
            elif above == NONE:
                self._places[leader] = plan.rest[leader][None]
            else:
                away = rotation.apply(self.rotation(above), plan.rest[leader] - plan.rest[above])
                self._places[leader] = self.place(above) + away
        return self._places[leader]


def _toward(carried: Array, wanted: Array, share: Array) -> Array:
    """Return rotations part of the way to others, shape (frame, 3, 3)."""
    if (share == 0.0).all():
        return np.broadcast_to(carried, (len(share), 3, 3))
    if (share == 1.0).all():
        return np.broadcast_to(wanted, (len(share), 3, 3))
    return quat.to_matrix(quat.slerp(quat.from_matrix(carried), quat.from_matrix(wanted), share))
