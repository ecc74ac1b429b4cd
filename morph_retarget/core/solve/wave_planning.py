"""The limbs' part of a plan: waves of limbs that are solved at the same time, those that hang on others after these."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from ..character.morphology import LimbKind
from .allotment import Allotment, Shared
from .branching import Stem
from .capsules import Capsules
from .collision import Obstacles
from .hierarchy import Hierarchy
from .limb_phase import Limbs
from .limit_phase import LimitedLimbs
from .limits import JointLimits
from .plan import Limb, Wave
from .settings import SolverSettings
from .stretching import Elastic

HINTS = {
    LimbKind.LEG: np.array([0.0, -1.0, 0.2]),
    LimbKind.ARM: np.array([0.0, 1.0, -0.3]),
    LimbKind.WING: np.array([0.0, 1.0, 0.3]),
    LimbKind.FIN: np.array([0.0, 1.0, 0.0]),
    LimbKind.TENTACLE: np.array([0.0, 0.0, 1.0]),
}
"""Where the middle of a straight limb moves when it bends: knees forward, elbows back, the rest up."""
_HINT = np.array([0.0, 1.0, 0.3])
"""The same of necks, tails and what else is no limb of the character."""


@dataclass(frozen=True)
class _Round:
    """Limbs and stems that hang on nothing that is still to be solved."""

    limbs: list[Limb]
    stems: list[Shared]
    left: set[int]
    """Bodies of these, and of those that are solved after them."""


def waves_of(
    allotment: Allotment, settings: SolverSettings, limits: JointLimits | None, fixed: Collection[int]
) -> Iterator[Wave]:
    """Yield limbs, and stems that limbs share, in the order in which they are solved.

    Args:
        allotment: Of the goals.
        settings: Of the solver.
        limits: Of all bodies, shapes (body, 3); None when nothing limits them.
        fixed: Bodies whose joints cannot move off where their parents hold them.
    """
    hierarchy, capsules = allotment.hierarchy, None
    if settings.avoids_collisions and allotment.limbs:
        capsules = Capsules.of(hierarchy.character, hierarchy.rest, settings.radii)
    for now in _rounds(allotment):
        if now.limbs:
            wave = _constrained(_wave(hierarchy, now.limbs, settings), hierarchy, settings, limits, fixed)
            yield wave if capsules is None else _clear_of(capsules, wave, hierarchy, now.left, settings)
        for stem in now.stems:
            yield _constrained(_stem(allotment, stem, settings), hierarchy, settings, limits, fixed)


def _rounds(allotment: Allotment) -> Iterator[_Round]:
    """Yield what can be solved next, until all is."""
    limbs, stems, ancestors = list(allotment.limbs), [*allotment.stems, *allotment.heads], allotment.hierarchy.ancestors
    while limbs or stems:
        left = {body for limb in limbs for body in (*limb.joints, limb.body)}
        left |= {joint for stem in stems for joint in stem.joints}
        ready = [limb for limb in limbs if left.isdisjoint(ancestors[limb.joints[0]])]
        shared = [stem for stem in stems if left.isdisjoint(ancestors[stem.joints[0]])]
        yield _Round(ready, shared, left)
        limbs = [limb for limb in limbs if limb not in ready]
        stems = [stem for stem in stems if stem not in shared]


# --- one wave ---


def _wave(hierarchy: Hierarchy, limbs: Sequence[Limb], settings: SolverSettings) -> Wave:
    """Return limbs that share nothing."""
    bodies = [limb.body for limb in limbs]
    chains = Limbs.of(
        [hierarchy.rest[[*limb.joints, limb.body]] for limb in limbs],
        [_hint(hierarchy, body) for body in bodies],
        [settings.of_limb(hierarchy.names[body]) for body in bodies],
        [_side(hierarchy, body) for body in bodies],
    )
    return Wave(tuple(limbs), chains, np.array([limb.goal for limb in limbs], dtype=np.intp))


def _stem(allotment: Allotment, shared: Shared, settings: SolverSettings) -> Wave:
    """Return what some goals share of a limb, or all of it: one limb to the middle of the bodies that have them."""
    hierarchy, joints, bodies = allotment.hierarchy, shared.joints, shared.bodies
    names, last = hierarchy.names, joints[-1]
    paths = {limb.body: limb.path for limb in allotment.limbs}
    beyond = [paths[body][paths[body].index(last) + 1 :] if body in paths else () for body in bodies]
    points, tips = hierarchy.rest[list(joints)], hierarchy.rest[list(bodies)]
    # What has a goal of its own, such as a hand, has its settings for the limb that leads to it.
    own = settings if last in allotment.asked.posed else settings.of_limb(names[last])
    line = np.vstack([points, tips.mean(axis=0)])
    chain = Limbs.of([line], [_hint(hierarchy, bodies[0])], [own], [_side(hierarchy, last)])
    lengths = [hierarchy.lengths(path, body) for path, body in zip(beyond, bodies, strict=True)]
    slow_down = [settings.of_limb(names[body]).slow_down for body in bodies]
    first = [path[0] if path else body for path, body in zip(beyond, bodies, strict=True)]
    stem = Stem.of(points, hierarchy.rest[first], tips, lengths, slow_down, chain)
    goals = [place.goal for body in bodies for place in allotment.asked.places if place.body == body]
    rigid = tuple(body for body in bodies if body not in paths)
    return Wave((Limb(goals[0], first[0], joints),), chain, np.array(goals, dtype=np.intp), stem, rigid)


def _hint(hierarchy: Hierarchy, body: int) -> Array:
    """Return where the middle of a straight limb moves when it bends."""
    limb = hierarchy.limb_of(body)
    return _HINT if limb is None else HINTS[limb.kind]


def _side(hierarchy: Hierarchy, body: int) -> int:
    """Return +1 for what ends a limb on the left, -1 on the right, and 0 in the middle."""
    limb = hierarchy.limb_of(body)
    return 0 if limb is None else limb.side


# --- what holds it ---


def _constrained(
    wave: Wave, hierarchy: Hierarchy, settings: SolverSettings, limits: JointLimits | None, fixed: Collection[int]
) -> Wave:
    """Return a wave with limits of its joints, and with what may stretch."""
    joints, limited, elastic = [limb.joints for limb in wave.limbs], None, None
    if limits is not None:
        limited = LimitedLimbs.of(limits, hierarchy.axes, joints, wave.chains.segments)
    if settings.allows_stretch:
        elastic = Elastic.of(wave.chains, joints, wave.ends, fixed, settings)
    return replace(wave, limited=limited, elastic=elastic)


def _clear_of(
    capsules: Capsules, wave: Wave, hierarchy: Hierarchy, left: Collection[int], settings: SolverSettings
) -> Wave:
    """Return a wave that keeps out of what does not move any more when it is solved."""
    moved = {*left} - hierarchy.trunk
    still = [i for i, body in enumerate(capsules.carriers) if moved.isdisjoint((body, *hierarchy.ancestors[body]))]
    joints, bones = [limb.joints for limb in wave.limbs], {b for m in hierarchy.character.limbs for b in m.bones}
    radii = [[capsules.radius_of.get(j, 0.0) if j in bones else 0.0 for j in line] for line in joints]
    segments, around = wave.chains.segments, capsules.take(still)
    return replace(wave, obstacles=Obstacles.of(joints, segments, hierarchy.rest, around, radii, settings))
