"""The tree that bones make: who hangs on whom, and the ways through it."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from .arrays import Indices


class Tree:
    """Bones by number and the bone that each hangs on."""

    def __init__(self, parents: Indices) -> None:
        """Take the parent of each bone, -1 for roots, shape (bone,); bones may stand in any order."""
        self.parents = parents

    def __len__(self) -> int:
        return len(self.parents)

    @cached_property
    def children(self) -> list[list[int]]:
        """Each bone's children, in order."""
        out: list[list[int]] = [[] for _ in self.parents]
        for bone, parent in enumerate(self.parents):
            if parent >= 0:
                out[int(parent)].append(bone)
        return out

    @cached_property
    def roots(self) -> list[int]:
        """Bones without a parent."""
        return [bone for bone, parent in enumerate(self.parents) if parent < 0]

    @cached_property
    def order(self) -> list[int]:
        """All bones, parents before children."""
        out = list(self.roots)
        for bone in out:
            out.extend(self.children[bone])
        return out

    @cached_property
    def ancestors(self) -> list[list[int]]:
        """Each bone's ancestors, from its parent up to its root."""
        out: list[list[int]] = [[] for _ in self.parents]
        for bone in self.order:
            parent = int(self.parents[bone])
            if parent >= 0:
                out[bone] = [parent, *out[parent]]
        return out

    @cached_property
    def levels(self) -> list[Indices]:
        """Bones grouped by depth, so that kinematics loops over depths and not over bones."""
        depth = np.array([len(above) for above in self.ancestors])
        return [np.flatnonzero(depth == d) for d in range(int(depth.max(initial=0)) + 1)]

    def is_below(self, top: int, bottom: int) -> bool:
        """Return whether ``bottom`` descends from ``top``."""
        return top in self.ancestors[bottom]

    def below(self, top: int) -> list[int]:
        """Return all descendants of ``top``, in the order of their numbers."""
        return [bone for bone, above in enumerate(self.ancestors) if top in above]

    def path(self, top: int, bottom: int) -> list[int]:
        """Return the bones from ``top`` down to ``bottom``, both included; empty when they are not in line."""
        line = [bottom, *self.ancestors[bottom]]
        return line[: line.index(top) + 1][::-1] if top in line else []

    def path_between(self, top: int, bottom: int) -> list[int]:
        """Return the bones strictly between ``top`` and ``bottom``."""
        return self.path(top, bottom)[1:-1]

    def top_of(self, bone: int, beside: int) -> int:
        """Return the highest ancestor of ``bone`` (or itself) that is not also an ancestor of ``beside``."""
        shared = set(self.ancestors[beside])
        return [b for b in (bone, *self.ancestors[bone]) if b not in shared][-1]

    def meeting(self, bones: Sequence[int]) -> int | None:
        """Return the lowest bone that is or carries each of ``bones``, None when they hang on different roots."""
        shared = [bones[0], *self.ancestors[bones[0]]]
        for bone in bones[1:]:
            line = {bone, *self.ancestors[bone]}
            shared = [b for b in shared if b in line]
        return shared[0] if shared else None

    def way(self, start: int, end: int) -> list[int]:
        """Return the bones from ``start`` to ``end`` over where they meet, both included; empty when they do not."""
        meet = self.meeting([start, end])
        return [] if meet is None else [*self.path(meet, start)[::-1], *self.path(meet, end)[1:]]
