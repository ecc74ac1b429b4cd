"""Capsules: how thick the trunk, the head and the limbs of a character are, by a rule, and how far capsules are apart.

No mesh is asked for. A limb is as thick as a limb of its length usually is, unless its neighbours are too near for
that; a trunk as its limbs stand apart. Rules like these are wrong by some; so how near two
capsules may come to each other is never more than they are apart at rest: the rest pose is free of collisions.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from .. import quat
from ..arrays import Array, Indices
from ..character import girdles
from ..character.character import Character

THICK, THIN = 0.08, 0.055
"""Radii of a limb's first and last bone, as shares of its length."""
BESIDE = 0.4
"""Most of a radius, as a share of how far the next limb starts from the bone's own."""
BROAD = 0.65
"""Radius of a trunk, as a share of how far limbs start from its line …"""
SLIM, FAT = 0.15, 0.25
"""… and its least and most, as shares of the trunk's length."""
NECK = 0.5
"""Radius of a neck, as a share of the trunk's."""
SKULL = 0.4
"""Radius of a head, as a share of the head's length."""
AT_REST = 0.95
"""Share of the distance at rest to which a bone may come to another, if that is less than both their radii."""
CONE = 0.5
"""How near a bone may come to what it starts in, as a share of how far from its start."""
_TINY = 1e-12


@dataclass(frozen=True, eq=False)
class Capsules:
    """Round tubes about bones of the trunk and of limbs, at rest."""

    bodies: Indices
    """What carries each one, shape (capsule,)."""
    starts: Array
    """Of their axes [m], character frame, shape (capsule, 3)."""
    ends: Array
    """The same."""
    radii: Array
    """[m], shape (capsule,)."""

    @classmethod
    def of(cls, character: Character, rest: Array, radii: Mapping[str, float] | None = None) -> "Capsules":
        """Return the capsules of a character.

        Args:
            character: What the rig is.
            rest: Rest positions of all bodies [m], character frame, shape (body, 3).
            radii: Of bones that are known to be thinner or thicker than by the rule, by name [m].
        """
        found = [*_of_trunk(character, rest), *_of_limbs(character, rest)]
        known = radii or {}
        names = character.skeleton.names
        return cls(
            np.array([c.body for c in found], dtype=np.intp),
            np.array([c.start for c in found]).reshape(-1, 3),
            np.array([c.end for c in found]).reshape(-1, 3),
            np.array([known.get(names[c.body], c.radius) for c in found]),
        )

    def take(self, chosen: Sequence[int] | Indices) -> "Capsules":
        """Return some of the capsules."""
        places = np.array(chosen, dtype=np.intp)
        return Capsules(self.bodies[places], self.starts[places], self.ends[places], self.radii[places])

    def and_(self, others: "Capsules") -> "Capsules":
        """Return these and others."""
        return Capsules(
            np.concatenate([self.bodies, others.bodies]),
            np.concatenate([self.starts, others.starts]),
            np.concatenate([self.ends, others.ends]),
            np.concatenate([self.radii, others.radii]),
        )

    @cached_property
    def carriers(self) -> list[int]:
        """The bodies that carry them."""
        return [int(body) for body in self.bodies]

    @cached_property
    def radius_of(self) -> Mapping[int, float]:
        """Radius of each body that carries a capsule [m]."""
        return dict(zip(self.carriers, self.radii.tolist(), strict=True))


def clearances(points: Array, radii: Array, rooted: Array, others: Capsules, margin: float) -> Array:
    """Return how near points of bones may come to the axes of capsules [m], 0 where they may touch.

    Args:
        points: On each bone at rest, its start first [m], shape (bone, point, 3).
        radii: About them, 0 for none [m], shape (bone,).
        rooted: Whether what carries a bone keeps its start where it is, shape (bone,).
        others: The capsules.
        margin: By how much further they keep apart, as a share of the radii.

    Returns:
        Shape (bone, capsule, point).
    """
    wanted = ((1.0 + margin) * (radii[:, None] + others.radii))[..., None]
    at_rest = distances(points[:, None], points[:, None], others.starts[:, None], others.ends[:, None])
    # A bone that starts within another, as a thigh does in the hips, leaves that as out of a cone.
    away = np.maximum(at_rest[..., :1] - wanted, 0.0) + CONE * quat.length(points - points[:, :1])[:, None]
    near = np.minimum(np.minimum(wanted, AT_REST * at_rest), np.where(rooted[:, None, None], away, np.inf))
    return np.where(((radii[:, None] > 0.0) & (others.radii > 0.0))[..., None], near, 0.0)


