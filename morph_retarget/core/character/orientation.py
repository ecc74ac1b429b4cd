"""Which way a rig's up, left and forward are: trial frames, and the votes that settle front and sides."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array
from . import joint_map, mirror, trunk
from .anatomy import Body, Evidence, see
from .frame import WORLD_AXES, Placement
from .joint_map import Decision
from .words import Sense

UPRIGHT_PRIOR = 15.0
"""Log-odds that the world's up is the character's."""
PLAIN_SHAPE = 2.5
"""From this mean shape of the limbs on, no other up is tried."""
DEGENERATE_SHAPE = -2.0
"""Below this mean shape of the limbs the rest pose is no pose of a body, and names alone are trusted."""
LYING_SHAPE = 3.0
"""The same for a rig that only looks like a body when it is not upright in the world."""
BLIND_TRUST = 0.15
LEANING = 0.85
"""Cosine of the angle to the user's up axis from which on an axis cannot be that from side to side."""
AGREEING = 0.8
"""From this agreement on, see `mirror.lateral`, named pairs know the axis from side to side."""
NEAR_AXIS = 0.98
"""Cosine of the angle between the axis that names tell and one of the object's from which on both are the same …"""
TURNED = 0.7
"""… and the same for a rest that is bent …"""
SYMMETRIC = 0.995
"""… which it is below this symmetry."""
LEVEL = 0.5
"""Cosine of its angle to the up axis up to which it is level enough to face square to it."""
FULLY_NAMED = 12
"""So many joints must have been found by name for a rig to be judged by its names alone."""


@dataclass(frozen=True, eq=False)
class Sight:
    """The best trial frame and what the rig looks like in it."""

    body: Body
    decision: Decision
    trust: float
    """1 for a rest pose that looks like a body, `BLIND_TRUST` for one that does not."""
    faces: bool = True
    """Whether the rest faces somewhere: its left is known."""


def look(evidence: Evidence, placement: Placement, up: Array | None) -> Sight:
    """Return the frame in which ``evidence`` makes the best body.

    Args:
        evidence: The rig.
        placement: Of its armature in the world; its axes are trial axes.
        up: The character's up in the world when the user knows it, unit vector.
    """
    lateral = _lateral(evidence, placement, up)
    best: Sight | None = None
    for trial in _ups(lateral, placement, up):
        left = quat.unit(lateral - (lateral @ trial) * trial)
        if np.linalg.norm(left) < 0.5:
            continue
        body = see(evidence, left, trial)
        decision = joint_map.decide(body)
        prior = UPRIGHT_PRIOR if trial[2] > 0.95 else 0.0
        if best is None or decision.score + prior > best.decision.score + UPRIGHT_PRIOR * (best.body.axes[2, 2] > 0.95):
            best = Sight(body, decision, 1.0)
        if prior and decision.shape > PLAIN_SHAPE:
            break
    assert best is not None, "a plane of symmetry always leaves an up axis"
    return best


def is_no_pose(sight: Sight, up: Array | None) -> bool:
    """Return whether a rig looks like no body at all: all bones along one axis, limbs folded, sides mixed.

    Args:
        sight: What was seen.
        up: The axis that the user gave, None otherwise.
    """
    lying = sight.body.axes[2, 2] < 0.95 and up is None
    return sight.decision.shape < (LYING_SHAPE if lying else DEGENERATE_SHAPE) or _sides_mixed(sight.body)


def look_blind(evidence: Evidence, placement: Placement, up: Array | None) -> Sight | None:
    """Return a rig judged by its names alone, upright in the world; None when they do not name a body.

    Where names of left and right agree on a level axis, as in a crouch, it faces square to that.
    """
    axis = WORLD_AXES["+Z"] if up is None else up
    left = WORLD_AXES["+X"] if abs(axis[0]) < 0.9 else WORLD_AXES["+Y"]
    said = mirror.lateral(evidence.positions, evidence.by_name, evidence.tree)
    faces = said.agreement > AGREEING and abs(float(said.axis @ axis)) < LEVEL
    if faces:
        left = _lateral(evidence, placement, axis)
    body = see(evidence, quat.unit(left - (left @ axis) * axis), axis)
    decision = joint_map.decide(body, BLIND_TRUST)
    named = sum(f.by == "name" for f in decision.joints.values())
    return Sight(body, decision, BLIND_TRUST, faces and not _sides_mixed(body)) if named >= FULLY_NAMED else None


