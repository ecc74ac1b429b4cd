"""From generalized values to pose goals: S on every body that a channel poses, blended where channels share one."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from .. import quat
from ..arrays import Array
from ..solve.goals import Goals
from . import movement
from .bind import NONE, Binding, Round
from .channels import Values
from .movement import Frames

Deforms = Mapping[tuple[int, str], Array]
"""Scalar curves by body and name of the deform, each of shape (frame,)."""
_Mix = Callable[[Array, Array, Array], Array]


def frames_of(binding: Binding, external: Mapping[int, Array], posed: Array | None = None) -> Frames:
    """Return the frames in which the entries of a binding move.

    Args:
        binding: The binding.
        external: Target of each channel that has an external one [m], character frame, shapes (frame or 1, 3).
        posed: Positions of all bodies [m], shape (frame, body, 3), for targets that are bodies; rest when None.
    """
    plan = binding.plan
    if not plan.external and not plan.follows_bodies:
        return plan.frames
    rest = binding.bodies.positions[None] if posed is None else posed
    count = max([len(rest) if plan.follows_bodies else 1, *(len(external[channel]) for _, channel in plan.external)])
    targets = np.zeros((count, len(plan.body), 3))
    if plan.follows_bodies:
        followed = plan.target != NONE
        targets[:, followed] = rest[:, plan.target[followed]]
    for i, channel in plan.external:
        targets[:, i] = external[channel]
    return plan.frames.toward(targets)


def goals_of(binding: Binding, values: Values, found: Frames) -> Goals:
    """Return where the bodies of a binding shall be; channels that share a body are blended by their weights.

    A weight of 0 leaves a body alone; weights of channels that share a body count relative to each other as soon as
    they add up to 1 (Hecker 2008 §3.2.3).

    Args:
        binding: The binding.
        values: Of the action's channels.
        found: From `frames_of`.
    """
    plan = binding.plan
    places, turned = movement.specialize(found, values.positions[:, plan.channel], values.rotations[:, plan.channel])
    turns = quat.multiply(turned, plan.rest_axes)
    weights = np.maximum(values.weights[:, plan.channel], 0.0)
    rest = binding.bodies.positions[plan.goals]
    count = (len(places), len(plan.goals))
    positions = np.broadcast_to(rest, (*count, 3)).copy()
    moved = _blend(positions, places, weights * plan.position_weights, plan.position_rounds, _mixed)
    rotations = quat.identity(*count)
    rotated = _blend(rotations, turns, weights * plan.rotation_weights, plan.rotation_rounds, quat.slerp)
    return Goals(plan.goals, positions, rotations, moved, rotated)


def deforms_of(binding: Binding, values: Values) -> Deforms:
    """Return the deform curves of all bodies; channels with the same one on a body are averaged by their weights."""
    sums: dict[tuple[int, str], list[Array]] = {}
    for entry in binding.entries:
        for (channel, name), curve in values.deforms.items():
            if channel == entry.channel:
                weight = np.maximum(values.weights[:, channel], 0.0)
                total = sums.setdefault((entry.body, name), [np.zeros(len(values)), np.zeros(len(values))])
                total[0] = total[0] + weight * curve
                total[1] = total[1] + weight
    return {key: value / np.maximum(weight, 1.0) for key, (value, weight) in sums.items()}


def _blend(out: Array, given: Array, weights: Array, rounds: Sequence[Round], mix: _Mix) -> Array:
    """Fill goals with weighted blends and return how much each counts in all, shape (frame, goal).

    Args:
        out: Goals, shape (frame, goal, n); those without contributions stay as they are.
        given: What the entries want, shape (frame, entry, n).
        weights: Shape (frame, entry).
        rounds: Who contributes to what.
        mix: Interpolates.
    """
    total = np.zeros(out.shape[:2])
    for i, step in enumerate(rounds):
        own = weights[:, step.entries]
        if i == 0:
            out[:, step.goals], total[:, step.goals] = given[:, step.entries], own
            continue
        before = total[:, step.goals]
        share = own / np.maximum(before + own, 1e-12)
        out[:, step.goals] = mix(out[:, step.goals], given[:, step.entries], share)
        total[:, step.goals] = before + own
    return np.minimum(total, 1.0)


def _mixed(a: Array, b: Array, share: Array) -> Array:
    return a + share[..., None] * (b - a)
