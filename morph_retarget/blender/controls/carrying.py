"""Motion for deform bones as channels of the controls that pose them."""

from collections.abc import Collection, Generator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import bpy
import numpy as np

from ...core.arrays import Array, Indices
from ...core.character.control_limbs import Setting
from ...core.character.control_names import Limb
from ...core.character.controls import FOUND, Controls, Wanted, read
from ...core.errors import RigError
from ...core.mocap import carrying
from ...core.mocap.carrying import Handle, Handling, Seen, Values
from ...core.mocap.links import NONE, LimbLinks, Links
from ...core.mocap.measure import Spread, direction_errors
from ...core.mocap.motion import Motion
from ...core.mocap.root_motion import RootMotion
from ...core.pipeline import Result
from .. import actions, channels
from ..channels import Channel
from ..rig import pose_bone
from ..steps import run, within
from . import evaluating, reading, telling
from .evaluating import Stage
from .task import Carried, Onto, Task, Times, Work

PASSES = 8
"""So often the whole motion is evaluated at most."""
CLOSE_TURN = 0.001
"""Controls that are no further off need no better answer [rad] …"""
CLOSE_SWIVEL = 0.01
"""… knees and elbows that are no further off about the lines of their limbs [rad] …"""
CLOSE_PLACE = 1e-4
"""… and hips, hands and feet that are no further off [heights]."""
BETTER = 0.7
"""A pass that leaves more than this share of what was missing was the last …"""
FAR, PATIENCE = 0.1, 3
"""… or so many of them while controls are turned so far off [rad]: they hang on others, which must settle first."""


@dataclass(frozen=True, eq=False)
class Strings:
    """Controls that are ready to be moved frame by frame: the first answer, without looking what comes of it.

    It is exact where controls hang on each other in plain trees, as those that turn parts do.
    """

    work: Work
    handling: Handling

    def pull(self, motion: Motion) -> list[Channel]:
        """Return what controls do for a motion."""
        frames = len(motion.turns)
        goal = carrying.goal(self.handling, self.work.plan, motion)
        start, neutral = self.handling.start(frames), _repeated(self.handling.neutral, frames)
        return _channels(self.work, self.handling, carrying.solve(self.handling, goal, start, neutral))

    @cached_property
    def moves(self) -> Mapping[str, str]:
        """Which deform bone each control is moved for."""
        names, bodies = self.work.target.skeleton.names, self.work.plan.target.skeleton.names
        links = self.work.plan.links.target
        return {names[handle.control]: bodies[int(links[handle.link])] for handle in self.handling.handles}

    @property
    def switches(self) -> Sequence[Channel]:
        """What makes these controls count, one frame each."""
        return self.work.rest


def controls_of(stage: Stage, task: Task) -> Controls | None:
    """Return the controls of a rig, None for one that has none.

    Raises:
        MappingError: A control that the user has named does not exist.
    """
    character, links = task.character, task.plan.links
    names = character.skeleton.names
    bones = [names[int(b)] for b in links.target]
    roles = {joint: match.bone for joint, match in character.joints.items()}
    by_joint = {roles[joint]: control for joint, control in task.given.items() if joint in roles}
    both = [("leg", limb) for limb in links.legs] + [("arm", limb) for limb in links.arms]
    limbs = [made for kind, limb in both if (made := _limb(names, links, kind, limb)) is not None]
    chains = [[names[bone] for bone in limb.bones] for limb in character.limbs]
    reaches = {roles[joint]: said for joint, said in task.reaches.items() if joint in roles}
    return read(reading.facts(stage), Wanted(bones, roles, limbs, chains, by_joint, reaches))


def _limb(names: Sequence[str], links: Links, kind: str, limb: LimbLinks) -> Limb | None:
    """Return a limb that inverse kinematics of two bones may pose, or of three where it stands on its toes."""
    bones = [names[int(links.target[i])] for i in limb.chain]
    tip = "" if limb.ball == NONE else names[int(links.target[limb.ball])]
    if len(bones) == 3 or (len(bones) == 4 and links.names[limb.chain[0]].endswith("Shoulder")):
        return Limb(kind, *bones[-3:], tip=tip)
    if len(bones) < 4:
        return None
    upper, middle, heel, end = bones[-4:]
    return Limb(kind, upper, middle, end, tip, heel)


