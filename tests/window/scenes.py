"""What the paths share: scenes to act in, and waiting for something."""

import time
from collections.abc import Callable, Iterator

import bpy

from tests.window.hand import Hand


def until(there: Callable[[], object], what: str, seconds: float = 30.0) -> Iterator[None]:
    """Wait for something.

    Raises:
        AssertionError: It did not come.
    """
    end = time.monotonic() + seconds
    while not there():
        assert time.monotonic() < end, f"{what}: not within {seconds:g} s"
        yield


def search(hand: Hand, text: str) -> Iterator[None]:
    """Find an operator by the search for menus, and run it."""
    hand.point_at()
    yield
    hand.press("F3")
    yield
    yield
    hand.write(text)
    yield
    yield
    hand.press("RET")
    yield
    yield


def choose(*obs: bpy.types.Object) -> None:
    """Select objects and no others; the last becomes the active one."""
    layer = bpy.context.view_layer
    for ob in layer.objects:
        ob.select_set(ob in obs)
    layer.objects.active = obs[-1]
