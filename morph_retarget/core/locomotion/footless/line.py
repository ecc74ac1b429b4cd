"""The line of bodies from a character's head to the end of its tail, which crawls where there are no feet.

Each body is a straight piece between two points of the line. The body in which the ways to the head and to the tail
meet is one piece as well, from the first joint of the one to that of the other.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from ... import quat
from ...arrays import Array, Indices
from ...character.character import Character
from ..moving import heading_of, pointed, rise_of

ALIKE = 0.5
"""A bone without children ends where its tail is if it points the way the line comes, up to this cosine …"""
LONGEST_END = 1.5
"""… and is not longer than this many times the mean of the others, since importers guess it."""
RAISED = 0.03
"""What is higher above the middle of the line than this share of its length does not lie on the ground."""


@dataclass(frozen=True, eq=False)
class Line:
    """Bodies at rest in the ground frame, from the front to the rear."""

    bodies: tuple[int, ...]
    points: Array
    """Ends of the pieces [m], shape (body + 1, 3)."""
    has_head: bool
    """Whether the first body is the head."""
    root: int
    """The body that carries the whole line."""
    carrier: int
    """The place in the line of the body that turns with the root."""
    away: Array
    """From the rear end of that one's piece to the root's joint [m], shape (3,)."""

    def __len__(self) -> int:
        return len(self.bodies)

    @cached_property
    def posed(self) -> tuple[int, ...]:
        """What is turned: the root, and all bodies of the line besides it."""
        return (self.root, *(body for body in self.bodies if body != self.root))

    @cached_property
    def steps(self) -> Array:
        """From the rear end of each piece to its front end [m], shape (body, 3)."""
        return self.points[:-1] - self.points[1:]

    @cached_property
    def lengths(self) -> Array:
        """Of the pieces [m], shape (body,)."""
        return np.maximum(quat.length(self.steps), 1e-9)

    @cached_property
    def length(self) -> float:
        """Of the whole line [m]."""
        return float(self.lengths.sum())

    @cached_property
    def ways(self) -> Array:
        """From the front end along the line to each point [m], shape (body + 1,)."""
        return np.concatenate([[0.0], np.cumsum(self.lengths)])

    @cached_property
    def origin(self) -> float:
        """Way from the front end to where the line is nearest to the origin of the ground frame [m]."""
        starts, steps = self.points[:-1, :2], -self.steps[:, :2]
        share = -(starts * steps).sum(axis=1) / np.maximum((steps**2).sum(axis=1), 1e-18)
        share = np.clip(share, 0.0, 1.0)
        nearest = int(np.argmin(np.hypot(*(starts + share[:, None] * steps).T)))
        return float(self.ways[nearest] + share[nearest] * self.lengths[nearest])

    @cached_property
    def lying(self) -> tuple[int, int]:
        """The first and the last of the points that lie on the ground; heads look ahead and do not count."""
        low = self.points[:, 2] < float(np.median(self.points[:, 2])) + RAISED * self.length
        first, last = int(np.argmax(low)), len(low) - 1 - int(np.argmax(low[::-1]))
        if self.has_head:
            first = max(first, 1)
        # Two pieces at least have to lie.
        return max(min(first, len(self) - 2), 0), max(last, min(first + 2, len(self)))

    @cached_property
    def rises(self) -> Array:
        """By what angle the pieces go up to the front [rad], shape (body,)."""
        return rise_of(self.steps)

    @cached_property
    def _unturned(self) -> Array:
        """What turns each piece from its rest to where the ground frame looks, shape (body, 4)."""
        return quat.conjugate(pointed(heading_of(self.steps), self.rises))

    def turned(self, pieces: Indices, headings: Array, rises: Array) -> Array:
        """Return the turns from rest that point pieces, without any roll.

        Args:
            pieces: Their places in the line, shape (n,).
            headings: Where they shall point [rad], shape (frame, n).
            rises: How far upward [rad], shape (frame, n).
        """
        return quat.multiply(pointed(headings, rises), self._unturned[pieces])

    def along(self, turns: Array, held: int, place: Array) -> Array:
        """Return where the points of the line are when one of them is held, shape (frame, body + 1, 3).

        Args:
            turns: Of all bodies of the line from rest, shape (frame, body, 4).
            held: Which point.
            place: Where [m], shape (frame, 3).
        """
        steps = quat.rotate(turns, np.broadcast_to(self.steps, (*turns.shape[:2], 3)))
        back = np.zeros((len(turns), len(self) + 1, 3))
        np.cumsum(steps, axis=1, out=back[:, 1:])
        return (place + back[:, held])[:, None] - back

    def goals(self, turns: Array, points: Array) -> tuple[Array, Array]:
        """Return the place of the root [m], shape (frame, 3), and the turns of all that is posed, (frame, n, 4)."""
        carrying = turns[:, self.carrier]
        root = points[:, self.carrier + 1] + quat.rotate(carrying, np.broadcast_to(self.away, (len(turns), 3)))
        order = [self.bodies.index(b) if b in self.bodies else self.carrier for b in self.posed]
        return root, turns[:, order]


def find(character: Character, root: int) -> Line | None:
    """Return the line of a character that its root carries, None where it has none."""
    bodies = _bodies(character, root)
    if not bodies:
        return None
    tree, heads = character.skeleton.tree, character.local_to_character.points(character.skeleton.rest_positions)
    meeting = tree.meeting(bodies)
    middle = 0 if meeting is None else bodies.index(meeting)
    # Bodies before the meeting start at their rear ends, those behind it at their front ends.
    points = [heads[b] for b in bodies[:middle]] + [heads[b] for b in bodies[middle + 1 :]]
    front = heads[bodies[0]] if middle == 0 and len(bodies) > 1 else _end(character, bodies[0], points[:2])
    alone = middle == len(bodies) - 1
    rear = heads[bodies[-1]] if alone else _end(character, bodies[-1], points[:-3:-1])
    points = [front, *points, rear]
    away = heads[root] - points[middle + 1]
    has_head = bodies[0] == character.head
    return Line(tuple(bodies), np.array(points), has_head, root, middle, away)


def _bodies(character: Character, root: int) -> list[int]:
    """Return the bodies from the head, or what is foremost, to the one that is farthest from it."""
    tree, places = character.skeleton.tree, character.local_to_character.points(character.skeleton.rest_positions)
    head = character.head
    midline = dict.fromkeys((*character.spine, *character.neck, *(bone for tail in character.tails for bone in tail)))
    carried = [
        bone for bone in ([] if head is None else [head]) + list(midline) if _carries(tree.ancestors, root, bone)
    ]
    if not carried:
        return []
    front = head if head in carried else min(carried, key=lambda bone: float(places[bone, 1]))

    def length(way: Sequence[int]) -> float:
        return sum(float(np.linalg.norm(places[a] - places[b])) for a, b in pairwise(way))

    ways = [tree.way(front, bone) for bone in carried]
    longest = max(ways, key=lambda way: (length(way), len(way)))
    # What is above the root does not move with it.
    return [bone for bone in longest if _carries(tree.ancestors, root, bone)]


def _carries(ancestors: Sequence[Sequence[int]], root: int, bone: int) -> bool:
    return bone == root or root in ancestors[bone]


def _end(character: Character, bone: int, before: Sequence[Array]) -> Array:
    """Return where a body at an end of the line ends; ``before`` are the last points of the line, the last first."""
    place, skeleton = character.local_to_character, character.skeleton
    head, tail = place.points(skeleton.rest_positions[bone]), place.points(skeleton.rest_tails[bone])
    if len(before) < 2:
        return tail
    comes = before[0] - before[1]
    usual = float(np.linalg.norm(comes))
    own = float(np.linalg.norm(tail - head))
    if own < LONGEST_END * usual and (tail - head) @ comes > ALIKE * own * usual:
        return tail
    return head + comes
