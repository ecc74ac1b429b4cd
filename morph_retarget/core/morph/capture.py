"""From a captured motion to a generalized action: G on the bodies of the performer, channel by channel.

What a channel's values mean is told by its movement mode alone (Hecker 2008 §3.2), so a captured pose is generalized as
one that an animator makes by hand. Two things are different about captured motions:

- performers walk about. A generalized action has no way over the ground of its own, which is the character's matter, so
  the slow part of the way and of the turning is left out (`CaptureSettings.in_place`);
- performers lack bodies that other characters have. What stands in for them is in `STANDS_FOR`: their hands move the
  wings and fins of others. As the rest poses of unlike bodies mean nothing to each other, such a channel is measured
  from where the performer's arm hangs down.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .. import quat
from ..arrays import Array
from ..character.character import Character
from ..character.morphology import Capability
from ..errors import MotionError
from ..skeleton import Pose
from ..smoothing import between_ends
from . import movement
from .bind import GeneralizedAction, bind
from .bodies import UP, Bodies
from .channels import Channel, TargetKind, Values
from .context import TIE
from .specialize import frames_of

STANDS_FOR: Mapping[Capability, Capability] = {Capability.WING: Capability.GRASPER, Capability.FIN: Capability.GRASPER}
"""What of the performer moves bodies that it lacks."""


@dataclass(frozen=True)
class CaptureSettings:
    """What can be chosen about generalizing a captured motion."""

    in_place: bool = True
    """Leave out the slow part of the way over the ground and of the turning, which all channels would share."""
    slow: float = 1.0
    """What takes longer than about this counts as slow [s]."""


@dataclass(frozen=True, eq=False)
class Captured:
    """A generalized motion."""

    channels: tuple[Channel, ...]
    """Those that could be captured, in their order."""
    values: Values
    """Of these channels."""
    bodies: tuple[int, ...]
    """Where each was taken from."""
    travel: float
    """Way over the ground that was left out [m]."""
    turning: float
    """Largest turn away from ahead that was left out [rad]."""
    warnings: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Performance:
    """The bodies of a performer over a clip, character frame."""

    bodies: Bodies
    positions: Array
    """[m], shape (frame, body, 3)."""
    axes: Array
    """Orientations of the bodies' own axes, shape (frame, body, 4)."""

    def __len__(self) -> int:
        return len(self.positions)

    def hanging(self, body: int) -> Bodies:
        """Return the bodies with the pose for rest in which a limb hangs down farthest."""
        start = int(self.bodies.spine_segments[body])
        height = self.positions[:, body, 2] - self.positions[:, start, 2]
        row = int(np.flatnonzero(height <= height.min() + TIE * self.bodies.size)[0])
        return replace(self.bodies, positions=self.positions[row], axes=self.axes[row])


def standing(character: Character, pose: Pose, row: int) -> Character:
    """Return a character whose rest is a frame of its clip, for rigs whose own rest is no pose of a body."""
    skeleton = character.skeleton
    turns = quat.multiply(pose.rotations[row], quat.conjugate(skeleton.rest_rotations))
    along = quat.rotate(turns, skeleton.rest_tails - skeleton.rest_positions)
    posed = replace(
        skeleton,
        rest_positions=pose.positions[row],
        rest_rotations=pose.rotations[row],
        rest_tails=pose.positions[row] + along,
    )
    return replace(character, skeleton=posed, rest_is_pose=True)


def performance(character: Character, pose: Pose) -> Performance:
    """Return what a pose over time, armature space, is of a character's bodies."""
    bodies, place = Bodies.of(character), character.local_to_character
    turns = place.turns(quat.multiply(pose.rotations, quat.conjugate(character.skeleton.rest_rotations)))
    return Performance(bodies, place.points(pose.positions), quat.multiply(turns, bodies.axes))


def grounded(found: Performance) -> Performance:
    """Return a motion raised or lowered so that the feet stand as high as at rest.

    Rigs of mocap often rest at another height over the ground than they play. The height at which the lower foot is
    most of the time is taken for standing.
    """
    feet = found.bodies.with_capability(Capability.FOOT)
    if not feet:
        return found
    over = (found.positions[:, feet, 2] - found.bodies.positions[feet, 2]).min(axis=-1)
    return replace(found, positions=found.positions - np.median(over) * UP)


