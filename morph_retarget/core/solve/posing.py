"""From pose goals to bones: which joints each goal moves, and the pose that meets the goals.

The root is placed, then bodies are posed from it outward: those with a goal for their rotation are turned, and
those with a goal for their position are reached by the chain of joints that leads to them from what carries the
limb, the trunk or the neck. What has no goal is carried along. The pose depends on the goals of its frame alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array, Indices
from ..character.character import Character
from ..character.morphology import Capability, LimbKind
from .chain import Chain
from .goals import Goals

NONE = -1


@dataclass(frozen=True, eq=False)
class BodyPose:
    """A character's pose over a clip, character frame."""

    turns: Array
    """Turn of each body from its rest, shape (frame, body, 4)."""
    positions: Array
    """Of the bodies' joints [m], shape (frame, body, 3)."""
    shift: Array
    """How far the root moved from where its parents hold it [m], shape (frame, 3)."""


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
    out: list[int] = []
    for bone in above:
        if bone in taken or bone in carriers or bone == root:
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
    state = _State(plan, len(goals))
    state.place_root(goals)
    for step in plan.steps:
        if step.body != plan.root:
            state.take(step, goals)
    turns = state.turns()
    return BodyPose(turns, state.positions(turns), state.shift)


class _State:
    """A pose in the making: turns of the leaders, from the root outward."""

    def __init__(self, plan: Plan, frames: int) -> None:
        self.plan = plan
        self.frames = frames
        self.shift = np.zeros((frames, 3))
        self._own: dict[int, Array] = {}
        """Turns of bodies as far as they are known."""

    def place_root(self, goals: Goals) -> None:
        plan = self.plan
        for step in plan.steps:
            if step.body == plan.root:
                influence = goals.position_influence[:, step.goal, None]
                self.shift = influence * (goals.positions[:, step.goal] - plan.rest[plan.root])
                self._own[plan.root] = _toward(quat.identity(1), goals, step.goal)

    def take(self, step: Step, goals: Goals) -> None:
        """Meet one goal."""
        plan = self.plan
        if step.chain is not None:
            start = step.joints[0]
            carried = self.turn(int(plan.parents[start]))
            place = self.place(start)
            rest_end = place + quat.rotate(carried, plan.rest[step.body] - plan.rest[start])
            influence = goals.position_influence[:, step.goal, None]
            goal = rest_end + influence * (goals.positions[:, step.goal] - rest_end)
            turns, _ = step.chain.reach(quat.rotate(quat.conjugate(carried), goal - place))
            turned = quat.multiply(carried[:, None], turns)
            for i, joint in enumerate(step.joints):
                self._own[joint] = turned[:, i]
        carried = self.turn(int(plan.parents[step.body]))
        if step.level and step.chain is not None:
            carried = quat.slerp(carried, quat.identity(1), goals.position_influence[:, step.goal])
        self._own[step.body] = _toward(carried, goals, step.goal)

    def turn(self, body: int) -> Array:
        """Return the turn of a body as far as it is known, shape (frame, 4)."""
        while body >= 0:
            if body in self._own:
                return self._own[body]
            body = int(self.plan.parents[body])
        return quat.identity(self.frames)

    def place(self, body: int) -> Array:
        """Return where a body is as far as it is known [m], shape (frame, 3)."""
        plan = self.plan
        line = [body]
        while plan.parents[line[-1]] >= 0:
            line.append(int(plan.parents[line[-1]]))
        if plan.root in line:
            out, line = plan.rest[plan.root] + self.shift, line[: line.index(plan.root) + 1]
        else:
            out = np.broadcast_to(plan.rest[line[-1]], (self.frames, 3))
        at = line[-1]
        for below, above in zip(line[-2::-1], line[:0:-1], strict=True):
            # Rigid stretches are crossed in one step.
            if below in self._own or below == body:
                out = out + quat.rotate(self.turn(above), plan.rest[below] - plan.rest[at])
                at = below
        return out

    def turns(self) -> Array:
        """Return the turns of all bodies."""
        plan = self.plan
        out = np.empty((self.frames, len(plan.rest), 4))
        led = np.stack([np.broadcast_to(self.turn(leader), (self.frames, 4)) for leader in plan.order], axis=1)
        place = np.empty(len(plan.rest), dtype=np.intp)
        place[list(plan.order)] = np.arange(len(plan.order))
        np.take(led, place[plan.leaders], axis=1, out=out)
        return out

    def positions(self, turns: Array) -> Array:
        """Return the positions of all bodies, by forward kinematics over the leaders."""
        plan = self.plan
        heads = np.empty((self.frames, len(plan.rest), 3))
        known: dict[int, Array] = {}
        for leader in plan.order:
            parent = int(plan.parents[leader])
            if leader == plan.root:
                known[leader] = plan.rest[leader] + self.shift
            elif parent < 0:
                known[leader] = np.broadcast_to(plan.rest[leader], (self.frames, 3))
            else:
                above = int(plan.leaders[parent])
                known[leader] = known[above] + quat.rotate(turns[:, above], plan.rest[leader] - plan.rest[above])
        places = np.stack([known[leader] for leader in plan.order], axis=1)
        place = np.empty(len(plan.rest), dtype=np.intp)
        place[list(plan.order)] = np.arange(len(plan.order))
        rows = place[plan.leaders]
        heads[:] = places[:, rows] + quat.rotate(turns[:, plan.leaders], plan.rest - plan.rest[plan.leaders])
        return heads


def _toward(carried: Array, goals: Goals, goal: int) -> Array:
    influence = goals.rotation_influence[:, goal]
    return quat.slerp(carried, goals.turns[:, goal], influence)
