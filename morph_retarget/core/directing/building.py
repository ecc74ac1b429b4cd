"""Building a library from clips of any rigs: each is transferred once onto the body of the library.

    clip -> annotations and cycles, found (Grünvogel 2003 §5.4) -> mocap transfer (Feng 2013 §5) -> base motion

What becomes of each clip is told; one that cannot be used does not stop the others.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from .. import keyed, pipeline, quat
from ..character.character import Character
from ..clips import posing
from ..clips.character_model import RATE, CharacterModel
from ..clips.clip import ClipPrimitive
from ..clips.motions import cutting
from ..clips.motions.annotations import Annotations
from ..clips.motions.base_motion import BaseMotion
from ..clips.motions.kinds import GESTURE, OTHER
from ..clips.motions.library import Library
from ..clips.operators.loop import Loop
from ..clips.spots import STANDS
from ..clips.travel import Travel
from ..errors import MorphError, MotionError
from ..mocap import plan as planning
from ..mocap.plan import Plan
from ..morph.bodies import Bodies
from ..pipeline import Result
from ..play import root_of
from ..skeleton import Pose


@dataclass(frozen=True, eq=False)
class SourceClip:
    """A motion of some rig, to be taken into a library."""

    name: str
    character: Character
    """Who moves."""
    pose: Pose
    """Armature space, shape (frame, bone, ...)."""
    seconds_per_frame: float
    """Time between frames [s]."""
    kind: str = ""
    """What it is an example of; found when empty."""
    style: str = ""
    known: Annotations | None = None
    """All that is known of it by hand, frames at `RATE` and feet of its own body; found when None. The last frame of a
    cycle shows its first again."""


@dataclass(frozen=True)
class Taken:
    """What became of a clip."""

    name: str
    """Of the base motion; of the clip where there is none."""
    kept: bool
    """Whether it is in the library."""
    told: str
    """What was found, or why it was left out."""

    def __str__(self) -> str:
        return f"{self.name}: {self.told}" if self.kept else f"{self.name} is left out: {self.told}"


@dataclass(frozen=True, eq=False)
class Built:
    """A library and how it came about."""

    library: Library
    taken: tuple[Taken, ...]
    """What became of each clip, in their order."""


@dataclass(eq=False)
class Builder:
    """Takes clips into a library one by one, so that who waits sees how far it is and can stop it."""

    library: Library
    _plans: dict[int, tuple[CharacterModel, Plan]] = field(default_factory=dict[int, tuple[CharacterModel, Plan]])
    """Of the characters that were met, by their ids."""

    def take(self, clip: SourceClip) -> Taken:
        """Take a clip into the library, or tell why it cannot be used."""
        name = _free(clip.name, self.library)
        try:
            motion, named = self._motion(name, clip)
        except MorphError as error:
            return Taken(clip.name, False, str(error))
        self.library = self.library.with_motions([motion])
        return Taken(name, True, told(motion) + named)

    def _motion(self, name: str, clip: SourceClip) -> tuple[BaseMotion, str]:
        if len(clip.pose) < SHORTEST:
            raise MotionError(f"it has {len(clip.pose)} frames: choose one with at least {SHORTEST}")
        own, plan = self._met(clip.character)
        if clip.known is not None:
            motion = _known(name, own, clip, clip.known)
        else:
            motion = cutting.motion_of(name, own, clip.pose, clip.seconds_per_frame, clip.kind, clip.style)
        if plan is not None:
            motion = transferred(motion, plan, self.library.model)
        if clip.kind or clip.known is not None or motion.kind not in {GESTURE, OTHER}:
            return motion, ""
        # What has no name of its own is called by that of its clip.
        kind = kind_of(clip.name)
        return replace(motion, annotations=replace(motion.annotations, kind=kind)), f"; called {kind!r} by its name"

    def _met(self, character: Character) -> tuple[CharacterModel, Plan | None]:
        """Return a character as the body of clips, and how its motions come to the library's body if that is another.

        Raises:
            MorphError: They share too little.
        """
        model = self.library.model
        if character is model.character:
            return model, None
        known = self._plans.get(id(character))
        if known is None:
            own = CharacterModel(character, character.carrier(root_of(Bodies.of(character))))
            known = self._plans[id(character)] = own, planning.prepare(character, model.character)
        return known


SHORTEST = 3
"""A clip with fewer frames shows no motion."""


def build(model: CharacterModel, clips: Sequence[SourceClip]) -> Built:
    """Return a library of clips.

    Args:
        model: The body of the library.
        clips: Of any rigs.
    """
    builder = Builder(Library(model))
    taken = tuple(builder.take(clip) for clip in clips)
    return Built(builder.library, taken)


def transferred(motion: BaseMotion, plan: Plan, model: CharacterModel) -> BaseMotion:
    """Return a base motion of one body as one of another.

    What stands in it stands in the other, on the ground over which the travel leads: so clips that go on the spot get
    planted feet too. A cycle is transferred three times in a row, and the second is taken.

    Args:
        motion: Of the plan's source.
        plan: From its body to the other.
        model: The other body.
    """
    own, clip, count = motion.annotations, motion.clip, len(motion.clip.data)
    rows = np.arange(float(3 * count if own.cycle else count))
    source = Loop(3, clip) if own.cycle else clip
    frames, travel = source.frame(rows), source.travel(rows)
    feet = feet_between(plan.source, model.character)
    standing = np.zeros((len(frames), len(plan.links.legs)), dtype=np.bool_)
    for i, leg in enumerate(plan.links.legs):
        found = np.flatnonzero(clip.model.feet == plan.links.source[leg.end, 0])
        if len(found):
            standing[:, i] = frames.contacts[:, found[0]] > STANDS
    result = pipeline.evaluate(plan, posing.pose_of(clip.model, frames, travel), 1.0 / RATE, standing)
    contacts = np.zeros((len(frames), len(model.feet)))
    for theirs, ours in feet.items():
        contacts[:, ours] = frames.contacts[:, theirs]
    way = Travel(plan.scale * travel.places, travel.headings)
    data = posing.frames_of(model, on_model(model, plan, result), way, contacts)
    if own.cycle:
        data, way = data[count : 2 * count], way[count : 2 * count]
    made = ClipPrimitive(clip.name, model, data, way.since(way[:1]))
    sized = {name: value * plan.scale if name in LENGTHS else value for name, value in own.parameters.items()}
    strikes = tuple(replace(s, foot=feet[s.foot]) for s in own.strikes if s.foot in feet)
    parts = tuple(part for part in own.parts if part in model.parts)
    known = replace(own, speed=plan.scale * own.speed, strikes=strikes, parts=parts, parameters=sized)
    return BaseMotion(motion.name, made, known)


LENGTHS = {"speed", "distance", "height"}
"""Parameters that are larger for larger bodies."""


def on_model(model: CharacterModel, plan: Plan, result: Result) -> Pose:
    """Return a transferred clip as poses of the body, armature space, with the root carrying all.

    Where the hips have only the legs, a transfer moves what else hangs on the root beside them; here the root goes
    along with the hips. What is above it does so too, since a master bone that stays behind is no part of a motion.
    """
    skeleton, root, hips = model.character.skeleton, model.root, int(plan.links.target[0])
    pose = keyed.pose_of(skeleton, result.bones, result.basis, result.moved, result.shifts)
    rest = skeleton.rest_positions
    turns = quat.multiply(pose.rotations[:, hips], quat.conjugate(skeleton.rest_rotations[hips]))
    placed, turned = {root, *model.moving.tolist()}, {root, *result.bones.tolist()}
    if root != hips and root in skeleton.tree.ancestors[hips]:
        pose.rotations[:, root] = quat.multiply(turns, skeleton.rest_rotations[root])
        pose.positions[:, root] = pose.positions[:, hips] + quat.rotate(turns, (rest[root] - rest[hips])[None])
    for above in skeleton.tree.ancestors[root]:
        pose.positions[:, above] = rest[above] + pose.positions[:, root] - rest[root]
        placed.add(above)
        turned.add(above)
    for bone in range(len(skeleton)):  # parents first
        above = int(skeleton.parents[bone])
        if above >= 0 and bone not in turned:
            local = np.broadcast_to(skeleton.local_rotations[bone], turns.shape)
            pose.rotations[:, bone] = quat.multiply(pose.rotations[:, above], local)
        if above >= 0 and bone not in placed:
            step = np.broadcast_to(skeleton.local_offsets[bone], (len(turns), 3))
            pose.positions[:, bone] = pose.positions[:, above] + quat.rotate(pose.rotations[:, above], step)
    return pose


def feet_between(source: Character, target: Character) -> dict[int, int]:
    """Return for feet of one body those of another that stand in the same place, by side and row."""
    ours = {(leg.row, leg.side): i for i, leg in enumerate(target.legs)}
    return {i: ours[leg.row, leg.side] for i, leg in enumerate(source.legs) if (leg.row, leg.side) in ours}


def _known(name: str, model: CharacterModel, clip: SourceClip, own: Annotations) -> BaseMotion:
    """Return a clip with what is known of it by hand."""
    whole = cutting.whole(name, model, clip.pose, clip.seconds_per_frame)
    count, data, way = len(whole.clip.data), whole.clip.data, whole.clip.way
    if own.cycle:
        # The last frame is the first again, and falls away.
        count = max(count - 1, 1)
        data, way = data[:count], way[:count]
    last = count - (0.0 if own.cycle else 1.0)
    strikes = tuple(strike for strike in own.strikes if 0.0 <= strike.frame <= last)
    known = replace(own, strikes=strikes, style=clip.style or own.style, kind=clip.kind or own.kind)
    return BaseMotion(name, replace(whole.clip, data=data, way=way), known)


def told(motion: BaseMotion) -> str:
    """Return what is known of a base motion in words."""
    own = motion.annotations
    out = [
        " ".join(word for word in (own.style, own.kind, "" if own.phase == "whole" else own.phase, own.side) if word)
    ]
    lasts = motion.clip.length / RATE
    out.append(f"a cycle of {lasts:.2f} s" if own.cycle else f"{lasts:.2f} s")
    if own.speed > 0.0:
        out.append(f"{own.speed:.2f} m/s")
    if own.strikes:
        out.append(f"{len(own.strikes)} footfalls")
    return ", ".join(out)


def kind_of(name: str) -> str:
    """Return the name of a clip as a kind: one word in small letters, as commands write it."""
    words: Iterator[str] = (word.lower() for word in re.findall(r"[^\W_]+", name))
    return "_".join(words) or OTHER


def _free(name: str, library: Library) -> str:
    """Return a name that no base motion has yet."""
    names = {motion.name for motion in library.motions}
    out, number = name, 2
    while out in names:
        out, number = f"{name} {number}", number + 1
    return out
