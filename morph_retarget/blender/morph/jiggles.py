"""Jiggles of characters that play generalized actions: live, and when they are baked.

What is shown at a frame is the simulation from the first frame of the action, whatever was shown before. Far behind
the end of the action it begins later, since nothing is left by then of how it began. It is made over many frames at
once and kept; run-time state, dropped on load, undo and redo.
"""

from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass
from typing import Self

import bpy
import numpy as np

from ...core import jiggling, play, quat
from ...core.arrays import Array, Indices
from ...core.errors import MotionError
from ...core.jiggling import Jiggling
from ...core.morph.channels import TargetKind, Values
from ...core.play import Played
from ...core.skeleton import Pose
from .. import jiggle_bones, ways
from ..locomotion import walks
from ..locomotion.walks import Taken
from ..properties import of_rig
from ..sampling import moved_pose, seconds_per_frame
from . import clip, keys, own_values, stage, targets
from .clip import Clip
from .member import Member
from .stage import ToldTargets, ToldValues

LEAST = 128
"""At least so many frames are simulated at once; twice as many whenever they do not suffice."""
FADED = 40.0
"""Half-lives after which nothing is left of how a simulation began: a millionth of a millionth."""


@dataclass(frozen=True, eq=False)
class _Steady:
    """What a simulation takes for the same at all frames: values without curves, targets, the frame rate."""

    positions: Indices
    """Which values of channels no curve gives, counted through channels and components."""
    rotations: Indices
    weights: Indices
    targets: tuple[int, ...]
    """Channels with a target that nothing moves, as seen from the character."""

    @classmethod
    def of(cls, member: Member, moving: Container[int]) -> Self:
        """Return what is steady about an action as its curves are now, but for channels with targets that move."""
        curves, names = keys.curves(member.action), [channel.name for channel in member.definition.channels]

        def free(prop: str, width: int) -> Indices:
            paths = [(keys.path(name, prop), k) for name in names for k in range(width)]
            return np.flatnonzero([path not in curves for path in paths])

        still = tuple(i for i in range(len(names)) if i not in moving)
        return cls(free("position", 3), free("rotation", 4), free("weight", 1), still)

    def read(self, scene: bpy.types.Scene, values: Values, places: Mapping[int, Array]) -> tuple[object, ...]:
        """Return it as it is at one frame, to see whether it has changed."""
        return (
            scene.render.fps,
            scene.render.fps_base,
            values.positions.ravel()[self.positions].tobytes(),
            values.rotations.ravel()[self.rotations].tobytes(),
            values.weights.ravel()[self.weights].tobytes(),
            *(places[i].tobytes() for i in self.targets if i in places),
        )


@dataclass(frozen=True, eq=False)
class _Simulated:
    """The jiggles of a character over some frames."""

    member: Member
    jiggling: Jiggling
    action: int
    """First frame of the action."""
    stretch: int
    """Frames, in whole rounds of the action, after which nothing is left of how it began."""
    first: int
    """Frame from which on it was simulated."""
    basis: Array
    """Rotations of the jiggling bones, shape (frame, n, 4)."""
    steady: _Steady
    told: tuple[object, ...]
    """What was steady when it was made."""

    def covers(self, frame: float) -> bool:
        """Return whether it tells of a frame."""
        begins = _beginning(self.action, self.stretch, frame) == self.first
        return begins and frame - self.first <= len(self.basis) - 1.0

    def at(self, frame: float) -> Array:
        """Return the rotations at one frame, which need not be whole, shape (1, n, 4)."""
        place = min(max(frame - self.first, 0.0), len(self.basis) - 1.0)
        row = int(place + 1e-4)
        if place - row < 1e-4:
            return self.basis[row : row + 1]
        # Keys that were baked go straight from frame to frame as well.
        now, then = self.basis[row], self.basis[row + 1]
        then = np.where(quat.dot(now, then)[..., None] < 0.0, -then, then)
        return quat.normalize(now + (place - row) * (then - now))[None]


_simulated: dict[int, _Simulated] = {}
_edited: set[int] = set()
"""Characters whose curves have changed since; what they show while they are edited is that of before."""
problems: dict[int, str] = {}
"""Why the jiggles of a character are not shown live."""