def _lateral(evidence: Evidence, placement: Placement, up: Array | None) -> Array:
    said = mirror.lateral(evidence.positions, evidence.by_name, evidence.tree)
    trials = [placement.rotation[:, i] for i in range(3)] + [WORLD_AXES[k] for k in ("+X", "+Y", "+Z")]
    if up is not None:
        # What the user says of the up axis counts more than all that is seen.
        trials = [t for t in trials if abs(float(t @ up)) < LEANING]
    if said.agreement > AGREEING and (up is None or abs(float(said.axis @ up)) < LEANING):
        # Names know the direction to within a few degrees; the axes of the object are exact, and a bent rest that has
        # turned its hips still faces along one.
        nearest = max(trials, key=lambda t: abs(float(t @ said.axis)))
        near = NEAR_AXIS if said.symmetry > SYMMETRIC else TURNED
        return nearest if abs(float(nearest @ said.axis)) > near else said.axis
    distinct = [t for i, t in enumerate(trials) if all(abs(float(t @ u)) < 0.99 for u in trials[:i])]
    return max(distinct, key=lambda t: _symmetry(evidence, t))


def _symmetry(evidence: Evidence, axis: Array) -> float:
    """Return how well the tree mirrors onto itself along ``axis``: pairs of branches for it, odd bones against it."""
    partner = see(evidence, axis, _any_square(axis)).partner
    bones = len(partner)
    alone, paired = np.count_nonzero(partner == mirror.ALONE), np.count_nonzero(partner >= 0)
    return (paired - 0.2 * alone) / bones - (0.02 if abs(axis[2]) > 0.9 else 0.0) + 0.01 * abs(axis[0])


def _any_square(axis: Array) -> Array:
    other = WORLD_AXES["+Z"] if abs(axis[2]) < 0.9 else WORLD_AXES["+Y"]
    return quat.unit(other - (other @ axis) * axis)


def _ups(lateral: Array, placement: Placement, up: Array | None) -> list[Array]:
    if up is not None:
        return [up]
    trials = [WORLD_AXES["+Z"]]
    axes = [placement.rotation[:, i] for i in range(3)] + [WORLD_AXES[k] for k in ("+X", "+Y", "+Z")]
    for axis in axes:
        for sign in (1.0, -1.0):
            square = axis - (axis @ lateral) * lateral
            if np.linalg.norm(square) > 0.7:
                trial = sign * quat.unit(square)
                if all(float(t @ trial) < 0.95 for t in trials):
                    trials.append(trial)
    return trials


@dataclass(frozen=True)
class SideVotes:
    """Who says where the trial frame's +X is: positive for the character's left."""

    names: float
    body: float

    @property
    def sign(self) -> float:
        """+1 when the trial frame's first axis points to the character's left, -1 when to its right."""
        return 1.0 if self.names + self.body >= 0.0 else -1.0

    @property
    def contradicted(self) -> bool:
        """Whether the body has outvoted clear names."""
        return self.names * self.sign < -1.0


def side_votes(sight: Sight) -> SideVotes:
    """Return the evidence for the sign of the trial frame's first axis.

    The body tells front from back (toes, eyes, knees, elbows), which with up gives left; -Y forward is Blender's habit.
    """
    body = sight.body
    apart = _named_sides(body)
    names = 3.0 * float(np.mean(apart)) if len(apart) else 0.0
    if sight.trust < 1.0:
        return SideVotes(names, 0.0)
    # In the trial frame forward is -Y when +X is left.
    front = _front_votes(body, sight.decision)
    return SideVotes(names, front + 0.5 * float(np.sign(_world_forward(body))))


