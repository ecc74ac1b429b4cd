"""The motion models of a library: one for each kind of its base motions (Grünvogel 2003 §6.2)."""

from collections.abc import Mapping
from functools import lru_cache

from ..motions.library import Library
from .going import Going, is_loop
from .mirrored import with_mirrored
from .motion_model import MotionModel
from .performing import Performing

IDLE = "idle"
"""The kind that moves the character when nothing else does."""


@lru_cache(maxsize=8)
def models_of(library: Library, scale: float = 1.0) -> Mapping[str, MotionModel]:
    """Return motion models by their names: the kinds of base motions.

    Args:
        library: What they are made of.
        scale: Lengths that commands name over the same ones of the library's body.
    """
    out: dict[str, MotionModel] = {}
    for kind in library.kinds:
        motions = with_mirrored(library.of_kind(kind))
        if any(is_loop(motion) for motion in motions):
            out[kind] = Going(kind, motions, scale)
        else:
            out[kind] = Performing(kind, motions, scale, beneath=kind == IDLE)
    return out
