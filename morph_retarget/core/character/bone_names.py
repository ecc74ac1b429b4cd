"""Finding the bones of a rig that others have written down, under names that are a little different.

Exporters change case, put a namespace or a figure's name before names, and write ``_`` for what they do not allow.
A name means a bone of the rig when it is that bone's name, or when, these habits left out, only one bone is called so.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

_BETWEEN = re.compile(r"[\s._-]+")


@lru_cache(maxsize=8192)
def fold(name: str) -> str:
    """Return a name without namespace, in lower case, with ``_`` between its parts."""
    return _BETWEEN.sub("_", re.split(r"[:|]", name)[-1].strip().casefold())


@dataclass(frozen=True)
class BoneNames:
    """The names of all bones of one rig."""

    names: Sequence[str]

    @cached_property
    def _exact(self) -> frozenset[str]:
        return frozenset(self.names)

    @cached_property
    def _folded(self) -> Mapping[str, str | None]:
        """Bone by folded name, None where several bones share it."""
        out: dict[str, str | None] = {}
        for name in self.names:
            key = fold(name)
            out[key] = None if key in out else name
        return out

    def find(self, name: str) -> str | None:
        """Return the bone that a name means, None where there is no such bone, or more than one."""
        return name if name in self._exact else self._folded.get(fold(name))

    def first(self, names: Iterable[str]) -> str | None:
        """Return the bone of the first name that means one."""
        return next((bone for bone in map(self.find, names) if bone is not None), None)

    def count(self, names: Iterable[str]) -> int:
        """Return how many of some names mean bones."""
        return sum(self.find(name) is not None for name in names)

    def prefixes(self, name: str) -> list[str]:
        """Return what stands before ``name`` in the rig, nothing first: ``mixamorig1:`` before ``Hips``."""
        found = [own[: len(own) - len(name)] for own in self.names if own.casefold().endswith(name.casefold())]
        return sorted(found, key=len)
