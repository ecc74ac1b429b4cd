"""Movement modes: what matters about a movement, and the generalization G and specialization S that follow from it.

Hecker 2008 §3.2. For each body a mode is a *frame*: an origin, three square axes and a scale along each. Position is
generalized by going into the frame and specialized by going out of it, so that ``S = G^-1`` by construction, and a
mode only says where the frame stands. All frames of a clip and all bodies are one batch.

Generalized axes are those of the character (x left, y back, z up), except where a mode takes one of them over:

- *ground-relative*: z is vertical, 0 at rest and 1 at the ground;
- *sagittal-relative*: x is lateral, 0 at rest and 1 on the plane of symmetry;
- *secondary-relative*: x leads from the rest position to the target, 0 at rest and 1 at the target; y and z are square
  to it, to the left and up when the target is straight ahead. The lateral axis is taken, so sagittal-relative has no
  effect; with ground-relative as well, x leads to the target in plan only and z stays vertical.

Where a frame would degenerate it does not:

- a body that rests on the ground (or below it) moves down by a thousandth of the character's size for a z of 1, and
  up, for negative z, by at least a quarter of its limb's length; no body near the ground moves up by less;
- sagittal-relative bodies on the plane of symmetry move by a thousandth of the character's size, toward the right;
- a target nearer to the rest position than a thousandth of the character's size counts as straight ahead, gradually,
  and never as nearer than a tenth of that;
- extents and limb lengths have the least values told in `bodies`.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Flags, Indices
from . import aim
from .bodies import Bodies

TINY = 1e-3
"""Least length of a frame's axis, as a share of the character's size."""
LIFT = 0.25
"""Least way up for one unit of ground-relative height, as a share of the limb's length."""
MIRROR_TURN = np.array([1.0, 1.0, -1.0, -1.0])
"""What a rotation is multiplied by to be that of a mirror image on the plane of symmetry."""


class PositionMode(StrEnum):
    """What a position is measured from."""

    REST_RELATIVE = "rest_relative"
    ABSOLUTE = "absolute"


class RotationMode(StrEnum):
    """What a rotation is measured from."""

    REST_RELATIVE = "rest_relative"
    ABSOLUTE = "absolute"


class ScaleMode(StrEnum):
    """What positions are scaled by."""

    NONE = "none"
    CREATURE_SIZE = "creature_size"
    LIMB_LENGTH = "limb_length"


@dataclass(frozen=True)
class Movement:
    """What matters about a movement; the settings layer, see the module."""

    position: PositionMode = PositionMode.REST_RELATIVE
    """Absolute positions are the same place on every character: its rest pose is not that of the others. With
    LimbLength they are the same place in the reach of every limb, measured from the spine segment that carries it."""
    rotation: RotationMode = RotationMode.REST_RELATIVE
    """Absolute rotations are the same orientation of the body's own axes on every character."""
    scale: ScaleMode = ScaleMode.NONE
    """In a frame that turns with a target, CreatureSize scales by the mean of the three extents."""
    ground_relative: bool = False
    sagittal_relative: bool = False
    secondary_relative: bool = False
    directional_only: bool = False
    """SecondaryDirectionalOnly: the x axis turns with the target and is scaled by ``scale`` alone."""
    look_at: bool = False
    """Rotations are recorded in a frame that looks at the target; needs a target, as secondary-relative does."""

    @property
    def has_target(self) -> bool:
        """Whether the movement depends on a target."""
        return self.secondary_relative or self.look_at


@dataclass(frozen=True, eq=False)
class Base:
    """Rotations that come before others, most of which are often none."""

    rotations: Array
    """Shape (body, 4)."""
    rows: Indices
    """The bodies for which it is one, shape (n,)."""

    matrices: Array
    """What rotations after theirs multiply by, shape (n, 4, 4)."""

    @classmethod
    def of(cls, rotations: Array) -> "Base":
        """Return the base of rotations, shape (body, 4)."""
        rows = np.flatnonzero(quat.angle_between(rotations, quat.IDENTITY) > 1e-12)
        return cls(rotations, rows, quat.after_matrix(rotations[rows]))

    def before(self, rotations: Array, back: bool = False) -> Array:
        """Return rotations, shape (frame, body, 4), after the base, or without it (``back``); in place."""
        if len(self.rows):
            own = rotation.transposed(self.matrices) if back else self.matrices
            rotations[:, self.rows] = rotation.apply(own, rotations.take(self.rows, axis=1))
        return rotations


@dataclass(frozen=True, eq=False)
class Frames:
    """The frames of some bodies in some movement modes, from which G and S follow.

    Without a target the axes are those of the character; arrays with a leading 1 hold for every frame of the clip.
    """

    origin: Array
    """[m], shape (1, body, 3)."""
    scale: Array
    """Length along each generalized axis for one unit [m], negative where it runs backward, shape (1, body, 3); 1 where
    a target gives the length."""
    lift: Array
    """Ratio of the scale of negative z to that of positive z, shape (body,)."""
    base: Base
    """Orientation that a rotation of identity means, before looking at a target."""
    reflection: Array
    """What rotations are multiplied by to mirror them where bodies are mirrored, shape (body, 4)."""
    aims: aim.Aims
    """Which bodies have targets, and from where."""
    lead: aim.Lead | None
    """What leads to a target, None while nothing does."""
    gaze: aim.Gaze | None = None
    """What looks at a target, None while nothing does."""

    def __len__(self) -> int:
        """Return for how many frames of a clip they are known, 1 where they hold for all."""
        return max(
            1 if self.lead is None else len(self.lead.axes),
            1 if self.gaze is None else len(self.gaze.turns),
        )

    def toward(self, targets: Array) -> "Frames":
        """Return the frames turned and stretched toward targets.

        Args:
            targets: Target of each body [m], character frame, shape (frame, body, 3); unused without a target.
        """
        lead, gaze = self.aims.lead(targets), self.aims.gaze(targets)
        return Frames(self.origin, self.scale, self.lift, self.base, self.reflection, self.aims, lead, gaze)