def _named_sides(body: Body) -> Array:
    """Return for each pair that is named and lies apart the side that the name of its +X bone says.

    Where those that start at the trunk all say the same, they speak for the others: arms may be crossed.
    """
    evidence = body.evidence
    named = [(int(a), int(b)) for a, b in body.pairs if evidence.by_name[a] == b]
    named = [(a, b) for a, b in named if body.points[a, 0] - body.points[b, 0] > 1e-4]
    left, right = np.array(named, dtype=np.intp).reshape(-1, 2).T
    sides = np.array([evidence.readings[a].side for a, _ in named], dtype=np.float64)
    first = sides[mirror.of_trunk(left, right, evidence.tree)]
    return first if len(first) >= 2 and abs(first.mean()) == 1.0 else sides


def _sides_mixed(body: Body) -> bool:
    """Return whether many bones called left lie on either side: no pose of a body looks like that."""
    sides = _named_sides(body)
    return len(sides) >= 6 and abs(float(np.mean(sides))) < 0.5


def _world_forward(body: Body) -> float:
    forward = -body.axes[1]
    return float(forward @ WORLD_AXES["-Y"]) if abs(forward[1]) > 0.5 else float(forward @ WORLD_AXES["+X"])


def _front_votes(body: Body, decision: Decision) -> float:
    joints = {name: found.bone for name, found in decision.joints.items()}
    total = 0.0
    total += _vote(body, joints, (("leftFoot", "leftToes"), ("rightFoot", "rightToes")), weight=4.0, least=0.02)
    total += _bends(body, joints, "UpperLeg", "LowerLeg", "Foot", weight=1.5, least=0.01)
    total -= _bends(body, joints, "UpperArm", "LowerArm", "Hand", weight=0.7, least=0.01)
    head = joints.get("head")
    if head is not None:
        total += _face_vote(body, head)
    return total + _trunk_vote(body)


def _trunk_vote(body: Body) -> float:
    """Return where the head of a body on all fours lies: in front of the middle of its limbs."""
    head, by = trunk.find_head(body)
    if head is None or not len(body.pairs):
        return 0.0
    limbs = body.pair_points[:, 1]
    middle = 0.5 * float(limbs.min() + limbs.max())
    ahead = (middle - float(body.points[head, 1])) / max(float(np.ptp(body.points[:, 1])), 1e-6)
    long = float(np.ptp(body.points[:, 1])) > 0.6
    return (4.0 if by == "name" else 1.5) * float(np.sign(ahead)) if long and abs(ahead) > 0.15 else 0.0


def _vote(body: Body, joints: dict[str, int], steps: Sequence[tuple[str, str]], weight: float, least: float) -> float:
    ahead = [body.points[joints[a], 1] - body.points[joints[b], 1] for a, b in steps if a in joints and b in joints]
    mean = float(np.mean(ahead)) if ahead else 0.0
    return weight * float(np.sign(mean)) if abs(mean) > least else 0.0


def _bends(body: Body, joints: dict[str, int], upper: str, lower: str, end: str, weight: float, least: float) -> float:
    bends: list[float] = []
    for side in ("left", "right"):
        names = [side + j for j in (upper, lower, end)]
        if all(n in joints for n in names):
            a, b, c = (body.points[joints[n]] for n in names)
            t = float((b - a) @ (c - a)) / max(float((c - a) @ (c - a)), 1e-9)
            bends.append(float((a + t * (c - a) - b)[1]) / max(float(np.linalg.norm(c - a)), 1e-9))
    mean = float(np.mean(bends)) if bends else 0.0
    return weight * float(np.sign(mean)) if abs(mean) > least else 0.0


def _face_vote(body: Body, head: int) -> float:
    evidence = body.evidence
    front = [b for b in evidence.tree.below(head) if _is_front_of_face(evidence, b)]
    if not front:
        return 0.0
    ahead = float(np.mean([body.points[head, 1] - body.points[b, 1] for b in front]))
    return 2.0 * float(np.sign(ahead)) if abs(ahead) > 0.01 else 0.0


def _is_front_of_face(evidence: Evidence, bone: int) -> bool:
    reading = evidence.readings[bone]
    return reading.has(Sense.EYE, Sense.JAW, Sense.MOUTH) or bool(
        {"nose", "snout", "muzzle", "lip", "lips"} & set(reading.words)
    )