def in_place(found: Performance, width: int) -> tuple[Performance, float, float]:
    """Return a motion without the slow part of its way and turning, how far it went [m] and turned [rad].

    Args:
        found: The motion.
        width: Frames to either side that count as the same moment.
    """
    root = (found.bodies.with_capability(Capability.ROOT) or found.bodies.tree.roots)[0]
    turns = quat.multiply(found.axes[:, root], quat.conjugate(found.bodies.axes[root]))
    twist = quat.twist_about(turns, UP)
    yaw = np.unwrap(2.0 * quat.direction(twist[:, 3], twist[:, 0]))
    heading = _slow(yaw[:, None], width)[:, 0]
    path = _slow(found.positions[:, root, :2], width)
    back = quat.from_axis_angle(UP, -heading)[:, None]
    rest = found.bodies.positions[root] * np.array([1.0, 1.0, 0.0])
    from_path = found.positions - np.concatenate([path, np.zeros((len(path), 1))], axis=-1)[:, None]
    moved = replace(
        found,
        positions=quat.rotate(back, from_path) + rest,
        axes=quat.multiply(np.broadcast_to(back, back.shape), found.axes),
    )
    way = float(np.linalg.norm(np.diff(path, axis=0), axis=-1).sum()) if len(path) > 1 else 0.0
    return moved, way, float(np.abs(heading - heading[0]).max(initial=0.0))


def _slow(values: Array, width: int) -> Array:
    return between_ends(values, width) if width > 0 and len(values) > 2 else values.copy()


def capture(found: Performance, channels: Sequence[Channel]) -> Captured:
    """Return the generalized values of channels for a captured motion.

    Args:
        found: The motion.
        channels: What to capture; each takes the first body that it selects. What selects nothing is left out, unless
            its weights say that it only keeps others off its bodies.

    Raises:
        MotionError: Nothing is left.
    """
    kept: list[Channel] = []
    bodies: list[int] = []
    warnings: list[str] = []
    positions: list[Array] = []
    rotations: list[Array] = []
    for channel in channels:
        taken = _taken(found, channel)
        if taken is None and channel.position_weight + channel.rotation_weight > 0.0:
            warnings.append(f"channel {channel.name!r} was left out: the performer has no body for it")
            continue
        body, q, turn = taken or (-1, np.zeros((len(found), 3)), quat.identity(len(found)))
        kept.append(channel)
        bodies.append(body)
        positions.append(q)
        rotations.append(turn)
    if all(body < 0 for body in bodies):
        raise MotionError("none of the channels selects a body of the performer: choose other channels")
    values = Values(np.stack(positions, axis=1), np.stack(rotations, axis=1), np.ones((len(found), len(kept))))
    return Captured(tuple(kept), values, tuple(bodies), 0.0, 0.0, tuple(warnings))


def _taken(found: Performance, channel: Channel) -> tuple[int, Array, Array] | None:
    """Return the body that a channel is captured from, and its generalized positions and rotations."""
    # A channel by itself owns all that it selects; what is outside of the performer was not captured.
    missing = {0} if channel.target is TargetKind.EXTERNAL else set[int]()
    binding = bind(GeneralizedAction("", (channel,)), found.bodies, missing=missing)
    other = STANDS_FOR.get(channel.context.capability)
    if not binding.entries and other is not None:
        instead = replace(channel, context=replace(channel.context, capability=other))
        binding = bind(GeneralizedAction("", (instead,)), found.bodies, missing=missing)
        if binding.entries:
            binding = replace(binding, bodies=found.hanging(binding.entries[0].body))
    if not binding.entries:
        return None
    plan = binding.plan
    frames = frames_of(binding, {}, found.positions)
    turned = quat.multiply(found.axes[:, plan.body], quat.conjugate(binding.bodies.axes[plan.body]))
    q, turns = movement.generalize(frames, found.positions[:, plan.body], turned)
    return binding.entries[0].body, q[:, 0], quat.continuous(quat.normalize(turns[:, 0]))


def of_clip(
    character: Character,
    pose: Pose,
    channels: Sequence[Channel],
    stance: int,
    seconds_per_frame: float,
    settings: CaptureSettings | None = None,
) -> Captured:
    """Return the generalized values of channels for a clip.

    Args:
        character: The performer.
        pose: The clip, armature space.
        channels: What to capture.
        stance: Frame in which the performer stands plainly: the rest of one whose own rest is no pose of a body.
        seconds_per_frame: Of the clip.
        settings: Choices.

    Raises:
        MotionError: See `capture`.
    """
    settings = settings or CaptureSettings()
    found = performance(character if character.rest_is_pose else standing(character, pose, stance), pose)
    found, travel, turning = grounded(found), 0.0, 0.0
    if settings.in_place:
        found, travel, turning = in_place(found, round(0.5 * settings.slow / seconds_per_frame))
    captured = capture(found, channels)
    return replace(captured, travel=travel, turning=turning)
