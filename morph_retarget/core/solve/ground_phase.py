"""The ground phase: what goals only turn, or what hangs beyond a goal, is turned up where it would be below the ground.

Goals say where a hand is, and not where its fingers end; a tail is turned by angles, however long it is on the next
character. When all else is solved, such bodies are turned up about the joints that hold them, from the trunk outward,
no further than the ground asks for. So a tail lies on the ground from where it meets it, and the fingers of a hand that
picks something up lie flat. What they carry goes along. Nobody's place is asked for there, so no goal for one is lost.

The ground is level at z = 0, but below what rests lower. What is high above it stays as it is to the bit, and so does
the rest pose; the pose depends on that of its frame alone.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Indices
from ..character import flesh
from ..ground import OFF_GROUND
from .constraints import TINY, smooth_step
from .hierarchy import Hierarchy
from .plan import Plan
from .posing import BodyPose

SOFT = 0.02
"""From how high on bodies come down ever more slowly, as a share of the character's size; less for what rests lower."""
STEEPEST = np.radians(40.0)
"""How steeply up bodies are turned at most where they hang on what is below the ground itself."""
OUTWARD = 0.3
"""How much it counts, for what points straight down, to be turned up away from the trunk and not toward it."""
NEAR = 0.1
"""It counts half of that at this distance from the root, as a share of the character's size."""
BEHIND = 0.5
"""Points that lie behind are not lifted; they count in part up to this share of their distance."""
ROUNDS = 2
"""How often a body is turned up: what hangs nearly straight down first has to swing out."""
SAME = 1e-6
"""Points nearer to their joint than this share of the character's size do not count."""


@dataclass(frozen=True, eq=False)
class _Body:
    """A body that may be turned up."""

    leader: int
    """Its place in the plan's order."""
    points: Array
    """From its joint to what it carries, at rest [m], shape (point, 3)."""
    floor: Array
    """How low these may be [m], shape (point,)."""
    soft: Array
    """From how far above that on they come down more slowly [m], shape (point,)."""

    @cached_property
    def ahead(self) -> Array:
        """Where it points at rest, unit vector, shape (3,)."""
        return quat.unit(self.points.mean(axis=0))


@dataclass(frozen=True, eq=False)
class Lifting:
    """What of a character may be turned up, and what goes along."""

    bodies: dict[int, _Body]
    """By their places in the plan's order."""
    line: tuple[int, ...]
    """Places in the plan's order of these and of all that they carry, from the root outward."""
    size: float
    """The character's greatest extent [m]."""

    @classmethod
    def of(cls, hierarchy: Hierarchy, plan: Plan) -> "Lifting | None":
        """Return what may be turned up, None when nothing may, or nobody knows where the ground is."""
        own = flesh.flesh(hierarchy.character, hierarchy.tree, hierarchy.root)
        rest = plan.rest[own]
        size = float(np.ptp(rest, axis=0).max())
        if rest[:, 2].min() < -OFF_GROUND * size:
            return None
        bodies = {body.leader: body for body in _bodies(hierarchy, plan, frozenset(own.tolist()), size)}
        if not bodies:
            return None
        below: list[int] = []
        for i in range(len(plan.order)):
            carrier = int(plan.carriers[i])
            if i in bodies or (carrier != i and carrier in below):
                below.append(i)
        return cls(bodies, tuple(below), size)

    @cached_property
    def leaders(self) -> Indices:
        """Of all points, as places in the plan's order, shape (point,)."""
        return np.concatenate([np.full(len(own.points), i, dtype=np.intp) for i, own in self.bodies.items()])

    @cached_property
    def points(self) -> Array:
        """All of them, from their leaders at rest [m], shape (point, 3)."""
        return np.concatenate([own.points for own in self.bodies.values()])

    @cached_property
    def free(self) -> Array:
        """Heights from which on they are free to move [m], shape (point,)."""
        return np.concatenate([own.floor + own.soft for own in self.bodies.values()])


def lifted(lifting: Lifting, pose: BodyPose) -> BodyPose:
    """Return a pose with what would be below the ground turned up."""
    turned, places, leaders = pose.rotations, pose.places, lifting.leaders
    heights = places[:, leaders, 2] + np.einsum("fpx,px->fp", turned[:, leaders, 2], lifting.points)
    rows = np.flatnonzero((heights < lifting.free).any(axis=1))
    if not len(rows):
        return pose
    out = turned.copy()
    out[rows] = _turned(lifting, pose, rows)
    return replace(pose, rotations=out)


