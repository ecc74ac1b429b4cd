"""Events: told once when the frame comes to a marker, however often it is shown."""

from collections.abc import Iterator

import bpy
import pytest

from morph_retarget.blender import actions
from morph_retarget.blender.morph import events
from morph_retarget.blender.properties import of_rig
from tests.blender import acting, scenes, window

Told = list[tuple[str, str, int]]


@pytest.fixture
def told() -> Iterator[Told]:
    """Return what is told, as it is told: character, event and frame."""
    out: Told = []

    def hear(ob: bpy.types.Object, name: str, frame: int) -> None:
        out.append((ob.name, name, frame))

    events.callbacks.append(hear)
    events.forget()
    with window.registered():
        yield out
    events.callbacks.remove(hear)


@pytest.fixture
def ann(told: Told) -> bpy.types.Object:
    """Return a character whose action has the events "low" at 11 and "high" at 21."""
    ob = scenes.figure("Ann")
    made = acting.dip(ob)
    for name, frame in (("low", 11), ("high", 21)):
        made.pose_markers.new(name).frame = frame
    _show(1)
    told.clear()
    return ob


def _show(*frames: float) -> None:
    """Show frames one after another, as handlers do after Blender has."""
    scene = bpy.context.scene
    for frame in frames:
        whole = int(frame // 1)
        scene.frame_set(whole, subframe=frame - whole)
        events.show_frame(scene)


@pytest.mark.usefixtures("ann")
def test_each_is_told_once_while_playing(told: Told) -> None:
    _show(*range(1, 25))
    assert told == [("Ann", "low", 11), ("Ann", "high", 21)]


@pytest.mark.usefixtures("ann")
def test_it_does_not_matter_how_often_a_frame_is_shown(told: Told) -> None:
    _show(10, 10, 11, 11, 11, 12, 12)
    assert told == [("Ann", "low", 11)]


@pytest.mark.usefixtures("ann")
def test_parts_of_a_frame_tell_once_as_in_motion_blur(told: Told) -> None:
    _show(10.25, 10.75, 11.0, 10.75, 11.25, 11.0, 11.75)
    assert told == [("Ann", "low", 11)]


@pytest.mark.usefixtures("ann")
def test_scrubbing_onto_a_marker_tells_and_across_it_does_not(told: Told) -> None:
    _show(5, 11)
    assert told == [("Ann", "low", 11)]
    _show(5, 15, 11)
    assert len(told) == 2, "it is told again when it is come to again"
    _show(5, 15)
    assert len(told) == 2


def test_each_character_is_told_of(ann: bpy.types.Object, told: Told) -> None:
    bob = scenes.figure("Bob")
    acting.play(ann.animation_data.action, bob)
    _show(11)
    assert sorted(told) == [("Ann", "low", 11), ("Bob", "low", 11)]
    of_rig(bob).muted = True
    told.clear()
    _show(5, 11)
    assert told == [("Ann", "low", 11)]


def test_two_at_one_frame_and_another_action_are_told(ann: bpy.types.Object, told: Told) -> None:
    ann.animation_data.action.pose_markers.new("also").frame = 11
    _show(11)
    assert told == [("Ann", "also", 11), ("Ann", "low", 11)]
    other = acting.action("Other", [acting.HANDS])
    other.pose_markers.new("begin").frame = 11
    acting.play(other, ann, keyed=acting.DIP)
    _show(11)
    assert told[2:] == [("Ann", "begin", 11)]


def test_strips_shift_events(ann: bpy.types.Object, told: Told) -> None:
    made, slot = actions.assigned(ann)
    actions.assign(ann, None, None)
    strip = ann.animation_data.nla_tracks.new().strips.new("Dip", 101, made)
    strip.action_slot = slot
    strip.scale = 2.0
    _show(11, 101, 120, 121, 122, 141, 142)
    assert told == [("Ann", "low", 11), ("Ann", "high", 21)]


def test_without_a_character_nothing_is_told(told: Told) -> None:
    ob = scenes.walker()
    ob.animation_data.action.pose_markers.new("step").frame = 5
    _show(4, 5)
    assert told == []
