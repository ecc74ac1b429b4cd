"""What Blender makes of channels: an armature alone on a stage of its own, with an action that is not kept."""

import contextlib
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ...core.arrays import Array, Indices
from .. import actions, sampling
from ..actions import Writer
from ..channels import Channel
from ..rig import Rig, pose_of, rotations_of

STEPS_PER_YIELD = 16
NAME = "Morph Retarget"

stages: list[int] = []
"""Session-wide numbers of the scenes in which something is evaluated; handlers leave them alone."""


@dataclass(frozen=True, eq=False)
class Poses:
    """Some bones over some frames as Blender evaluates them."""

    rotations: Array
    """Armature space, shape (frame, bone, 4)."""
    positions: Array
    """Heads, armature space, shape (frame, bone, 3)."""
    moves: Array
    """How the object moves, from its space to that space before, shape (frame, 4, 4)."""


@dataclass(frozen=True, eq=False)
class Stage:
    """A scene with an armature and nothing else, so that no mesh is evaluated and no frame of the user's is changed."""

    rig: Rig
    scene: bpy.types.Scene

    def show(self, channels: Sequence[Channel], frames: Array) -> None:
        """Let the armature play channels, keyed on ``frames`` or as many of them as they have values."""
        ob = self.rig.object
        self.clear()
        writer = Writer(NAME, ob)
        for channel in channels:
            writer.write(channel.path(ob), channel.values, frames[: len(channel.values)], NAME)
        actions.play(ob, writer.action, writer.slot)

    def clear(self) -> None:
        """Remove what was played."""
        playing, _ = actions.assigned(self.rig.object)
        if playing is not None and playing.name.startswith(NAME) and playing.users <= 1:
            actions.assign(self.rig.object, None, None)
            bpy.data.actions.remove(playing)

    def at(self, frame: float) -> bpy.types.Object:
        """Return the evaluated armature at a frame."""
        sampling.set_frame(self.scene, frame)
        graph = self.scene.view_layers[0].depsgraph
        assert graph is not None, "the scene was evaluated"
        return self.rig.object.evaluated_get(graph)

    def poses(self, bones: Indices, frames: Array) -> Generator[float, None, Poses]:
        """Evaluate frames in steps; yields the share done and returns where ``bones`` are."""
        ob, places = self.rig.object, self.rig.pose_order[bones]
        rest = np.linalg.inv(np.array(ob.matrix_world, dtype=np.float64))
        buffer = np.empty(len(self.rig.skeleton) * 16, dtype=np.float32)
        matrices, moves = np.empty((len(frames), len(bones), 4, 4)), np.empty((len(frames), 4, 4))
        for i, frame in enumerate(frames.tolist()):
            evaluated = self.at(frame)
            pose_of(evaluated).bones.foreach_get("matrix", buffer)
            matrices[i] = buffer.reshape(-1, 4, 4)[places].transpose(0, 2, 1)
            moves[i] = rest @ np.array(evaluated.matrix_world, dtype=np.float64)
            if i % STEPS_PER_YIELD == 0:
                yield i / len(frames)
        return Poses(rotations_of(matrices[..., :3, :3]), matrices[..., :3, 3], moves)


@contextlib.contextmanager
def stage(rig: Rig, scene: bpy.types.Scene) -> Iterator[Stage]:
    """Give a stage for a while; afterwards the armature plays what it played before.

    Args:
        rig: The armature.
        scene: Gives the frame rate.
    """
    ob, kept = rig.object, actions.assigned(rig.object)
    data = ob.animation_data
    weight = (data.action_influence, data.action_blend_type) if data else None
    own = bpy.data.scenes.new(NAME)
    number = own.session_uid
    stages.append(number)
    try:
        own.render.fps, own.render.fps_base = scene.render.fps, scene.render.fps_base
        own.collection.objects.link(ob)
        actions.assign(ob, None, None)
        given = Stage(rig, own)
        try:
            yield given
        finally:
            given.clear()
    finally:
        actions.assign(ob, *kept)
        if weight is not None and ob.animation_data is not None:
            ob.animation_data.action_influence, ob.animation_data.action_blend_type = weight
        bpy.data.scenes.remove(own)
        stages.remove(number)