def distances(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Return how far the line segments from a to b are from those from c to d [m], shapes (..., 3) to (...)."""
    along, other, away = b - a, d - c, a - c
    size, other_size = (np.maximum(quat.dot(v, v), _TINY) for v in (along, other))
    across, ahead, beside = quat.dot(along, other), quat.dot(along, away), quat.dot(other, away)
    square = size * other_size - across * across
    free = np.where(square > 1e-9 * size * other_size, across * beside - ahead * other_size, 0.0)
    share = np.clip(free / np.maximum(square, _TINY * size * other_size), 0.0, 1.0)
    there = np.clip((across * share + beside) / other_size, 0.0, 1.0)
    share = np.clip((across * there - ahead) / size, 0.0, 1.0)
    return quat.length(away + share[..., None] * along - there[..., None] * other)


@dataclass(frozen=True)
class _Capsule:
    body: int
    start: Array
    end: Array
    radius: float


def _of_trunk(character: Character, rest: Array) -> Iterator[_Capsule]:
    """Yield the capsules of spine, necks and head, each carried by the bone that it lies along."""
    trunk = [*character.spine, *character.neck, *([] if character.head is None else [character.head])]
    ancestors = character.skeleton.tree.ancestors
    above = {b: next((a for a in ancestors[b] if a in trunk), None) for b in trunk}
    bones = [(a, b) for b, a in above.items() if a is not None and np.linalg.norm(rest[a] - rest[b]) > _TINY]
    spine = [(a, b) for a, b in bones if a in character.spine]
    length = sum(float(np.linalg.norm(rest[b] - rest[a])) for a, b in spine)
    starts = [rest[line[0]] for line in _hinged(character, rest)]
    aside = [min((_distance(p, rest[a], rest[b]) for a, b in spine), default=0.0) for p in starts]
    broad = min(max(BROAD * max(aside, default=0.0), SLIM * length), FAT * length)
    for a, b in bones:
        yield _Capsule(a, rest[a], rest[b], broad if a in character.spine else NECK * broad)
    if character.head is not None:
        start = rest[character.head]
        end = character.local_to_character.points(character.skeleton.rest_tails[[character.head]])[0]
        radius = SKULL * float(np.linalg.norm(end - start))
        yield _Capsule(character.head, start, start + (1.0 - SKULL) * (end - start), radius)


def _of_limbs(character: Character, rest: Array) -> Iterator[_Capsule]:
    """Yield the capsules of limbs, from where they start to their hands, feet or tips."""
    lines = _hinged(character, rest)
    starts = [rest[line[0]] for line in lines]
    for i, line in enumerate(lines):
        lengths = [float(np.linalg.norm(rest[b] - rest[a])) for a, b in pairwise(line)]
        beside = min((float(np.linalg.norm(p - starts[i])) for j, p in enumerate(starts) if j != i), default=np.inf)
        full, shares = sum(lengths), np.linspace(THICK, THIN, max(len(lengths), 2))
        for (a, b), length, share in zip(pairwise(line), lengths, shares, strict=False):
            radius = min(share * full, BESIDE * beside)
            if length > _TINY:
                yield _Capsule(a, rest[a], rest[b], radius)


def _hinged(character: Character, rest: Array) -> list[tuple[int, ...]]:
    """Return the bones of all limbs without their girdles, which lie in the trunk."""
    inside = girdles.find(character, rest)
    return [m.bones[1:] if len(m.bones) > 2 and m.bones[0] in inside else m.bones for m in character.limbs]


def _distance(point: Array, start: Array, end: Array) -> float:
    return float(distances(point, point, start, end))
