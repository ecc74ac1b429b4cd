"""The armatures that handlers know of: those of the scene, whatever was done to it since the last event."""

from collections.abc import Callable

import bpy
import pytest

from morph_retarget.blender import present
from morph_retarget.blender.morph import cast
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel
from morph_retarget.core.morph.context import Context
from tests.blender import acts, scenes

HANDS = Channel("Hands", Context(Capability.GRASPER))

pytestmark = pytest.mark.usefixtures("registered")


def _frame(frame: int) -> None:
    bpy.context.scene.frame_set(frame)


def _edit(_: int) -> None:
    bpy.context.view_layer.update()


def _there() -> list[str]:
    return sorted(ob.name for ob in bpy.context.scene.objects if ob.type == "ARMATURE")


@pytest.mark.parametrize("event", [_frame, _edit])
def test_armatures_are_known_at_the_event_after_they_have_come_or_gone(event: Callable[[int], None]) -> None:
    scene, data = bpy.context.scene, bpy.data.armatures.new("Rig")
    within = bpy.data.collections.new("Within")
    scene.collection.children.link(within)
    changes: list[Callable[[], object]] = [
        lambda: scenes.figure("First"),
        lambda: within.objects.link(bpy.data.objects.new("Second", data)),
        lambda: scene.collection.objects.link(bpy.data.objects["Second"]),
        lambda: within.objects.unlink(bpy.data.objects["Second"]),
        lambda: scene.collection.objects.unlink(bpy.data.objects["Second"]),
        lambda: within.objects.link(bpy.data.objects["Second"]),
        lambda: scene.collection.children.unlink(within),
        lambda: scene.collection.children.link(within),
        lambda: bpy.data.objects.remove(bpy.data.objects["First"]),
    ]
    counts = []
    for frame, change in enumerate(changes, 1):
        change()
        event(frame)
        assert [ob.name for ob in sorted(present.armatures(scene), key=lambda ob: ob.name)] == _there()
        counts.append(len(_there()))
    assert set(counts) == {1, 2}


def test_frames_and_edits_that_bring_no_object_do_not_look_for_armatures_anew() -> None:
    ob = scenes.figure("Rig")
    _frame(1)
    known = present.armatures(bpy.context.scene)
    for frame in range(2, 5):
        _frame(frame)
        ob.location.x += 1.0
        _edit(frame)
    assert present.armatures(bpy.context.scene) is known


def test_what_was_removed_a_moment_ago_is_not_among_them() -> None:
    scenes.figure("Gone")
    kept = scenes.figure("Kept")
    _frame(1)
    bpy.data.objects.remove(bpy.data.objects["Gone"])
    assert present.armatures(bpy.context.scene) == [kept]


def test_of_scenes_that_no_window_shows_all_objects_are_looked_at_each_time() -> None:
    other = bpy.data.scenes.new("Other")
    assert present.armatures(other) == []
    ob = scenes.figure("Rig")
    other.collection.objects.link(ob)
    other.view_layers[0].update()
    assert present.armatures(other) == [ob]


def test_after_undo_the_armatures_are_those_that_came_back() -> None:
    bpy.ops.ed.undo_push(message="nothing")
    scenes.figure("Rig")
    _frame(1)
    bpy.ops.ed.undo_push(message="a rig")
    bpy.ops.ed.undo()
    assert present.armatures(bpy.context.scene) == []
    bpy.ops.ed.redo()
    assert [ob.name for ob in present.armatures(bpy.context.scene)] == ["Rig"]


def test_a_character_that_comes_to_a_scene_later_plays_with_the_next_frame() -> None:
    made = acts.act([acts.creature("biped")], HANDS)
    made.key(1, "Hands", position=(0.0, 0.0, 0.0))
    made.key(10, "Hands", position=(0.0, -0.3, 0.2))
    _frame(1)
    other = acts.creature("biped")
    cast.add(other, made.action)
    _frame(10)
    assert any(bone.rotation_quaternion[0] < 0.99 for bone in other.pose.bones)
