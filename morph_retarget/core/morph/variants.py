"""Variants: how many different ways an action can play on a character (Hecker 2008 §4.1.2).

The variant product takes one body for each group of varying channels, in every way that uses no body twice and keeps
to the sides that the channels ask for. It has no limit of arity, and the groups' bodies need not be of one kind.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

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
