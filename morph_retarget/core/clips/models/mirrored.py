"""Mirrored sets: what a library has for one side, done with the other (Feng 2013 §6.1)."""

from collections.abc import Iterable, Sequence

import numpy as np

from ..clip import ClipPrimitive
from ..motions.annotations import NO_SIDE
from ..motions.base_motion import BaseMotion
from ..operators.mirror import Mirror
from ..operators.partners import partners_of

ALIKE = 0.1
"""Turns and directions that differ by less are the same [rad/s, rad]."""


def with_mirrored(motions: Sequence[BaseMotion]) -> tuple[BaseMotion, ...]:
    """Return base motions of one kind with the mirror images of those that have no counterpart."""
    if not motions:
        return ()
    feet = partners_of(motions[0].clip.model).feet.tolist()
    images = [_image(motion, feet) for motion in motions if _is_sided(motion)]
    return (*motions, *(image for image in images if not _has(motions, image)))


def _is_sided(motion: BaseMotion) -> bool:
    known = motion.annotations
    return known.side != NO_SIDE or abs(known.turn_rate) > ALIKE or ALIKE < abs(known.direction) < np.pi - ALIKE


def _image(motion: BaseMotion, feet: Sequence[int]) -> BaseMotion:
    clip = motion.clip
    image, times = Mirror(clip), clip.start + np.arange(clip.length)
    name = f"{motion.name} mirrored"
    seen = ClipPrimitive(name, clip.model, image.frame(times), image.travel(times), image.active, clip.first)
    return BaseMotion(name, seen, motion.annotations.mirrored(feet))


def _has(motions: Iterable[BaseMotion], image: BaseMotion) -> bool:
    """Return whether there is a motion that does what a mirror image does."""
    wanted = image.annotations
    for motion in motions:
        known = motion.annotations
        same = (known.side, known.style, known.phase) == (wanted.side, wanted.style, wanted.phase)
        near = abs(known.turn_rate - wanted.turn_rate) < ALIKE and abs(known.direction - wanted.direction) < ALIKE
        if same and near and abs(known.speed - wanted.speed) < ALIKE * max(wanted.speed, 1e-6) + 1e-9:
            shared = set(known.parameters) & set(wanted.parameters)
            if all(abs(known.parameters[n] - wanted.parameters[n]) < ALIKE for n in shared):
                return True
    return False