def is_plain(ob: bpy.types.Object, onto: Onto, given: Collection[str]) -> bool:
    """Return whether a motion goes onto the bones of an armature, so that no controls have to be looked for.

    Args:
        ob: The armature.
        onto: What is asked for.
        given: Joints of which the user has named controls.
    """
    return onto is Onto.NONE or (onto is Onto.AUTO and not given and not reading.has_constraints(ob))


def carry(
    task: Task, result: Result, onto: Onto, times: Times, scene: bpy.types.Scene
) -> Generator[float, None, Carried | None]:
    """Carry a motion onto the controls of a rig in steps; yields the share done.

    Args:
        task: Where to.
        result: The motion.
        onto: Which controls.
        times: When it is keyed.
        scene: Gives the frame rate.

    Returns:
        None where the bones that were mapped are to be keyed.

    Raises:
        RigError: The rig has no controls, and they were asked for.
        MappingError: A control that the user has named does not exist.
    """
    if is_plain(task.target.object, onto, {*task.given, *task.reaches}):
        return None
    with evaluating.stage(task.target, scene) as stage:
        work = _work(stage, task, onto)
        return None if work is None else (yield from _carry(stage, work, result, times))


def prepare(task: Task, onto: Onto, scene: bpy.types.Scene) -> Strings:
    """Return what answers frame by frame; arguments as for `carry`.

    Raises:
        RigError: The rig has no controls.
        MappingError: A control that the user has named does not exist.
    """
    with evaluating.stage(task.target, scene) as stage:
        work = _work(stage, task, onto)
        if work is None:
            raise _without_controls(task)
        return Strings(work, run(_handling(stage, work)))


def _work(stage: Stage, task: Task, onto: Onto) -> Work | None:
    """Return a task with the controls of its rig, None where the bones that were mapped are to be keyed.

    Raises:
        RigError: The rig has no controls, and they were asked for.
        MappingError: A control that the user has named does not exist.
    """
    # Where few bones copy others, as twist bones do, and names tell of no controls, there are none.
    is_controlled = len(task.character.skeleton) < len(task.target.skeleton)
    found = controls_of(stage, task)
    sure = found is not None and (found.family != FOUND or any(not limb.turned for limb in found.limbs))
    if found is not None and (onto is not Onto.AUTO or task.given or task.reaches or is_controlled or sure):
        return Work(task, found, onto, _settings(task, found, onto))
    if onto is Onto.AUTO and not is_controlled:
        return None
    raise _without_controls(task)


def _without_controls(task: Task) -> RigError:
    return RigError(
        f"rig {task.target.name!r} has no controls that could be found: "
        "name them in the joint list, or write on its bones"
    )


def _carry(stage: Stage, work: Work, result: Result, times: Times) -> Generator[float, None, Carried]:
    plan, frames, places = work.plan, times.keyed, times.places
    handling = yield from _handling(stage, work)
    motion, travels = result.motion, result.travel
    if travels is not None and result.root_motion in (RootMotion.OBJECT, RootMotion.IN_PLACE):
        motion = carrying.without(motion, travels, plan.target_rest[0])
    beside = _beside(work, result, places)
    goal = carrying.goal(handling, plan, motion if places is None else carrying.at(motion, places))
    values = carrying.solve(handling, goal, handling.start(len(frames)), _repeated(handling.neutral, len(frames)))
    height = plan.target.frame.height / plan.target.placement.scale
    best: tuple[float, Values, Seen, Array] | None = None
    passes, stalled = 0, 0
    while passes < PASSES:
        passes += 1
        made = [*beside, *_channels(work, handling, values)]
        stage.show(_whole(work, made), frames)
        # Each further pass is less likely.
        seeing = _seen(stage, work, handling, frames)
        seen, moves = yield from within(1.0 - 0.5 ** (passes - 1), 1.0 - 0.5**passes, seeing)
        miss = carrying.miss(handling, goal, seen)
        score = max(miss.turn / CLOSE_TURN, miss.swivel / CLOSE_SWIVEL, miss.place / (CLOSE_PLACE * height))
        stalled = stalled + 1 if best is not None and score > BETTER * best[0] else 0
        if best is None or score < best[0]:
            best = score, values, seen, moves
        if score <= 1.0 or stalled == (PATIENCE if miss.turn > FAR else 1):
            break
        goal = carrying.corrected(handling, goal, seen)
        values = carrying.solve(handling, goal, values, seen)
    assert best is not None, "there was at least one pass"
    _, values, seen, moves = best
    made = [*beside, *_channels(work, handling, values)]
    if places is not None:
        stage.show(_whole(work, made), frames)
        seen, moves = yield from _seen(stage, work, handling, times.shown)
    still = result.root_motion is not RootMotion.OBJECT
    shown = carrying.shown(plan, seen, None if still else moves)
    if travels is not None and result.root_motion is RootMotion.IN_PLACE:
        shown = carrying.along(shown, travels, plan.target_rest[0])
    error = Spread.of(direction_errors(plan.links, result.motion.points, shown.points))
    own, body = [*made, *work.rest], _body(work)
    if work.task.only:
        moved = _chosen(work)
        own = [*(channel for channel in made if channel.bone in moved), *work.rest]
        body = [name for name in body if name in moved]
    return Carried(
        own, body, shown, telling.described(work, len(handling.handles), passes, error), telling.warnings(work, error)
    )


