"""Actions and files as what libraries of motions are built from: sampled on their armatures, with what is known."""

from collections.abc import Generator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import bpy

from ...core.character.character import Character
from ...core.clips.character_model import RATE
from ...core.clips.motions.annotations import Annotations
from ...core.directing.building import Builder, SourceClip, Taken
from ...core.errors import MorphError
from ...core.skeleton import Pose
from .. import actions, retarget, rig, sampling
from ..io import load
from ..properties import of_rig
from . import annotations


@dataclass(frozen=True, eq=False)
class Sampled:
    """An action on its armature."""

    name: str
    character: Character
    """What the armature is."""
    pose: Pose
    """Armature space, where the object stood at rest, shape (frame, bone, ...)."""
    first: float
    """Frame of the action at which it begins."""
    seconds_per_frame: float
    known: Annotations | None
    """What the action keeps of its annotations, None where it keeps none."""

    @property
    def feet(self) -> list[str]:
        """Bones that are feet, in the order in which annotations count them."""
        return feet_of(self.character)

    @property
    def rate(self) -> float:
        """Frames of clips for each frame of the action."""
        return RATE * self.seconds_per_frame


@dataclass(frozen=True, eq=False)
class Wanted:
    """An action that shall be taken into a library."""

    armature: bpy.types.Object
    action: bpy.types.Action
    slot: bpy.types.ActionSlot
    name: str = ""
    """Of the motion; that of the action when empty."""


def sample(
    wanted: Wanted, scene: bpy.types.Scene, annotated: bool = True, character: Character | None = None
) -> Generator[float, None, Sampled]:
    """Sample an action in steps, the part that its manual frame range tells; yields the share done.

    Args:
        wanted: The action.
        scene: Gives the frame rate; its frame is put back after stepping.
        annotated: Whether what the action keeps of its annotations counts.
        character: What the armature is, where that is known.

    Raises:
        MotionError: The action has no keys, or moves none of the armature's bones; an annotation makes no sense.
    """
    action, own = wanted.action, rig.read(wanted.armature)
    part = (round(action.frame_start), round(action.frame_end)) if action.use_frame_range else None
    clip = yield from sampling.sample(own, action, wanted.slot, scene, part)
    found = character or retarget.character_of(own, of_rig(wanted.armature).overrides(), clip)
    first, known = float(clip.frames[0]), None
    if annotated and annotations.of_action(action).is_annotated:
        known = annotations.read(action, feet_of(found), first, RATE * clip.seconds_per_frame)
    return Sampled(wanted.name or action.name, found, clip.pose, first, clip.seconds_per_frame, known)


def feet_of(character: Character) -> list[str]:
    """Return the bones of a character that are feet, in the order in which annotations count them."""
    return [character.skeleton.names[leg.end] for leg in character.legs]


# --- building ---


def files_of(folder: Path) -> list[Path]:
    """Return the files of a folder that may hold clips, in order of their names."""
    return sorted(path for path in folder.iterdir() if path.suffix.lower() in load.KINDS)


def wanted_of(obs: Sequence[bpy.types.Object]) -> list[Wanted]:
    """Return all actions of the file that move one of some armatures, each on the first that it moves."""
    found: dict[bpy.types.Action, Wanted] = {}
    for ob in obs:
        for action, slot in actions.of_armature(ob):
            found.setdefault(action, Wanted(ob, action, slot))
    return list(found.values())


def take(
    builder: Builder, wanted: Sequence[Wanted], files: Sequence[Path], scene: bpy.types.Scene
) -> Generator[float, None, list[Taken]]:
    """Take actions and files into a library in steps; yields the share done, returns what became of each clip.

    Files are borrowed one after the other; nothing of them stays.
    """
    out: list[Taken] = []
    count = max(len(wanted) + len(files), 1)
    for share, taken in _take_all(builder, wanted, scene):
        out += taken
        yield share * len(wanted) / count
    for i, path in enumerate(files):
        with ExitStack() as stack:
            try:
                obs = stack.enter_context(load.borrowed(load.Request(path)))
            except MorphError as error:
                out.append(Taken(path.name, False, str(error)))
                continue
            inside = _named(wanted_of(obs), path)
            if not inside:
                out.append(Taken(path.name, False, "it holds no action that moves an armature"))
            for share, taken in _take_all(builder, inside, scene):
                out += taken
                yield (len(wanted) + i + share) / count
    return out


def _named(wanted: list[Wanted], path: Path) -> list[Wanted]:
    """Return the actions of a file; a single one is called like the file, since importers often name them all alike."""
    if len(wanted) != 1:
        return wanted
    (one,) = wanted
    return [Wanted(one.armature, one.action, one.slot, path.stem)]


def _take_all(
    builder: Builder, wanted: Sequence[Wanted], scene: bpy.types.Scene
) -> Generator[tuple[float, list[Taken]], None, None]:
    """Take actions into a library; yields the share done, with what became of clips that are."""
    characters: dict[bpy.types.Object, Character] = {}
    for i, one in enumerate(wanted):
        try:
            work = sample(one, scene, character=characters.get(one.armature))
            while True:
                try:
                    share = next(work)
                except StopIteration as end:
                    sampled: Sampled = end.value
                    break
                yield (i + share) / len(wanted), []
        except MorphError as error:
            yield (i + 1) / len(wanted), [Taken(one.name or one.action.name, False, str(error))]
            continue
        if sampled.character.rest_is_pose:  # else each clip tells anew what the body is
            characters[one.armature] = sampled.character
        clip = SourceClip(sampled.name, sampled.character, sampled.pose, sampled.seconds_per_frame, known=sampled.known)
        yield (i + 1) / len(wanted), [builder.take(clip)]
