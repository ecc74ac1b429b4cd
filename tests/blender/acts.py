"""Acts for tests: characters that play a generalized action together, and what they are told and show."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from morph_retarget.blender.io import load
from morph_retarget.blender.morph import analyses, cast, definitions, keys, perform, stage, telling
from morph_retarget.blender.morph.properties import MORPHRETARGET_PG_channel, of_action
from morph_retarget.blender.morph.values import MORPHRETARGET_PG_values
from morph_retarget.blender.properties import of_rig
from morph_retarget.core import play, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.morph.channels import Channel
from morph_retarget.core.solve.goals import Goals
from tools import armatures, creatures

CHARACTERS = Path(__file__).resolve().parent.parent.parent / "sample_blends" / "characters"
FRAMES = np.arange(1.0, 21.01, 0.25)
"""Frames at which it is enough to look, of actions from 1 to 20."""


@dataclass(frozen=True)
class Act:
    """Some characters and what they play."""

    action: bpy.types.Action
    obs: Sequence[bpy.types.Object]

    def channel(self, name: str = "") -> MORPHRETARGET_PG_channel:
        """Return the definition of a channel, of the first one without a name."""
        own = of_action(self.action).channels
        return own[name] if name else own[0]

    def values(self, i: int = 0, name: str = "") -> MORPHRETARGET_PG_values:
        """Return the values of a channel on one of the characters."""
        return of_rig(self.obs[i]).channels[name or self.channel().name]

    def key(self, frame: float, name: str = "", **values: object) -> None:
        """Key values of a channel at a frame."""
        item = self.values(0, name)
        for part, value in values.items():
            setattr(item, part, value)
        keys.insert(self.obs[0], item.name, list(values), frame)

    def curve(self, part: str = "position", index: int = 0, name: str = "") -> bpy.types.FCurve:
        """Return one curve of a channel."""
        return keys.curves(self.action)[keys.path(name or self.channel().name, part), index]

    def shown(self, i: int = 0) -> Goals:
        """Return the goals that a character shows."""
        found = perform.shown(self.obs[i])
        assert found is not None
        return found.played.goals

    def tell(self, i: int = 0) -> str:
        """Return what a character says of its problems."""
        return "\n".join(telling.tell(self.obs[i]))


def act(obs: Iterable[bpy.types.Object], *channels: Channel, name: str = "Act") -> Act:
    """Return characters that play a new action with some channels; the first one is the active object."""
    action = bpy.data.actions.new(name)
    for channel in channels:
        definitions.add(action, channel)
    found = tuple(obs)
    for ob in found:
        cast.add(ob, action)
    bpy.context.view_layer.objects.active = found[0]
    bpy.context.scene.frame_set(1)
    return Act(action, found)


def creature(name: str) -> bpy.types.Object:
    """Return one of our creatures as a bare armature, bones rolled at random."""
    ob = armatures.build(name.capitalize(), creatures.CREATURES[name](), np.random.default_rng(7))
    analyses.of(ob)  # as it stands here, wherever it goes
    return ob


def character(name: str) -> bpy.types.Object:
    """Return one of the characters that are shipped, with its mesh."""
    return load.add(load.Request(CHARACTERS / f"{name}.blend"))[0]


def empty_object(name: str, place: Sequence[float]) -> bpy.types.Object:
    """Return an object without data, somewhere in the world."""
    ob = bpy.data.objects.new(name, None)
    bpy.context.scene.collection.objects.link(ob)
    ob.location = place
    bpy.context.view_layer.update()
    return ob


def goals(ob: bpy.types.Object, frames: Array = FRAMES) -> Goals:
    """Return where the curves of its action bring the bodies of a character, at any frames."""
    member = cast.member(ob)
    values = stage.values_over(member, ob, frames)
    return play.goals_at(member.part, values, stage.targets_of(member, ob, bpy.context.evaluated_depsgraph_get()))


def motion(ob: bpy.types.Object, frames: Array = FRAMES, body: str = "") -> tuple[Array, Array]:
    """Return places [m] and turns of one body over frames, shapes (frame, 3) and (frame, 4); the first without a name.

    Character frame.
    """
    found = goals(ob, frames)
    place = [cast.member(ob).bodies.names[b] for b in found.bodies].index(body) if body else 0
    return found.positions[:, place], found.turns[:, place]


def apart(one: tuple[Array, Array], other: tuple[Array, Array]) -> float:
    """Return how far two motions are from each other at most [m or rad]."""
    return max(float(np.abs(one[0] - other[0]).max()), float(quat.angle_between(one[1], other[1]).max()))


def heads(ob: bpy.types.Object, bones: Iterable[str]) -> Array:
    """Return where bones are in the world as Blender shows them now, shape (bone, 3)."""
    seen = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return np.array([seen.matrix_world @ seen.pose.bones[bone].head for bone in bones])


def pose(ob: bpy.types.Object) -> Array:
    """Return all matrices of an armature's bones as Blender shows them now, armature space, shape (bone, 4, 4)."""
    seen = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return np.array([bone.matrix for bone in seen.pose.bones])


def in_world(ob: bpy.types.Object, points: Array) -> Array:
    """Return points of a character's frame in the world, shape (..., 3)."""
    local = cast.member(ob).character.local_to_character.inverse().points(points)
    return local @ np.array(ob.matrix_world)[:3, :3].T + np.array(ob.matrix_world)[:3, 3]
