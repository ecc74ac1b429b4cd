"""``play ACTION CHARACTER… -o OUT``: give a generalized action to characters."""

import argparse
import contextlib
from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ...core.errors import FileError, MotionError, listed
from ...core.morph.channels import TargetKind
from .. import retarget, rig
from ..io import save
from ..io.load import Request
from ..morph import analyses, bake, cast, choice, clip, deforms, on_controls, own_values, pose
from ..morph.bake import Options, Take
from ..morph.values import MORPHRETARGET_PG_values
from ..properties import of_rig
from . import action_file, data, directing, locomotion, manner, numbers
from .action_file import ActionFile
from .messages import naming, say
from .opening import add_rig_options, armature_here, open_rig
from .outputs import Outputs, set_range, set_rate

FAILED = 1
NEAREST = "nearest"


def add_to(parser: argparse.ArgumentParser) -> None:
    """Describe the command to ``parser``."""
    parser.add_argument(
        "action",
        metavar="ACTION",
        help="generalized action: FILE.blend#ACTION, or an action in the open file; - for locomotion alone; "
        "a script of commands: FILE.toml or FILE.bml",
    )
    parser.add_argument("characters", metavar="CHARACTER", nargs="+", help="rigs: files, or armatures in the open file")
    parser.add_argument(
        "-o", "--out", required=True, help="result (.blend .glb .fbx .bvh); {source}, {target}, {action} are filled in"
    )
    parser.add_argument(
        "--report", metavar="FILE", help="write what was done and measured, as a JSON list with one entry a character"
    )
    parser.add_argument(
        "--target",
        action="append",
        default=[],
        type=_target,
        metavar="CHANNEL=OBJECT[:BONE]",
        help="target of a channel that has an external one: an object of a character's or the action's file",
    )
    parser.add_argument(
        "--variant",
        default=None,
        type=_variant,
        metavar="N",
        help=f"which of the ways to play, from 0; {NEAREST}: whose bodies have the shortest way to their targets",
    )
    parser.add_argument("--frames", metavar="A:B", type=numbers.frames, help="first and last frame of the action")
    parser.add_argument(
        "--fps",
        type=numbers.above_zero,
        metavar="RATE",
        help="frame rate of the result (default: the character .blend's, else that of the action's file)",
    )
    manner.add_options(parser)
    parser.add_argument(
        "--live", action="store_true", help="leave the generalized action on the characters, to be edited on; a .blend"
    )
    add_rig_options(parser)
    parser.set_defaults(run=run)


def _target(text: str) -> tuple[str, str]:
    channel, sign, target = text.partition("=")
    if not sign or not channel or not target:
        raise argparse.ArgumentTypeError(f"{text!r} is no target: write it as CHANNEL=OBJECT or CHANNEL=OBJECT:BONE")
    return channel, target


def _variant(text: str) -> int | str:
    if text != NEAREST and not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is no variant: use a number from 0 on, or {NEAREST}")
    return text if text == NEAREST else int(text)


@dataclass(frozen=True)
class _Job:
    """What was asked for, checked and read."""

    arguments: argparse.Namespace
    outputs: Outputs
    source: ActionFile


class _NothingPlays(Exception):  # noqa: N818 - it is no error of the request
    """No character plays any of the action."""


def run(arguments: argparse.Namespace) -> int:
    """Play the action on all characters and write the results: all of them, or none."""
    outputs = Outputs(str(arguments.out), arguments.action, arguments.characters, arguments.report)
    outputs.check()
    if arguments.live and not outputs.template.lower().endswith(".blend"):
        raise FileError(f"{outputs.template}: only a .blend can keep an action live: write one, or leave out --live")
    if arguments.live and arguments.fps:
        raise FileError(f"{outputs.template}: --fps resamples what is baked: leave it out with --live")
    stays_open = all(armature_here(text) is not None for text in arguments.characters)
    reports: list[dict[str, object]] = []
    warnings: list[str] = []
    with data.known(), _source(arguments.action, stays_open) as source:
        job = _Job(arguments, outputs, source)
        _check_targets(job)
        try:
            with save.Outbox() as outbox:
                _play_all(job, outbox, reports, warnings)
                outputs.write_report(outbox, reports)
            status = 0
        except _NothingPlays:
            with save.Outbox() as outbox:
                outputs.write_report(outbox, reports)
            status = FAILED
        finally:
            cast.forget(rig=True)
    for text in dict.fromkeys(warnings):
        say(text if status else f"warning: {text}")
    if status:
        say(f"action {source.name!r} plays on none of the characters: nothing was written")
    return status


def _source(text: str, stays_open: bool) -> contextlib.AbstractContextManager[ActionFile]:
    if text == locomotion.NO_ACTION:
        return contextlib.nullcontext(locomotion.no_action())
    if directing.is_script(text):
        return contextlib.nullcontext(directing.found(text))
    return action_file.found(text, stays_open)


