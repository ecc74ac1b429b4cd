"""How much a body is in the same state at two frames of clips: where its joints are, and how they move."""

import numpy as np

from ... import quat
from ...arrays import Array
from ..clip import Clip
from ..posing import UP, pose_of
from ..travel import Travel

SPEED = 4.0
"""Joints that move apart by one body height a frame count as so many body heights."""


def places(clip: Clip, times: Array) -> Array:
    """Return where joints are as seen from the travel [body heights], shape (n, joint, 3)."""
    own = clip.model.character
    pose = pose_of(clip.model, clip.frame(times))
    return own.local_to_character.points(pose.positions) / own.frame.height


def speeds(clip: Clip, times: Array) -> Array:
    """Return how fast joints move over the ground, as seen from the travel [body heights a frame], (n, joint, 3)."""
    early, late = clip.held(times - 0.5), clip.held(times + 0.5)
    here = clip.travel(times)
    ends = [_carried(places(clip, t), clip.travel(t).since(here), clip) for t in (early, late)]
    return (ends[1] - ends[0]) / np.maximum(late - early, 1e-9)[:, None, None]


def unlikeness(first: Clip, first_times: Array, second: Clip, second_times: Array) -> Array:
    """Return how much frames of one clip differ from those of another, mean squares [body heights²], shape (n, m)."""
    features = [
        np.concatenate([places(clip, times), SPEED * speeds(clip, times)], axis=-1).reshape(len(times), -1)
        for clip, times in ((first, first_times), (second, second_times))
    ]
    a, b = features
    squares = (a * a).sum(axis=1)[:, None] + (b * b).sum(axis=1) - 2.0 * a @ b.T
    return np.maximum(squares, 0.0) / len(first.model)


def standing_otherwise(first: Clip, first_times: Array, second: Clip, second_times: Array) -> Array:
    """Return how many feet stand in a frame of one clip and not in one of another, or the reverse, shape (n, m)."""
    a, b = (clip.frame(times).contacts > 0.5 for clip, times in ((first, first_times), (second, second_times)))
    return (a[:, None] != b).sum(axis=-1)


def _carried(points: Array, way: Travel, clip: Clip) -> Array:
    turns = quat.from_axis_angle(UP, way.headings)
    shifts = np.column_stack([way.places, np.zeros(len(way))]) / clip.model.character.frame.height
    return quat.rotate(turns[:, None], points) + shifts[:, None]
