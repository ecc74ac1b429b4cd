"""Laying pose goals over others: an action over a gait.

Where a body has goals of both, those of the upper layer win as far as they count; bodies that the upper layer leaves
alone are posed by the lower one. The upper layer was made for a body that stands; it goes along with the lower one.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from . import quat
from .arrays import Array
from .morph.specialize import Deforms
from .solve.goals import Goals

Wanted = Sequence[tuple[int, bool, bool]]
"""For each goal its body, and whether it has a place and a turn."""


@dataclass(frozen=True, eq=False)
class Layer:
    """A lower layer: what poses a body under an action, and where that brings the body as a whole."""

    goals: Goals
    places: Array
    """Where the ground under the body has moved to [m], character frame, shape (frame, 3)."""
    turns: Array
    """How the body as a whole is turned, shape (frame, 4)."""
    deforms: Deforms = field(default_factory=dict[tuple[int, str], Array])
    """Scalar curves beside the pose."""

    def at(self, frames: slice) -> "Layer":
        """Return the layer at some frames of the clip."""
        own = self.goals
        goals = Goals(
            own.bodies,
            own.positions[frames],
            own.turns[frames],
            own.position_influence[frames],
            own.rotation_influence[frames],
        )
        return Layer(goals, self.places[frames], self.turns[frames], {k: v[frames] for k, v in self.deforms.items()})

    def seen(self, places: Mapping[int, Array]) -> Mapping[int, Array]:
        """Return targets [m] as the moved body sees them, shapes (frame or 1, 3) to (frame, 3)."""
        back = quat.conjugate(self.turns)
        return {channel: quat.rotate(back, place - self.places) for channel, place in places.items()}

    def carries(self, goals: Goals) -> Goals:
        """Return goals for a body that stands as those for the moved one."""
        turns = np.broadcast_to(self.turns[:, None], goals.turns.shape)
        return Goals(
            goals.bodies,
            quat.rotate(turns, goals.positions) + self.places[:, None],
            quat.multiply(turns, goals.turns),
            goals.position_influence,
            goals.rotation_influence,
        )


def wanted(upper: Wanted, lower: Wanted) -> list[tuple[int, bool, bool]]:
    """Return the goals of two layers, as `together` orders them: those of the upper one first."""
    out = {body: (place, turn) for body, place, turn in upper}
    for body, place, turn in lower:
        before = out.get(body, (False, False))
        out[body] = before[0] or place, before[1] or turn
    return [(body, *kinds) for body, kinds in out.items()]


def together(upper: Goals, lower: Goals) -> Goals:
    """Return the goals of two layers as one; both have the same frames."""
    mine = {int(body): i for i, body in enumerate(lower.bodies)}
    both = [(i, mine[int(body)]) for i, body in enumerate(upper.bodies) if int(body) in mine]
    shared = {row for _, row in both}
    alone = [row for row in range(len(lower.bodies)) if row not in shared]
    out = Goals(
        np.append(upper.bodies, lower.bodies[alone]),
        np.concatenate([upper.positions, lower.positions[:, alone]], axis=1),
        np.concatenate([upper.turns, lower.turns[:, alone]], axis=1),
        np.concatenate([upper.position_influence, lower.position_influence[:, alone]], axis=1),
        np.concatenate([upper.rotation_influence, lower.rotation_influence[:, alone]], axis=1),
    )
    if both:
        ours, theirs = (list(rows) for rows in zip(*both, strict=True))
        share = _over(out.position_influence, lower.position_influence, ours, theirs)
        below = lower.positions[:, theirs]
        out.positions[:, ours] = below + share[..., None] * (upper.positions[:, ours] - below)
        share = _over(out.rotation_influence, lower.rotation_influence, ours, theirs)
        out.turns[:, ours] = quat.slerp(lower.turns[:, theirs], upper.turns[:, ours], share)
    return out


def _over(influence: Array, lower: Array, ours: list[int], theirs: list[int]) -> Array:
    """Add what a lower layer leaves of the influence, in place; return how much of it all is the upper layer's."""
    own = influence[:, ours].copy()
    whole = own + (1.0 - own) * lower[:, theirs]
    influence[:, ours] = whole
    return np.where(whole > 0.0, own / np.maximum(whole, 1e-12), 1.0)
