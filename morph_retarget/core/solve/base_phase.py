"""Limbs that goals for turns have posed already, brought on to the goals for their places (Hecker 2008 §4.3).

Goals for turns make the pose from which the solver sets out. Where they turn all joints of a limb, as a clip does that
plays underneath, the limb sets out from there too: without a goal for its end it stays as it was posed, and to one it
goes the smallest way. Its bones keep the plane in which they lie, its end goes from where it was along an arc about
the limb's start, and what hangs on its bones goes along.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import quat, rotation
from ..arrays import Array
from . import closing, constraints, stretching
from .constraints import TINY
from .limb_phase import BENT, LEAN, STRAIGHT, Limbs
from .limb_settings import LimbSettings
from .plan import Wave
from .state import State, stacked, toward

SAME = 1e-9
"""Share of its distance by which a limb's end may be off without its bones leaning for it."""


@dataclass(frozen=True, eq=False)
class Base:
    """A limb, or a stem, as goals for turns have posed it."""

    limb: int
    """Its place in its wave."""
    place: tuple[slice, int, slice]
    """That of its joints among those of the wave, shape (frame, limb, joint)."""
    turns: Array
    """Of its joints, shape (frame, joint, 3, 3)."""
    bones: Array
    """From each joint to the next, the last one to the end [m], shape (frame, joint, 3)."""
    share: Array
    """How far the goals for turns count, that of the least one, shape (frame,)."""
    riders: dict[int, tuple[int, Array]]
    """Bodies with turns of their own that hang on its bones, as twist bones do: on which of its joints, and how they
    were turned, shape (frame or 1, 3, 3)."""


def of_wave(state: State, wave: Wave) -> tuple[Base, ...]:
    """Return those limbs of a wave that goals for turns pose, before the wave decides anything."""
    turned = state.plan.turned
    places = [i for i, limb in enumerate(wave.limbs) if all(joint in turned for joint in limb.joints)]
    if not places:
        return ()
    posed = state.supposing({})
    found = (_base(posed, wave, i) for i in places)
    return tuple(base for base in found if base.share.any())


def _base(posed: State, wave: Wave, i: int) -> Base:
    plan, limb, frames = posed.plan, wave.limbs[i], len(posed)
    share = posed.goals.rotation_influence[:, [plan.turned[joint] for joint in limb.joints]].min(axis=1)
    turns = stacked([posed.rotation(joint) for joint in limb.joints], frames)
    places = [posed.place(joint) for joint in limb.joints]
    if wave.stem is None:
        places.append(posed.place(limb.body))
    else:
        places.append(places[-1] + rotation.apply(turns[:, -1], wave.chains.segments[i, -1]))
    hanging = [body for body, joint in plan.riders.items() if joint in limb.joints]
    riders = {body: (limb.joints.index(plan.riders[body]), posed.rotation(body)) for body in hanging}
    place = (slice(None), i, slice(wave.chains.segments.shape[1] - len(limb.joints), None))
    return Base(i, place, turns, np.diff(stacked(places, frames), axis=1), share, riders)


def are_all(bases: Sequence[Base], wave: Wave) -> bool:
    """Return whether goals for turns pose all limbs of a wave in full, so that none comes from rest."""
    plain = wave.stem is None and wave.elastic is None and len(bases) == len(wave.limbs)
    return plain and all((base.share == 1.0).all() for base in bases)


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
        i, whole = base.limb, None
        if wave.stem is not None:
            # Several goals weigh against each other in it, so it goes over to what was found for them.
            came = _between(base.turns, turned[base.place], influence.max(axis=1))
        else:
            if full is not None and longer is not None:
                whole = full[base.place]
                longer[base.place] += base.share[:, None] * (_counted(whole, influence[:, i]) - longer[base.place])
            goal = rotation.apply(carried[:, i], ways[:, i])
            came = _brought(base, wave.chains, carried[:, i], goal, influence[:, i], whole)
        out[base.place] = _between(turned[base.place], came, base.share)
    return out, longer


def kept(bases: Sequence[Base], turned: Array, twisted: Array) -> Array:
    """Return joints, of which those of limbs that were posed do not twist, shape (frame, limb, joint, 3, 3)."""
    for base in bases:
        twisted[base.place] = _between(twisted[base.place], turned[base.place], base.share)
    return twisted


def _brought(base: Base, limbs: Limbs, carried: Array, goal: Array, influence: Array, factors: Array | None) -> Array:
    """Return how the joints of a limb turn on the way from where it was posed to a goal, shape (frame, joint, 3, 3).

    Args:
        base: The limb as it was posed.
        limbs: Of its wave.
        carried: How what carries it is turned, shape (frame, 3, 3).
        goal: From where it starts, character frame [m], shape (frame, 3).
        influence: How far the goal counts, shape (frame,).
        factors: By what factors its bones are longer at the goal, shape (frame, joint), None where none may be.
    """
    if not influence.any():
        return base.turns
    i, lengths, end = base.limb, quat.length(base.bones), base.bones.sum(axis=1)
    reach = _reachable(limbs.settings[i], base.bones, quat.length(goal), factors)
    chord, full = quat.length(end), lengths.sum(axis=-1)
    distance = chord + influence * (reach - chord)
    if factors is not None:
        lengths = lengths * _counted(factors, influence)
    line = _pointing(end, full, base.bones[:, 0])
    hint = rotation.apply(base.turns[:, 0], limbs.hints[i])
    shape = _leaning(base.bones, line, hint, 1.0 + (distance - chord) / np.maximum(chord, 0.1 * full + TINY))
    bent = closing.close(shape[:, None], lengths[:, None], line[:, None], distance[:, None])[:, 0]
    came = _pointing((lengths[..., None] * bent).sum(axis=1), full, line)
    aim = _aim(came, _pointing(goal, full, came), rotation.apply(carried, _ease(limbs, i)), influence)
    if limbs.swivels is not None:
        swivel = quat.from_axis_angle(rotation.apply(aim, came), influence * limbs.swivels[i])
        aim = np.matmul(quat.to_matrix(swivel), aim)
    turned = np.matmul(aim[:, None], np.matmul(rotation.between(_along(base.bones, line), bent), base.turns))
    return np.where((influence == 0.0)[:, None, None, None], base.turns, turned)


