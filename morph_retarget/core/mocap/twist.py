"""Sharing the twist of a segment among the bones in line along it, so that a skin wraps evenly."""

import numpy as np

from .. import quat
from ..arrays import Array, Indices
from ..character.character import Character
from .links import NONE, Links
from .transfer import Transfer

STRAIGHT = 0.995
"""Cosine within which a bone lies in line with the segment it belongs to."""


def share(target: Character, links: Links, transfer: Transfer, turns: Array, basis: Array) -> tuple[Indices, Array]:
    """Return all bones to be keyed and their basis rotations, with twist spread over the bones in line.

    A limb of one bone keeps its rotation; with further bones in line, each takes an equal share of the twist, and the
    last has all of it, so that what hangs below is unchanged.

    Args:
        target: The body.
        links: Of the pair.
        transfer: Of the pair.
        turns: Of the links, character frame, shape (frame, link, 4).
        basis: Basis rotations of the links' own bones, shape (frame, link, 4).

    Returns:
        Bones, shape (n,), and rotations, shape (frame, n, 4).
    """
    bones, rotations = [links.target], [basis.copy()]
    for i, extra in enumerate(links.twists):
        if not extra or links.names[i].startswith(("neck", "spine")) or not _in_line(target, links, i, extra):
            continue
        own, rest = _spread(target, links, transfer, turns, i, extra)
        rotations[0][:, i] = own
        bones.append(np.array(extra, dtype=np.intp))
        rotations.append(rest)
    return np.concatenate(bones), np.concatenate(rotations, axis=1)


def _axis(target: Character, links: Links, i: int) -> Array:
    head, tail = target.skeleton.rest_positions[links.target[[i, links.after[i]]]]
    return quat.unit(tail - head)


def _in_line(target: Character, links: Links, i: int, extra: tuple[int, ...]) -> bool:
    axis, head = _axis(target, links, i), target.skeleton.rest_positions[links.target[i]]
    ways = target.skeleton.rest_positions[list(extra)] - head
    lengths = np.linalg.norm(ways, axis=-1)
    return bool(np.all(ways @ axis >= STRAIGHT * lengths - 1e-9))


def _spread(
    target: Character, links: Links, transfer: Transfer, turns: Array, i: int, extra: tuple[int, ...]
) -> tuple[Array, Array]:
    """Return the basis rotations of a link's own bone and of its extra bones."""
    to_local = quat.conjugate(target.local_to_character.turn)
    turner = int(transfer.turner[i])
    relative = turns[:, i] if turner == NONE else quat.multiply(quat.conjugate(turns[:, turner]), turns[:, i])
    local = quat.multiply(quat.multiply(to_local, relative), quat.conjugate(to_local))
    axis = _axis(target, links, i)
    twist = quat.twist_about(local, axis)
    swing = quat.multiply(local, quat.conjugate(twist))
    part = quat.from_rotation_vector(quat.to_rotation_vector(twist) / (len(extra) + 1))
    rests = target.skeleton.rest_rotations[[int(links.target[i]), *extra]]
    own = _in_rest(quat.multiply(swing, part), rests[0])
    others = [_in_rest(part, rest) for rest in rests[1:]]
    return own, np.stack(others, axis=1)


def _in_rest(turn: Array, rest: Array) -> Array:
    return quat.multiply(quat.multiply(quat.conjugate(rest), turn), rest)
