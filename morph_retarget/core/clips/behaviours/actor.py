"""The body that behaves: what behaviours read of a character, humanoid or not."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array
from ...character.character import Character
from ...character.morphology import Capability
from ...morph.bodies import Bodies
from ...tree import Tree

LOOKING_SPINE = 0.4
"""Share of the spine that turns with the head of a body without legs, which lies on the rest of it."""


@dataclass(frozen=True, eq=False)
class Actor:
    """A character, its bodies at rest, and the body that carries all others."""

    character: Character
    bodies: Bodies
    root: int

    @property
    def tree(self) -> Tree:
        """Who carries whom."""
        return self.bodies.limb_tree

    @property
    def rest(self) -> Array:
        """Places of all bodies at rest [m], character frame, shape (body, 3)."""
        return self.bodies.positions

    @cached_property
    def height(self) -> float:
        """What lengths are judged by [m]: how high it is, or for what lies on the ground how large."""
        return max(self.character.frame.height, 0.4 * self.bodies.size)

    @cached_property
    def head(self) -> int | None:
        """What looks: the head, or what has the eyes where there is none; None when nothing does."""
        if self.character.head is not None:
            return self.character.head
        eyes = self.eyes
        return None if not eyes else self.tree.meeting([int(self.tree.parents[eye]) for eye in eyes])

    @cached_property
    def eyes(self) -> tuple[int, ...]:
        """Eyeballs that turn by themselves."""
        found = self.bodies.with_capability(Capability.EYE)
        return tuple(body for body in found if self.tree.parents[body] >= 0 and body != self.character.head)

    @cached_property
    def sight(self) -> Array:
        """Where the head looks from, from its joint at rest [m], shape (3,)."""
        assert self.head is not None, "only what has a head looks"
        if self.eyes:
            return self.rest[list(self.eyes)].mean(axis=0) - self.rest[self.head]
        return np.zeros(3)

    @cached_property
    def forward(self) -> Array:
        """Where the head looks at rest, unit vector, shape (3,)."""
        assert self.head is not None, "only what has a head looks"
        return self.bodies.forwards[self.head]

    @cached_property
    def line(self) -> tuple[int, ...]:
        """Joints of the trunk that may turn to look or to lean, from below up to the head; no foot moves with them."""
        if self.head is None:
            return ()
        own = self.character
        trunk = {*own.spine, *own.neck, self.head}
        path = [*reversed(self.tree.ancestors[self.head]), self.head]
        found = [body for body in path if body in trunk and body != self.root and not self._carries(body)]
        if not own.legs:
            spine = [body for body in found if body in own.spine]
            still = spine[: int(np.ceil((1.0 - LOOKING_SPINE) * len(spine)))]
            found = [body for body in found if body not in still]
        return tuple(found)

    @property
    def neck(self) -> Sequence[int]:
        """Joints between trunk and head."""
        return [body for body in self.line if body in self.character.neck]

    @property
    def back(self) -> Sequence[int]:
        """Joints of the spine, from below."""
        return [body for body in self.line if body in self.character.spine and body not in self.character.neck]

    def _carries(self, body: int) -> bool:
        """Return whether a body carries the root, or feet that stand."""
        feet = (leg.end for leg in self.character.legs)
        return any(self.tree.is_below(body, other) for other in (self.root, *feet))
