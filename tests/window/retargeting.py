"""A user chooses two armatures, retargets, takes it back, does it again, and stops another one halfway."""

from collections.abc import Iterator

import bpy
import numpy as np

from morph_retarget.blender.properties import of_scene
from tests.blender import scenes
from tests.window.hand import Hand
from tests.window.scenes import choose, search, until


def path(hand: Hand) -> Iterator[None]:
    """Play it."""
    scenes.walker()
    scenes.sprout()
    bpy.ops.ed.undo_push(message="Two armatures")
    choose(bpy.data.objects["Walker"], bpy.data.objects["Sprout"])
    yield from search(hand, "use selected")
    settings = of_scene(bpy.context.scene)
    assert (settings.source.name, settings.target.name) == ("Walker", "Sprout")
    yield from search(hand, "morph retarget retarget")
    yield from until(_action, "a new action")
    assert _action().name == "Walk on Sprout"
    assert _moves(), "the target moves"
    logged = bpy.context.window_manager.operators[-1]
    assert (logged.source, logged.target, logged.action) == ("Walker", "Sprout", "Walk"), "the log tells all"
    hand.press("Z", ctrl=True)
    yield from until(lambda: _action() is None, "the step taken back")
    hand.press("Z", ctrl=True, shift=True)
    yield from until(_action, "the step done again")
    hand.press("Z", ctrl=True)
    yield from until(lambda: _action() is None, "the step taken back again")
    yield from _stopped(hand)


def _stopped(hand: Hand) -> Iterator[None]:
    """Begin to retarget a long clip, and press Escape."""
    scenes.walker("Strider", seconds=LONG, action="Long Walk")
    of_scene(bpy.context.scene).source = bpy.data.objects["Strider"]
    before = set(bpy.data.actions.keys())
    area = hand.area()
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=hand.window, area=area, region=region):
        assert bpy.ops.morph_retarget.retarget("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
    hand.press("ESC")
    for _ in range(4):
        yield
    assert set(bpy.data.actions.keys()) == before, "nothing is left of what was stopped"
    assert _action() is None
    assert not hand.window.modal_operators, "it listens no more"


LONG = 60.0
"""Duration of a clip that takes a while [s]."""


def _action() -> bpy.types.Action | None:
    data = bpy.data.objects["Sprout"].animation_data
    return None if data is None else data.action


def _moves() -> bool:
    ob = bpy.data.objects["Sprout"]
    found = scenes.heads(ob, ["Hips", "Foot.L", "Hand.R"], [1, 17, 34])
    bpy.context.scene.frame_set(1)
    return bool((np.ptp(found, axis=0).max(axis=-1) > 0.1).all())
