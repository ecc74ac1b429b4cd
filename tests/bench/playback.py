"""What characters that play a generalized action live cost a frame, beside Blender's own playback of the baked actions.

Live, a frame is solved when it is first shown; after that it is known again. Both are measured.
"""

import bpy
import numpy as np

from morph_retarget.blender import actions, registration, retarget
from morph_retarget.blender.morph import bake, cast, definitions, keys, perform
from morph_retarget.blender.morph.bake import Options
from morph_retarget.blender.properties import of_rig
from tools import armatures
from tools.figure import humanoid

from .figures import Figure, medians, seconds, short
from .perform import BUILD, CHANNELS

FRAMES, REPETITIONS = 120, 9
GOALS = {1: 1.0, 10: 1.2}
"""Number of characters to the most that live playback may cost, as a share of baked playback."""


def run() -> list[Figure]:
    """Return the time of a frame with live characters over that with baked ones."""
    return [figure for count, goal in GOALS.items() for figure in _measured(count, goal)]


def _measured(count: int, goal: float) -> list[Figure]:
    bpy.ops.wm.read_homefile(use_empty=True)
    registration.register("morph_retarget")
    try:
        obs = _characters(count)
        own = [actions.assigned(ob) for ob in obs]
        retarget.run(bake.bake(obs, bpy.context.scene, Options(frames=(1, FRAMES))))
        baked = [actions.assigned(ob) for ob in obs]
        for ob, (action, slot) in zip(obs, own, strict=True):
            actions.assign(ob, action, slot)
        first = _anew()
        theirs, ours = medians([lambda: _played(obs, baked), lambda: _played(obs, own)], REPETITIONS)
        bare = _bare(obs)
    finally:
        registration.unregister()
    per = 1e6 / FRAMES
    print(f"{count} live: {short(per * ours)} µs a frame, baked {short(per * theirs)}, at first {short(per * first)}")
    print(f"its curves and poses in a handler that only writes them: {short(per * bare)} µs a frame")
    return [
        Figure(f"playback: {count} live over baked", ours / theirs, "", goal, bare / theirs),
        Figure(f"playback: {count} live for the first time over baked", first / theirs, ""),
    ]


def _characters(count: int) -> list[bpy.types.Object]:
    """Return figures that play one action, keyed in all channels."""
    obs = [armatures.build(f"Figure {i}", humanoid(1.75, build=BUILD)) for i in range(count)]
    action, rng = bpy.data.actions.new("Bench"), np.random.default_rng(0)
    for channel in CHANNELS:
        definitions.add(action, channel)
    target = bpy.data.objects.new("Target", None)
    target.location = (0.3, -0.6, 1.2)
    for ob in obs:
        cast.add(ob, action)
        for item in of_rig(ob).channels:
            item.target = target
    for frame in range(1, FRAMES + 1, 17):
        for channel in CHANNELS:
            of_rig(obs[0]).channels[channel.name].position = rng.uniform(-0.3, 0.3, 3)
            of_rig(obs[0]).channels[channel.name].rotation = (1.0, *rng.uniform(-0.2, 0.2, 3))
            part = "position" if channel.poses_position and channel.name != "Palms" else "rotation"
            keys.insert(obs[0], channel.name, (part,), frame)
    return obs


Assigned = tuple[bpy.types.Action | None, bpy.types.ActionSlot | None]


def _played(obs: list[bpy.types.Object], what: list[Assigned]) -> float:
    for ob, (action, slot) in zip(obs, what, strict=True):
        actions.assign(ob, action, slot)
    _play()
    return _play()


def _anew() -> float:
    perform.forget()
    return _play()


def _bare(obs: list[bpy.types.Object]) -> float:
    """Return the time for the curves of live characters, and for a handler that does no more than write poses [s]."""
    bones = [ob.pose.bones for ob in obs]
    state = [np.zeros(4 * len(own), dtype=np.float32) for own in bones]

    def write(*_: object) -> None:
        for ob, own, values in zip(obs, bones, state, strict=True):
            own.foreach_set("rotation_quaternion", values)
            ob.update_tag(refresh={"OBJECT"})

    handlers = bpy.app.handlers.frame_change_post
    kept = list(handlers)
    handlers.clear()
    handlers.append(write)
    [taken] = medians([_play], REPETITIONS)
    handlers.clear()
    handlers.extend(kept)
    return taken


def _play() -> float:
    """Return the time to set each frame [s]."""
    scene = bpy.context.scene
    bpy.context.view_layer.update()
    return seconds(lambda: [scene.frame_set(frame) for frame in range(1, FRAMES + 1)])
