"""What rigs were found to be: one that comes again as it was is not analysed again.

Undo, the next clip and the next target like this bring it back. All that is made for a character, as its library of
motions, stays with it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import fields

import numpy as np

from ..core.arrays import Array
from ..core.character.analysis import Overrides, analyze
from ..core.character.character import Character
from ..core.character.frame import Placement
from ..core.skeleton import Skeleton

MOST = 64
"""Of no more rigs is it kept what they are."""
_known: dict[tuple[object, ...], Character] = {}
"""By all that the analysis goes by; those used last at the end."""


def recognized(
    skeleton: Skeleton, placement: Placement, overrides: Overrides, positions: Array | None = None
) -> Character:
    """Return what a rig is, as `analyze` does.

    Raises:
        RigError: The rig has a single bone.
        MappingError: An override names a joint or bone that does not exist.
    """
    state = *_state(skeleton), *_state(placement), *_state(overrides), _plain(positions)
    found = _known.pop(state, None)
    if found is None:
        found = analyze(skeleton, placement, overrides, positions)
    _known[state] = found
    if len(_known) > MOST:
        del _known[next(iter(_known))]
    return found


def _state(part: Skeleton | Placement | Overrides) -> Iterator[object]:
    """Yield what is equal for parts that are the same."""
    for own in fields(part):
        if own.init:
            yield _plain(getattr(part, own.name))


def _plain(value: object) -> object:
    if isinstance(value, np.ndarray):
        return value.shape, value.tobytes()
    return tuple(value.items()) if isinstance(value, Mapping) else value
