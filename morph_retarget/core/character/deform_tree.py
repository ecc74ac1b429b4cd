"""The body within a control rig: its deform bones alone, each under the one that carries it.

Between deform bones lie mechanisms and controls, whose names are those of body parts too. The tree goes past them.
"""

import re
from collections.abc import Callable, Collection, Mapping, Sequence

import numpy as np

from ..arrays import Indices
from ..skeleton import Skeleton
from .control_names import split

_HELPERS = re.compile(
    r"^(?:(?:DEF|ORG|MCH|FK|IK|STR|TGT|ROT)-)+|^c_|_(?:fk|ik|stretch|twist|tweak|parent|master)$", re.I
)
LEAST = 5
"""A rig is posed by controls when at least so many deform bones copy others …"""
SHARE = 0.25
"""… and at least this share of all."""


def is_controlled(deform: Collection[str], copies: Mapping[str, Sequence[str]]) -> bool:
    """Return whether a rig is posed by controls.

    Args:
        deform: Its deform bones.
        copies: Bone to the bones that it copies, where it does.
    """
    own = [name for name in deform if copies.get(name)]
    return len(own) >= LEAST and len(own) >= SHARE * len(deform)


def within(
    skeleton: Skeleton,
    deform: Collection[str],
    copies: Mapping[str, Sequence[str]],
    aims: Mapping[str, Sequence[str]],
) -> tuple[Skeleton, Indices]:
    """Return the skeleton that some bones make, and their places in the whole, shape (bone,).

    Args:
        skeleton: All bones.
        deform: Those that count.
        copies: Bone to the bones that it copies, where it does.
        aims: Bone to the bones that it points to, where it does.
    """
    kept = [i for i, name in enumerate(skeleton.names) if name in deform]
    twins: dict[tuple[str, str], int] = {}
    followers: dict[str, int] = {}
    for i in kept:
        twins.setdefault(_part(skeleton.names[i]), i)
        for name in copies.get(skeleton.names[i], ()):
            followers.setdefault(name, i)

    def twin(bone: int) -> int | None:
        name = skeleton.names[bone]
        if name in deform:
            return bone
        found = followers.get(name, twins.get(_part(name)))
        # A bone that lies where a control does, and points elsewhere than this would take it, turns by another one.
        points = () if found is None else [skeleton.index[one] for one in aims.get(skeleton.names[found], ())]
        return found if not points or any(skeleton.tree.is_below(bone, one) for one in points) else None

    above = {i: _carrier(skeleton, i, twin) for i in kept}
    above = {i: parent if parent is None or not _loops(above, i) else None for i, parent in above.items()}
    order = sorted(kept, key=lambda i: _depth(above, i))
    place = {bone: i for i, bone in enumerate(order)}
    parents = np.array([-1 if (parent := above[i]) is None else place[parent] for i in order], dtype=np.intp)
    rows = np.array(order, dtype=np.intp)
    return (
        Skeleton(
            tuple(skeleton.names[i] for i in order),
            parents,
            skeleton.rest_positions[rows],
            skeleton.rest_rotations[rows],
            skeleton.rest_tails[rows],
            None if skeleton.deform is None else skeleton.deform[rows],
        ),
        rows,
    )


def _part(name: str) -> tuple[str, str]:
    """Return which part of a body a name is about, whatever its bone is for."""
    base, end = split(name)
    before = None
    while base != before:
        before, base = base, _HELPERS.sub("", base)
    return base.casefold(), end


def _carrier(skeleton: Skeleton, bone: int, twin: Callable[[int], int | None]) -> int | None:
    for above in skeleton.tree.ancestors[bone]:
        found = twin(above)
        if found is not None and found != bone and not skeleton.tree.is_below(bone, found):
            return found
    return None


def _loops(above: Mapping[int, int | None], bone: int) -> bool:
    """Return whether a bone would hang on itself."""
    seen, now = {bone}, above[bone]
    while now is not None and now not in seen:
        seen.add(now)
        now = above[now]
    return now == bone


def _depth(above: Mapping[int, int | None], bone: int) -> int:
    steps, now = 0, above[bone]
    while now is not None and steps <= len(above):
        steps, now = steps + 1, above[now]
    return steps
