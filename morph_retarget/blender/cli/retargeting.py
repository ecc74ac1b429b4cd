"""``retarget SOURCE TARGET… -o OUT``: give a clip to one or more rigs."""

import argparse
import json
from dataclasses import dataclass, replace
from pathlib import Path

import bpy

from ...core.character.analysis import Overrides
from ...core.errors import FileError, MotionError, listed
from ...core.mocap.feet import FeetSettings
from ...core.mocap.plan import Matching, RetargetSettings
from ...core.mocap.root_motion import RootMotion
from .. import actions, presets, retarget, rig, sampling, terrain
from ..io import load, save
from ..io.load import Request
from ..retarget import Options, Outcome, Reference, Source
from .messages import naming, say
from .opening import add_rig_options, armature_here, axes, open_rig


def add_to(parser: argparse.ArgumentParser) -> None:
    """Describe the command to ``parser``."""
    parser.add_argument("source", metavar="SOURCE", help="clip: a file, FILE#ACTION, or an armature in the open file")
    parser.add_argument("targets", metavar="TARGET", nargs="+", help="rigs: files, or armatures in the open file")
    parser.add_argument(
        "-o", "--out", required=True, help="result (.blend .glb .fbx .bvh); {source}, {target}, {action} are filled in"
    )
    parser.add_argument("--map", metavar="FILE", help="joint map for the targets (JSON, as map --json prints it)")
    parser.add_argument("--source-map", metavar="FILE", help="joint map for the source")
    parser.add_argument("--source-armature", metavar="NAME", help="which armature of the source, as --armature")
    parser.add_argument(
        "--report", metavar="FILE", help="write what was done and measured, as a JSON list with one entry a pair"
    )
    add_rig_options(parser)
    _add_transfer_options(parser.add_argument_group("transfer"))
    _add_key_options(parser.add_argument_group("keys"))
    parser.set_defaults(run=run)


def _add_transfer_options(group: argparse._ArgumentGroup) -> None:  # pyright: ignore[reportPrivateUsage] - it has no public name
    group.add_argument("--action", metavar="NAME", help="which action of the source")
    group.add_argument("--all-actions", action="store_true", help="all actions that move the source armature")
    group.add_argument("--frames", metavar="A:B", type=_frames, help="first and last frame of the source")
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
        type=_share,
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
        "--scale",
        type=_above_zero,
        metavar="RATIO",
        help="target's travel over the source's (default: leg lengths)",
    )


def _add_key_options(group: argparse._ArgumentGroup) -> None:  # pyright: ignore[reportPrivateUsage]
    group.add_argument(
        "--fps",
        type=_above_zero,
        metavar="RATE",
        help="frame rate of the result (default: the target .blend's, else the clip's)",
    )
    group.add_argument("--resample", action="store_true", help="key whole frames where the rates differ")
    group.add_argument("--name", default=Options.name, help=f"name of the new action (default {Options.name!r})")


def _frames(text: str) -> tuple[int, int]:
    first, _, last = text.partition(":")
    try:
        found = int(first), int(last)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no range: write it as 1:240") from None
    if found[0] > found[1]:
        raise argparse.ArgumentTypeError(f"{text!r} ends before it starts: write it as 1:240")
    return found


def _share(text: str) -> float:
    value = _number(text)
    if not 0.0 <= value <= 1.0:
        raise argparse.ArgumentTypeError(f"{text!r} is no share: use a number from 0 to 1")
    return value


def _above_zero(text: str) -> float:
    value = _number(text)
    if not 0.0 < value < 32767.0:
        raise argparse.ArgumentTypeError(f"{text!r} is too small or too large: use a number above 0")
    return value


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no number") from None


@dataclass(frozen=True)
class _Job:
    """What was asked for, checked and read."""

    arguments: argparse.Namespace
    out: str
    options: Options
    overrides: Overrides

    @property
    def separate(self) -> bool:
        """Whether each pair gets a file of its own."""
        return any(field in self.out for field in ("{target}", "{action}", "{source}"))

    def path(self, target: str, action: str) -> Path:
        """Return the file of one result; files give their names without ending, armatures theirs."""
        names = {"{source}": _short(self.arguments.source), "{action}": action, "{target}": _short(target)}
        out = self.out
        for field, name in names.items():
            out = out.replace(field, "".join(c if c not in '/\\:*?"<>|' else "_" for c in name))
        return Path(out)


def run(arguments: argparse.Namespace) -> int:
    """Retarget all pairs and write the results: all of them, or none."""
    target_map, source_map = _read_map(arguments.map), _read_map(arguments.source_map)
    job = _Job(arguments, str(arguments.out), _options(arguments), Overrides(*axes(arguments), joints=target_map))
    _check(job)
    sources = _read_sources(job, source_map)
    reports: list[dict[str, object]] = []
    warnings: list[str] = []
    kept: list[bpy.types.Object] = []
    with save.Outbox() as outbox:
        for i, text in enumerate(arguments.targets):
            ob, label = open_rig(text, arguments.armature, fresh=job.separate or i == 0)
            if job.separate or i == 0:
                _set_rate(arguments, text, sources[0])
            for source in sources:
                _set_range(source)
                with naming(label):
                    outcome = _one(job, source, ob)
                named = arguments.source if len(sources) == 1 else f"{arguments.source}#{source.clip.name}"
                reports.append(outcome.report | {"source": named, "target": text})
                warnings += outcome.warnings
                if job.separate:
                    outbox.rigs(job.path(text, source.clip.name), [ob])
            kept.append(ob)
        if not job.separate:
            outbox.rigs(Path(job.out), kept)
        if arguments.report:
            outbox.text(Path(arguments.report), json.dumps(reports, indent=1, ensure_ascii=False) + "\n")
    for text in dict.fromkeys(warnings):
        say(f"warning: {text}")
    return 0


