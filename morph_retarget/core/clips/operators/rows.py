"""Frames put together: rows from several batches, and joints of one batch laid over those of another."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ... import quat
from ...arrays import Array, Flags, Indices
from ..character_model import CharacterModel
from ..frames import Frames


@dataclass(frozen=True, eq=False)
class Portion:
    """Joints, and what belongs to them in frames: the feet that they are, the translations that they have."""

    joints: Flags
    """Shape (joint,)."""
    moving: Flags
    """Of `CharacterModel.moving`, shape (moving,)."""
    feet: Flags
    """Of `CharacterModel.feet`, shape (foot,)."""

    @classmethod
    def of(cls, model: CharacterModel, joints: Flags) -> "Portion":
        """Return what belongs to joints, shape (joint,)."""
        return cls(joints, joints[model.moving], joints[model.feet])


def picked(rows: Flags) -> slice | Indices:
    """Return rows as what picks them: a slice where they lie side by side, which copies nothing."""
    (found,) = rows.nonzero()
    if len(found) and found[-1] - found[0] == len(found) - 1:
        return slice(int(found[0]), int(found[-1]) + 1)
    return found


def placed(count: int, parts: Sequence[tuple[Flags, Frames]]) -> Frames:
    """Return ``count`` rows of frames from batches that hold only some rows each, in order, and together hold all."""
    for rows, frames in parts:
        if rows.all():
            return frames
    shapes = parts[0][1]
    out = Frames(*(np.empty((count, *a.shape[1:])) for a in _arrays(shapes)))
    for rows, frames in parts:
        chosen = picked(rows)
        for target, source in zip(_arrays(out), _arrays(frames), strict=True):
            target[chosen] = source
    return out


def replaced(frames: Frames, rows: Indices, others: Frames) -> Frames:
    """Return frames with others in some rows, shape (k,); a new batch."""
    out = copied(frames)
    for target, source in zip(_arrays(out), _arrays(others), strict=True):
        target[rows] = source
    return out


def laid(lower: Frames, upper: Frames, portion: Portion, share: Array) -> Frames:
    """Return ``lower`` with some joints on their way to ``upper`` by a share, shape (n,); a new batch."""
    out = copied(lower)
    whole, part = share >= 1.0, (share > 0.0) & (share < 1.0)
    for rows in (whole, part):
        if not rows.any():
            continue
        some, chosen = share[rows], picked(rows)
        for target, source, own in zip(_arrays(out), _arrays(upper), _columns(portion), strict=True):
            if not own.any():
                continue
            columns = np.flatnonzero(own)
            goal = source[chosen][:, columns]
            if rows is part:
                goal = _between(target[chosen][:, columns], goal, some, target is out.rotations)
            if isinstance(chosen, slice):
                target[chosen, columns] = goal
            else:
                target[chosen[:, None], columns] = goal
    return out


def masked(model: CharacterModel, frames: Frames, portion: Portion) -> Frames:
    """Return frames in which all that does not belong to some joints rests; a new batch."""
    return laid(Frames.at_rest(model, len(frames)), frames, portion, np.ones(len(frames)))


def copied(frames: Frames) -> Frames:
    """Return a batch that may be written to."""
    return Frames(*(a.copy() for a in _arrays(frames)))


def mingled(
    model: CharacterModel,
    share: Array,
    first: Callable[[Flags], Frames],
    second: Callable[[Flags], Frames],
    kept: Flags,
    taken: Flags,
) -> Frames:
    """Return frames of one clip on their way to those of another; each is asked only for the rows that it counts in.

    Args:
        model: The body.
        share: Of the second clip, shape (n,).
        first: Returns the first clip's frames of chosen rows.
        second: The same for the second.
        kept: Joints that are the first clip's whatever the share, shape (joint,).
        taken: Joints that are the second's.
    """
    if kept.all():
        return first(np.ones(len(share), dtype=np.bool_))
    early, late = (share < 1.0) | kept.any(), (share > 0.0) | taken.any()
    if not late.any():
        return first(early)
    if not early.any():
        return second(late)
    a, b = first(early), second(late)
    both = early & late
    parts = [(early & ~late, _some(a, ~late[early])), (late & ~early, _some(b, ~early[late]))]
    if both.any():
        lower, upper, part = _some(a, late[early]), _some(b, early[late]), share[both]
        if kept.any() or taken.any():
            mixed = laid(lower, upper, Portion.of(model, ~(kept | taken)), part)
            mixed = laid(mixed, upper, Portion.of(model, taken), np.ones(len(part))) if taken.any() else mixed
        else:
            mixed = lower.mixed(upper, part)
        parts.append((both, mixed))
    return placed(len(share), [(rows, frames) for rows, frames in parts if len(frames)])


def _some(frames: Frames, rows: Flags) -> Frames:
    return frames[picked(rows)]


def _between(low: Array, high: Array, share: Array, turns: bool) -> Array:
    if turns:
        return quat.slerp(low, high, share[:, None])
    return low + share.reshape(-1, *[1] * (low.ndim - 1)) * (high - low)


def _arrays(frames: Frames) -> tuple[Array, Array, Array, Array]:
    return frames.rotations, frames.translations, frames.feet, frames.contacts


def _columns(portion: Portion) -> tuple[Flags, Flags, Flags, Flags]:
    return portion.joints, portion.moving, portion.feet, portion.feet
