"""Retargeting in Blender: sample the source, run the pipeline, key the target. Data in, data out; no context."""

import time
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import bpy
import numpy as np

from ..core import jiggling, pipeline, report
from ..core.character.analysis import Overrides
from ..core.character.character import Character
from ..core.character.control_given import Reaching
from ..core.errors import MotionError, RigError
from ..core.ground import Ground
from ..core.jiggling import Jiggling
from ..core.mocap import reference
from ..core.mocap.measure import measure
from ..core.mocap.plan import Plan, ReferencePose, RetargetSettings, prepare
from ..core.mocap.root_motion import RootMotion
from ..core.pipeline import Result
from ..core.solve.jiggle_kinds import JiggleSettings
from . import channels, contacts, jiggle_bones, jiggle_keys, rig, sampling, writing
from .contacts import Contact
from .controls import deforming
from .controls.task import Onto, Task
from .laying import Lay, Place
from .recognition import recognized
from .rig import Rig
from .sampling import Clip
from .steps import run as run
from .steps import within as within
from .templates import filled
from .writing import Written

_NOTHING_LOOSE = (
    "nothing jiggles on {target!r}: it has no tail, ears, hair or the like, or something moves them already"
)


class Reference(StrEnum):
    """Which pose of the source stands for the target's rest."""

    AUTO = "auto"
    REST = "rest"
    FRAME = "frame"
    CURRENT = "current"


@dataclass(frozen=True)
class Options:
    """What can be chosen about one retarget in Blender."""

    settings: RetargetSettings = field(default_factory=RetargetSettings)
    reference: Reference = Reference.AUTO
    reference_frame: int = 1
    """Frame of the source that stands for the target's rest, with `Reference.FRAME`."""
    frames: tuple[int, int] | None = None
    """First and last frame of the source; its keyed range when None."""
    name: str = "{action} on {target}"
    """Name of the new action; ``{action}``, ``{source}`` and ``{target}`` are filled in."""
    resample: bool = False
    """Key whole frames of the scene when the clip has another rate; else its own frames at their times."""
    keep_others: bool = True
    """Take over what the target's old action does to bones that are not mapped."""
    onto: Onto = Onto.AUTO
    """Whether bones are keyed, or the controls that pose them."""
    controls: Mapping[str, str] = field(default_factory=dict[str, str])
    """The user's own controls, by joint."""
    reaches: Mapping[str, Reaching] = field(default_factory=dict[str, Reaching])
    """What the user says of how hands and feet are brought to places, by joint."""
    only: frozenset[str] = frozenset()
    """Bones or controls of the target that are to be moved, all others keep their animation; all when empty."""
    lay: Lay = Lay.REPLACE
    """What becomes of the target's own animation."""
    jiggles: JiggleSettings | None = None
    """How tails, ears, hair and the like of the target follow the rest of it, in place of what its old action does to
    them; None where they do not."""


@dataclass(frozen=True, eq=False)
class Source:
    """A rig with its character and one sampled clip."""

    rig: Rig
    character: Character
    clip: Clip
    seconds: Mapping[str, float]
    """Time that sampling and analysis took [s]."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """A finished retarget."""

    action: bpy.types.Action
    slot: bpy.types.ActionSlot
    plan: Plan
    result: Result
    report: dict[str, object]
    warnings: tuple[str, ...]


def character_of(own: Rig, overrides: Overrides | None = None, clip: Clip | None = None) -> Character:
    """Return what a rig is; one whose rest is no pose is judged by a frame of its clip.

    Raises:
        RigError: The rig has a single bone.
        MappingError: An override names a joint or bone that does not exist.
    """
    overrides = overrides or Overrides()
    found = recognized(own.skeleton, own.placement, overrides)
    if found.rest_is_pose or clip is None:
        return found
    up = reference.upright_axis(found, clip.pose) if overrides.up is None else overrides.up
    row = reference.standing_frame(found, clip.pose, up)
    posed = Overrides(up, overrides.forward, overrides.joints)
    return recognized(own.skeleton, own.placement, posed, clip.pose.positions[row])


def read_source(
    own: Rig,
    action: bpy.types.Action,
    slot: bpy.types.ActionSlot,
    scene: bpy.types.Scene,
    overrides: Overrides | None = None,
    frames: tuple[int, int] | None = None,
) -> Generator[float, None, Source]:
    """Sample and analyse a source in steps; yields the share done and returns the `Source`.

    Raises:
        MotionError: The action has no keys, or moves none of the rig's bones.
    """
    start = time.perf_counter()
    clip = yield from sampling.sample(own, action, slot, scene, frames)
    sampled = time.perf_counter()
    character = character_of(own, overrides, clip)
    return Source(own, character, clip, {"sample": sampled - start, "analyze": time.perf_counter() - sampled})


def check_target(ob: bpy.types.Object) -> None:
    """Check that an armature can be given an action.

    Raises:
        RigError: It is linked from another file without a library override that can be edited, or a strip of it is
            being tweaked.
    """
    if ob.library is not None and ob.override_library is None:
        raise RigError(
            f"armature {ob.name!r} is linked from {ob.library.filepath}: make a library override of it first "
            "(Object > Library Override > Make)"
        )
    if ob.override_library is not None and ob.override_library.is_system_override:
        raise RigError(
            f"armature {ob.name!r} is a library override that cannot be edited: make it editable first "
            "(Outliner > Library Override > Make > Selected)"
        )
    if ob.animation_data is not None and ob.animation_data.use_tweak_mode:
        raise RigError(f"a strip of armature {ob.name!r} is being tweaked: leave tweak mode in the NLA editor first")


def retarget(
    source: Source,
    target: Rig,
    character: Character,
    options: Options,
    scene: bpy.types.Scene,
    given: Sequence[Contact] | None = None,
    ground: Ground | None = None,
) -> Outcome:
    """Give a target the source's motion as a new action, and make it play that; arguments as for `in_steps`."""
    return run(in_steps(source, target, character, options, scene, given, ground))