def _check(job: _Job) -> None:
    """Check all that can be known before anything is read."""
    arguments, out = job.arguments, job.out
    save.check(job.path("target", "action"))
    if arguments.report:
        save.check_folder(Path(arguments.report))
    if len(arguments.targets) > 1 and out.lower().endswith(".bvh") and "{target}" not in out:
        raise FileError(f"{out}: a BVH file holds one armature: put {{target}} into its name")
    if len(arguments.targets) > 1 and job.separate and "{target}" not in out:
        raise FileError(f"{out}: all targets would get the same file: put {{target}} into its name")
    if arguments.all_actions and not out.lower().endswith(".blend") and "{action}" not in out:
        raise FileError(f"{out}: holds one action: put {{action}} into its name, or write a .blend")
    paths = [job.path(text, "action") for text in arguments.targets] if job.separate else []
    twice = [path for i, path in enumerate(paths) if path in paths[:i]]
    if twice:
        raise FileError(f"{twice[0]}: two targets would get this file: give them different names")
    source = Request.parse(arguments.source)
    for text in arguments.targets:
        target = Request.parse(text)
        if target.path.exists() and source.path.exists() and target.path.samefile(source.path):
            raise FileError(f"{target.path}: source and target are the same file: choose another rig, or copy the file")
        if armature_here(text) is None:
            target.check()
        elif text == arguments.source:
            raise FileError(f"{text}: source and target are the same armature: choose another")


def _one(job: _Job, source: Source, ob: bpy.types.Object) -> Outcome:
    own = rig.read(ob)
    character = retarget.character_of(own, job.overrides)
    name = job.arguments.ground
    ground = terrain.ground_of(_ground_object(name), character) if name else None
    return retarget.retarget(source, own, character, job.options, rig.scene_of(), ground=ground)


def _ground_object(name: str) -> bpy.types.Object:
    found = bpy.data.objects.get(name)
    if found is None or found.type != "MESH":
        meshes = [ob.name for ob in bpy.data.objects if ob.type == "MESH"]
        raise FileError(
            f"there is no mesh {name!r} for the ground: choose one of {listed(meshes) or 'none (it has no meshes)'}"
        )
    return found


def _options(arguments: argparse.Namespace) -> Options:
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
        feet=replace(FeetSettings(), lock=arguments.lock),
    )
    return Options(settings, kind, frame, arguments.frames, arguments.name, arguments.resample)


def _read_map(path: str | None) -> dict[str, str]:
    return {} if path is None else presets.load(Path(path))


# --- sources ---


def _read_sources(job: _Job, joints: dict[str, str]) -> list[Source]:
    arguments = job.arguments
    request = Request.parse(arguments.source)
    here = any(armature_here(text) is not None for text in arguments.targets)
    if here and armature_here(arguments.source) is None:
        # The targets are in the open file, which must not be closed for the source.
        others = set(bpy.data.actions)
        with load.borrowed(request) as armatures:
            ob = load.choose(armatures, request.path, arguments.source_armature or arguments.armature)
            return _sample(job, ob, request, joints, [a for a in bpy.data.actions if a not in others])
    ob, _ = open_rig(arguments.source, arguments.source_armature or arguments.armature)
    return _sample(job, ob, request, joints, list(bpy.data.actions))


def _sample(
    job: _Job, ob: bpy.types.Object, request: Request, joints: dict[str, str], own_actions: list[bpy.types.Action]
) -> list[Source]:
    with naming(str(request.path)):
        own = rig.read(ob)
        overrides, frames = Overrides(joints=joints), job.options.frames
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


# --- times and names ---


def _set_rate(arguments: argparse.Namespace, target: str, source: Source) -> None:
    """Give the scene the frame rate asked for, or the clip's; a scene that came with the target keeps its own."""
    scene = rig.scene_of()
    own_scene = target.lower().endswith(".blend") or armature_here(target) is not None
    rate = arguments.fps or (None if own_scene else 1.0 / source.clip.seconds_per_frame)
    if rate is not None:
        scene.render.fps = max(round(rate), 1)
        scene.render.fps_base = scene.render.fps / rate


def _set_range(source: Source) -> None:
    """Give the scene the frame range of a clip at the scene's rate."""
    scene, clip = rig.scene_of(), source.clip
    length = (len(clip.frames) - 1) * clip.seconds_per_frame / sampling.seconds_per_frame(scene)
    scene.frame_start = int(clip.frames[0])
    scene.frame_end = max(round(clip.frames[0] + length), scene.frame_start)


def _short(text: str) -> str:
    path = Request.parse(text).path
    return path.stem if path.exists() else text
