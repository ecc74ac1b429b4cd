"""Where the target's feet shall be (Feng 2013 §4.2 and §5.2): the source's paths, scaled, on the target's ground.

The paper warps the whole path of a foot by the ratio of leg lengths, starting where the transferred pose puts the foot
at the first frame. Here that is done anew for every plant, and during flight the correction is carried over smoothly
from one plant to the next, as the paper does with the height of terrain (eqs 3 and 4): so turning on the spot, wide
hips and boots with high soles need no exceptions, and a leg in the air keeps the shape that the transfer gave it. While
only the ball of a foot stands it is the ball that keeps the source's path, not the ankle.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from .. import contacts, quat
from ..arrays import Array, Flags
from ..contacts import ContactSettings
from ..ground import Ground, heights_on
from ..runs import runs
from ..smoothing import bridged
from .links import NONE, LimbLinks


@dataclass(frozen=True)
class FeetSettings:
    """How feet are planted."""

    lock: float = 1.0
    """0 keeps the source's own slide during contact, 1 removes it."""
    level: float = 0.05
    """Plants within this distance from the lowest floor stand on it exactly [leg lengths]."""
    drift: float = 0.08
    """A foot that travels farther than this while it stands is dragged on purpose and not locked [leg lengths]."""


@dataclass(frozen=True, eq=False)
class Steps:
    """The contacts of all feet over a clip."""

    ankle: Flags
    """Whether the ankle rests, shape (frame, foot)."""
    ball: Flags
    """Whether the ball of the foot rests, shape (frame, foot); equal to ``ankle`` without toes."""
    ankle_floor: Array
    """Height of each resting ankle on the lowest floor, source's frame [m], shape (foot,)."""
    ball_floor: Array
    """The same for the balls, shape (foot,)."""

    @property
    def standing(self) -> Flags:
        """Whether each foot stands on its heel or its ball, shape (frame, foot)."""
        return self.ankle | self.ball


def find_steps(
    legs: Sequence[LimbLinks],
    points: Array,
    seconds_per_frame: float,
    leg_length: float,
    settings: ContactSettings,
    given: Flags | None = None,
) -> Steps:
    """Return when the feet of the source stand.

    Args:
        legs: Of the pair.
        points: Places of the links on the source, character frame [m], shape (frame, link, 3).
        seconds_per_frame: Of the clip [s].
        leg_length: Of the source [m].
        settings: Thresholds.
        given: The user's own plants, shape (frame, foot); they replace those found.
    """
    ankles = points[:, [leg.end for leg in legs]]
    balls = points[:, [leg.ball if leg.ball != NONE else leg.end for leg in legs]]
    ankle = contacts.find_plants(ankles, seconds_per_frame, leg_length, settings)
    ball = contacts.find_plants(balls, seconds_per_frame, leg_length, settings)
    if given is not None:
        ankle, ball = ankle & given, np.where(ankle & given, ball & given, given)
    return Steps(
        ankle,
        ball,
        _floor(ankles, ankle, settings.height * leg_length),
        _floor(balls, ball, settings.height * leg_length),
    )


def _floor(points: Array, resting: Flags, low: float) -> Array:
    """Return the height of each point on the lowest floor: of its plants up to ``low`` above it, the middle one."""
    out = np.empty(points.shape[1])
    for foot in range(points.shape[1]):
        heights = [median(points[a : b + 1, foot, 2].tolist()) for a, b in runs(resting[:, foot])]
        lowest = [h for h in heights if h < min(heights) + low]
        out[foot] = median(lowest) if lowest else float(points[:, foot, 2].min())
    return out


@dataclass(frozen=True, eq=False)
class Paths:
    """Where the target's ankles shall be."""

    targets: Array
    """Character frame [m], shape (frame, foot, 3)."""
    terrain: Array
    """Height of the terrain under each foot, interpolated during flight [m], shape (frame, foot)."""


