"""The soles of a body's feet: the points under them that must not sink into the ground."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array
from .links import NONE, LimbLinks
from .plan import Plan


@dataclass(frozen=True, eq=False)
class Sole:
    """The points under a foot that must not sink into the ground."""

    link: int
    offsets: Array
    """From the link's place at rest, shape (n, 3)."""


def _under(legs: Sequence[LimbLinks], rest: Array, tips: Sequence[Array | None]) -> list[list[Sole]]:
    """Return the sole of each foot on the target: under the ankle, under the ball and under the toes.

    Args:
        legs: Of the pair.
        rest: Place of each link at rest, character frame, ground at z = 0, shape (link, 3).
        tips: Where the toes of each foot end at rest, shape (3,); None when unknown.
    """
    out: list[list[Sole]] = []
    for leg, tip in zip(legs, tips, strict=True):
        ankle = rest[leg.end]
        under = [np.array([0.0, 0.0, -max(float(ankle[2]), 0.0)])]
        parts: list[Sole] = []
        if leg.ball != NONE:
            ball = rest[leg.ball]
            under.append(np.array([*(ball - ankle)[:2], -max(float(ankle[2]), 0.0)]))
            if tip is not None:
                parts.append(Sole(leg.ball, np.array([[*(tip - ball)[:2], -max(float(ball[2]), 0.0)]])))
        elif tip is not None:
            under.append(np.array([*(tip - ankle)[:2], -max(float(ankle[2]), 0.0)]))
        out.append([Sole(leg.end, np.stack(under)), *parts])
    return out


def heights(feet: Sequence[Sequence[Sole]], turns: Array, points: Array) -> Array:
    """Return the height of the lowest point of each sole [m], shape (frame, foot)."""
    out = np.empty((len(turns), len(feet)))
    for f, parts in enumerate(feet):
        heights = [
            points[:, part.link, None, 2] + quat.rotate(turns[:, part.link, None], part.offsets)[..., 2]
            for part in parts
        ]
        out[:, f] = np.concatenate(heights, axis=1).min(axis=1)
    return out


def of_target(plan: Plan) -> list[list[Sole]]:
    """Return the soles of the target's feet."""
    skeleton, ours = plan.target.skeleton, plan.target.local_to_character
    tips: list[Array | None] = []
    for leg in plan.links.legs:
        last = int(plan.links.target[leg.ball if leg.ball != NONE else leg.end])
        below = skeleton.tree.children[last]
        tips.append(ours.points(skeleton.rest_positions[below[0]]) if below else None)
    return _under(plan.links.legs, plan.target_rest, tips)
