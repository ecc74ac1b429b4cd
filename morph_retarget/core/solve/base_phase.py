"""Limbs that goals for turns have posed already, brought on to the goals for their places (Hecker 2008 §4.3).

Goals for turns make the pose from which the solver sets out. Where they turn all joints of a limb, as a clip does that
plays underneath, the limb sets out from there too: without a goal for its end it stays as it was posed, and to one it
goes the smallest way. Its bones keep the plane in which they lie, its end goes from where it was along an arc about
the limb's start, and what hangs on its bones goes along.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Indices
from . import closing, constraints, stretching
from .constraints import TINY
from .limb_phase import BENT, LEAN, STRAIGHT, Limbs
from .plan import Wave
from .state import State, stacked, toward

SAME = 1e-9
"""Share of its distance by which a limb's end may be off without its bones leaning for it."""


@dataclass(frozen=True, eq=False)
class Base:
    """Limbs of as many joints, or a stem, as goals for turns have posed them."""

    limbs: Indices
    """Their places in their wave, shape (limb,)."""
    turns: Array
    """Of their joints, shape (frame, limb, joint, 3, 3)."""
    bones: Array
    """From each joint to the next, the last one to the end [m], shape (frame, limb, joint, 3)."""
    share: Array
    """How far the goals for turns count, that of the least one of each limb, shape (frame, limb)."""
    riders: Sequence[tuple[int, int, int, Array]]
    """Bodies with turns of their own that hang on their bones, as twist bones do: on which limb, on which of its
    joints, and how they were turned, shape (frame or 1, 3, 3)."""

    @property
    def place(self) -> tuple[slice, Indices, slice]:
        """That of the joints among those of the wave, shape (frame, limb, joint)."""
        return slice(None), self.limbs, slice(-self.bones.shape[2], None)

    def at(self, own: Indices) -> "Base":
        """Return some of the limbs."""
        if len(own) == len(self.limbs):
            return self
        return replace(
            self, limbs=self.limbs[own], turns=self.turns[:, own], bones=self.bones[:, own], share=self.share[:, own]
        )


def of_wave(state: State, wave: Wave) -> tuple[Base, ...]:
    """Return those limbs of a wave that goals for turns pose, before the wave decides anything."""
    alike = state.plan.posed[wave]
    if not alike:
        return ()
    posed = state.supposing({})
    found = (_base(posed, wave, limbs) for limbs in alike)
    return tuple(base for base in found if base.share.any())


def _base(posed: State, wave: Wave, limbs: Sequence[int]) -> Base:
    plan, frames, joints = posed.plan, len(posed), [wave.limbs[i].joints for i in limbs]
    counts = posed.goals.rotation_influence[:, [[plan.turned[joint] for joint in line] for line in joints]]
    turns = stacked([posed.rotation(joint) for line in joints for joint in line], frames)
    turns = turns.reshape(frames, *counts.shape[1:], 3, 3)
    starts = stacked([posed.place(joint) for line in joints for joint in line], frames)
    starts = starts.reshape(frames, *counts.shape[1:], 3)
    if wave.stem is None:
        ends = stacked([posed.place(wave.limbs[i].body) for i in limbs], frames)
    else:
        ends = starts[:, :, -1] + rotation.apply(turns[:, :, -1], wave.chains.segments[:, -1])
    bones = np.concatenate([starts[:, :, 1:], ends[:, :, None]], axis=2) - starts
    where = {joint: (i, k) for i, line in enumerate(joints) for k, joint in enumerate(line)}
    riders = [(body, *where[joint], posed.rotation(body)) for body, joint in plan.riders.items() if joint in where]
    return Base(np.array(limbs, dtype=np.intp), turns, bones, counts.min(axis=2), riders)


def are_whole(bases: Sequence[Base], wave: Wave) -> bool:
    """Return whether goals for turns pose these limbs of a wave in full: how they come from rest is no matter then."""
    return wave.stem is None and all((base.share == 1.0).all() for base in bases)


def are_all(bases: Sequence[Base], wave: Wave) -> bool:
    """Return whether these are all limbs of a wave, and none of its bones may stretch."""
    return wave.elastic is None and sum(len(base.limbs) for base in bases) == len(wave.limbs)


# --- toward goals ---


