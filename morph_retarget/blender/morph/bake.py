"""Baking: a generalized action as a character plays it, written as an ordinary action beside it."""

import time
from collections.abc import Generator, Sequence
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ...core import long_clip
from ...core.errors import MotionError
from ...core.morph import measure
from ...core.play import Played
from .. import actions, channels, keying, retarget
from ..locomotion import walks
from ..locomotion.walks import Taken
from ..templates import filled
from ..writing import Written
from . import cast, clip, deform_keys, events, jiggles, on_controls, pose
from .clip import Clip
from .member import Member


@dataclass(frozen=True)
class Options:
    """What can be chosen about baking."""

    frames: tuple[int, int] | None = None
    """First and last frame of the action; all of it when None."""
    name: str = "{action} on {character}"
    """Name of the new action; ``{action}`` and ``{character}`` are filled in."""
    rate: float = 1.0
    """Frames of the action for each frame of the scene: above 1 where the scene has fewer frames a second."""


@dataclass(frozen=True, eq=False)
class Take:
    """A character as it plays an action, before anything is written."""

    member: Member
    clip: Clip
    played: Played
    seconds: dict[str, float]

    rate: float
    """Frames of the action for each frame of the scene."""
    walk: Taken | None = None
    """How the character goes over the ground."""
    on_controls: Written | None = None
    """The same on controls, None where bones are keyed."""

    @property
    def binds(self) -> bool:
        """Whether any of the action plays on the character."""
        return self.member.plays

    @property
    def events(self) -> list[tuple[str, float]]:
        """Events of the action within the clip, and their frames of the scene."""
        first, last = float(self.clip.frames[0]), float(self.clip.frames[-1])
        at = [(name, first + (frame - first) / self.rate) for name, frame in events.markers_of(self.member.action)]
        return [(name, round(frame, 3)) for name, frame in at if first - 0.5 < frame <= last + 0.5]

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the user should know."""
        return (*self.member.part.binding.problems, *self._notes)

    @property
    def _notes(self) -> tuple[str, ...]:
        """The same besides problems of the binding."""
        walking = () if self.walk is None else self.walk.warnings
        carried = () if self.on_controls is None else self.on_controls.warnings
        return (*self.member.warnings, *walking, *carried, *on_controls.told(self.member, self.played))

    def report(self) -> dict[str, object]:
        """Return what was played and measured, as it is written to report files."""
        return measure.describe(
            self.member.action.name,
            self.member.rig.object.name,
            len(self.clip.frames),
            self.seconds,
            self.member.part.binding,
            self.played,
            self.events,
            self._notes,
        )


@dataclass(frozen=True, eq=False)
class Outcome:
    """A baked action."""

    action: bpy.types.Action
    slot: bpy.types.ActionSlot
    take: Take
    more: tuple[bpy.types.Action, ...]
    """Actions of shape keys."""
    report: dict[str, object]


def take(ob: bpy.types.Object, scene: bpy.types.Scene, options: Options) -> Generator[float, None, Take]:
    """Play the generalized action of a character in steps; yields the share done and returns the `Take`.

    Raises:
        MotionError: It plays none, or one without keys.
        MorphError: See `cast.member`.
    """
    action = cast.action_of(ob)
    if action is None:
        raise MotionError(f"armature {ob.name!r} plays no generalized action: add it to one first")
    start = time.perf_counter()
    member = cast.member(ob, action)
    first, last = options.frames or clip.range_of(member, scene)
    frames = first + np.arange(int((last - first) / options.rate + 1e-6) + 1.0)
    bound = time.perf_counter()
    walk = yield from retarget.within(0.0, 0.25, walks.taken(member, scene, frames, options.rate))
    found = yield from retarget.within(0.25, 0.5, clip.clip_of(member, ob, scene, frames, options.rate))
    sampled = time.perf_counter()
    yield 0.5
    lower = None if walk is None else walk.layer(found.frames)
    played = yield from retarget.within(0.5, 1.0, long_clip.evaluate(member.part, found.values, found.targets, lower))
    played = jiggles.over(member, scene, played, found, walk, options.rate)
    seconds = {"bind": bound - start, "sample": sampled - bound, "evaluate": time.perf_counter() - sampled}
    return Take(member, found, played, seconds, options.rate, walk)


def carried(taken: Take, scene: bpy.types.Scene) -> Generator[float, None, Take]:
    """Carry a take onto the controls of its rig, if it has any, in steps; yields the share done and returns the take.

    Raises:
        RigError: The rig is posed by controls, and none could be found.
        MappingError: A control that the user has named does not exist.
    """
    made = yield from on_controls.written(taken.member, taken.played, taken.clip.frames, scene)
    return replace(taken, on_controls=made)


def write(taken: Take, options: Options) -> Outcome:
    """Key what a character plays in a new action and make it play that; the generalized action is kept.

    Raises:
        MotionError: The template of the name is wrong.
    """
    start = time.perf_counter()
    member, found, played = taken.member, taken.clip, taken.played
    ob, names = member.rig.object, member.rig.skeleton.names
    name = action_name(options.name, member.action.name, ob.name)
    member.action.use_fake_user = True
    deforming = deform_keys.channels_of(member, played)
    moved = channels.body_bones(member.rig, [names.index(c.bone) for c in deforming if c.bone in names])
    if taken.on_controls is None:
        keyed = [*pose.channels_of(member.rig, played), *deforming]
        moved += channels.body_bones(member.rig, played.bones)
    else:
        keyed = [*taken.on_controls.channels, *deforming]
        moved += taken.on_controls.body
    action, slot = keying.write(
        member.rig, keyed, moved, found.frames, name, keep_others=True, keep_object=member.gait is not None
    )
    more = deform_keys.write(member, played, found.frames, name)
    for event, frame in taken.events:
        action.pose_markers.new(event).frame = round(frame)
    cast.forget(ob)
    taken.seconds["write"] = time.perf_counter() - start
    return Outcome(action, slot, taken, tuple(more), taken.report())


def bake(
    obs: Sequence[bpy.types.Object], scene: bpy.types.Scene, options: Options
) -> Generator[float, None, list[Outcome]]:
    """Bake characters in steps; yields the share done and returns the outcomes.

    All are played before the first is written, so that those that reach for each other see each other as they are
    live. When it fails or is closed before its end, the actions that it has made are removed and all characters play
    what they played before.

    Raises:
        MorphError: See `take`.
    """
    taken: list[Take] = []
    for i, ob in enumerate(obs):
        taken.append((yield from retarget.within(i / len(obs), (i + 1) / len(obs), _taken(ob, scene, options))))
    return write_all(taken, options)


def _taken(ob: bpy.types.Object, scene: bpy.types.Scene, options: Options) -> Generator[float, None, Take]:
    found = yield from retarget.within(0.0, 0.5, take(ob, scene, options))
    return (yield from retarget.within(0.5, 1.0, carried(found, scene)))


def write_all(taken: Sequence[Take], options: Options) -> list[Outcome]:
    """Write takes; all of them, or none.

    Raises:
        MotionError: The template of the name is wrong.
    """
    before = [(one.member.rig.object, actions.assigned(one.member.rig.object)) for one in taken]
    done: list[Outcome] = []
    try:
        done.extend(write(one, options) for one in taken)
    except BaseException:
        for ob, kept in before:
            actions.assign(ob, *kept)
        bpy.data.batch_remove([made for outcome in done for made in (outcome.action, *outcome.more)])
        raise
    return done


def action_name(template: str, action: str, character: str) -> str:
    """Return the name of a new action.

    Raises:
        MotionError: The template has a field besides ``{action}`` and ``{character}``, or a lone brace.
    """
    return filled(template, "action name", action=action, character=character)
