"""The character model: the body that clips are made for, and the parts it falls into (Grünvogel 2003 §4).

All clips of a tree share one. It need not be the body that shows the motion in the end: what comes out of the tree is
transferred to that once (Feng 2013 §5.1).
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Flags, Indices
from ..character.character import Character
from ..character.morphology import LimbKind
from ..errors import MotionError, listed
from ..solve import detached

RATE = 30.0
"""Frames of a clip in a second; the paper samples its motions at as many (§7)."""
_SIDES = {1: "left", -1: "right", 0: "middle"}
_LIMBS = {
    LimbKind.LEG: "leg",
    LimbKind.ARM: "arm",
    LimbKind.WING: "wing",
    LimbKind.FIN: "fin",
    LimbKind.TENTACLE: "tentacle",
}


@dataclass(frozen=True, eq=False)
class CharacterModel:
    """A body with its joints in a fixed order: those of its skeleton's bones."""

    character: Character
    root: int
    """The joint that carries all others; those above it rest."""

    def __len__(self) -> int:
        return len(self.character.skeleton)

    @property
    def names(self) -> tuple[str, ...]:
        """Of the joints."""
        return self.character.skeleton.names

    @cached_property
    def feet(self) -> Indices:
        """Joints that stand: the ends of the legs, front row first, left before right, shape (foot,)."""
        return np.array([leg.end for leg in self.character.legs], dtype=np.intp)

    @cached_property
    def moving(self) -> Indices:
        """Joints that have translations, the root first: what hangs on nothing, or not on its limb, shape (n,)."""
        own = self.character.skeleton
        above = {self.root, *own.tree.ancestors[self.root]}
        carried = detached.carried(self.character, self.root, frozenset())
        loose = {*own.tree.roots, *np.flatnonzero(own.parents != carried.parents).tolist()} - above
        return np.array([self.root, *sorted(loose)], dtype=np.intp)

    @cached_property
    def parts(self) -> Mapping[str, Flags]:
        """Parts of the body and their joints, shape (joint,); each joint is in one of them, and in groups of these.

        Parts are ``trunk``, ``head`` (with the neck), ``left arm``, ``right leg``, ``tail`` and the like; groups are
        ``arms``, ``legs`` and so on, ``upper`` (all but what carries the body), ``lower`` (legs) and ``all``.
        """
        own = self.character
        out: dict[str, set[int]] = {"trunk": set(), "head": set()}
        free = set(range(len(self)))

        def take(name: str, tops: Iterable[int]) -> None:
            for top in tops:
                below = set(own.skeleton.tree.below(top)) | {top}
                out.setdefault(name, set[int]()).update(below & free)
                free.difference_update(below)

        for limb in own.limbs:
            take(f"{_SIDES[limb.side]} {_LIMBS[limb.kind]}", limb.bones[:1])
        for tail in own.tails:
            take("tail", tail[:1])
        take("head", own.neck[:1] or (() if own.head is None else (own.head,)))
        out["trunk"] |= free
        groups: dict[str, set[int]] = {}
        for name, joints in out.items():
            _, _, kind = name.partition(" ")
            if kind:
                groups.setdefault(kind + "s", set[int]()).update(joints)
        legs = groups.get("legs", set[int]())
        groups |= {"lower": legs, "upper": set(range(len(self))) - legs, "all": set(range(len(self)))}
        return {name: self._flags(joints) for name, joints in (out | groups).items()}

    def part(self, *names: str) -> Flags:
        """Return the joints of parts, shape (joint,).

        Raises:
            MotionError: The body has no such part.
        """
        out = np.zeros(len(self), dtype=np.bool_)
        for name in names:
            if name not in self.parts:
                raise MotionError(f"the body has no part {name!r}: choose one of {listed(self.parts, 40)}")
            out |= self.parts[name]
        return out

    def _flags(self, joints: Iterable[int]) -> Flags:
        out = np.zeros(len(self), dtype=np.bool_)
        out[list(joints)] = True
        return out