def _repeated(seen: Seen, frames: int) -> Seen:
    parts = (seen.rotations, seen.positions, seen.turned, seen.points)
    return Seen(*(np.repeat(part, frames, axis=0) for part in parts))


# --- what is moved ---


def _chosen(work: Work) -> set[str]:
    """Return the controls that the user wants to be moved."""
    names, bodies, only = work.target.skeleton.names, work.plan.target.skeleton.names, set(work.task.only)
    out: set[str] = set()
    for handle in _handles(work):
        links = (handle.link,) if handle.limb is None else handle.limb
        bones = {bodies[int(work.plan.links.target[link])] for link in links}
        if names[handle.control] in only or bones & only:
            out.add(names[handle.control])
    return out


def _settings(task: Task, found: Controls, onto: Onto) -> list[Channel]:
    """Return all switches as channels of one frame; of those that matter for the chosen bones, if some are chosen."""
    target, only = task.target, set(task.only)
    chosen: list[Setting] = list(found.settings)
    for limb in found.limbs:
        chosen += limb.reached if onto is Onto.IK else limb.turned
    for bone, prop in found.kept:
        value = pose_bone(target.object, bone).get(prop)
        if isinstance(value, int | float):
            chosen.append(Setting(bone, prop, float(value)))
    if only:
        both = [{*one.serves, *(found.turning.get(bone, bone) for bone in one.serves)} for one in chosen]
        chosen = [one for one, bones in zip(chosen, both, strict=True) if bones & only]
    # One switch may serve several limbs.
    values = {(one.bone, one.prop): one.value for one in reversed(chosen)}
    return [reading.setting(bone, prop, np.array([[value]])) for (bone, prop), value in values.items()]


def _handles(work: Work) -> list[Handle]:
    """Return what is to be moved by which link, what carries others first."""
    found, links, index = work.controls, work.plan.links, work.target.skeleton.index
    names = work.plan.target.skeleton.names
    reached = {limb.limb.end: limb for limb in work.reached}
    own = {part for limb in reached.values() for part in limb.limb.bones}
    tips = {limb.limb.tip: limb.tip for limb in reached.values() if limb.tip is not None}
    controlled = np.array([names[int(b)] in found.turning or names[int(b)] in own for b in links.target])
    aims = carrying.aims(links, controlled)
    place = {names[int(b)]: i for i, b in enumerate(links.target)}
    out: list[Handle] = []
    if found.trunk is not None:
        out.append(Handle(index[found.trunk], 0, placed=True))
    for i, bone in enumerate(names[int(b)] for b in links.target):
        control = tips.get(bone) or found.turning.get(bone)
        limb = reached.get(bone)
        if limb is not None:
            out.append(Handle(index[limb.control], i, placed=True))
            upper, middle, last = (place[part] for part in limb.limb.bones)
            if limb.pole is not None:
                out.append(Handle(index[limb.pole], upper, limb=(upper, middle, last)))
            if limb.heel is not None:
                out.append(Handle(index[limb.heel], last))
        if control is not None and bone not in own and index[control] not in [h.control for h in out]:
            out.append(Handle(index[control], i, int(aims[i])))
    return out