def brought(
    bases: Sequence[Base],
    wave: Wave,
    carried: Array,
    ways: Array,
    influence: Array,
    turned: Array,
    factors: Array | None,
) -> tuple[Array, Array | None]:
    """Return how joints turn as limbs go from where they were posed to their goals, and by what factors bones grow.

    Args:
        bases: The limbs as they were posed.
        wave: Theirs; its other limbs stay as they are.
        carried: How what carries each limb of the wave is turned, shape (frame, limb, 3, 3).
        ways: From where they start to their goals, in the frames of that [m], shape (frame, goal, 3).
        influence: How far the goals count, shape (frame, goal).
        turned: How joints turn when limbs come from rest, shape (frame, limb, joint, 3, 3) …
        factors: … and by what factors bones are longer then, shape (frame, limb, joint), None when none may be.
    """
    out, longer, full = turned.copy(), factors, None
    if factors is not None and wave.stem is None and wave.elastic is not None:
        longer, full = factors.copy(), stretching.solve(wave.elastic, ways, influence)[1]
    for base in bases:
        if wave.stem is not None:
            # Several goals weigh against each other in it, so it goes over to what was found for them.
            came = toward(base.turns, turned[base.place], influence.max(axis=1)[:, None, None])
        else:
            whole, counts = None, influence.take(base.limbs, axis=1)
            if full is not None and longer is not None:
                whole = full[base.place]
                longer[base.place] += base.share[..., None] * (_counted(whole, counts) - longer[base.place])
            came, own = base.turns.copy(), np.flatnonzero(counts.any(axis=0))
            if len(own):  # the others stay as they were posed
                some, grown = base.at(own), None if whole is None else whole[:, own]
                start, way = carried.take(some.limbs, axis=1), ways.take(some.limbs, axis=1)
                came[:, own] = _brought(some, wave.chains, start, way, counts[:, own], grown)
        out[base.place] = toward(turned[base.place], came, base.share[..., None])
    return out, longer


def kept(bases: Sequence[Base], turned: Array, twisted: Array) -> Array:
    """Return joints, of which those of limbs that were posed do not twist, shape (frame, limb, joint, 3, 3)."""
    for base in bases:
        twisted[base.place] = toward(twisted[base.place], turned[base.place], base.share[..., None])
    return twisted


def _brought(base: Base, limbs: Limbs, carried: Array, ways: Array, influence: Array, factors: Array | None) -> Array:
    """Return how joints turn as limbs go from where they were posed to goals, shape (frame, limb, joint, 3, 3).

    Args:
        base: The limbs as they were posed.
        limbs: All of their wave.
        carried: How what carries them is turned, shape (frame, limb, 3, 3).
        ways: From where they start to their goals, in the frames of that [m], shape (frame, limb, 3).
        influence: How far the goals count, shape (frame, limb).
        factors: By what factors their bones are longer at the goals, shape (frame, limb, joint), None where none is.
    """
    own, lengths, end = base.limbs, quat.length(base.bones), base.bones.sum(axis=2)
    goal = rotation.apply(carried, ways)
    chord, full = quat.length(end), lengths.sum(axis=-1)
    reach = _reachable(limbs.limits[:, own], lengths, chord, quat.length(goal), factors)
    distance = chord + influence * (reach - chord)
    line = _pointing(end, full, base.bones[:, :, 0])
    along = _along(base.bones, line)
    hint = rotation.apply(base.turns[:, :, 0], limbs.hints[own])
    scale = 1.0 + (distance - chord) / np.maximum(chord, 0.1 * full + TINY)
    shape = _leaning(along, lengths, line, hint, scale)
    if factors is not None:
        lengths = lengths * _counted(factors, influence)
    bent = closing.close(shape, lengths, line, distance)
    came = _pointing((lengths[..., None] * bent).sum(axis=2), full, line)
    aim = _aim(came, _pointing(goal, full, came), rotation.apply(carried, limbs.ease[own]), influence)
    if limbs.swivels is not None:
        aim = np.matmul(rotation.about(rotation.apply(aim, came), influence * limbs.swivels[own]), aim)
    turned = np.matmul(aim[:, :, None], np.matmul(rotation.between(along, bent), base.turns))
    return np.where((influence == 0.0)[..., None, None, None], base.turns, turned)


def _counted(factors: Array, influence: Array) -> Array:
    """Return by what factors bones are longer for goals that count in part, shape (frame, limb, joint)."""
    return 1.0 + influence[..., None] * (factors - 1.0)


