"""Judging an action on a character in the open file: what is played is what would be baked, and nothing is keyed."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np

from ...core.arrays import Flags
from ...core.errors import MorphError
from ...core.ground import Ground
from ...core.locomotion.stepping.gait import Gait
from ...core.morph import branch
from ...core.validation import drawing
from ...core.validation.cell import Cell
from ...core.verdicts.judging import DEFAULT, Limits, judge
from ...core.verdicts.performance import Performance
from ...core.verdicts.played import performance_of
from .. import actions, retarget, rig
from ..locomotion import going
from ..locomotion.properties import Source
from ..morph import analyses, bake, cast, choice, clip, definitions, keys
from ..morph.bake import Take
from ..morph.member import Member
from ..morph.properties import of_action
from ..properties import of_rig
from ..sampling import seconds_per_frame
from . import standins


@dataclass(frozen=True)
class Options:
    """How cells are played and judged."""

    limits: Limits = field(default=DEFAULT)
    frames: tuple[int, int] | None = None
    """First and last frame of the action; all of it when None."""
    rate: float = 1.0
    """Frames of the action for each frame of the scene."""
    variant: int | None = None
    """Which of the ways to play; None for the one whose bodies are nearest to their targets, the first without any."""
    stand_ins: bool = True
    """Whether something stands in for external targets that are missing."""
    draws: bool = True
    """Whether cells keep how they look."""


def judged(
    ob: bpy.types.Object,
    action: bpy.types.Action,
    options: Options,
    names: tuple[str, str] | None = None,
    among: Sequence[bpy.types.Action] = (),
) -> Cell:
    """Play a generalized action on a character and judge it; what goes wrong is told in the cell.

    Args:
        ob: An armature, which plays what it played before afterwards.
        action: The action.
        options: How.
        names: What the cell calls action and character; by their own names when None.
        among: All actions of the grid: of those that are branches of one movement, a character plays the first that is
            for it, and the others do not apply.
    """
    start = time.perf_counter()
    named = names or (action.name, ob.name)
    before, variant = actions.assigned(ob), of_rig(ob).variant
    try:
        played = _branch_for(ob, action, among)
        if played != action:
            return Cell(*named, problems=(f"the character plays {played.name!r} of the same movement",), applies=False)
        taken = _taken(ob, action, options)
        binding = taken.member.part.binding
        if not binding.entries and binding.action.channels:
            return Cell(*named, problems=taken.warnings, applies=False)
        performance = performance_of_take(taken)
        verdicts = judge(performance, options.limits)
    except MorphError as error:
        return Cell(*named, error=str(error), seconds=time.perf_counter() - start)
    finally:
        actions.assign(ob, *before)
        of_rig(ob).variant = variant
        cast.forget(ob)
    wrong = {v.found.row for v in verdicts.values() if not v.passed and v.found.row is not None}
    return Cell(
        *named,
        verdicts,
        taken.warnings,
        first=float(taken.clip.frames[0]),
        frames=len(taken.clip.frames),
        variant=binding.variant,
        variants=len(binding.variants),
        seconds=time.perf_counter() - start,
        strip=drawing.strip_of(performance, wrong) if options.draws else None,
    )


def _branch_for(ob: bpy.types.Object, action: bpy.types.Action, among: Sequence[bpy.types.Action]) -> bpy.types.Action:
    """Return what a character plays of the movement that an action is a branch of: the first branch that is for it."""
    movement = of_action(action).movement
    found = sorted((other for other in among if movement and of_action(other).movement == movement), key=_name)
    place = branch.choose([definitions.read(other).branch for other in found], analyses.of(ob)[2])
    return action if place is None else found[place]


def _name(action: bpy.types.Action) -> str:
    return action.name


def _taken(ob: bpy.types.Object, action: bpy.types.Action, options: Options) -> Take:
    cast.add(ob, action)
    member = cast.member(ob)
    if options.stand_ins and standins.give(member):
        member = cast.member(ob)
    of_rig(ob).variant = options.variant or 0
    if options.variant is None and _varies_by_target(member):
        of_rig(ob).variant = choice.nearest_variant(member, ob, bpy.context.evaluated_depsgraph_get())
    cast.forget(ob)
    frames = options.frames or clip.keyed_range(ob, action)
    return retarget.run(bake.take(ob, rig.scene_of(), bake.Options(frames, rate=options.rate)))


def _varies_by_target(member: Member) -> bool:
    channels = member.definition.channels
    aimed = any(channels[e.channel].has_target for e in member.binding.entries if e.position or e.rotation)
    return aimed and len(member.binding.variants) > 1


def performance_of_take(taken: Take) -> Performance:
    """Return what a character plays, to be judged."""
    seconds = seconds_per_frame(rig.scene_of())
    return performance_of(taken.member.character, taken.played, seconds, _standing(taken), _ground(taken))


def _standing(taken: Take) -> Flags | None:
    """Return when feet stand as the gait has it, None without one, or where it does not count in full."""
    walk, frames = taken.walk, taken.clip.frames
    if walk is None or not isinstance(walk.walk.gait, Gait):
        return None
    gait, member = walk.walk.gait, taken.member
    standing = gait.contacts(walk.walk.clock.times(frames))
    posed = {entry.body for entry in member.binding.entries if entry.position}
    goals = taken.played.goals
    place = {int(body): i for i, body in enumerate(goals.bodies)}
    for i, leg in enumerate(gait.legs.legs):
        goal = place.get(leg.foot)
        if leg.foot in posed or goal is None:
            standing[:, i] = False
        else:
            standing[:, i] &= goals.position_influence[:, goal] >= 0.99
    return standing


def _ground(taken: Take) -> Ground | None:
    """Return how high the ground is on which a character goes, None for one that is level."""
    member, walk = taken.member, taken.walk
    if walk is None:
        return None
    ob = member.rig.object
    own = of_rig(ob).gait
    if walk.walk.is_carried or (own.ground is None and own.source == Source.PATH):
        return _nowhere
    if own.ground is None:
        return None
    graph = bpy.context.evaluated_depsgraph_get()
    where = going.read(ob, member.character, keys.curves(member.action), walk.walk.clock, graph)
    return where.ground(member.character.frame.height)


def _nowhere(points: np.ndarray) -> np.ndarray:
    """Return that nobody knows how high the ground is."""
    return np.full(len(points), np.nan)


def judged_all(
    obs: Sequence[bpy.types.Object], among: Sequence[bpy.types.Action], options: Options | None = None
) -> list[Cell]:
    """Judge all of some actions on all of some characters of the open file; for scripts.

    Args:
        obs: Armatures.
        among: Generalized actions.
        options: How.
    """
    return [judged(ob, action, options or Options(), among=among) for ob in obs for action in among]
