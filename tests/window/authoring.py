"""A user makes a generalized action for two characters, drags a hand, keys it at two frames, and looks at both."""

from collections.abc import Iterator

import bpy
import numpy as np

from morph_retarget.blender.morph import cast, keys
from morph_retarget.blender.morph.properties import of_action
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.arrays import Array
from tests.blender import scenes
from tests.window.hand import Hand
from tests.window.scenes import choose, search, until

DRAG = 120
"""How far the hand is dragged [px]."""
LATER = 11
"""Frame of the second key."""


def path(hand: Hand) -> Iterator[None]:
    """Play it."""
    scenes.figure("Ann")
    scenes.sprout("Bob").location.x = 1.5
    choose(bpy.data.objects["Bob"], bpy.data.objects["Ann"])
    yield from search(hand, "new generalized action")
    yield from until(lambda: _plays("Ann") and _plays("Bob"), "an action that both play")
    yield from search(hand, "select bodies")
    yield from until(lambda: bpy.context.mode == "POSE", "Pose mode with the hands selected")
    yield from _drag(hand, 0)
    yield from search(hand, "key channel")
    for _ in range(LATER - bpy.context.scene.frame_current):
        hand.press("RIGHT_ARROW")
        yield
    yield from until(lambda: bpy.context.scene.frame_current == LATER, f"frame {LATER}")
    yield from _drag(hand, DRAG)
    yield from search(hand, "key channel")
    found = keys.curves(_plays("Ann"))
    curve = found[keys.path(_channel(), "position"), 2]
    assert [point.co.x for point in curve.keyframe_points] == [1.0, LATER]
    assert np.ptp([point.co.y for point in curve.keyframe_points]) > 0.05, "the drag became another value"
    for name, bone in (("Ann", "leftHand"), ("Bob", "Hand.L")):
        places = _places(name, bone)
        assert np.ptp(places, axis=0).max() > 0.02, f"{name} plays what was dragged on Ann"


def _drag(hand: Hand, way: int) -> Iterator[None]:
    """Drag what is selected upwards."""
    hand.point_at()
    hand.press("G")
    yield
    for part in (0.3, 0.6, 1.0):
        area = hand.area()
        hand.point(area.x + 0.3 * area.width, area.y + 0.5 * area.height + part * way)
        yield
    hand.press("LEFTMOUSE")
    yield
    yield


def _plays(name: str) -> bpy.types.Action | None:
    return cast.action_of(bpy.data.objects[name])


def _channel() -> str:
    return of_action(_plays("Ann")).channels[0].name


def _places(name: str, bone: str) -> Array:
    """Return where a bone is at both keys, shape (2, 3)."""
    assert _channel() in of_rig(bpy.data.objects[name]).channels
    return scenes.heads(bpy.data.objects[name], [bone], [1, LATER])[:, 0]
