"""The weighted average of frames."""

from collections.abc import Sequence

import numpy as np

from ... import quat
from ...arrays import Array, Flags
from ..character_model import CharacterModel
from ..frames import Frames
from .rows import Portion


def averaged(model: CharacterModel, frames: Sequence[Frames], weights: Array, active: Flags) -> Frames:
    """Return the mean of several batches; each joint's is that of the batches that have it.

    Rotations are averaged as vectors of four, each turned to the side of the one that counts most, and made unit
    rotations again: for rotations that are alike this is their mean.

    Args:
        model: The body.
        frames: Batches of the same times.
        weights: Of the batches, shape (batch,), positive.
        active: Joints that each of them has, shape (batch, joint).
    """
    portions = [Portion.of(model, joints) for joints in active]
    joints = _shares(weights, np.array([p.joints for p in portions]))
    moving, feet = (
        _shares(weights, np.array([p.moving for p in portions])),
        _shares(weights, np.array([p.feet for p in portions])),
    )
    most = frames[int(np.argmax(weights))].rotations
    rotations = np.zeros_like(most)
    for share, part in zip(joints, frames, strict=True):
        rotations += np.einsum("...,...i->...i", np.copysign(share, quat.dot(part.rotations, most)), part.rotations)
    return Frames(
        quat.normalize(rotations),
        _summed([f.translations for f in frames], moving[:, :, None]),
        _summed([f.feet for f in frames], feet[:, :, None]),
        _summed([f.contacts for f in frames], feet),
    )


def _shares(weights: Array, active: Flags) -> Array:
    """Return how much each batch counts for each item, shape (batch, item); all count for what none has."""
    counting = weights[:, None] * (active | ~active.any(axis=0))
    return counting / counting.sum(axis=0)


def _summed(values: Sequence[Array], shares: Array) -> Array:
    out = np.zeros_like(values[0])
    for share, part in zip(shares, values, strict=True):
        out += share * part
    return out