def plan_paths(
    legs: Sequence[LimbLinks],
    steps: Steps,
    source_points: Array,
    target_points: Array,
    target_rest: Array,
    turns: Array,
    scale: float,
    leg_length: float,
    settings: FeetSettings,
    ground: Ground | None = None,
) -> Paths:
    """Return where the target's ankles shall be in every frame.

    Args:
        legs: Of the pair.
        steps: When the source's feet stand.
        source_points: Places of the links on the source, shape (frame, link, 3).
        target_points: Places of the links as transferred, shape (frame, link, 3).
        target_rest: Places of the links on the target at rest, shape (link, 3).
        turns: Turns of the target's links, shape (frame, link, 4).
        scale: Target's leg length over the source's.
        leg_length: Of the source [m].
        settings: How feet are planted.
        ground: Terrain, the target's character frame; flat at z = 0 when None, and where there is none.
    """
    paths: list[Array] = []
    heights: list[Array] = []
    for f, leg in enumerate(legs):
        foot = _Foot(
            leg=leg,
            ankle=steps.ankle[:, f],
            ball=steps.ball[:, f],
            path=scale * source_points[:, leg.end],
            ball_path=scale * source_points[:, leg.ball if leg.ball != NONE else leg.end],
            transferred=target_points[:, leg.end],
            floor=scale * steps.ankle_floor[f],
            rest_height=float(target_rest[leg.end, 2]),
        )
        own_ball = np.zeros(3) if leg.ball == NONE else target_rest[leg.ball] - target_rest[leg.end]
        roll = foot.ball_path - foot.path - quat.rotate(turns[:, leg.end], own_ball)
        target, terrain = _path(foot, roll, scale * leg_length, settings, ground)
        paths.append(target)
        heights.append(terrain)
    return Paths(np.stack(paths, axis=1), np.stack(heights, axis=1))


@dataclass(frozen=True, eq=False)
class _Foot:
    """One foot of the source, scaled to the target's size."""

    leg: LimbLinks
    ankle: Flags
    ball: Flags
    path: Array
    ball_path: Array
    transferred: Array
    floor: float
    rest_height: float


def _path(
    foot: _Foot, roll: Array, leg_length: float, settings: FeetSettings, ground: Ground | None
) -> tuple[Array, Array]:
    """Return where an ankle shall be, shape (frame, 3), and the height of the terrain under it, shape (frame,).

    Args:
        foot: The foot.
        roll: Way of the ankle that would let the ball keep its own scaled path, but for a constant, shape (frame, 3).
        leg_length: Of the target [m].
        settings: How feet are planted.
        ground: Terrain.
    """
    found = runs(foot.ankle | foot.ball)
    if not found:
        lift = np.array(
            [0.0, 0.0, foot.rest_height - foot.floor + foot.path[:, 2].mean() - foot.transferred[:, 2].mean()]
        )
        return foot.transferred + lift, np.zeros(len(foot.path))
    # What the transferred ankle lacks: known while the foot stands, carried over in flight.
    lacking, terrain = np.zeros_like(foot.path), np.zeros((len(foot.path), 1))
    for first, last in found:
        inside = slice(first, last + 1)
        resting = foot.ankle[inside]
        base = _mean(foot.path[inside], resting)
        offset = _mean(foot.transferred[inside], resting) - base
        level = abs(base[2] - foot.floor) < settings.level * leg_length
        height = float(heights_on(ground, base + offset, 0.0)) if ground is not None else 0.0
        offset[2] = foot.rest_height - (base[2] if level else foot.floor) + height
        mended = foot.path[inside] + offset + _mend(foot, roll, inside, leg_length, settings)
        lacking[inside], terrain[inside] = mended - foot.transferred[inside], height
    return foot.transferred + bridged(lacking, found), bridged(terrain, found)[:, 0]


def _mend(foot: _Foot, roll: Array, inside: slice, leg_length: float, settings: FeetSettings) -> Array:
    """Return what is added to the path of a standing ankle, shape (n, 3): its slide taken out, its roll over the ball.

    While the ankle rests it keeps its place; while only the ball does the ball keeps the place that it had then.
    """
    ankle, ball = foot.ankle[inside], foot.ball[inside]
    slide = foot.path[inside] - _mean(foot.path[inside], ankle)
    # An ankle over a rolling heel rises and sinks; only its way along the ground is slide.
    slide[:, 2] *= ankle & ball
    out = -_share(slide, ankle, leg_length, settings) * slide
    pivot = roll[inside] - _share(foot.ball_path[inside], ball, leg_length, settings) * foot.ball_path[inside]
    for first, last in runs(ball & ~ankle):
        _roll_on(out, pivot, first, last)
    return out