def _turned(lifting: Lifting, pose: BodyPose, rows: Indices) -> Array:
    """Return how the leaders are turned in some frames, shape (row, leader, 3, 3)."""
    plan, turned, places = pose.plan, pose.rotations[rows], pose.places[rows]
    offsets = plan.offsets if pose.stretched is None else plan.offsets + pose.stretched[rows]
    root = places[:, plan.order.index(plan.root)].copy()
    changes: dict[int, Array] = {}
    for i in lifting.line:
        carrier = int(plan.carriers[i])
        if carrier in changes:
            away = offsets[i] if offsets.ndim == 2 else offsets[:, i]
            places[:, i] = places[:, carrier] + rotation.apply(turned[:, carrier], away)
            turned[:, i] = changes[carrier] @ turned[:, i]
            changes[i] = changes[carrier]
        body = lifting.bodies.get(i)
        if body is None:
            continue
        for _ in range(ROUNDS):
            change = _up(body, places[:, i], turned[:, i], root, lifting.size)
            if change is None:
                break
            turned[:, i] = change @ turned[:, i]
            changes[i] = change @ changes[i] if i in changes else change
        held = _held(plan, i, turned)
        if held is not None and i in changes:
            changes[i] = held @ rotation.transposed(turned[:, i]) @ changes[i]
            turned[:, i] = held
    return turned


def _held(plan: Plan, leader: int, turned: Array) -> Array | None:
    """Return a leader within its limits, shape (row, 3, 3), None where it has none."""
    body = plan.order[leader]
    if plan.limited is None or body not in plan.limited.limits:
        return None
    above = plan.holders[body]
    carried = np.broadcast_to(rotation.IDENTITY, turned[:, 0].shape) if above < 0 else turned[:, plan.led_by[above]]
    return plan.limited.held(body, carried, turned[:, leader])


def _up(body: _Body, joint: Array, turned: Array, root: Array, size: float) -> Array | None:
    """Return the turns that take a body up, shape (row, 3, 3), None where it is high enough in all rows.

    Args:
        body: The body.
        joint: Where its joint is [m], shape (row, 3).
        turned: How it is turned, shape (row, 3, 3).
        root: Where the root is [m], shape (row, 3).
        size: Of the character [m].
    """
    points = rotation.apply(turned[:, None], body.points)
    above = joint[:, None, 2] + points[..., 2] - body.floor
    low = above < body.soft
    if not low.any():
        return None
    way = joint - root
    ahead = rotation.apply(turned, body.ahead) + OUTWARD * way / (quat.length(way)[:, None] + NEAR * size)
    ahead[:, 2] = 0.0
    ahead = quat.unit(ahead)
    reach = np.maximum(quat.length(points), TINY)
    # Exponentials meet the straight line above without a kink, and never come to the floor.
    soft = np.maximum(body.soft, TINY)
    wanted = np.where(low, soft * np.exp(np.minimum(above / soft - 1.0, 0.0)), above)
    rise = (wanted - above + points[..., 2]) / reach
    now = np.arcsin(np.clip(points[..., 2] / reach, -1.0, 1.0))
    up = np.arcsin(np.clip(rise, -1.0, np.maximum(np.sin(STEEPEST), points[..., 2] / reach)).clip(-1.0, 1.0)) - now
    behind = -quat.dot(points, np.broadcast_to(ahead[:, None], points.shape)) / reach
    counts = 1.0 - smooth_step(behind, 0.0, BEHIND)
    angle = np.maximum(np.where(low, counts * up, 0.0).max(axis=1), 0.0)
    axis = np.stack([ahead[:, 1], -ahead[:, 0], np.zeros(len(ahead))], axis=-1)
    return rotation.about(axis, angle)


# --- which bodies ---


def _bodies(hierarchy: Hierarchy, plan: Plan, own: frozenset[int], size: float) -> Iterator[_Body]:
    """Yield the bodies that may be turned up: nothing beyond them has a place to come to, or is a limb of its own."""
    ends = {body for wave in plan.waves for body in wave.ends}
    busy = {joint for wave in plan.waves for limb in wave.limbs for joint in limb.joints} | {plan.root}
    placed = {body for wave in plan.waves for body in (*wave.rigid, *(limb.body for limb in wave.limbs))}
    if plan.trunk is not None:
        busy |= {*plan.trunk.joints}
        placed |= {plan.trunk.last, *(pin.owner for pin in plan.trunk.pins)}
    limbs = [frozenset((*limb.bones, *limb.digits)) for limb in hierarchy.character.limbs]
    children: dict[int, list[int]] = {leader: [] for leader in plan.order}
    for body in range(len(plan.rest)):
        leader = int(plan.leaders[body])
        carrier = leader if leader != body else plan.above[body]
        if carrier in children and carrier != body:
            children[carrier].append(body)
    for i, leader in enumerate(plan.order):
        if leader in busy or leader not in own or leader in plan.level or hierarchy.is_foot(leader):
            continue
        if leader not in plan.turned and leader not in ends:
            continue
        below = {body for body in own if leader in hierarchy.ancestors[body]}
        others = [limb for limb in limbs if leader not in limb]
        if not placed.isdisjoint(below) or any(not below.isdisjoint(limb) for limb in others):
            continue
        points = [plan.rest[body] - plan.rest[leader] for body in children[leader] if body in own]
        places = np.array([p for p in points if np.linalg.norm(p) > SAME * size]).reshape(-1, 3)
        if not len(places) or float(np.linalg.norm(places.mean(axis=0))) < SAME * size:
            continue
        height = places[:, 2] + plan.rest[leader, 2]
        floor = np.minimum(height, 0.0)
        yield _Body(i, places, floor, np.minimum(height - floor, SOFT * size))
