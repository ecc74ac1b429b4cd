"""What characters that play a generalized action live cost a frame, beside Blender's own playback of the baked actions.

Live, a frame is solved when it is first shown; after that it is known again. Both are measured, for an action that is
keyed in all of many channels, and for one of the samples.
"""

from collections.abc import Callable
from dataclasses import dataclass

import bpy
import numpy as np

from morph_retarget.blender import actions, registration, retarget
from morph_retarget.blender.morph import bake, cast, definitions, keys, perform
from morph_retarget.blender.morph.bake import Options
from morph_retarget.blender.properties import of_rig
from tools import acting, acts, armatures
from tools.figure import humanoid

from .figures import Figure, medians, seconds, short
from .perform import BUILD, CHANNELS

REPETITIONS = 9
GOALS = {1: 1.0, 10: 1.2}
"""Number of characters to the most that live playback may cost, as a share of baked playback."""


@dataclass(frozen=True)
class _Kind:
    """What is played."""

    name: str
    frames: int
    """Its last one; the first is 1."""
    act: Callable[[list[bpy.types.Object]], None]
    """Lets characters play it."""

    def play(self) -> float:
        """Return the time to set each frame [s]."""
        scene = bpy.context.scene
        bpy.context.view_layer.update()
        return seconds(lambda: [scene.frame_set(frame) for frame in range(1, self.frames + 1)])


def run() -> list[Figure]:
    """Return the time of a frame with live characters over that with baked ones."""
    wave = acts.named("Wave by Hand")
    kinds = (_Kind("dense", 120, _all_keyed), _Kind("wave", wave.frames, lambda obs: _sample(obs, wave)))
    return [figure for kind in kinds for count, goal in GOALS.items() for figure in _measured(kind, count, goal)]


def _measured(kind: _Kind, count: int, goal: float) -> list[Figure]:
    bpy.ops.wm.read_homefile(use_empty=True)
    registration.register("morph_retarget")
    try:
        obs = [armatures.build(f"Figure {i}", humanoid(1.75, build=BUILD)) for i in range(count)]
        kind.act(obs)
        own = [actions.assigned(ob) for ob in obs]
        retarget.run(bake.bake(obs, bpy.context.scene, Options(frames=(1, kind.frames))))
        baked = [actions.assigned(ob) for ob in obs]
        for ob, (action, slot) in zip(obs, own, strict=True):
            actions.assign(ob, action, slot)
        first = _anew(kind)
        theirs, ours = medians([lambda: _played(kind, obs, baked), lambda: _played(kind, obs, own)], REPETITIONS)
        bare = _bare(kind, obs)
        curves = [len(actions.curves(*what[0])) for what in (own, baked)]
    finally:
        registration.unregister()
    per, name = 1e6 / kind.frames, f"{kind.name}, {count}"
    print(f"{name} live: {short(per * ours)} µs a frame, baked {short(per * theirs)}, at first {short(per * first)}")
    print(f"its curves and poses in a handler that only writes them: {short(per * bare)} µs a frame")
    print(f"curves of a character: {curves[0]} live, {curves[1]} baked")
    return [
        Figure(f"playback: {name} live over baked", ours / theirs, "", goal, bare / theirs),
        Figure(f"playback: {name} live for the first time over baked", first / theirs, ""),
    ]


def _all_keyed(obs: list[bpy.types.Object]) -> None:
    """Let figures play one action, keyed in all channels, with a target."""
    action, rng = bpy.data.actions.new("Bench"), np.random.default_rng(0)
    for channel in CHANNELS:
        definitions.add(action, channel)
    target = bpy.data.objects.new("Target", None)
    target.location = (0.3, -0.6, 1.2)
    bpy.context.scene.collection.objects.link(target)
    for ob in obs:
        cast.add(ob, action)
        for item in of_rig(ob).channels:
            item.target = target
    for frame in range(1, 121, 17):
        for channel in CHANNELS:
            of_rig(obs[0]).channels[channel.name].position = rng.uniform(-0.3, 0.3, 3)
            of_rig(obs[0]).channels[channel.name].rotation = (1.0, *rng.uniform(-0.2, 0.2, 3))
            part = "position" if channel.poses_position and channel.name != "Palms" else "rotation"
            keys.insert(obs[0], channel.name, (part,), frame)


def _sample(obs: list[bpy.types.Object], act: acting.Act) -> None:
    """Let figures play one of the actions that are shipped."""
    action = acting.write(act)
    for ob in obs:
        acting.play(ob, action, act)


Assigned = tuple[bpy.types.Action | None, bpy.types.ActionSlot | None]


def _played(kind: _Kind, obs: list[bpy.types.Object], what: list[Assigned]) -> float:
    for ob, (action, slot) in zip(obs, what, strict=True):
        actions.assign(ob, action, slot)
    kind.play()
    return kind.play()


def _anew(kind: _Kind) -> float:
    perform.forget()
    return kind.play()


def _bare(kind: _Kind, obs: list[bpy.types.Object]) -> float:
    """Return the time for the curves of live characters, and for a handler that does no more than write poses [s]."""
    bones = [ob.pose.bones for ob in obs]
    state = [np.zeros(4 * len(own), dtype=np.float32) for own in bones]

    def write(*_: object) -> None:
        for ob, own, values in zip(obs, bones, state, strict=True):
            own.foreach_set("rotation_quaternion", values)
            ob.update_tag(refresh={"OBJECT"})

    found = bpy.app.handlers.frame_change_pre, bpy.app.handlers.frame_change_post
    kept = [list(handlers) for handlers in found]
    for handlers in found:
        handlers.clear()
    found[0].append(write)
    [taken] = medians([kind.play], REPETITIONS)
    for handlers, before in zip(found, kept, strict=True):
        handlers[:] = before
    return taken
