"""Controls that copy the turns of others, as the bones of a tail that one bone curls: what is left for them to do.

Such a bone turns as the other one does in its own frame, and then by its own channels on top of that, as if what it
copies carried it. Without that known, a curl would be made by each bone anew, and grow from bone to bone.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .. import euler, quat
from ..arrays import Array

ALL = (True, True, True)


@dataclass(frozen=True)
class Copy:
    """Whose turn a handle copies, before its own."""

    source: int
    """The handle whose local turn it copies."""
    axes: tuple[bool, bool, bool] = ALL
    """Which of its Euler angles, about x, y and z."""
    order: str = "XYZ"
    """Their order."""

    def taken(self, turns: Array) -> Array:
        """Return what is copied of local turns, shapes (frame, 4)."""
        if self.axes == ALL:
            return turns
        angles = euler.from_quaternions(turns, self.order)
        return euler.to_quaternions(np.where(self.axes, angles, 0.0), self.order)


def parted(copies: Mapping[int, Copy], before: Array, wanted: Array) -> Array:
    """Return what handles have to do by their own channels, shape (frame, handle, 4).

    Args:
        copies: By handle.
        before: What their channels held when they were seen, shape (frame, handle, 4).
        wanted: How they shall turn from what carries them as it was seen, with what was copied then, the same shape.
    """
    out = wanted.copy()
    seen: dict[int, Array] = {}
    whole: dict[int, Array] = {}

    def part(handle: int) -> None:
        """Find the local turns of a handle, with what it copies, as it was seen and as it will be."""
        if handle in whole:
            return
        seen[handle], whole[handle] = before[:, handle], out[:, handle]  # also where copies go round in a circle
        copy = copies.get(handle)
        if copy is None:
            return
        part(copy.source)
        was, is_now = copy.taken(seen[copy.source]), copy.taken(whole[copy.source])
        # What is copied turns the frame of its own turn: away from where it was seen, and to where it will be.
        out[:, handle] = quat.multiply(quat.conjugate(is_now), quat.multiply(was, wanted[:, handle]))
        seen[handle] = quat.multiply(was, before[:, handle])
        whole[handle] = quat.multiply(is_now, out[:, handle])

    for handle in copies:
        part(handle)
    return out
