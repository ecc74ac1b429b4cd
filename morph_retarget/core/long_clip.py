"""Playing long clips block by block, so that who waits sees how far it is and can stop it, and memory does not grow."""

from collections.abc import Generator, Mapping, Sequence

import numpy as np

from . import play
from .arrays import Array
from .layering import Layer
from .morph.channels import Values
from .play import Part, Played, Stretched
from .solve.goals import Goals
from .solve.posing import BodyPose

BLOCK = 256
"""Frames that are evaluated at once."""


def evaluate(
    part: Part, values: Values, external: Mapping[int, Array], lower: Layer | None = None
) -> Generator[float, None, Played]:
    """Play a clip in steps; yields the share done and returns what `play.evaluate` does, with its arguments."""
    count, done = len(values), list[Played]()
    for start in range(0, count, BLOCK):
        rows = slice(start, start + BLOCK)
        targets = {channel: places if len(places) == 1 else places[rows] for channel, places in external.items()}
        done.append(play.evaluate(part, values.at(rows), targets, None if lower is None else lower.at(rows)))
        if start + BLOCK < count:
            yield (start + BLOCK) / count
    return done[0] if len(done) == 1 else joined(done)


def joined(blocks: Sequence[Played]) -> Played:
    """Return what a part plays in some clips, one after the other, as one clip."""
    first = blocks[0]
    return Played(
        first.bones,
        _rows([block.basis for block in blocks]),
        first.root,
        _rows([block.shift for block in blocks]),
        _joined_goals([block.goals for block in blocks]),
        _joined_poses([block.pose for block in blocks]),
        {key: _rows([block.deforms[key] for block in blocks]) for key in first.deforms},
        None if first.followed is None else _rows([b.followed for b in blocks if b.followed is not None]),
        _joined_stretched([b.stretched for b in blocks if b.stretched is not None]),
    )


def _joined_goals(goals: Sequence[Goals]) -> Goals:
    return Goals(
        goals[0].bodies,
        _rows([g.positions for g in goals]),
        _rows([g.turns for g in goals]),
        _rows([g.position_influence for g in goals]),
        _rows([g.rotation_influence for g in goals]),
    )


def _joined_poses(poses: Sequence[BodyPose]) -> BodyPose:
    moved = [np.broadcast_to(pose.moved, pose.shift.shape) for pose in poses]
    rotations, shift = _rows([pose.rotations for pose in poses]), _rows([pose.shift for pose in poses])
    stretched = [pose.stretched for pose in poses if pose.stretched is not None]
    return BodyPose(rotations, _rows(moved), shift, poses[0].plan, _rows(stretched) if stretched else None)


def _joined_stretched(blocks: Sequence[Stretched]) -> Stretched | None:
    """Return what moves over some clips; a part that may stretch has it in all of them, and others in none."""
    return Stretched(blocks[0].bones, _rows([block.shifts for block in blocks])) if blocks else None


def _rows(arrays: Sequence[Array]) -> Array:
    return np.concatenate(arrays)
