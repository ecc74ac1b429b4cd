"""Jiggles of a character: what of it jiggles, and a motion with the jiggles in it.

A played generalized action or a sampled pose -> the bones that it only carries along -> lags -> basis rotations
"""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from . import quat
from .arrays import Array
from .character.character import Character
from .play import Played
from .skeleton import Pose
from .solve import jiggle, jiggle_chains
from .solve.jiggle import Surroundings
from .solve.jiggle_chains import Chains
from .solve.jiggle_kinds import JiggleSettings

ALIKE = 1e-3
"""Poses are alike if bones are turned and placed differently by no more than this [rad; sizes of the character]."""


@dataclass(frozen=True, eq=False)
class Jiggling:
    """What jiggles on a character, and how."""

    character: Character
    chains: Chains
    settings: JiggleSettings
    around: Surroundings

    def __bool__(self) -> bool:
        return len(self.chains) > 0


def prepare(
    character: Character, posed: Collection[int], settings: JiggleSettings, among: Collection[int] | None = None
) -> Jiggling:
    """Return what jiggles on a character whose other bones something else poses.

    Args:
        character: What the rig is.
        posed: Bones that an action poses.
        settings: How it jiggles.
        among: Bones that may jiggle; all when None.
    """
    chains = jiggle_chains.find(character, posed, settings, among)
    place = character.local_to_character
    spread = float(np.ptp(character.skeleton.rest_positions, axis=0).max())
    # Heights in armature space are those of the character frame, moved and scaled.
    up = place.inverse().directions(np.array([0.0, 0.0, 1.0]))
    ground = place.inverse().points(np.array([0.0, 0.0, character.floor])) @ up
    size = max(spread, character.frame.height / place.scale, 1e-12)
    return Jiggling(character, chains, settings, Surroundings(size, up, float(ground) if settings.ground else None))


def carried(jiggling: Jiggling, played: Played) -> Pose:
    """Return the jiggling bones as a played action carries them along, armature space."""
    chains, back = jiggling.chains, jiggling.character.local_to_character.inverse()
    rotations = quat.multiply(back.turns(played.pose.turns[:, chains.bones]), chains.rest)
    return Pose(rotations, back.points(played.pose.positions[:, chains.bones]))


def changes(jiggling: Jiggling, pose: Pose, step: float, last: int | None = None) -> Array:
    """Return what follows the basis rotations of the jiggling bones, shape (frame, n, 4).

    Args:
        jiggling: What jiggles.
        pose: Those bones as they are carried, in a space that does not move with the character.
        step: Time between frames [s].
        last: Frame with which the action ends, counted from its first; the last one when None. If it ends as it began,
            it is taken for a cycle.
    """
    chains, settings = jiggling.chains, jiggling.settings
    period = len(pose) - 1 if last is None else last
    loops = settings.loop and 0 < period < len(pose) and _alike(pose, period, jiggling.around.size)
    turns = jiggle.simulate(chains, settings.gravity, pose, step, jiggling.around, period if loops else None)
    return jiggle.basis_changes(chains, pose, turns)


def _alike(pose: Pose, period: int, size: float) -> bool:
    """Return whether a pose comes back after some frames, wherever the character has gone in them."""
    turned = quat.angle_between(pose.rotations[0], pose.rotations[period]).max(initial=0.0)
    moved = pose.positions[period] - pose.positions[0]
    return bool(turned < ALIKE and np.ptp(moved, axis=0).max(initial=0.0) < ALIKE * size)


def with_jiggles(played: Played, jiggling: Jiggling, basis: Array) -> Played:
    """Return a played action with basis rotations of its jiggling bones added, shape (frame, n, 4)."""
    bones = np.concatenate([played.bones, jiggling.chains.bones])
    return replace(played, bones=bones, basis=np.concatenate([played.basis, basis], axis=1))