def frames(bodies: Bodies, chosen: Indices, modes: Sequence[Movement], mirrored: Flags) -> Frames:
    """Return the frames in which some bodies move, for targets straight ahead and one metre away.

    A mirrored body's frame is that of its mirror image, reflected: ``S(b, q, true)`` is the reflection of
    ``S(b', q, false)``, where b' is b seen in a mirror on the plane of symmetry (Hecker 2008 §4.1.2).

    Args:
        bodies: Of the character.
        chosen: The bodies, shape (body,); one may stand there several times.
        modes: Movement of each.
        mirrored: Whether each is specialized as its mirror image, shape (body,).
    """
    flip = np.where(mirrored, -1.0, 1.0)
    rest = bodies.positions[chosen].copy()
    rest[:, 0] *= flip
    starts = bodies.positions[bodies.spine_segments[chosen]].copy()
    starts[:, 0] *= flip
    origin, scale, lift = _still(bodies, chosen, modes, rest, starts)
    origin[:, 0] *= flip
    aimed, looking = _where(m.secondary_relative for m in modes), _where(m.look_at for m in modes)
    level = np.array([m.ground_relative for m in modes], dtype=bool)[aimed]
    aims = aim.Aims(
        tiny=TINY * bodies.size,
        aimed=aimed,
        rest=rest[aimed],
        flip=np.stack([flip[aimed], np.ones(len(aimed)), np.ones(len(aimed))], axis=-1),
        flat=np.stack([np.ones(len(aimed)), np.ones(len(aimed)), 1.0 - level], axis=-1),
        only_turned=np.array([m.directional_only for m in modes], dtype=bool)[aimed],
        looking=looking,
        forwards=bodies.forwards[chosen[looking]],
        eyes=bodies.positions[chosen[looking]],
    )
    absolute = np.array([m.rotation is RotationMode.ABSOLUTE for m in modes], dtype=bool)
    base = np.where(absolute[:, None], quat.IDENTITY, bodies.axes[chosen])
    leading = np.zeros(len(chosen), dtype=bool)
    leading[aimed] = True
    scale[~leading, 0] *= flip[~leading]
    reflection = np.where(mirrored[:, None], MIRROR_TURN, 1.0)
    return Frames(origin[None], scale[None], lift, Base.of(base), reflection, aims, aims.ahead())


def _where(flags: Iterable[bool]) -> Indices:
    return np.flatnonzero(np.array(list(flags), dtype=bool))


def _still(
    bodies: Bodies, chosen: Indices, modes: Sequence[Movement], rest: Array, starts: Array
) -> tuple[Array, Array, Array]:
    """Return origins, scales and lifts without targets; ``rest`` and limbs' ``starts`` are seen in the mirror."""
    count, tiny = len(chosen), TINY * bodies.size
    limbs = bodies.limb_lengths[chosen]
    origin, scale, lift = rest.copy(), np.ones((count, 3)), np.ones(count)
    for i, mode in enumerate(modes):
        if mode.position is PositionMode.ABSOLUTE and not mode.secondary_relative:
            origin[i] = starts[i] if mode.scale is ScaleMode.LIMB_LENGTH else 0.0
        if mode.scale is ScaleMode.LIMB_LENGTH:
            scale[i] = limbs[i]
        elif mode.scale is ScaleMode.CREATURE_SIZE:
            scale[i] = np.cbrt(np.prod(bodies.extents)) if mode.secondary_relative else bodies.extents
        if mode.sagittal_relative and not mode.secondary_relative:
            origin[i, 0] = rest[i, 0]
            scale[i, 0] = -np.sign(rest[i, 0] or 1.0) * max(abs(rest[i, 0]), tiny)
        if mode.ground_relative:
            origin[i, 2] = rest[i, 2]
            down = max(rest[i, 2], tiny)
            scale[i, 2], lift[i] = -down, max(down, LIFT * limbs[i]) / down
        if mode.secondary_relative and not mode.directional_only:
            scale[i, 0] = 1.0
    return origin, scale, lift


def specialize(found: Frames, positions: Array, rotations: Array) -> tuple[Array, Array]:
    """Return S: places and orientations of bodies from their generalized coordinates.

    Args:
        found: Frames of the bodies.
        positions: Generalized positions, shape (frame, body, 3).
        rotations: Generalized rotations, unit quaternions, shape (frame, body, 4).

    Returns:
        Positions [m], shape (frame, body, 3), and orientations of the bodies' own axes, shape (frame, body, 4), both
        in the character frame.
    """
    away = positions * found.scale
    away[..., 2] *= np.where(positions[..., 2] < 0.0, found.lift, 1.0)
    if found.lead is not None:
        away = found.lead.applied(away)
    turned = found.base.before(rotations * found.reflection)
    return found.origin + away, turned if found.gaze is None else found.gaze.applied(turned)


def generalize(found: Frames, places: Array, turned: Array) -> tuple[Array, Array]:
    """Return G, the inverse of `specialize`, argument for result."""
    away = places - found.origin
    if found.lead is not None:
        away = found.lead.undone(away)
    positions = away / found.scale
    positions[..., 2] /= np.where(positions[..., 2] < 0.0, found.lift, 1.0)
    if found.gaze is not None:
        turned = found.gaze.undone(turned)
    return positions, found.base.before(turned.copy(), back=True) * found.reflection