def _counted(factors: Array, influence: Array) -> Array:
    """Return by what factors bones are longer for goals that count in part, shape (frame, joint)."""
    return 1.0 + influence[:, None] * (factors - 1.0)


def _between(start: Array, end: Array, share: Array) -> Array:
    """Return joints part of the way from one pose to another, shape (frame, joint, 3, 3)."""
    return np.stack([toward(start[:, k], end[:, k], share) for k in range(start.shape[1])], axis=1)


def take_along(state: State, base: Base, turned: Array) -> None:
    """Turn what hangs on the bones of a limb along with these, shape (frame, joint, 3, 3)."""
    supposed = state.supposing({})
    for body, (k, posed) in base.riders.items():
        still = (turned[:, k] == base.turns[:, k]).all(axis=(1, 2))[:, None, None]
        along = np.matmul(np.matmul(turned[:, k], rotation.transposed(base.turns[:, k])), posed)
        alone = np.broadcast_to(supposed.rotation(body), along.shape)
        state.turn(body, toward(alone, np.where(still, posed, along), base.share))


# --- shapes ---


def _reachable(settings: LimbSettings, bones: Array, away: Array, factors: Array | None) -> Array:
    """Return how far the end comes to a goal that is some way off [m], shape (frame,); see `Limbs.reachable`."""
    lengths = quat.length(bones)
    full = lengths.sum(axis=-1)
    soft = np.maximum(settings.slow_down * full, quat.length(bones.sum(axis=1)))
    room = np.maximum(settings.full_reach * full - soft, 1e-9 * full + TINY)
    reached = np.minimum(away, soft) - room * np.expm1(-np.maximum(away - soft, 0.0) / room)
    if factors is None:
        return reached
    # What gets longer has slowed down before.
    longer = (factors * lengths).sum(axis=-1)
    return np.where(longer > full, np.minimum(away, settings.full_reach * longer), reached)


def _leaning(bones: Array, line: Array, hint: Array, scale: Array) -> Array:
    """Return directions of bones that can bend, shape (frame, joint, 3): straight ones lean as they get shorter.

    Args:
        bones: As they were posed [m], shape (frame, joint, 3).
        line: From start to end, unit vectors, shape (frame, 3).
        hint: Where the joints of a straight limb move when it bends, shape (frame, 3).
        scale: By what factor the end comes nearer, shape (frame,).
    """
    own, lengths = _along(bones, line), quat.length(bones)
    if own.shape[1] < 2:
        return own
    bend = np.arccos(np.clip(quat.dot(own[:, 1:], own[:, :-1]), -1.0, 1.0)).max(axis=-1)
    straight = 1.0 - constraints.smooth_step(bend, STRAIGHT, BENT)
    scale = np.where(np.abs(scale - 1.0) < SAME, 1.0, scale)
    size = LEAN * straight * np.sqrt(np.maximum(1.0 - scale * scale, 0.0))
    if not size.any():
        return own
    aside = quat.unit(hint - quat.dot(hint, line)[:, None] * line)
    other = quat.unit(quat.cross(line, np.eye(3)[np.argmin(np.abs(line), axis=-1)]))
    aside = np.where(aside.any(axis=-1, keepdims=True), aside, other)
    middle = (np.cumsum(lengths, axis=-1) - 0.5 * lengths) / np.maximum(lengths.sum(axis=-1), TINY)[:, None]
    return quat.unit(own + (size[:, None] * np.cos(np.pi * middle))[..., None] * aside[:, None])


def _along(bones: Array, line: Array) -> Array:
    """Return the directions of bones, that of the whole where one has no length."""
    own = quat.unit(bones)
    return np.where(own.any(axis=-1, keepdims=True), own, line[:, None])


def _aim(came: Array, wanted: Array, ease: Array, influence: Array) -> Array:
    """Return rotations that take limbs from where they point to where they shall, part of the way, (frame, 3, 3).

    They lead by where the limb is at ease. The smallest rotation would jump where an arm that hangs down reaches up.
    """
    whole = np.matmul(rotation.between(ease, wanted), rotation.between(came, ease))
    return toward(np.broadcast_to(rotation.IDENTITY, whole.shape), whole, influence)


def _ease(limbs: Limbs, i: int) -> Array:
    """Return where a limb points when it is at ease, in the frame of what carries it, shape (3,).

    That is half way from where it rests to where its end goes when it folds, in front of the body. Knees lead, and so
    legs fold to behind it: theirs is where they rest.
    """
    line, hint = limbs.lines[i], limbs.hints[i]
    if hint[1] < 0.0:
        return line
    return quat.unit(line - quat.unit(hint - quat.dot(hint, line) * line))


def _pointing(vectors: Array, full: Array, otherwise: Array) -> Array:
    """Return unit vectors, those of others where there is none, shape (frame, 3)."""
    return quat.unit(np.where((quat.length(vectors) > 1e-6 * full + TINY)[:, None], vectors, otherwise))