def forget() -> None:
    """Drop all simulations; they are made anew when they are next needed."""
    _simulated.clear()
    _edited.clear()
    problems.clear()


def welcome(ob: bpy.types.Object) -> None:
    """Switch jiggles on for an armature that has never played a generalized action; others keep what they have."""
    if not len(of_rig(ob).channels):
        of_rig(ob).jiggles.enabled = True


def curves_edited(obs: Iterable[bpy.types.Object]) -> None:
    """Let the jiggles of characters follow an edit of curves with the next frame."""
    _edited.update(ob.session_uid for ob in obs)


def prepare(member: Member, played: Played) -> Jiggling:
    """Return what jiggles on a character while it plays its action; nothing does that follows controls."""
    own, found = member.rig, jiggle_bones.curves_of(member.rig.object)
    posed = {*(int(bone) for bone in played.bones), played.root, *jiggle_bones.posed(own, found)}
    if member.follows_controls:
        posed = {*range(len(own.skeleton))}
    return jiggling.prepare(member.character, posed, of_rig(own.object).jiggles.settings())


def is_still(member: Member) -> bool:
    """Return whether it is known that nothing jiggles on a character."""
    ob = member.rig.object
    if not of_rig(ob).jiggles.enabled:
        return True
    found = _simulated.get(ob.session_uid)
    return found is not None and found.member is member and not found.jiggling and ob.session_uid not in _edited


def shown(
    member: Member,
    played: Played,
    scene: bpy.types.Scene,
    graph: bpy.types.Depsgraph,
    told: ToldValues,
    seen: ToldTargets,
    anew: bool,
) -> Played:
    """Return the one frame that a character plays, with its jiggles.

    Args:
        member: How the character plays its action.
        played: The frame.
        scene: Gives the frame.
        graph: Gives what it goes along and on.
        told: Values of the channels at the frame.
        seen: Targets at the frame.
        anew: Whether the frame has changed; while something is edited, what was simulated before is good enough.
    """
    ob = member.rig.object
    problems.pop(ob.session_uid, None)
    if not of_rig(ob).jiggles.enabled:
        _simulated.pop(ob.session_uid, None)
        return played
    values, places = told.values, seen.places
    before, frame = _simulated.get(ob.session_uid), scene.frame_current_final
    if before is not None and (before.member is not member or not before.covers(frame)):
        before = None
    if before is not None and anew:
        way = walks.number(member, scene, graph)
        same = ob.session_uid not in _edited and before.told == (way, *before.steady.read(scene, values, places))
        before = before if same else None
    if before is None:
        try:
            before = _simulate(member, scene, graph, played, values, places)
        except MotionError as error:
            problems[ob.session_uid] = str(error)
            return played
        _simulated[ob.session_uid] = before
        _edited.discard(ob.session_uid)
    return jiggling.with_jiggles(played, before.jiggling, before.at(frame)) if before.jiggling else played


def _simulate(
    member: Member,
    scene: bpy.types.Scene,
    graph: bpy.types.Depsgraph,
    played: Played,
    values: Values,
    places: Mapping[int, Array],
) -> _Simulated:
    """Return the jiggles until at least the end of an action, or the present frame, if that is later.

    Raises:
        MotionError: The frames before cannot be known without setting them.
    """
    ob, found, frame = member.rig.object, prepare(member, played), scene.frame_current_final
    moving = _moving(member) if found else []
    steady = _Steady.of(member, moving)
    told = (walks.number(member, scene, graph), *steady.read(scene, values, places))
    if not found:
        return _Simulated(member, found, 0, 10**6, 0, np.empty((2 * 10**6, 0, 4)), steady, told)
    _check_known(member, moving)
    known = member.gait is not None or keys.curves(member.action)
    first, last = clip.range_of(member, scene) if known else (int(frame), int(frame))
    stretch = _stretch(found, last - first, seconds_per_frame(scene))
    start = _beginning(first, stretch, frame)
    count = LEAST
    while count <= max(last, frame) - start + 1.0:
        count *= 2
    frames = start + np.arange(float(count))
    places = {**places, **{i: _places(member, i, frames) for i in moving}}
    lower = walks.over(member, scene, graph, frames)
    whole = play.evaluate(member.part, stage.values_over(member, ob, frames), places, lower)
    basis = _changes(member, found, scene, whole, frames, last - first)
    return _Simulated(member, found, first, stretch, start, basis, steady, told)


