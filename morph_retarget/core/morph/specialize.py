"""From generalized values to pose goals: S on every body that a channel poses, blended where channels share one."""

from collections.abc import Mapping

import numpy as np

from .. import quat
from ..arrays import Array
from ..solve.goals import Goals
from . import movement
from .bind import NONE, Binding
from .channels import Values
from .movement import Frames

Deforms = Mapping[tuple[int, str], Array]
"""Scalar curves by body and name of the deform, each of shape (frame,)."""


def frames_of(binding: Binding, external: Mapping[int, Array], posed: Array | None = None) -> Frames:
    """Return the frames in which the entries of a binding move; rotations are turns from rest in them.

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
    return plan.toward(targets)


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
    # Of NumPy's ways to gather, `take` is several times faster than an index.
    positions, rotations = values.positions.take(plan.channel, axis=1), values.rotations.take(plan.channel, axis=1)
    places, turns = movement.specialize(found, positions, rotations)
    weights = np.maximum(values.weights.take(plan.channel, axis=1), 0.0)
    positions, moved = _blended(places, weights * plan.position_weights, plan.places)
    if not moved.all():
        positions = np.where(moved[..., None] > 0.0, positions, binding.bodies.positions[plan.goals])
    # Of the two quaternions of a rotation, the one nearer to the first that shares the goal is blended.
    later = turns.take(plan.later, axis=1)
    turns[:, plan.later] = np.where(quat.dot(later, turns.take(plan.first, axis=1))[..., None] < 0.0, -later, later)
    blended, turned = _blended(turns, weights * plan.rotation_weights, plan.turns)
    return Goals(plan.goals, positions, quat.normalize(blended), np.minimum(moved, 1.0), np.minimum(turned, 1.0))


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


def _blended(given: Array, weights: Array, shares: Array) -> tuple[Array, Array]:
    """Return weighted means and the sums of their weights, shapes (frame, goal, n) and (frame, goal).

    Args:
        given: What the entries want, shape (frame, entry, n).
        weights: Shape (frame, entry).
        shares: 1 where an entry contributes to a goal, else 0, shape (goal, entry).
    """
    total = weights @ shares.T
    return (shares @ (weights[..., None] * given)) / np.maximum(total, 1e-12)[..., None], total
