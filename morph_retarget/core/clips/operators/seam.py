"""The seam of a loop whose ends do not fit: both are bent toward each other, so that it is not seen (paper §8)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ... import quat
from ...arrays import Array
from ..frames import Frames


@dataclass(frozen=True, eq=False)
class Seam:
    """How far the ends of a cycle miss each other, in place and in speed.

    Each end takes half of what is missing, and less the further a frame is from the seam. So a round keeps its length
    and its strikes their frames, which they would not if the ends were laid over each other.
    """

    ends: Frames
    """The first frame and two soon after it, two soon before the last and the last."""
    gap: float
    """Frames from each of the three to the next."""
    closing: float
    """Frames from the last to the first again."""
    cycle: float
    """Frames of a round."""
    blend: float
    """Frames that are bent on either side of the seam."""

    def closed(self, frames: Frames, into: Array) -> Frames:
        """Return frames bent toward the seam.

        Args:
            frames: Of the cycle.
            into: How far from its first frame each is [frames], shape (n,).
        """
        after, before = into / self.blend, (self.cycle - into) / self.blend
        near = np.flatnonzero((after < 1.0) | (before < 1.0))
        if not len(near):
            return frames
        after, before = np.minimum(after[near], 1.0), np.minimum(before[near], 1.0)
        place = 0.5 * (_fading(after) - _fading(before))
        speed = -0.5 * self.blend * (_turning(after) + _turning(before))
        shares = np.column_stack([place, speed])
        # Of a quaternion (1, v), which need not be unit: no angles, and v is a sum of two.
        bent = _shared(shares, self._turns)
        bent[..., 0] = 1.0
        rotations = frames.rotations.copy()
        rotations[near] = quat.normalize(quat.multiply(frames.rotations[near], bent))
        translations, feet = frames.translations.copy(), frames.feet.copy()
        translations[near] += _shared(shares, self._missed(self.ends.translations))
        feet[near] += _shared(shares, self._missed(self.ends.feet))
        return Frames(rotations, translations, feet, frames.contacts)

    @cached_property
    def _turns(self) -> Array:
        """By how much rotations miss the first frame, and how much faster they leave it, shape (2, joint, 4).

        Half of the first as the vector of a quaternion (1, v) is half the turn; a speed is that of a small one.
        """
        turns = self.ends.rotations
        step, faster = self._speeds(quat.to_rotation_vector(quat.multiply(quat.conjugate(turns[:-1]), turns[1:])))
        on = quat.multiply(turns[-1], quat.from_rotation_vector(self.closing * step))
        missed = quat.to_rotation_vector(quat.multiply(quat.conjugate(turns[0]), on))
        out = np.zeros((2, len(missed), 4))
        out[0, :, 1:] = 2.0 * np.tan(0.25 * quat.length(missed))[:, None] * quat.unit(missed)
        out[1, :, 1:] = 0.5 * faster
        return out

    def _missed(self, ends: Array) -> Array:
        """Return the same for places, shape (6, n, 3) to (2, n, 3)."""
        step, faster = self._speeds(np.diff(ends, axis=0))
        return np.stack([ends[-1] + self.closing * step - ends[0], faster])

    def _speeds(self, steps: Array) -> tuple[Array, Array]:
        """Return the mean speed at both ends, and by how much more they leave the seam than they come to it.

        Speeds change toward the seam as they do beside it, or a cycle that fits would be bent.

        Args:
            steps: From each end frame to the next, shape (5, n, 3).
        """
        if self.gap <= 0.0:
            return np.zeros_like(steps[0]), np.zeros_like(steps[0])
        leave, after, before, arrive = (steps[i] / self.gap for i in (0, 1, 3, 4))
        ahead = 0.5 * (self.gap + self.closing) / self.gap
        return 0.5 * (leave + arrive), leave - arrive - ahead * (after - leave + arrive - before)


def _shared(shares: Array, both: Array) -> Array:
    """Return sums of two by shares, shapes (k, 2) and (2, n, m) to (k, n, m)."""
    return (shares @ both.reshape(2, -1)).reshape(len(shares), *both.shape[1:])


def _fading(x: Array) -> Array:
    """Return a way from 1 at 0 to 0 at 1 that is level at both ends."""
    return (1.0 + 2.0 * x) * (1.0 - x) ** 2


def _turning(x: Array) -> Array:
    """Return what is 0 at both ends, level at 1, and leaves 0 with a slope of 1."""
    return x * (1.0 - x) ** 2