def in_steps(
    source: Source,
    target: Rig,
    character: Character,
    options: Options,
    scene: bpy.types.Scene,
    given: Sequence[Contact] | None = None,
    ground: Ground | None = None,
) -> Generator[float, None, Outcome]:
    """Give a target the source's motion as a new action, and make it play that; yields the share done.

    The old action, other slots, rest poses and object transforms are left as they are.

    Args:
        source: The clip.
        target: The rig.
        character: What the rig is.
        options: Choices.
        scene: Gives the frame rate.
        given: The user's own contacts; found from the motion when None.
        ground: Terrain, the target's character frame.

    Raises:
        RigError: See `transfer`; or controls are asked for and there are none.
        MappingError: The two share no joints, or a control that the user has named does not exist.
        MotionError: A contact names no foot of the source; or see `check_jiggles`.
    """
    check_jiggles(options)
    times = dict(source.seconds)
    start = time.perf_counter()
    task, result = task_of(source, target, character, options, given, ground)
    plan = task.plan
    times["transfer"] = time.perf_counter() - start
    start = time.perf_counter()
    written = writing.written(source.clip, task, result, options.onto, options.resample, scene)
    made = yield from within(0.0, 0.8 if options.jiggles else 1.0, written)
    name = action_name(options.name, source.clip.name, source.rig.name, target.name)
    if not made.channels:
        raise RigError(f"none of the bones of {target.name!r} that were chosen is given the motion: choose others")
    place = Place(name, options.lay, options.keep_others)
    loose = _loose(target, character, made, options)
    laid = yield from within(0.8, 1.0, jiggle_keys.lay(target, made, place, loose, scene))
    times["write"] = time.perf_counter() - start
    warnings = [*_warnings(source, target, plan, made.on_controls is not None), *made.warnings]
    jiggling_bones = [] if loose is None else jiggle_keys.names_of(target, loose)
    if loose is not None and not loose:
        warnings.append(_NOTHING_LOOSE.format(target=target.name))
    measures, count = measure(plan, result.source, made.motion, ground), len(source.clip.frames)
    described = report.describe(source.clip.name, target.name, count, times, plan, measures, jiggling_bones, warnings)
    if made.on_controls is not None:
        described["controls"] = dict(made.on_controls)
    return Outcome(laid.action, laid.slot, plan, result, described, tuple(warnings))


def _loose(target: Rig, character: Character, made: Written, options: Options) -> Jiggling | None:
    """Return what of a target jiggles while it plays a motion, None where that is not asked for."""
    if options.jiggles is None:
        return None
    posed = jiggle_bones.posed_by(target, made.channels)
    among = {target.skeleton.index[name] for name in options.only} or None
    return jiggling.prepare(character, posed, options.jiggles, among)


def check_jiggles(options: Options) -> None:
    """Check that jiggles can be had with the other options.

    Raises:
        MotionError: The new action is laid over another, of which jiggles would know nothing.
    """
    if options.jiggles and options.lay is Lay.ADD:
        raise MotionError(
            "jiggles cannot follow a motion that is added to another: leave them out, or replace or stash what is there"
        )


