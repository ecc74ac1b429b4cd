"""Mirror: a motion as it is seen in a mirror, left and right changed over."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ... import quat
from ...arrays import Array, Flags
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from .aggregate import ClipAggregate
from .partners import Partners, partners_of

_X = np.array([0.0, 1.0, 0.0, 0.0])
"""Half a turn about the lateral axis: what conjugating by it makes of a rotation is that of the mirror image."""
_SEEN = np.array([-1.0, 1.0, 1.0])


@dataclass(frozen=True, eq=False)
class Mirror(ClipAggregate):
    """A clip seen in the character's plane of symmetry; twice is the clip again."""

    clip: Clip

    @property
    def parts(self) -> tuple[Clip, ...]:
        """The clip."""
        return (self.clip,)

    @property
    def active(self) -> Flags:
        """Joints that it has."""
        return self.clip.active[self.partners.joints]

    @cached_property
    def partners(self) -> Partners:
        """Of the body."""
        return partners_of(self.model)

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        own, there = self.clip.frame(times), self.partners
        rotations = own.rotations[:, there.joints]
        rotations[..., 1:] = np.einsum("jab,njb->nja", self._turned, rotations[..., 1:])
        translations = np.einsum("jab,njb->nja", self._moved, own.translations[:, there.moving])
        return Frames(rotations, translations, own.feet[:, there.feet] * _SEEN, own.contacts[:, there.feet])

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        way = self.clip.travel(times)
        return Travel(way.places * _SEEN[:2], -way.headings)

    @cached_property
    def _turned(self) -> Array:
        """What takes the axes of rotations from the rest frame of a joint's partner to its own, shape (joint, 3, 3).

        A rotation about a joint's own axes is, in the character frame, one about the axes of its rest; there it is
        mirrored, and from there brought to the rest frame of the joint on the other side.
        """
        model = self.model
        rest = quat.multiply(model.character.local_to_character.turn, model.character.skeleton.rest_rotations)
        over = quat.multiply(quat.multiply(quat.conjugate(rest), _X), rest[self.partners.joints])
        return quat.to_matrix(over)

    @cached_property
    def _moved(self) -> Array:
        """The same for translations, which are no rotations, shape (moving, 3, 3)."""
        model = self.model
        to_character = model.character.local_to_character.rotation
        rest = to_character @ quat.to_matrix(model.character.skeleton.rest_rotations[model.moving])
        return np.swapaxes(rest, -1, -2) @ (_SEEN[:, None] * rest[self.partners.moving])
