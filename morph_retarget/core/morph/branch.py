"""Branching: which characters an action is for (Hecker 2008 §4.1.1)."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from ..character.morphology import Capability
from .bodies import UP, Bodies

UPRIGHT = 0.5
"""A spine is upright if it rises by at least this share of its length."""


class Answer(StrEnum):
    """A predicate's three values: the character must have it, must not, or it does not matter."""

    IGNORE = "ignore"
    TRUE = "true"
    FALSE = "false"


@dataclass(frozen=True)
class Branch:
    """What a character must be for an action to bind to it."""

    upright_spine: Answer = Answer.IGNORE
    has_graspers: Answer = Answer.IGNORE
    has_feet: Answer = Answer.IGNORE
    has_mouth: Answer = Answer.IGNORE
    has_tail: Answer = Answer.IGNORE
    has_wings: Answer = Answer.IGNORE
    leg_count: int | None = None
    """None does not matter."""

    def refusals(self, bodies: Bodies) -> tuple[str, ...]:
        """Return in words why a character does not fit, empty if it does."""
        facts = {
            "an upright spine": (self.upright_spine, has_upright_spine(bodies)),
            "graspers": (self.has_graspers, _any(bodies, Capability.GRASPER)),
            "feet": (self.has_feet, _any(bodies, Capability.FOOT)),
            "a mouth": (self.has_mouth, _any(bodies, Capability.MOUTH)),
            "a tail": (self.has_tail, _any(bodies, Capability.TAIL)),
            "wings": (self.has_wings, _any(bodies, Capability.WING)),
        }
        out = [
            f"it has {what}" if found else f"it lacks {what}"
            for what, (wanted, found) in facts.items()
            if wanted is not Answer.IGNORE and (wanted is Answer.TRUE) != found
        ]
        legs = len(bodies.with_capability(Capability.FOOT))
        if self.leg_count is not None and legs != self.leg_count:
            out.append(f"it has {legs} legs and not {self.leg_count}")
        return tuple(out)


def choose(branches: Sequence[Branch], bodies: Bodies) -> int | None:
    """Return which of several branches of one movement is the first that fits a character, None when none does."""
    return next((i for i, branch in enumerate(branches) if not branch.refusals(bodies)), None)


def has_upright_spine(bodies: Bodies) -> bool:
    """Return whether a spine is upright rather than prone, from the root to the farthest spine segment or head."""
    line = [*bodies.with_capability(Capability.SPINE), *bodies.with_capability(Capability.NECK)]
    roots = bodies.with_capability(Capability.ROOT) or bodies.tree.roots
    start = bodies.positions[roots[0]]
    if not line:
        return False
    away = bodies.positions[line] - start
    farthest = away[int(np.argmax(np.linalg.norm(away, axis=-1)))]
    length = float(np.linalg.norm(farthest))
    return length > 0.0 and float(farthest @ UP) >= UPRIGHT * length


def _any(bodies: Bodies, capability: Capability) -> bool:
    return bool(bodies.with_capability(capability))