def _check_targets(job: _Job) -> None:
    """Check that what is given a target can have one, before any character is read."""
    external = [c.name for c in job.source.definition.channels if c.target is TargetKind.EXTERNAL]
    for name, _ in job.arguments.target:
        if name not in external:
            choices = f"choose one of {listed(external)}" if external else "none of its channels has one"
            raise MotionError(
                f"--target {name!r}: action {job.source.name!r} has no such channel with an external target: {choices}"
            )


def _play_all(job: _Job, outbox: save.Outbox, reports: list[dict[str, object]], warnings: list[str]) -> None:
    """Play on all characters, those that share a file together."""
    outputs, bound = job.outputs, False
    for group in [[text] for text in outputs.targets] if outputs.separate else [list(outputs.targets)]:
        characters = _cast(job, group)
        rate = _rate(job, group[0])
        if isinstance(job.source, directing.ScriptFile):
            for text, ob in zip(group, characters, strict=True):
                warnings += [f"{text}: {warning}" for warning in directing.tell(job.source, ob)]
        options = Options(_frames(job, characters), rate=rate)
        taken = [_take(job, text, ob, options) for text, ob in zip(group, characters, strict=True)]
        set_range(min(one.clip.frames[0] for one in taken), max(one.clip.frames[-1] for one in taken))
        if job.arguments.live:
            _show(taken)
        else:
            bake.write_all(taken, options)
        for text, one in zip(group, taken, strict=True):
            reports.append(one.report() | {"source": job.arguments.action, "target": text})
            warnings += [f"{text}: {warning}" for warning in one.warnings]
            bound |= one.binds
        outbox.rigs(outputs.path(group[0], job.source.name), characters)
    if not bound:
        raise _NothingPlays


def _frames(job: _Job, characters: Sequence[bpy.types.Object]) -> tuple[int, int] | None:
    """Return the first and last frame to play, None where no keys tell.

    Characters that go do so beyond the keys of the action; here they stop with it, and without one with the scene.
    """
    if job.arguments.frames is not None:
        return job.arguments.frames
    if isinstance(job.source, directing.ScriptFile):
        return directing.frames(characters)
    action = cast.action_of(characters[0])
    if action is not None and not isinstance(job.source, locomotion.NoAction):
        return clip.keyed_range(characters[0], action)
    scene = rig.scene_of()
    return scene.frame_start, scene.frame_end


def _cast(job: _Job, group: Sequence[str]) -> list[bpy.types.Object]:
    """Open the characters of one file, and let them play the action."""
    arguments, out = job.arguments, list[bpy.types.Object]()
    for i, text in enumerate(group):
        ob, label = open_rig(text, arguments.armature, fresh=i == 0)
        with naming(label):
            retarget.check_target(ob)
            own = of_rig(ob)
            own.up, own.forward = arguments.up or own.up, arguments.forward or own.forward
            analyses.of(ob)
        out.append(ob)
    action = job.source.bring()
    for ob in out:
        manner.apply(arguments, job.source, ob)
        cast.add(ob, action)
    for ob in out:
        for name, target in arguments.target:
            _aim(job, of_rig(ob).channels[name], target)
        if isinstance(arguments.variant, int):
            of_rig(ob).variant = arguments.variant
        cast.forget(ob)
    return out


def _aim(job: _Job, item: MORPHRETARGET_PG_values, text: str) -> None:
    """Give a channel of a character its target: an object whose name may hold colons, or a bone of one."""
    name, _, bone = text.rpartition(":")
    whole = job.source.bring_object(text)
    found = whole or (job.source.bring_object(name) if name else None)
    if found is None:
        names = listed(ob.name for ob in bpy.data.objects)
        raise MotionError(f"--target {item.name!r}: there is no object {text!r}: choose one of {names}")
    item.target, item.target_bone = found, "" if whole is not None else bone
    if not own_values.has_target(item):
        raise MotionError(f"--target {item.name!r}: object {found.name!r} has no bone {bone!r}: choose one that it has")


def _rate(job: _Job, text: str) -> float:
    """Give the scene its frame rate, and return how many frames of the action pass in one of its frames."""
    rate = set_rate(job.arguments.fps, text, job.source.rate)
    return 1.0 if job.arguments.live or isinstance(job.source, locomotion.NoAction) else job.source.rate / rate


def _take(job: _Job, text: str, ob: bpy.types.Object, options: Options) -> Take:
    with naming(str(Request.parse(text).path)):
        if job.arguments.variant == NEAREST:
            own = cast.member(ob)
            if own.part.binding.variants:
                of_rig(ob).variant = choice.nearest_variant(own, ob, bpy.context.evaluated_depsgraph_get())
                cast.forget(ob)
        scene = rig.scene_of()
        found = retarget.run(bake.take(ob, scene, options))
        return found if job.arguments.live else retarget.run(bake.carried(found, scene))


def _show(taken: Sequence[Take]) -> None:
    """Put characters in the first pose of what they play, which they show until frames change."""
    rig.scene_of().frame_set(int(taken[0].clip.frames[0]))
    for one in taken:
        pose.show(one.member.rig.object, on_controls.setting_of(one.member, one.played))
        deforms.show(one.member, one.played)