def take_along(state: State, base: Base, turned: Array) -> None:
    """Turn what hangs on the bones of limbs along with these, shape (frame, limb, joint, 3, 3)."""
    supposed = state.supposing({})
    for body, limb, k, posed in base.riders:
        now, was = turned[:, limb, k], base.turns[:, limb, k]
        still = (now == was).all(axis=(1, 2))[:, None, None]
        along = np.matmul(np.matmul(now, rotation.transposed(was)), posed)
        alone = np.broadcast_to(supposed.rotation(body), along.shape)
        state.turn(body, toward(alone, np.where(still, posed, along), base.share[:, limb]))


# --- shapes ---


def _reachable(limits: Array, lengths: Array, chord: Array, away: Array, factors: Array | None) -> Array:
    """Return how far ends come to goals [m], shape (frame, limb); see `Limbs.reachable`.

    Args:
        limits: See `Limbs.limits`.
        lengths: Of the bones [m], shape (frame, limb, joint).
        chord: From start to end as limbs were posed [m], shape (frame, limb).
        away: How far off the goals are [m], shape (frame, limb).
        factors: See `_brought`.
    """
    full, (slow_down, full_reach) = lengths.sum(axis=-1), limits
    soft = np.maximum(slow_down * full, chord)
    room = np.maximum(full_reach * full - soft, 1e-9 * full + TINY)
    reached = np.minimum(away, soft) - room * np.expm1(-np.maximum(away - soft, 0.0) / room)
    if factors is None:
        return reached
    # What gets longer has slowed down before.
    longer = (factors * lengths).sum(axis=-1)
    return np.where(longer > full, np.minimum(away, full_reach * longer), reached)


def _leaning(own: Array, lengths: Array, line: Array, hint: Array, scale: Array) -> Array:
    """Return directions of bones that can bend, shape (frame, limb, joint, 3): straight ones lean as they get shorter.

    Args:
        own: Directions of the bones as they were posed, unit vectors, shape (frame, limb, joint, 3).
        lengths: Of the bones [m], shape (frame, limb, joint).
        line: From start to end, unit vectors, shape (frame, limb, 3).
        hint: Where the joints of a straight limb move when it bends, shape (frame, limb, 3).
        scale: By what factor the end comes nearer, shape (frame, limb).
    """
    if own.shape[2] < 2:
        return own
    bend = np.arccos(np.clip(quat.dot(own[:, :, 1:], own[:, :, :-1]), -1.0, 1.0)).max(axis=-1)
    straight = 1.0 - constraints.smooth_step(bend, STRAIGHT, BENT)
    scale = np.where(np.abs(scale - 1.0) < SAME, 1.0, scale)
    size = LEAN * straight * np.sqrt(np.maximum(1.0 - scale * scale, 0.0))
    if not size.any():
        return own
    aside = quat.unit(hint - quat.dot(hint, line)[..., None] * line)
    other = quat.unit(quat.cross(line, np.eye(3)[np.argmin(np.abs(line), axis=-1)]))
    aside = np.where(aside.any(axis=-1, keepdims=True), aside, other)
    middle = (np.cumsum(lengths, axis=-1) - 0.5 * lengths) / np.maximum(lengths.sum(axis=-1), TINY)[..., None]
    return quat.unit(own + (size[..., None] * np.cos(np.pi * middle))[..., None] * aside[:, :, None])


def _along(bones: Array, line: Array) -> Array:
    """Return the directions of bones, that of the whole where one has no length."""
    own = quat.unit(bones)
    return np.where(own.any(axis=-1, keepdims=True), own, line[:, :, None])


def _aim(came: Array, wanted: Array, ease: Array, influence: Array) -> Array:
    """Return rotations that take limbs from where they point to where they shall, part of the way, (frame, limb, 3, 3).

    They lead by where the limb is at ease. The smallest rotation would jump where an arm that hangs down reaches up.
    """
    whole = np.matmul(rotation.between(ease, wanted), rotation.between(came, ease))
    return toward(np.broadcast_to(rotation.IDENTITY, whole.shape), whole, influence)


def _pointing(vectors: Array, full: Array, otherwise: Array) -> Array:
    """Return unit vectors, those of others where there is none, shape (frame, limb, 3)."""
    return quat.unit(np.where((quat.length(vectors) > 1e-6 * full + TINY)[..., None], vectors, otherwise))
