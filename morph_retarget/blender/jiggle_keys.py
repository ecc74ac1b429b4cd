"""Jiggles as keys: what an action leaves alone on an armature, and how it follows."""

from collections.abc import Generator
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ..core import jiggling, quat
from ..core.arrays import Array
from ..core.jiggling import Jiggling
from ..core.skeleton import Pose, pose_from_basis
from . import channels, laying, sampling
from .actions import Filler
from .channels import ROTATIONS, Channel
from .laying import Laid, Place
from .rig import Rig, pose_bone
from .writing import Written

Played = tuple[bpy.types.Action, bpy.types.ActionSlot]


@dataclass(frozen=True, eq=False)
class Jiggles:
    """Keys of what jiggles on an armature that plays an action."""

    rig: Rig
    channels: list[Channel]
    """Rotations of the bones that jiggle."""
    frames: Array
    """Shape (frame,)."""

    @property
    def bones(self) -> tuple[str, ...]:
        """Names of what jiggles."""
        return tuple(channel.bone or "" for channel in self.channels)

    @property
    def paths(self) -> set[str]:
        """Data paths of all rotations of what jiggles, in any mode."""
        bones = [pose_bone(self.rig.object, name) for name in self.bones]
        return {bone.path_from_id(prop) for bone in bones for prop in ROTATIONS}

    def write(self, filler: Filler) -> None:
        """Key them in an action, in place of the rotations that it has for them."""
        filler.remove(self.paths)
        for channel in self.channels:
            filler.write(channel.path(self.rig.object), channel.values, self.frames, channel.bone or "")


def of(
    own: Rig,
    loose: Jiggling,
    played: Played,
    scene: bpy.types.Scene,
    wanted: tuple[int, int] | None = None,
) -> Generator[float, None, Jiggles]:
    """Find the jiggles of an armature that plays an action; yields the share done and returns them.

    Args:
        own: The armature, which need not play the action now.
        loose: What jiggles on it, and how.
        played: The action and its slot.
        scene: Gives the frame rate; its frame is put back if it has to be changed.
        wanted: First and last frame to jiggle in, all of the action's when None.

    Raises:
        MotionError: The action has no keys or moves no bones.
    """
    clip = yield from sampling.sample(own, *played, scene, wanted)
    bones, basis = names_of(own, loose), _with_changes(own, loose, clip)
    keyed = [channels.rotation(pose_bone(own.object, name), name, basis[:, i]) for i, name in enumerate(bones)]
    return Jiggles(own, keyed, clip.frames)


def names_of(own: Rig, loose: Jiggling) -> list[str]:
    """Return the names of the bones that jiggle."""
    return [own.skeleton.names[bone] for bone in loose.chains.bones]


def lay(
    target: Rig, made: Written, place: Place, loose: Jiggling | None, scene: bpy.types.Scene
) -> Generator[float, None, Laid]:
    """Put a motion in its place as a new action, with what follows it; yields the share done.

    Args:
        target: The rig.
        made: The motion.
        place: Where it goes; it is not laid over another.
        loose: What shall jiggle; nothing when None.
        scene: Gives the frame rate; its frame is put back if it has to be changed.

    Raises:
        MotionError: The motion moves no bones.
    """
    if not loose:
        return laying.lay(target, made, place)
    # What the old action does to loose parts was meant for another motion.
    made = replace(made, body=[*made.body, *names_of(target, loose)])
    frames = int(np.floor(made.frames[0] + 1e-3)), int(np.ceil(made.frames[-1] - 1e-3))
    done: list[Laid] = []
    with laying.undone_if_it_fails(target.object, done):
        laid = laying.lay(target, made, place)
        done.append(laid)
        found = yield from of(target, loose, (laid.action, laid.slot), scene, frames)
        found.write(Filler(laid.action, laid.slot))
    return laid


def _with_changes(own: Rig, what: Jiggling, clip: sampling.Clip) -> Array:
    """Return the basis rotations of the jiggling bones: what the action holds them in, and the jiggles on top."""
    bones, pose, skeleton = what.chains.bones, clip.pose, own.skeleton
    mine = Pose(pose.rotations[:, bones], pose.positions[:, bones])
    local = quat.multiply(quat.conjugate(pose.rotations[:, skeleton.parents[bones]]), mine.rotations)
    held = quat.multiply(quat.conjugate(skeleton.local_rotations[bones]), local)
    # What the action holds a tail in is what gravity has made of it.
    basis = quat.identity(1, len(skeleton))
    basis[:, bones] = held[:1]
    rest = pose_from_basis(skeleton, basis, np.zeros((1, len(skeleton), 3))).rotations[0, bones]
    what = replace(what, chains=replace(what.chains, rest=rest))
    return quat.multiply(held, jiggling.changes(what, mine, clip.seconds_per_frame))