def _share(path: Array, resting: Flags, leg_length: float, settings: FeetSettings) -> float:
    """Return how much of a resting point's slide is taken out: all, unless it is dragged a long way."""
    if not resting.any():
        return 0.0
    reach = float(np.linalg.norm(np.ptp(path[resting, :2], axis=0)))
    return settings.lock * min(max(2.0 - reach / (settings.drift * leg_length), 0.0), 1.0)


def _roll_on(out: Array, pivot: Array, first: int, last: int) -> None:
    """Let ``out`` follow ``pivot`` over a run of frames in which only the ball stands, from where it was before.

    An ankle that comes to rest again does so where the ball has led it: on feet of other proportions not where the
    source's did, which would drag the ball along. Its height is its own, and reached evenly over the run.
    """
    inside = slice(first, last + 1)
    own = pivot[inside]
    before, after = first > 0, last + 1 < len(out)
    if before:
        own = own - pivot[first - 1] + out[first - 1]
        if after:
            apart = pivot[last + 1] - pivot[first - 1] + out[first - 1] - out[last + 1]
            own = own - np.linspace(0.0, 1.0, len(own) + 2)[1:-1, None] * apart * np.array([0.0, 0.0, 1.0])
            out[last + 1 :] += apart * np.array([1.0, 1.0, 0.0])
    elif after:
        own = own - pivot[last + 1] + out[last + 1]
    else:
        own = own - own.mean(axis=0)
    out[inside] = own


def _mean(values: Array, where: Flags) -> Array:
    return values[where].mean(axis=0) if where.any() else values.mean(axis=0)


TILTED_REST = np.radians(10.0)
"""A sole that stands tilted by more than this was not flat at rest: what is flat is then read from the contacts."""
MOST_FLATTENING = np.radians(60.0)
"""A correction larger than this means that a foot never stands flat: it is left as transferred."""


def flatten(
    legs: Sequence[LimbLinks], steps: Steps, source_turns: Array, turns: Array, post: Array, rest_is_pose: bool
) -> Array:
    """Return turns in which soles are as flat on the target as they are on the source.

    The transfer gives a foot the direction of the source's foot, which tilts the sole when one ankle is higher than
    the other. At rest both soles are flat, so what is up for the one foot is up for the other; where the source's rest
    is no standing pose, its sole is taken to be flat in the frames in which it stands.

    Args:
        legs: Of the pair.
        steps: When the source's feet stand.
        source_turns: Of the source's links, shape (frame, link, 4).
        turns: Of the target's links, shape (frame, link, 4).
        post: Of the transfer, shape (link, 4).
        rest_is_pose: Whether the source's rest looks like a body.
    """
    out = turns.copy()
    up = np.array([0.0, 0.0, 1.0])
    for f, leg in enumerate(legs):
        flat = steps.ankle[:, f] & steps.ball[:, f]
        for link in (leg.end, leg.ball):
            if link == NONE:
                continue
            sole = _sole(source_turns[flat, link], up, rest_is_pose)
            if rest_is_pose:
                # Both feet point forward at rest, so turning out and in follows from the rests as well.
                flattened = quat.multiply(source_turns[:, link], quat.between(up, sole))
                out[:, link] = quat.multiply(flattened, np.array(leg.turn))
                continue
            mend = quat.between(up, quat.rotate(quat.conjugate(post[link]), sole))
            if quat.angle_between(mend, quat.IDENTITY) < MOST_FLATTENING:
                out[:, link] = quat.multiply(out[:, link], mend)
    return out


def _sole(standing_turns: Array, up: Array, rest_is_pose: bool) -> Array:
    """Return the direction that is up for a foot that stands flat, in the source's rest, shape (3,)."""
    if not len(standing_turns):
        return up
    normals = quat.rotate(quat.conjugate(standing_turns), up)
    seen = quat.unit(np.median(normals, axis=0))
    return up if rest_is_pose and seen @ up > np.cos(TILTED_REST) else seen
