"""Variants: how many different ways an action can play on a character (Hecker 2008 §4.1.2).

The variant product takes one body for each group of varying channels, in every way that uses no body twice and keeps
to the sides that the channels ask for. It has no limit of arity, and the groups' bodies need not be of one kind.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from .. import quat
from ..arrays import Array
from .channels import SideConstraint


@dataclass(frozen=True)
class Group:
    """Channels that vary together."""

    bodies: tuple[int, ...]
    """What they choose from."""
    side: SideConstraint = SideConstraint.ANY
    """Where, relative to the first group."""


def variant_product(groups: Sequence[Group], sides: Sequence[int]) -> list[tuple[int, ...]]:
    """Return all variants, each the body of every group.

    Args:
        groups: In the order of their first channels.
        sides: +1 left, 0 middle, -1 right for every body of the character.
    """
    return list(_allowed(groups, sides)) if groups else []


def _allowed(groups: Sequence[Group], sides: Sequence[int]) -> Iterator[tuple[int, ...]]:
    for bodies in product(*(group.bodies for group in groups)):
        if len(set(bodies)) == len(bodies) and all(
            _fits(group.side, sides[bodies[0]], sides[body]) for group, body in zip(groups[1:], bodies[1:], strict=True)
        ):
            yield bodies


def _fits(constraint: SideConstraint, first: int, other: int) -> bool:
    """Return whether a body's side suits; a body in the middle is on the same side as another there, opposite none."""
    if constraint is SideConstraint.SAME:
        return first == other
    return constraint is SideConstraint.ANY or first * other < 0


def nearest(places: Array, targets: Array, same: float) -> int:
    """Return the variant whose bodies have the shortest way to their targets, all ways added up.

    Args:
        places: Rest positions of the bodies that move relative to targets [m], shape (variant, body, 3); NaN where a
            variant lacks a body that others have, which makes it the last to be chosen.
        targets: Where their targets are [m], same shape.
        same: Ways that differ by less are equally long [m]; of equal ones the first variant is taken.
    """
    ways = quat.length(targets - places).sum(axis=-1)
    ways = np.where(np.isnan(ways), np.inf, ways)
    return int(np.flatnonzero(ways <= ways.min() + same)[0])
