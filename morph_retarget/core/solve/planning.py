"""Finding how goals are met on a character: composes a plan, which `posing` reads for each clip.

    hierarchy -> allotment of joints to goals -> trunk, waves of limbs -> plan

The trunk (spine, neck and head) is the business of the spine phase; all else that leads from the trunk to a goal is a
limb, solved after it, those that hang on other limbs last. A sub-tree without goals is carried along.
"""

from collections.abc import Collection, Iterator, Sequence, Set

import numpy as np

from ..arrays import Array, Indices
from ..character.character import Character
from ..errors import RigError, listed
from .allotment import Allotment, Asked, allot
from .hierarchy import Hierarchy
from .limit_phase import Limited
from .limits import JointLimits
from .plan import Plan, Trunk, Wave
from .settings import DEFAULT, SolverSettings
from .trunk_planning import nudge_of, trunk_of
from .wave_planning import waves_of


def prepare(
    character: Character,
    rest: Array,
    root: int,
    wanted: Sequence[tuple[int, bool, bool]],
    settings: SolverSettings = DEFAULT,
    limits: JointLimits | None = None,
    fixed: Collection[int] = (),
) -> Plan:
    """Return how goals for some bodies are met.

    Args:
        character: What the rig is.
        rest: Rest positions of all bodies [m], character frame, shape (body, 3).
        root: The body that carries all others.
        wanted: For each goal its body, and whether it has a place and a rotation.
        settings: Of the solver.
        limits: Of all bodies, shapes (body, 3); None when nothing limits them.
        fixed: Bodies whose joints cannot move off where their parents hold them, whatever may stretch.

    Raises:
        RigError: A limb has settings that is none of the character.
    """
    skeleton, hierarchy = character.skeleton, Hierarchy(character, rest, root, frozenset(fixed))
    unknown = [name for name in settings.limbs if name not in skeleton.index]
    if unknown:
        ends = listed(skeleton.names[body] for body, position, _ in wanted if position)
        raise RigError(f"solver settings are for {unknown[0]!r}, which is no bone: choose the end of a limb, as {ends}")
    allotment = allot(Asked.of(hierarchy, wanted, settings.bends_spine))
    trunk = trunk_of(allotment, settings, fixed)
    waves = tuple(waves_of(allotment, settings, limits, fixed))
    level = {limb.body: limb.goal for limb in allotment.limbs if hierarchy.is_foot(limb.body)}
    pulled = tuple(dict.fromkeys(_pulled(trunk, waves)))
    driven = _driven(allotment, trunk, {*level, *pulled})
    tree, turned = hierarchy.tree, allotment.turned
    means = tuple((body, goals) for body, goals in turned.items() if len(goals) > 1)
    place_of = {body: len(wanted) + i for i, (body, _) in enumerate(means)}
    moving = driven | hierarchy.loose | {*tree.roots}
    order = tree.order
    leading = tuple(body for body in order if body in moving)
    return Plan(
        tree.parents,
        rest,
        root,
        trunk,
        waves,
        {body: place_of.get(body, goals[0]) for body, goals in turned.items()},
        level,
        _leaders(hierarchy, moving),
        leading,
        tuple(body for body in order if body in driven or body in hierarchy.loose),
        allotment.unreachable,
        settings,
        nudge_of(allotment, settings),
        None if limits is None else Limited.of(limits, hierarchy.axes, leading),
        tuple(dict.fromkeys((*pulled, *hierarchy.detached))),
        tuple(dict.fromkeys(_stiff(trunk, waves, fixed))) if settings.allows_stretch else (),
        hierarchy.detached,
        means,
    )


# --- what turns ---


def _driven(allotment: Allotment, trunk: Trunk | None, others: Set[int]) -> Set[int]:
    """Return the bodies that goals turn, with ``others`` of which that is known."""
    ends = {limb.body for limb in allotment.limbs}
    bent = trunk.joints if trunk is not None else ()
    return others | {allotment.hierarchy.root, *allotment.turned, *allotment.joints, *bent, *ends}


def _leaders(hierarchy: Hierarchy, moving: Set[int]) -> Indices:
    """Return for each body the nearest one upward (itself included) that turns by itself, shape (body,)."""
    tree, out = hierarchy.tree, np.empty(len(hierarchy.rest), dtype=np.intp)
    for body in tree.order:
        out[body] = body if body in moving else out[tree.parents[body]]
    return out


# --- what stretches ---


def _pulled(trunk: Trunk | None, waves: Sequence[Wave]) -> Iterator[int]:
    """Yield the bodies whose joints move off where they are held when bones stretch."""
    for wave in waves:
        if wave.elastic is not None:
            yield from (link.end for link in wave.elastic.links)
    if trunk is not None:
        yield from trunk.drawn


def _stiff(trunk: Trunk | None, waves: Sequence[Wave], fixed: Collection[int]) -> Iterator[int]:
    """Yield the bodies that keep limbs or pieces of the spine from stretching: they are at the ends of their bones."""
    if trunk is not None:
        yield from (body for body in trunk.ends if body in fixed)
    for wave in waves:
        for i, limb in enumerate(wave.limbs):
            yield from (body for body in (*limb.joints[1:], *wave.ends[i : i + 1]) if body in fixed)