def _stretch(found: Jiggling, length: int, step: float) -> int:
    """Return after how many frames nothing is left of how a simulation began, in whole rounds of its action.

    Args:
        found: What jiggles.
        length: Of the action [frames].
        step: Time between frames [s].
    """
    least, round_ = FADED * float(found.chains.half_life.max()) / step, max(length, 1)
    return round_ * max(int(np.ceil(max(least, LEAST) / round_)), 1)


def _beginning(action: int, stretch: int, frame: float) -> int:
    """Return from which frame on it is simulated what is shown at a frame: a whole stretch before it, or more."""
    return action + stretch * max(int((frame - action) // stretch) - 1, 0)


def _moving(member: Member) -> list[int]:
    """Return the channels with external targets that move, as seen from the character."""
    ob, items = member.rig.object, of_rig(member.rig.object).channels
    channels = [i for i, c in enumerate(member.definition.channels) if c.target is TargetKind.EXTERNAL]
    given = {i: items[member.definition.channels[i].name] for i in channels}
    return [
        i
        for i, item in given.items()
        if own_values.has_target(item) and (targets.moves(ob) or targets.moves(item.target, item.target_bone))
    ]


def _check_known(member: Member, moving: Iterable[int]) -> None:
    """Raise an error if values or targets depend on more than keys, which only stepping through frames can tell."""
    ob = member.rig.object
    others = list(clip.driven(ob, member.action))
    for i in moving:
        item = of_rig(ob).channels[member.definition.channels[i].name]
        if item.target_bone or not (ways.readable(item.target) and ways.readable(ob)):
            others.append(f"target {item.target.name!r}")
    if others:
        raise MotionError(f"jiggles are there when it is baked: {others[0]} cannot be followed live")


def _places(member: Member, channel: int, frames: Array) -> Array:
    """Return where keys bring the target of a channel [m], character frame, shape (frame, 3)."""
    ob = member.rig.object
    target = of_rig(ob).channels[member.definition.channels[channel].name].target
    seen = np.linalg.inv(ways.world(ob, frames)) @ ways.world(target, frames)
    return member.character.local_to_character.points(seen[:, :3, 3])


def _changes(
    member: Member, found: Jiggling, scene: bpy.types.Scene, played: Played, frames: Array, last: int
) -> Array:
    own = jiggling.carried(found, played)
    own = Pose(*(np.broadcast_to(part, (len(frames), *part.shape[1:])) for part in (own.rotations, own.positions)))
    moved = ways.over(member.rig, frames)
    return jiggling.changes(found, own if moved is None else moved_pose(own, moved), seconds_per_frame(scene), last)


# --- baking ---


def over(
    member: Member, scene: bpy.types.Scene, played: Played, found: Clip, walk: Taken | None, rate: float
) -> Played:
    """Return a played clip with its jiggles, if the character has them switched on.

    Args:
        member: How the character plays its action.
        scene: Gives the frame rate.
        played: The clip.
        found: What it was played from.
        walk: How the character goes.
        rate: Frames of the action for each frame of the scene.
    """
    ob = member.rig.object
    what = prepare(member, played) if of_rig(ob).jiggles.enabled else None
    if not what:
        return played
    first, last = clip.range_of(member, scene)
    lead, count = 0, len(found.frames)
    if not found.stepped:
        # The simulation begins where the action does, whatever part of it is wanted.
        lead = max(int((found.frames[0] - first) / rate + 1e-6), 0)
        count = max(int((last - found.frames[0]) / rate + 1e-6) + 1, count)
    steps = np.arange(-lead, count, dtype=np.float64)
    whole = played
    if len(steps) > len(found.frames):
        values = stage.values_over(member, ob, found.frames[0] + rate * steps)
        lower = None if walk is None else walk.layer(found.frames[0] + steps)
        whole = play.evaluate(member.part, values, found.targets, lower)
    end = round((last - found.frames[0]) / rate) + lead
    basis = _changes(member, what, scene, whole, found.frames[0] + steps, end)
    return jiggling.with_jiggles(played, what, basis[lead : lead + len(found.frames)])