def task_of(
    source: Source,
    target: Rig,
    character: Character,
    options: Options,
    given: Sequence[Contact] | None = None,
    ground: Ground | None = None,
) -> tuple[Task, Result]:
    """Return the source's motion as the target's body plays it, and what of the target it is to be written on.

    Nothing is written. Arguments and errors are those of `in_steps`.
    """
    body = None
    if options.onto is not Onto.NONE:
        body = deforming.body_of(target, character, [bone for _, bone in options.settings.also])
    rig_of_body, its_character = body or (target, character)
    plan, result = transfer(source, rig_of_body, its_character, options, given, ground)
    only = _existing(target, options.only)
    return Task(target, its_character, plan, options.controls, options.reaches, only), result


def _existing(target: Rig, bones: frozenset[str]) -> frozenset[str]:
    """Return bones that were chosen.

    Raises:
        RigError: The target does not have one of them.
    """
    missing = sorted(bones - set(target.skeleton.names))
    if missing:
        raise RigError(f"armature {target.name!r} has no bone {missing[0]!r}: choose some of its bones")
    return bones


def transfer(
    source: Source,
    target: Rig,
    character: Character,
    options: Options,
    given: Sequence[Contact] | None = None,
    ground: Ground | None = None,
) -> tuple[Plan, Result]:
    """Return the source's motion as the target plays it, without writing anything.

    Args:
        source: The clip.
        target: The rig.
        character: What the rig is.
        options: Choices.
        given: The user's own contacts; found from the motion when None.
        ground: Terrain, the target's character frame.

    Raises:
        RigError: The target is linked, has no legs while the source has, or lacks the root bone asked for.
        MappingError: The two share no joints.
        MotionError: A contact names no foot of the source.
    """
    check_target(target.object)
    if source.rig.uid == target.uid:
        raise RigError(f"source and target are both {target.name!r}: choose two armatures")
    if options.settings.root_motion is RootMotion.ROOT_BONE:
        channels.root_bone(target, character)
    plan, clip = make_plan(source, target, character, options), source.clip
    rows = None if given is None else contacts.standing(plan, clip, given)
    return plan, pipeline.evaluate(plan, clip.pose, clip.seconds_per_frame, rows, ground)


def action_name(template: str, action: str, source: str, target: str) -> str:
    """Return the name of a new action.

    Raises:
        MotionError: The template has a field besides ``{action}``, ``{source}`` and ``{target}``, or a lone brace.
    """
    return filled(template, "action name", action=action, source=source, target=target)


def make_plan(source: Source, target: Rig, character: Character, options: Options) -> Plan:
    """Return the plan of a pair, with the reference poses that were asked for.

    Raises:
        RigError: Just one of the two has legs.
        MappingError: They share no joints.
    """
    theirs: ReferencePose | None = None
    ours: ReferencePose | None = None
    pose, frames = source.clip.pose, source.clip.frames
    if options.reference is Reference.FRAME:
        row = int(np.argmin(np.abs(frames - options.reference_frame)))
        theirs = ReferencePose(f"frame {frames[row]:g}", pose.rotations[row], pose.positions[row])
    elif options.reference is Reference.CURRENT:
        theirs = ReferencePose("current pose", *rig.read_pose(source.rig, source.rig.object))
        ours = ReferencePose("current pose", *rig.read_pose(target, target.object))
    elif options.reference is Reference.AUTO and not source.character.rest_is_pose:
        row = reference.frame_like_rest(source.character, character, pose)
        theirs = ReferencePose(f"frame {frames[row]:g}", pose.rotations[row], pose.positions[row])
    return prepare(source.character, character, options.settings, theirs, ours)


def _warnings(source: Source, target: Rig, plan: Plan, on_controls: bool) -> tuple[str, ...]:
    out = [*source.rig.warnings, *target.warnings]
    out += [f"source {source.rig.name!r}: {w}" for w in source.character.warnings]
    out += [f"target {target.name!r}: {w}" for w in plan.target.warnings]
    if plan.reference != "rest pose":
        out.append(f"the source's {plan.reference} stands for the target's rest pose")
    if source.clip.stepped:
        out.append(f"the source was sampled frame by frame because of {', '.join(source.clip.stepped)}")
    linked = {plan.target.skeleton.names[b] for b in plan.links.target}
    for bone in () if on_controls else rig.pose_of(target.object).bones:
        active = [c.name for c in bone.constraints if c.enabled and c.influence > 0.0]
        if bone.name in linked and active:
            out.append(
                f"bone {bone.name!r} has the constraint {active[0]!r}, which acts on top of the keys: "
                "mute it if it should not"
            )
            break
    return tuple(out)
