"""A user bakes what all characters play, takes it back, and bakes one: it has the same poses, the other still plays."""

from collections.abc import Iterator

import bpy
import numpy as np

from morph_retarget.blender.morph import cast
from tests.blender import acting, scenes
from tests.window.hand import Hand
from tests.window.scenes import choose, search, until

FRAMES = (1, 6, 11, 16, 21)
HANDS = ("leftHand", "rightHand")


def path(hand: Hand) -> Iterator[None]:
    """Play it."""
    ann, bob = scenes.figure("Ann"), scenes.sprout("Bob")
    acting.dip(ann, bob)
    choose(ann)
    bpy.ops.ed.undo_push(message="Two characters")
    before = scenes.heads(ann, HANDS, FRAMES)
    assert np.ptp(before, axis=0).max() > 0.1, "the hands dip"
    yield from _bake_all(hand)
    yield from until(lambda: not _plays("Ann") and not _plays("Bob"), "ordinary actions")
    hand.press("Z", ctrl=True)
    yield from until(lambda: _plays("Ann") and _plays("Bob"), "the step taken back")
    yield from search(hand, "bake action")
    yield from until(lambda: not _plays("Ann"), "an ordinary action")
    assert _plays("Bob"), "the button does not remember that all were meant before"
    after = scenes.heads(bpy.data.objects["Ann"], HANDS, FRAMES)
    assert scenes.apart(before, after) < 1e-4, "the poses are those that were played"
    assert "Dip" in bpy.data.actions, "the generalized action is kept"
    hand.press("Z", ctrl=True)
    yield from until(lambda: _plays("Ann"), "the step taken back")


class MORPHRETARGET_MT_bake_all(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_bake_all"
    bl_label = "Bake"

    def draw(self, _: bpy.types.Context) -> None:
        self.layout.operator_context = "INVOKE_DEFAULT"
        self.layout.operator("morph_retarget.bake_action", text="Bake All").all_characters = True


def _bake_all(hand: Hand) -> Iterator[None]:
    """Press the button that bakes all, where the hand can find it."""
    bpy.utils.register_class(MORPHRETARGET_MT_bake_all)
    hand.point_at()
    yield
    with bpy.context.temp_override(window=hand.window, area=hand.area()):
        bpy.ops.wm.call_menu(name=MORPHRETARGET_MT_bake_all.bl_idname)
    yield
    hand.press("B")  # the letter that is underlined
    yield
    bpy.utils.unregister_class(MORPHRETARGET_MT_bake_all)


def _plays(name: str) -> bool:
    return cast.action_of(bpy.data.objects[name]) is not None
