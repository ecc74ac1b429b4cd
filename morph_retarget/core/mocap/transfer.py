"""Transferring joint rotations (Feng 2013 §4.1 eqs 1 and 2, §5.1): two products a joint, all frames in one batch.

With the alignment of source and target, the paper's rotations before and after, ``q_pre`` and ``q_post``, are computed
once for a pair of bodies; then ``q_target = q_pre * q * q_post`` for every frame, where ``q`` is the source joint's
turn relative to the joint that carries it.
"""

from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array, Flags, Indices
from ..character.frame import Placement
from ..skeleton import Skeleton
from .alignment import Alignment
from .links import NONE, Links


@dataclass(frozen=True, eq=False)
class Transfer:
    """What is prepared once for a pair of bodies."""

    links: Links
    carrier: Indices
    """The link that carries each link in the target's own tree, NONE where nothing linked does, shape (link,)."""
    turner: Indices
    """The link whose turn each link's bone inherits: its carrier, NONE where a bone on the way inherits no rotation,
    shape (link,)."""
    post: Array
    """``target turn = source turn * post`` in the character frame, shape (link, 4)."""
    q_pre: Array
    """Feng 2013 §5.1, into the target bone's own rest frame, shape (link, 4)."""
    q_post: Array
    """Feng 2013 §5.1, shape (link, 4)."""
    rest_in_character: Array
    """Rest orientation of each target bone, taken to the character frame, shape (link, 4)."""


def prepare(links: Links, alignment: Alignment, target: Skeleton, local_to_character: Placement) -> Transfer:
    """Return the transfer for a pair of bodies.

    Args:
        links: Of the pair.
        alignment: Of the pair.
        target: The target's skeleton.
        local_to_character: From the target's armature space to its character frame.
    """
    carrier = carriers(links, target)
    turner = np.where(_inherits(links, target, carrier), carrier, NONE)
    post = alignment.post
    above = np.where((turner == NONE)[:, None], quat.IDENTITY, post[turner])
    rest = quat.multiply(local_to_character.turn, target.rest_rotations[links.target])
    q_pre = quat.multiply(quat.conjugate(rest), quat.conjugate(above))
    return Transfer(links, carrier, turner, post, q_pre, quat.multiply(post, rest), rest)


def carriers(links: Links, target: Skeleton) -> Indices:
    """Return the nearest linked ancestor of each link in the target's tree, NONE without one, shape (link,)."""
    link_of = {int(bone): i for i, bone in enumerate(links.target)}
    found = [next((link_of[b] for b in target.tree.ancestors[int(t)] if b in link_of), NONE) for t in links.target]
    return np.array(found, dtype=np.intp)


def _inherits(links: Links, target: Skeleton, carrier: Indices) -> Flags:
    """Return whether each link's bone takes over the rotation of its carrier, shape (link,)."""
    if target.inherits is None:
        return carrier != NONE
    out = carrier != NONE
    for i in np.flatnonzero(out):
        bone, top = int(links.target[i]), int(links.target[carrier[i]])
        line = [bone, *target.tree.ancestors[bone]]
        out[i] = target.inherits[line[: line.index(top)]].all()
    return out


def relative(turns: Array, carrier: Indices, links: Indices) -> Array:
    """Return the turns of some links relative to what carries them, shape (frame, n, 4).

    Args:
        turns: Of all links, shape (frame, link, 4).
        carrier: The link that carries each link, NONE for those that nothing carries, shape (link,).
        links: The links wanted, shape (n,).
    """
    own, above = turns[:, links], carrier[links]
    out = quat.multiply(quat.conjugate(turns[:, above]), own)
    free = np.flatnonzero(above == NONE)
    out[:, free] = own[:, free]
    return out


def apply(transfer: Transfer, source_turns: Array, links: Indices) -> Array:
    """Return the basis rotations of some target bones, eqs 1 and 2, shape (frame, n, 4).

    Args:
        transfer: Of the pair.
        source_turns: Turn of each link from the source's rest, character frame, shape (frame, link, 4).
        links: The links wanted, shape (n,).
    """
    q = relative(source_turns, transfer.turner, links)
    return quat.multiply(quat.multiply(transfer.q_pre[links], q), transfer.q_post[links])


def target_turns(transfer: Transfer, source_turns: Array) -> Array:
    """Return the turn of each target bone from its rest in the character frame, shape (frame, link, 4)."""
    return quat.multiply(source_turns, transfer.post)


def basis_from_turns(transfer: Transfer, turns: Array, links: Indices) -> Array:
    """Return the basis rotations of some target bones from turns that were changed after the transfer.

    Args:
        transfer: Of the pair.
        turns: Of all links, character frame, shape (frame, link, 4).
        links: The links wanted, shape (n,).

    Returns:
        Shape (frame, n, 4).
    """
    own = relative(turns, transfer.turner, links)
    rest = transfer.rest_in_character[links]
    return quat.multiply(quat.multiply(quat.conjugate(rest), own), rest)
