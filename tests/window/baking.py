"""A user bakes what a character plays, and gets the same poses as an ordinary action."""

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
    ann = scenes.figure("Ann")
    acting.dip(ann)
    choose(ann)
    bpy.ops.ed.undo_push(message="A character")
    before = scenes.heads(ann, HANDS, FRAMES)
    assert np.ptp(before, axis=0).max() > 0.1, "the hands dip"
    yield from search(hand, "bake action")
    yield from until(lambda: cast.action_of(bpy.data.objects["Ann"]) is None, "an ordinary action")
    after = scenes.heads(bpy.data.objects["Ann"], HANDS, FRAMES)
    assert scenes.apart(before, after) < 1e-4, "the poses are those that were played"
    assert "Dip" in bpy.data.actions, "the generalized action is kept"
    hand.press("Z", ctrl=True)
    yield from until(lambda: cast.action_of(bpy.data.objects["Ann"]) is not None, "the step taken back")
