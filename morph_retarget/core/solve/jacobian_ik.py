"""Inverse kinematics by the damped Jacobian pseudo-inverse, for the whole skeleton at once and all frames in a batch.

Feng 2013 §4.2: ``dtheta = J+ dx + (I - J+ J) dz`` with ``J+ = J^T (J J^T + lambda^2 I)^-1`` and ``lambda = 0.05 h``,
where ``dx`` leads each effector to its target and ``dz`` each joint back to the pose that came in.

Two details make it arrive. The damping is the paper's while the error is as large as it and shrinks with the error
below that, because a constant one stalls centimetres short on a nearly straight leg. And the pull toward the incoming
pose fades from step to step, because under damping it leaks into the task.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np

from .. import quat
from ..arrays import Array, Flags

NONE = -1


@dataclass(frozen=True)
class JacobianSettings:
    """Constants of the solver."""

    damping: float = 0.05
    """Lambda over the character's height (the paper's alpha)."""
    tolerance: float = 0.0001
    """An effector this near has arrived [heights]: on a nearly straight leg a millimetre is degrees of knee."""
    iterations: int = 24
    """At most so many steps."""
    stall: float = 0.02
    """A frame whose error falls by less than this share in a step is finished."""
    stride: float = 0.15
    """An effector heads for a place at most this far away in one step [heights], lest joints overshoot."""
    swing: float = 0.7
    """A joint turns at most so far in one step [rad]: a straight leg has hardly a way to bend, and would whip."""
    pull: float = 0.5
    """Share of the way back to the incoming pose in the first step; halved in each further one."""


@dataclass(frozen=True)
class Effector:
    """One point that shall reach its target."""

    joint: int
    """The joint that carries it."""
    offset: Array
    """From that joint at rest, shape (3,)."""


@dataclass(frozen=True, eq=False)
class Problem:
    """Joints that may turn, in a tree, and the effectors at their ends."""

    parents: Sequence[int]
    """Joint above each joint, NONE for those that hang on something that stays, shape (joint,)."""
    offsets: Array
    """From the joint above, at rest, shape (joint, 3); unused for joints without one."""
    effectors: Sequence[Effector]
    stiffness: Array | None = None
    """0 … 1 for each joint: how much it may contribute, 1 fully; shape (joint,)."""


@dataclass(frozen=True, eq=False)
class Solution:
    """What came out."""

    turns: Array
    """Turn of each joint from rest, shape (frame, joint, 4)."""
    error: Array
    """Largest distance of an effector from its (reachable) target, shape (frame,)."""
    steps: int
    """Steps that the slowest frame took."""


def solve(
    problem: Problem,
    turns: Array,
    anchors: Array,
    targets: Array,
    root: Array,
    height: float,
    settings: JacobianSettings | None = None,
    start: Array | None = None,
) -> Solution:
    """Return turns that bring the effectors to their targets with as little change as possible.

    Args:
        problem: The joints and effectors.
        turns: Incoming pose: turn of each joint from rest, shape (frame, joint, 4).
        anchors: Place of each joint that has no joint above it, shape (frame, joint, 3); other rows are unused.
        targets: Where the effectors shall be, shape (frame, effector, 3).
        root: Place of the skeleton's root, shape (frame, 3): targets are pulled into the sphere of reach around it.
        height: Of the character [m].
        settings: Constants.
        start: Pose to start from, shape (frame, joint, 4); the incoming pose when None.
    """
    settings = settings or JacobianSettings()
    out = (turns if start is None else start).copy()
    targets = _within_reach(problem, anchors, targets, root)
    error = np.zeros(len(turns))
    active = np.arange(len(turns))
    before = np.full(len(turns), np.inf)
    steps = 0
    for step in range(settings.iterations + 1):
        now = out[active]
        joints, effectors = _places(problem, now, anchors[active])
        dx = targets[active] - effectors
        error[active] = quat.length(dx).max(axis=-1)
        going = (error[active] > settings.tolerance * height) & (
            error[active] < (1.0 - settings.stall) * before[active]
        )
        if step == settings.iterations or not going.any():
            break
        # The first step of a straight leg may only unlock its knee, which brings the foot no nearer yet.
        before[active] = error[active] if step else np.inf
        active = active[going]
        pull = settings.pull * 0.5**step
        dz = pull * _toward(problem, now[going], turns[active])
        lever = effectors[going, None] - joints[going, :, None]
        stride = _shortened(dx[going], settings.stride * height)
        dtheta = _increment(problem, lever, stride, dz, error[active], settings.damping * height)
        out[active] = _turned(problem, now[going], _shortened(dtheta, settings.swing))
        steps = step + 1
    return Solution(out, error, steps)


def _below(problem: Problem) -> Flags:
    """Return whether each effector hangs below each joint, shape (joint, effector)."""
    out = np.zeros((len(problem.parents), len(problem.effectors)), dtype=bool)
    for e, effector in enumerate(problem.effectors):
        joint = effector.joint
        while joint != NONE:
            out[joint, e] = True
            joint = problem.parents[joint]
    return out


def _within_reach(problem: Problem, anchors: Array, targets: Array, root: Array) -> Array:
    out = targets.copy()
    for e, effector in enumerate(problem.effectors):
        reach, joint = float(np.linalg.norm(effector.offset)), effector.joint
        while problem.parents[joint] != NONE:
            reach += float(np.linalg.norm(problem.offsets[joint]))
            joint = problem.parents[joint]
        radius = reach + quat.length(anchors[:, joint] - root)
        away = targets[:, e] - root
        distance = quat.length(away)
        shrink = np.minimum(1.0, radius / np.maximum(distance, 1e-12))
        out[:, e] = root + shrink[:, None] * away
    return out


def _shortened(vectors: Array, most: float) -> Array:
    length = quat.length(vectors)
    if length.max(initial=0.0) <= most:
        return vectors
    return vectors * np.minimum(1.0, most / np.maximum(length, 1e-12))[..., None]


def _places(problem: Problem, turns: Array, anchors: Array) -> tuple[Array, Array]:
    joints = anchors.copy()
    for j, parent in enumerate(problem.parents):
        if parent != NONE:
            joints[:, j] = joints[:, parent] + quat.rotate(turns[:, parent], problem.offsets[j])
    effectors = [joints[:, e.joint] + quat.rotate(turns[:, e.joint], e.offset) for e in problem.effectors]
    return joints, np.stack(effectors, axis=1)


def _toward(problem: Problem, turns: Array, wanted: Array) -> Array:
    """Return the rotation vectors that lead each joint, relative to the one above it, back to the incoming pose."""
    out = np.empty((*turns.shape[:2], 3))
    for j, parent in enumerate(problem.parents):
        goal = wanted[:, j]
        if parent != NONE:
            drift = quat.multiply(turns[:, parent], quat.conjugate(wanted[:, parent]))
            goal = quat.multiply(drift, goal)
        out[:, j] = quat.to_rotation_vector(quat.multiply(goal, quat.conjugate(turns[:, j])))
    return out


def _increment(problem: Problem, lever: Array, dx: Array, dz: Array, error: Array, damping: float) -> Array:
    """Return the joint increments of one step, as rotation vectors, shape (frame, joint, 3).

    Args:
        problem: The joints and effectors.
        lever: From each joint to each effector, shape (frame, joint, effector, 3). The Jacobian's block for joint j
            and effector e is the cross product with it, so neither it nor its product with itself is ever formed.
        dx: From the effectors to their targets, shape (frame, effector, 3).
        dz: Toward the incoming pose, shape (frame, joint, 3).
        error: Largest distance, shape (frame,).
        damping: The paper's lambda.
    """
    lever = lever * _below(problem)[:, :, None]
    give = np.ones(len(problem.parents)) if problem.stiffness is None else problem.stiffness
    dz = dz * give[:, None]
    residual = dx - quat.cross(dz[:, :, None], lever).sum(axis=1)
    squared = damping * np.minimum(error, damping)
    weighted = lever * give[:, None, None]
    if lever.shape[2] == 1:
        task = _solve_one(lever[:, :, 0], weighted[:, :, 0], squared, residual[:, 0])[:, None]
    else:
        task = _solve_many(lever, weighted, squared, residual)
    return quat.cross(weighted, task[:, None]).sum(axis=2) + dz


def _solve_one(lever: Array, weighted: Array, squared: Array, residual: Array) -> Array:
    """Return ``(J J^T + lambda^2 I)^-1 residual`` for one effector, by the adjugate of the 3 x 3 matrix."""
    # J J^T = sum over joints of |r|^2 I - r r^T.
    a = -np.einsum("fji,fjk->fik", weighted, lever)
    trace = -(a[:, 0, 0] + a[:, 1, 1] + a[:, 2, 2])
    for i in range(3):
        a[:, i, i] += trace + squared + 1e-12
    c0, c1, c2 = quat.cross(a[:, 1], a[:, 2]), quat.cross(a[:, 2], a[:, 0]), quat.cross(a[:, 0], a[:, 1])
    determinant = np.sum(a[:, 0] * c0, axis=-1, keepdims=True)
    return (residual[:, :1] * c0 + residual[:, 1:2] * c1 + residual[:, 2:] * c2) / determinant


def _solve_many(lever: Array, weighted: Array, squared: Array, residual: Array) -> Array:
    frames, _, effectors, _ = lever.shape
    dots = np.einsum("fjai,fjbi->fab", weighted, lever)
    outer = np.einsum("fjbi,fjak->faibk", weighted, lever)
    a = np.einsum("fab,ik->faibk", dots, np.eye(3)) - np.einsum("faibk->faibk", outer)
    a = a.reshape(frames, 3 * effectors, 3 * effectors)
    a[:, np.arange(3 * effectors), np.arange(3 * effectors)] += squared[:, None] + 1e-12
    solved = cast("Array", np.linalg.solve(a, residual.reshape(frames, -1, 1)))
    return solved.reshape(frames, effectors, 3)


def _turned(problem: Problem, turns: Array, dtheta: Array) -> Array:
    """Return the turns after every joint was turned by its increment and carried along by those above it."""
    whole = dtheta.copy()
    for j, parent in enumerate(problem.parents):
        if parent != NONE:
            whole[:, j] += whole[:, parent]
    return quat.normalize(quat.multiply(quat.from_rotation_vector(whole), turns))
