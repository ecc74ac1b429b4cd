"""Frames of clips: what a clip returns for a batch of times."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array, Flags, Indices
from .character_model import CharacterModel
from .spots import spots_of
from .travel import Travel


@dataclass(frozen=True, eq=False)
class Frames:
    """Rotations and translations for all joints of a character model (Grünvogel 2003 §5.3), seen from its travel.

    Beside the paper's two arrays it is kept where feet stand: places that are blended by themselves keep standing feet
    where they are, which blended rotations would not (Feng 2013 §5.2).
    """

    rotations: Array
    """From rest in the joints' own rest frames, the identity where a joint is not active, shape (n, joint, 4)."""
    translations: Array
    """Of `CharacterModel.moving`: from where their parents hold them, in their own rest frames, armature space,
    shape (n, moving, 3)."""
    feet: Array
    """Spots on which the feet stand, at the heights of the feet themselves [m], character frame, shape (n, foot, 3).
    In the world a spot stays the same while a foot rolls over its sole; in flight it goes with the foot."""
    contacts: Array
    """How far each foot stands, 0 … 1, shape (n, foot)."""

    def __len__(self) -> int:
        return len(self.rotations)

    def __getitem__(self, rows: slice | Indices | Flags) -> "Frames":
        return Frames(self.rotations[rows], self.translations[rows], self.feet[rows], self.contacts[rows])

    @classmethod
    def at_rest(cls, model: CharacterModel, count: int = 1) -> "Frames":
        """Return the rest pose, standing."""
        own = model.character
        places = own.local_to_character.points(own.skeleton.rest_positions)[None]
        feet = spots_of(model, places, Travel.still(), np.ones((1, len(model.feet))))
        return cls(
            quat.identity(count, len(model)),
            np.zeros((count, len(model.moving), 3)),
            feet.repeat(count, axis=0),
            np.ones((count, len(model.feet))),
        )

    def mixed(self, other: "Frames", share: Array) -> "Frames":
        """Return what lies between these and ``other``, shape (n,): rotations the shorter way round."""
        row, wide = share[:, None], share[:, None, None]
        return Frames(
            quat.slerp(self.rotations, other.rotations, row),
            self.translations + wide * (other.translations - self.translations),
            self.feet + wide * (other.feet - self.feet),
            self.contacts + row * (other.contacts - self.contacts),
        )

    def at(self, rows: Array) -> "Frames":
        """Return frames between those that were sampled, at rows that need not be whole; held beyond the ends."""
        rows = np.clip(rows, 0.0, len(self) - 1.0)
        low = np.minimum(rows.astype(np.intp), max(len(self) - 2, 0))
        part = rows - low
        if not part.any():
            return self[low]
        return self[low].mixed(self[np.minimum(low + 1, len(self) - 1)], part)


def joined(parts: Sequence[Frames]) -> Frames:
    """Return batches of frames one after the other."""
    if len(parts) == 1:
        return parts[0]
    return Frames(
        np.concatenate([part.rotations for part in parts]),
        np.concatenate([part.translations for part in parts]),
        np.concatenate([part.feet for part in parts]),
        np.concatenate([part.contacts for part in parts]),
    )


def chosen(first: Frames, second: Frames, where: Flags) -> Frames:
    """Return ``first`` in some rows and ``second`` in all others; both hold only their own rows, in order."""
    row = np.empty(len(where), dtype=np.intp)
    row[where] = np.arange(int(where.sum()))
    row[~where] = int(where.sum()) + np.arange(int((~where).sum()))
    return joined([first, second])[row]
