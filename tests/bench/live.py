"""What following live costs a frame, beside Blender's own playback of the same motion as keys."""

import bpy

from morph_retarget.blender import actions, live, registration
from morph_retarget.blender.properties import of_scene

from . import walkers
from .figures import Figure, medians, seconds, short
from .walkers import Pair

FRAMES, BONES = 240, 52
REPETITIONS = 9


def run() -> list[Figure]:
    """Return the time of a frame with a live target over that with a baked one."""
    registration.register("morph_retarget")
    try:
        pair = walkers.open_pair(BONES, FRAMES)
        settings = of_scene(bpy.context.scene)
        settings.source, settings.target = pair.walker, pair.sprout
        walkers.transfer(pair, plant_feet=True)
        baked = actions.assigned(pair.sprout)
        still, keyed, followed = medians(
            [lambda: _still(pair), lambda: _keyed(pair, *baked), lambda: _live(pair)], REPETITIONS
        )
    finally:
        registration.unregister()
    floor, ours, theirs = (1e6 * taken / FRAMES for taken in (still, followed, keyed))
    print(f"live {short(ours)} µs a frame, baked {short(theirs)}, source alone {short(floor)}")
    return [Figure("live: playback over that of a baked action", ours / theirs, "", 1.5, floor / theirs)]


def _still(pair: Pair) -> float:
    actions.assign(pair.sprout, None, None)
    return _play()


def _keyed(pair: Pair, action: bpy.types.Action, slot: bpy.types.ActionSlot) -> float:
    actions.assign(pair.sprout, action, slot)
    return _play()


def _live(pair: Pair) -> float:
    actions.assign(pair.sprout, None, None)
    live.start(bpy.context.scene, pair.walker, pair.sprout)
    taken = _play()
    live.stop(pair.sprout, clear=True)
    return taken


def _play() -> float:
    """Return the time to set each frame [s]."""
    scene = bpy.context.scene
    bpy.context.view_layer.update()
    return seconds(lambda: [scene.frame_set(frame) for frame in range(1, FRAMES + 1)])
