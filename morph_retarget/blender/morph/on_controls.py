"""Characters whose bones follow controls: what the deform bones play is carried onto the controls that pose them.

An action binds to the deform bones as if they were a rig of their own. Baked, what Blender makes of the controls is
looked at and put right; live, each frame gets the first answer, which is exact for controls that turn parts.
"""

from collections.abc import Collection, Generator, Mapping
from dataclasses import dataclass

import bpy
import numpy as np

from ...core import keyed, pipeline
from ...core.arrays import Array
from ...core.character.character import Character
from ...core.character.control_given import Reaching
from ...core.errors import listed
from ...core.mocap import kinematics
from ...core.mocap.motion import Motion
from ...core.mocap.plan import RetargetSettings
from ...core.mocap.plan import prepare as prepare_plan
from ...core.play import Played
from .. import rig, writing
from ..controls import carrying, reading
from ..controls.carrying import Strings
from ..controls.task import Onto, Task
from ..properties import of_rig, of_scene
from ..sampling import Clip, seconds_per_frame
from ..writing import Written
from .member import Member
from .pose import Setting

_AS_PLAYED = RetargetSettings(plant_feet=False)
"""From a body to itself nothing is to be changed."""
TURNED = 1e-3
"""A bone that is turned by less is not missed [rad]."""


@dataclass(frozen=True, eq=False)
class OnControls:
    """A character's controls, ready to be set frame by frame, whatever it plays."""

    character: Character
    """What the deform bones are."""
    said: tuple[Mapping[str, str], Mapping[str, Reaching]]
    """The user's own controls, and what is said of how hands and feet are brought to places, by joint."""
    strings: Strings

    def setting(self, played: Played, hands_off: Collection[str] = ()) -> Setting:
        """Return what the first frame of a played clip sets on controls, but for those to leave as they are."""
        links, skeleton = self.strings.work.plan.links, self.character.skeleton
        pose, place = keyed.played(skeleton, played), self.character.local_to_character
        turns = kinematics.source_turns(links, skeleton, pose, place)
        points = kinematics.source_points(links, pose.positions, place)
        return Setting.on(self.strings.work.target, self.strings.pull(Motion(turns, points)), hands_off)

    def switch(self) -> None:
        """Let the controls count, where others do."""
        ob = self.strings.work.target.object
        for channel in self.strings.switches:
            if reading.value(ob, channel) != channel.values[0, 0]:
                reading.switch(ob, channel)
                ob.update_tag()


_known: dict[int, OnControls] = {}


def forget() -> None:
    """Drop what was found of controls: undo and loading replace the rigs."""
    _known.clear()


def of(member: Member) -> OnControls | None:
    """Return the controls of a character, found once and kept; None for one that is posed by its bones.

    Raises:
        RigError: It has no controls that could be found.
        MappingError: A control that the user has named does not exist.
    """
    if not member.follows_controls:
        return None
    known, own = _known.get(member.rig.uid), of_rig(member.rig.object)
    said = own.controls(), own.reaches()
    if known is None or known.character is not member.character or known.said != said:
        strings = carrying.prepare(_task(member), Onto.AUTO, rig.scene_of())
        known = _known[member.rig.uid] = OnControls(member.character, said, strings)
    return known


def moves(member: Member) -> Mapping[str, str] | None:
    """Return which bone of a character each control is moved for, None where its bones are posed or were not yet."""
    known = _known.get(member.rig.uid)
    return known.strings.moves if known is not None and member.follows_controls else None


def setting_of(member: Member, played: Played, hands_off: Collection[str] = ()) -> Setting:
    """Return what the first frame of a played clip sets on pose bones, but for those to leave as they are.

    Raises:
        MorphError: See `of`.
    """
    found = of(member)
    return Setting.of(member.rig, played, hands_off) if found is None else found.setting(played, hands_off)


def written(
    member: Member, played: Played, frames: Array, scene: bpy.types.Scene
) -> Generator[float, None, Written | None]:
    """Carry what a character plays onto its controls in steps; yields the share done.

    They are those that the scene's settings ask for.

    Args:
        member: The character.
        played: What it plays.
        frames: Of the scene, shape (frame,).
        scene: Gives the settings and the frame rate.

    Returns:
        None for a character that is posed by its bones.

    Raises:
        RigError: It has no controls that could be found.
        MappingError: A control that the user has named does not exist.
    """
    if not member.follows_controls:
        return None
    task, step = _task(member), seconds_per_frame(scene)
    clip = Clip(member.action.name, frames, step, keyed.played(member.character.skeleton, played), ())
    result = pipeline.evaluate(task.plan, clip.pose, step)
    chosen = of_scene(scene).options().onto
    onto = chosen if chosen in {Onto.FK, Onto.IK} else Onto.AUTO
    return (yield from writing.written(clip, task, result, onto, False, scene))


def told(member: Member, played: Played) -> tuple[str, ...]:
    """Return which bones an action turns that no control is known of, in words."""
    if not member.follows_controls:
        return ()
    linked, names = {int(bone) for bone in _task(member).plan.links.target}, member.rig.skeleton.names
    turned = np.abs(played.basis[..., 1:]).max(axis=(0, 2)) > 0.5 * TURNED
    lost = [names[bone] for bone in played.bones[turned].tolist() if bone not in linked]
    return (f"no control is known that turns {listed(map(repr, lost))}: they stay as they are",) if lost else ()


def _task(member: Member) -> Task:
    own, character = of_rig(member.rig.object), member.character
    plan = prepare_plan(character, character, _AS_PLAYED)
    return Task(rig.read(member.rig.object), character, plan, own.controls(), own.reaches())
