"""Clips that wander at random on a small body, for laws that hold for any clip."""

from functools import cache

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array, Flags
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.clips.character_model import CharacterModel
from morph_retarget.core.clips.clip import Clip, ClipPrimitive
from morph_retarget.core.clips.frames import Frames
from morph_retarget.core.clips.travel import Travel
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.play import root_of
from tools.figure import Build, humanoid

from .skeletons import skeleton_of


@cache
def body() -> CharacterModel:
    """Return a humanoid whose bones have axes that mean nothing."""
    bones = humanoid(1.7, build=Build(spine=2, fingers=0, root=True))
    character = analyze(skeleton_of(bones, np.random.default_rng(8)))
    return CharacterModel(character, root_of(Bodies.of(character)))


def wander(
    seed: int,
    frames: int = 24,
    joints: Flags | None = None,
    first: float = 0.0,
    model: CharacterModel | None = None,
) -> ClipPrimitive:
    """Return a smooth clip in which all joints turn and that goes about in curves.

    Args:
        seed: Other ones make other clips.
        frames: How many it has.
        joints: Those that it has, shape (joint,); all when None.
        first: Its first frame.
        model: The body that it is made for; `body` when None.
    """
    model, rng = model or body(), np.random.default_rng(seed)
    some = np.ones(len(model), dtype=np.bool_) if joints is None else joints
    turns = _smooth(rng, frames, len(model) * 3, 0.5).reshape(frames, -1, 3) * some[:, None]
    data = Frames(
        quat.from_rotation_vector(turns),
        0.1 * _smooth(rng, frames, 3 * len(model.moving), 1.0).reshape(frames, -1, 3) * some[model.moving][:, None],
        _smooth(rng, frames, 3 * len(model.feet), 0.3).reshape(frames, -1, 3),
        np.clip(0.5 + _smooth(rng, frames, len(model.feet), 1.0), 0.0, 1.0),
    )
    steps = Travel(
        np.array([0.0, -0.04]) + _smooth(rng, frames - 1, 2, 0.01), 0.03 + _smooth(rng, frames - 1, 1, 0.02)[:, 0]
    )
    return ClipPrimitive(f"wander {seed}", model, data, steps.summed(), some, first)


def _smooth(rng: np.random.Generator, frames: int, count: int, size: float) -> Array:
    time = np.arange(frames)[:, None] / 12.0
    return size * np.sin(rng.uniform(0.5, 2.0, count) * time + rng.uniform(0.0, 6.0, count))


def difference(first: Frames, second: Frames) -> float:
    """Return the largest difference between frames: of turns [rad], places [m] and contacts."""
    return max(
        float(quat.angle_between(first.rotations, second.rotations).max(initial=0.0)),
        float(np.abs(first.translations - second.translations).max(initial=0.0)),
        float(np.abs(first.feet - second.feet).max(initial=0.0)),
        float(np.abs(first.contacts - second.contacts).max(initial=0.0)),
    )


def apart(first: Travel, second: Travel) -> float:
    """Return the largest difference between travels, [m] or [rad]."""
    return max(
        float(np.abs(first.places - second.places).max(initial=0.0)),
        float(np.abs(first.headings - second.headings).max(initial=0.0)),
    )


def times_of(clip: Clip, seed: int = 0, count: int = 60, until: float = 100.0) -> Array:
    """Return times within a clip, whole ones and others, in no order, shape (count,)."""
    end = clip.end if clip.is_finite else clip.start + until
    out = np.random.default_rng(seed).uniform(clip.start, end, count)
    whole = np.round(out)
    return np.where((np.arange(count) % 3 > 0) | (whole < clip.start) | (whole > end), out, whole)