def _handling(stage: Stage, work: Work) -> Generator[float, None, Handling]:
    """Evaluate the rig with its controls at rest and its switches set."""
    handles = _handles(work)
    names, skeleton = work.target.skeleton.names, work.target.skeleton
    place = {names[handle.control]: i for i, handle in enumerate(handles)}
    for limb in work.reached:
        # What hangs on the end of a limb is carried by whichever control poses it.
        place.setdefault(work.controls.turning.get(limb.limb.end, limb.control), place[limb.control])
    above = [place.get(work.controls.carriers.get(names[handle.control], ""), NONE) for handle in handles]
    frame = np.array([1.0])
    stage.show(_whole(work, []), frame)
    controls = np.array([handle.control for handle in handles], dtype=np.intp)
    found = yield from stage.poses(np.concatenate([controls, _bodies(work)]), frame)
    neutral = _split(found, len(handles))
    axes = neutral.rotations[0].copy()
    parents = yield from stage.poses(np.maximum(skeleton.parents[controls], 0), frame)
    for i, handle in enumerate(handles):
        if not work.target.armature.bones[names[handle.control]].use_local_location:
            lone = skeleton.parents[handle.control] < 0
            axes[i] = np.array([1.0, 0.0, 0.0, 0.0]) if lone else parents.rotations[0, i]
    seen, own = stage.at(1.0), [names[handle.control] for handle in handles]
    along = [i == NONE or reading.turns_along(seen, name, own[i]) for name, i in zip(own, above, strict=True)]
    return Handling(
        tuple(handles), np.array(above, dtype=np.intp), np.array(along), axes, neutral, reading.copies(seen, own)
    )


def _bodies(work: Work) -> Indices:
    """Return the links' bones among all bones of the rig, shape (link,)."""
    names, index = work.plan.target.skeleton.names, work.target.skeleton.index
    return np.array([index[names[int(bone)]] for bone in work.plan.links.target], dtype=np.intp)


def _split(found: evaluating.Poses, count: int) -> Seen:
    return Seen(
        found.rotations[:, :count], found.positions[:, :count], found.rotations[:, count:], found.positions[:, count:]
    )


def _seen(stage: Stage, work: Work, handling: Handling, frames: Array) -> Generator[float, None, tuple[Seen, Array]]:
    controls = np.array([handle.control for handle in handling.handles], dtype=np.intp)
    found = yield from stage.poses(np.concatenate([controls, _bodies(work)]), frames)
    return _split(found, len(controls)), found.moves


# --- channels ---


def _channels(work: Work, handling: Handling, values: Values) -> list[Channel]:
    """Return what controls do, in the rotation modes that they have."""
    ob, names = work.target.object, work.target.skeleton.names
    out: list[Channel] = []
    for i, handle in enumerate(handling.handles):
        name = names[handle.control]
        if handle.limb is None:
            out.append(channels.rotation(pose_bone(ob, name), name, values.rotations[:, i]))
        if handle.placed or handle.limb is not None:
            out.append(Channel(name, "location", values.locations[:, i]))
    return out


def _beside(work: Work, result: Result, places: Array | None) -> list[Channel]:
    """Return what carries the travel, where the hips do not."""
    if result.travel is None or result.root_motion in (RootMotion.HIPS, RootMotion.IN_PLACE):
        return []
    keyed = result if places is None else result.resampled(places)
    count = len(keyed.basis)
    none = np.zeros(0, dtype=np.intp)
    root = None
    if result.root_motion is RootMotion.ROOT_BONE:
        root = channels.root_bone(work.target, work.task.character)
    alone = replace(keyed, bones=none, basis=np.zeros((count, 0, 4)), moved=none, shifts=np.zeros((count, 0, 3)))
    return channels.of_result(work.target, work.task.character, alone, root)


def _body(work: Work) -> list[str]:
    """Return the bones that the motion owns: what is moved, and what must rest for that."""
    index, found = work.target.skeleton.index, work.controls
    own = [work.target.skeleton.names[handle.control] for handle in _handles(work)]
    return channels.body_bones(work.target, [index[name] for name in (*own, *found.still)])


def _whole(work: Work, made: Sequence[Channel]) -> list[Channel]:
    """Return channels with all that must rest or be set beside them."""
    ob = work.target.object
    return [*made, *work.rest, *channels.resting(ob, _body(work), made, actions.paths_in_strips(ob))]
