"""``retarget SOURCE TARGET… -o OUT``: give a clip to one or more rigs."""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import bpy

from ...core.character.analysis import Overrides
from ...core.character.bone_maps.bone_map import BoneMap
from ...core.character.bone_maps.placing import Placed
from ...core.character.families import Family
from ...core.errors import FileError, MappingError, MotionError, listed
from ...core.mocap.feet import FeetSettings
from ...core.mocap.plan import Matching, RetargetSettings
from ...core.mocap.root_motion import RootMotion
from ...core.solve.jiggle_kinds import JiggleSettings
from .. import actions, bone_maps, retarget, rig, sampling, terrain
from ..controls.task import Onto
from ..io import load, save
from ..io.load import Request
from ..laying import Lay
from ..properties import of_rig
from ..retarget import Options, Outcome, Reference, Source
from . import data, numbers
from .messages import naming, say
from .opening import add_rig_options, armature_here, axes, open_rig
from .outputs import Outputs, set_range, set_rate


def add_to(parser: argparse.ArgumentParser) -> None:
    """Describe the command to ``parser``."""
    parser.add_argument("source", metavar="SOURCE", help="clip: a file, FILE#ACTION, or an armature in the open file")
    parser.add_argument("targets", metavar="TARGET", nargs="+", help="rigs: files, or armatures in the open file")
    parser.add_argument(
        "-o", "--out", required=True, help="result (.blend .glb .fbx .bvh); {source}, {target}, {action} are filled in"
    )
    parser.add_argument(
        "--report", metavar="FILE", help="write what was done and measured, as a JSON list with one entry a pair"
    )
    add_options(parser)
    parser.set_defaults(run=run)


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that tell how a pair is retargeted."""
    parser.add_argument(
        "--map",
        metavar="FILE",
        help="bone map for the targets: as map --json prints it, one of KeeMap, Animation Retargeting, Rokoko or Expy "
        "Kit, or the name of a preset",
    )
    parser.add_argument("--source-map", metavar="FILE", help="bone map for the source")
    parser.add_argument("--source-armature", metavar="NAME", help="which armature of the source, as --armature")
    add_rig_options(parser)
    _add_transfer_options(parser.add_argument_group("transfer"))
    _add_key_options(parser.add_argument_group("keys"))


def _add_transfer_options(group: argparse._ArgumentGroup) -> None:  # pyright: ignore[reportPrivateUsage] - it has no public name
    group.add_argument("--action", metavar="NAME", help="which action of the source")
    group.add_argument("--all-actions", action="store_true", help="all actions that move the source armature")
    group.add_argument("--frames", metavar="A:B", type=numbers.frames, help="first and last frame of the source")
    group.add_argument(
        "--reference",
        default="auto",
        metavar="POSE",
        help="source pose that stands for the target's rest: auto, rest, or a frame",
    )
    group.add_argument(
        "--matching", choices=[m.value for m in Matching], default="auto", help="how the two rest poses correspond"
    )
    group.add_argument("--no-plant-feet", action="store_true", help="leave feet where the transfer puts them")
    group.add_argument(
        "--lock",
        type=numbers.share,
        default=1.0,
        metavar="SHARE",
        help="how much of the source's own foot slide to remove, 0 to 1 (default 1)",
    )
    group.add_argument("--hands", action="store_true", help="bring the hands to the source's scaled places too")
    group.add_argument("--ground", metavar="OBJECT", help="mesh in the target's file that the feet follow")
    group.add_argument(
        "--root", choices=[r.value for r in RootMotion], default="hips", help="what carries the root motion"
    )
    group.add_argument(
        "--also",
        metavar="JOINT=BONE",
        default="",
        help="further bones of the target that turn as a joint of the source does, as 'leftHand=Claw.L,head=Hat'",
    )
    group.add_argument("--mirror", action="store_true", help="change left and right over")
    group.add_argument(
        "--controls",
        choices=[o.value for o in Onto],
        default="auto",
        help="which controls of a rig get the keys, none for its bones (default: fk where a rig has controls)",
    )
    group.add_argument(
        "--scale",
        type=numbers.above_zero,
        metavar="RATIO",
        help="target's travel over the source's (default: leg lengths)",
    )


def _add_key_options(group: argparse._ArgumentGroup) -> None:  # pyright: ignore[reportPrivateUsage]
    group.add_argument(
        "--fps",
        type=numbers.above_zero,
        metavar="RATE",
        help="frame rate of the result (default: the target .blend's, else the clip's)",
    )
    group.add_argument("--resample", action="store_true", help="key whole frames where the rates differ")
    group.add_argument(
        "--lay",
        choices=[lay.value for lay in Lay],
        default="replace",
        help="what becomes of the target's own animation: stash puts the result on a muted NLA track, "
        "add lays what it changes over it",
    )
    group.add_argument(
        "--bones", metavar="NAMES", default="", help="move only these bones or controls, as 'head,hand.L'"
    )
    group.add_argument(
        "--jiggles",
        action="store_true",
        help="let tails, ears, hair and the like of the targets follow, as far as the clip does not move them; "
        "settings in a target's file count",
    )
    group.add_argument("--name", default=Options.name, help=f"name of the new action (default {Options.name!r})")


@dataclass(frozen=True)
class _Job:
    """What was asked for, checked and read."""

    arguments: argparse.Namespace
    outputs: Outputs
    options: Options
    overrides: Overrides
    target_map: BoneMap | Family | None
    warnings: list[str] = field(default_factory=list[str])
    """What of the maps could not be used."""


@dataclass(frozen=True)
class Done:
    """What came of it."""

    reports: Sequence[dict[str, object]]
    """One for each pair."""
    warnings: Sequence[str]
    files: Sequence[Path]
    """Results that were written, without the report."""


def run(arguments: argparse.Namespace) -> int:
    """Retarget all pairs and write the results: all of them, or none."""
    for text in dict.fromkeys(perform(arguments).warnings):
        say(f"warning: {text}")
    return 0


def perform(
    arguments: argparse.Namespace,
    fresh: bool = False,
    look: Callable[[bpy.types.Object, Outcome], None] | None = None,
) -> Done:
    """Retarget all pairs and write the results: all of them, or none.

    Args:
        arguments: As `add_to` describes them.
        fresh: Refuse to replace files.
        look: Is shown each target while it plays what it was given.

    Raises:
        MorphError: The request or an input cannot be used.
    """
    with data.known():
        return _performed(arguments, fresh, look)


def _performed(
    arguments: argparse.Namespace, fresh: bool, look: Callable[[bpy.types.Object, Outcome], None] | None
) -> Done:
    target_map, source_map = (
        None if path is None else bone_maps.find(path) for path in (arguments.map, arguments.source_map)
    )
    outputs = Outputs(str(arguments.out), arguments.source, arguments.targets, arguments.report)
    job = _Job(arguments, outputs, options_of(arguments), Overrides(*axes(arguments)), target_map)
    _check(job)
    sources = _read_sources(job, source_map)
    reports: list[dict[str, object]] = []
    warnings: list[str] = []
    kept: list[bpy.types.Object] = []
    files: list[Path] = []
    with save.Outbox() as outbox:
        for i, text in enumerate(arguments.targets):
            ob, label = open_rig(text, arguments.armature, fresh=outputs.separate or i == 0)
            if outputs.separate or i == 0:
                set_rate(arguments.fps, text, 1.0 / sources[0].clip.seconds_per_frame)
            for source in sources:
                _set_range(source)
                with naming(label):
                    outcome = _one(job, source, ob)
                named = arguments.source if len(sources) == 1 else f"{arguments.source}#{source.clip.name}"
                reports.append(outcome.report | {"source": named, "target": text})
                warnings += outcome.warnings
                if look is not None:
                    look(ob, outcome)
                if outputs.separate:
                    files.append(_free(outputs.path(text, source.clip.name), fresh))
                    outbox.rigs(files[-1], [ob])
            kept.append(ob)
        if not outputs.separate:
            files.append(_free(Path(outputs.template), fresh))
            outbox.rigs(files[-1], kept)
        outputs.write_report(outbox, reports)
    return Done(reports, job.warnings + warnings, files)


def _free(path: Path, fresh: bool) -> Path:
    if fresh and path.exists():
        raise FileError(f"{path}: is there already: move it away, or ask to overwrite it")
    return path


def _check(job: _Job) -> None:
    """Check all that can be known before anything is read."""
    arguments, out = job.arguments, job.outputs.template
    job.outputs.check()
    if arguments.all_actions and not out.lower().endswith(".blend") and "{action}" not in out:
        raise FileError(f"{out}: holds one action: put {{action}} into its name, or write a .blend")
    source = Request.parse(arguments.source)
    for text in arguments.targets:
        target = Request.parse(text)
        if target.path.exists() and source.path.exists() and target.path.samefile(source.path):
            raise FileError(f"{target.path}: source and target are the same file: choose another rig, or copy the file")
        if armature_here(text) is not None and text == arguments.source:
            raise FileError(f"{text}: source and target are the same armature: choose another")


def _one(job: _Job, source: Source, ob: bpy.types.Object) -> Outcome:
    own, options = rig.read(ob), job.options
    placed = bone_maps.place(job.target_map, own, job.overrides, source.character)
    _tell(job, placed, ob)
    character = retarget.character_of(own, replace(job.overrides, joints=placed.joints))
    options = replace(options, controls=placed.controls, reaches=placed.reaches)
    name = job.arguments.ground
    ground = terrain.ground_of(_ground_object(name), character) if name else None
    if options.jiggles:
        options = replace(options, jiggles=of_rig(ob).jiggles.settings())
    return retarget.retarget(source, own, character, options, rig.scene_of(), ground=ground)


def _tell(job: _Job, placed: Placed, ob: bpy.types.Object) -> None:
    if placed.left_out:
        job.warnings.append(f"bone map for {ob.name!r}: {placed.told()}")


def _ground_object(name: str) -> bpy.types.Object:
    found = bpy.data.objects.get(name)
    if found is None or found.type != "MESH":
        meshes = [ob.name for ob in bpy.data.objects if ob.type == "MESH"]
        raise FileError(
            f"there is no mesh {name!r} for the ground: choose one of {listed(meshes) or 'none (it has no meshes)'}"
        )
    return found


def options_of(arguments: argparse.Namespace) -> Options:
    """Return what the options ask for.

    Raises:
        MotionError: The reference is no frame, the name of the action has unknown fields, or jiggles cannot be had.
    """
    kind, frame = Reference.AUTO, 1
    if arguments.reference in ("auto", "rest"):
        kind = Reference(arguments.reference)
    else:
        try:
            kind, frame = Reference.FRAME, int(arguments.reference)
        except ValueError:
            raise MotionError(f"--reference {arguments.reference!r}: use auto, rest or the number of a frame") from None
    retarget.action_name(arguments.name, "action", "source", "target")
    carrier = RootMotion(arguments.root)
    if carrier is RootMotion.OBJECT and str(arguments.out).lower().endswith(".bvh"):
        carrier = RootMotion.HIPS  # a BVH file has no object: what it would do, its root does
    settings = RetargetSettings(
        matching=Matching(arguments.matching),
        plant_feet=not arguments.no_plant_feet,
        reach_hands=arguments.hands,
        root_motion=carrier,
        scale=arguments.scale or 0.0,
        mirror=arguments.mirror,
        also=_pairs(arguments.also),
        feet=replace(FeetSettings(), lock=arguments.lock),
    )
    options = Options(
        settings,
        kind,
        frame,
        arguments.frames,
        arguments.name,
        arguments.resample,
        onto=Onto(arguments.controls),
        only=frozenset(name.strip() for name in arguments.bones.split(",") if name.strip()),
        lay=Lay(arguments.lay),
        jiggles=JiggleSettings() if arguments.jiggles else None,
    )
    retarget.check_jiggles(options)
    return options


def _pairs(text: str) -> tuple[tuple[str, str], ...]:
    """Return what ``--also`` names.

    Raises:
        MappingError: A part of it is no pair.
    """
    out: list[tuple[str, str]] = []
    for part in filter(None, (part.strip() for part in text.split(","))):
        joint, equals, bone = part.partition("=")
        if not (joint and equals and bone):
            raise MappingError(f"--also {part!r}: name a joint and a bone, as leftHand=Claw.L")
        out.append((joint.strip(), bone.strip()))
    return tuple(out)


# --- sources ---


def _read_sources(job: _Job, given: BoneMap | Family | None) -> list[Source]:
    arguments = job.arguments
    request = Request.parse(arguments.source)
    here = any(armature_here(text) is not None for text in arguments.targets)
    if here and armature_here(arguments.source) is None:
        # The targets are in the open file, which must not be closed for the source.
        others = set(bpy.data.actions)
        with load.borrowed(request) as armatures:
            ob = load.choose(armatures, request.path, arguments.source_armature or arguments.armature)
            return _sample(job, ob, request, given, [a for a in bpy.data.actions if a not in others])
    ob, _ = open_rig(arguments.source, arguments.source_armature or arguments.armature)
    return _sample(job, ob, request, given, list(bpy.data.actions))


def _sample(
    job: _Job,
    ob: bpy.types.Object,
    request: Request,
    given: BoneMap | Family | None,
    own_actions: list[bpy.types.Action],
) -> list[Source]:
    with naming(str(request.path)):
        own = rig.read(ob)
        placed = bone_maps.place(given, own)
        _tell(job, placed, ob)
        overrides, frames = Overrides(joints=placed.joints), job.options.frames
        fitting = [pair for pair in actions.of_armature(ob) if pair[0] in own_actions]
        chosen = _choose_actions(ob, fitting, request.action or job.arguments.action, job.arguments.all_actions)
        return [retarget.run(retarget.read_source(own, a, s, rig.scene_of(), overrides, frames)) for a, s in chosen]


_Clips = list[tuple[bpy.types.Action, bpy.types.ActionSlot]]


def _choose_actions(ob: bpy.types.Object, fitting: _Clips, name: str | None, every: bool) -> _Clips:
    """Return the actions of the source that are meant: a named one, all, or the one that it plays."""
    if name is not None and not every:
        # Importers write an action's name as "armature|name".
        named = [p for p in fitting if p[0].name == name] or [p for p in fitting if p[0].name.endswith(f"|{name}")]
        if not named:
            names = listed([a.name for a, _ in fitting], 20)
            raise MotionError(f"has no action {name!r}: choose one of {names or 'none'}")
        return named[:1]
    if every and fitting:
        return fitting
    playing, slot = actions.assigned(ob)
    if playing is not None and not every:
        slot = slot or actions.fitting_slot(playing, ob)
    elif fitting:
        playing, slot = fitting[0]
    if playing is None or slot is None:
        raise MotionError(f"armature {ob.name!r} has no action: choose a clip that moves")
    others = [a.name for a, _ in fitting if a != playing]
    if others:
        say(f"using action {playing.name!r}; there are also {listed(others)} (choose with FILE#ACTION)")
    return [(playing, slot)]


# --- times ---


def _set_range(source: Source) -> None:
    """Give the scene the frame range of a clip at the scene's rate."""
    clip = source.clip
    length = (len(clip.frames) - 1) * clip.seconds_per_frame / sampling.seconds_per_frame(rig.scene_of())
    set_range(clip.frames[0], clip.frames[0] + length)
