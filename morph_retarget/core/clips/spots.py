"""The spots on which feet stand: what stays in its place in the world while a foot rolls over its sole."""

import numpy as np

from .. import quat
from ..arrays import Array, Indices
from ..runs import runs
from ..smoothing import bridged
from .character_model import CharacterModel
from .travel import Travel

STANDS = 0.5
"""A foot whose contact counts for more than this stands."""
_UP: Array = np.array([0.0, 0.0, 1.0])


def spots_of(model: CharacterModel, positions: Array, travel: Travel, contacts: Array, cycle: bool = False) -> Array:
    """Return the spots of feet as seen from a travel [m], shape (n, foot, 3).

    The spot is where the ball of a foot is for most of the time in which it stands.

    Args:
        model: The body.
        positions: Of its joints where the travel leads [m], character frame, shape (n, joint, 3).
        travel: Of the same frames.
        contacts: How far each foot stands, shape (n, foot).
        cycle: Whether the frame after the last is the first again.
    """
    count, standing = len(positions), contacts > STANDS
    out = np.empty((count, len(model.feet), 3))
    for foot, balls in enumerate(balls_of(model)):
        ball = positions[:, balls].mean(axis=1)
        lacking, found = np.zeros((count, 2)), runs(standing[:, foot])
        for first, last in found:
            inside = slice(first, last + 1)
            lacking[inside] = np.median(ball[inside, :2], axis=0) - ball[inside, :2]
        if cycle and len(found) > 1 and found[0][0] == 0 and found[-1][1] == count - 1:
            _join(lacking, ball, found, travel)
        out[:, foot, :2] = ball[:, :2] + bridged(lacking, found)
        out[:, foot, 2] = positions[:, model.feet[foot], 2]
    return in_travel(out, travel)


def balls_of(model: CharacterModel) -> list[Indices]:
    """Return the joints whose middle is the ball of each foot: the first ones of its toes, else the foot itself."""
    parents = model.character.skeleton.parents
    out: list[Indices] = []
    for leg in model.character.legs:
        toes = [digit for digit in leg.digits if int(parents[digit]) == leg.end]
        out.append(np.array(toes or [leg.end], dtype=np.intp))
    return out


def in_travel(points: Array, travel: Travel) -> Array:
    """Return points as seen from a travel [m], shape (n, m, 3)."""
    back = travel.inverse()
    return in_world(points, back)


def in_world(points: Array, travel: Travel) -> Array:
    """Return points that are seen from a travel where it leads [m], shape (n, m, 3)."""
    turns = quat.from_axis_angle(_UP, travel.headings)
    shifts = np.column_stack([travel.places, np.zeros(len(travel))])
    return quat.rotate(turns[:, None], points) + shifts[:, None]


def closing(travel: Travel) -> Travel:
    """Return what leads from the last frame of a cycle to its first one again: the mean of its last and first step."""
    if len(travel) < 2:
        return Travel.still()
    steps = travel.steps()
    return steps[-1:].mixed(steps[:1], np.array([0.5]))


def _join(lacking: Array, ball: Array, found: list[tuple[int, int]], travel: Travel) -> None:
    """Let a foot that stands over the end of a cycle have one spot there, in place."""
    (_, until), (since, _) = found[0], found[-1]
    after = travel[-1:].then(closing(travel))  # the first frame again, one cycle on
    once_more = after.then(travel[: until + 1].since(travel[:1]))
    start = in_world(in_travel(ball[: until + 1, None], travel[: until + 1]), once_more)[:, 0, :2]
    spot = np.median(np.concatenate([ball[since:, :2], start]), axis=0)
    lacking[since:] = spot - ball[since:, :2]
    first = in_world(in_travel(np.array([[[*spot, 0.0]]]), after), travel[:1])[0, 0, :2]
    lacking[: until + 1] = first - ball[: until + 1, :2]
