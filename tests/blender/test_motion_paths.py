"""The motion path of a channel, as the viewport draws it: it is where the body is meant to go."""

import bpy
import numpy as np
import pytest

from morph_retarget.blender.morph import cast, definitions, keys, paths, perform, stage
from morph_retarget.blender.morph.properties import MORPHRETARGET_PG_action, of_action
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel, MirrorRule, TargetKind
from morph_retarget.core.morph.context import Context, Side
from morph_retarget.core.morph.movement import Movement, ScaleMode
from tests.blender import scenes

ops = bpy.ops.morph_retarget
FRAMES = np.arange(1.0, 21.0)

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture(autouse=True)
def _frames() -> None:
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 20


@pytest.fixture
def ann() -> bpy.types.Object:
    """Return a humanoid that does not stand at the origin."""
    ob = scenes.figure("Ann")
    scenes.stand(ob, scenes.matrix((0, 0, 30), 1.0, (1, 2, 0)))
    return ob


@pytest.fixture
def own(ann: bpy.types.Object) -> MORPHRETARGET_PG_action:
    """Return the definitions of an action that Ann plays, with keys for its one channel."""
    ops.new_action(name="Reach", character=ann.name)
    found = of_action(ann.animation_data.action)
    found.channels[0].name = "Reach"
    _key(ann, "Reach", {1: (0, 0, 0), 10: (0.4, -0.2, 0.3), 20: (1, 0, 0)})
    return found


def _key(ob: bpy.types.Object, channel: str, positions: dict[int, tuple[float, float, float]]) -> None:
    for frame, position in positions.items():
        of_rig(ob).channels[channel].position = position
        keys.insert(ob, channel, ["position"], frame)


def _path(ob: bpy.types.Object) -> paths.MotionPath:
    graph = bpy.context.evaluated_depsgraph_get()
    found = paths.path_of(ob, bpy.context.scene, graph)
    assert found is not None
    return found


def _goals(ob: bpy.types.Object, body: str) -> Array:
    """Return where a body is meant to be at each frame of the scene, in the object's own space."""
    out = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(int(frame))
        shown = perform.shown(ob)
        goals = shown.played.goals
        place = [shown.member.bodies.names[b] for b in goals.bodies].index(body)
        out.append(shown.member.character.local_to_character.inverse().points(goals.positions[0, place]))
    return np.array(out)


MODES = {
    "rest": Movement(),
    "limb": Movement(scale=ScaleMode.LIMB_LENGTH, ground_relative=True),
    "sagittal": Movement(sagittal_relative=True),
    "target": Movement(secondary_relative=True, scale=ScaleMode.LIMB_LENGTH),
}


@pytest.mark.parametrize("mode", MODES)
def test_the_path_is_where_the_body_is_meant_to_go(ann: bpy.types.Object, mode: str) -> None:
    action = bpy.data.actions.new("Reach")
    kind = TargetKind.EXTERNAL if MODES[mode].secondary_relative else TargetKind.NONE
    definitions.add(action, Channel("Reach", Context(Capability.GRASPER), MODES[mode], kind, mirror=MirrorRule.LEFT))
    cast.add(ann, action)
    fruit = of_rig(ann).channels["Reach"].target = scenes.empty_object("Fruit")
    fruit.location = (1.4, 1.5, 1.3)
    _key(ann, "Reach", {1: (0, 0, 0), 10: (0.4, -0.2, 0.3), 20: (1, 0, 0)})
    for hand in ("leftHand", "rightHand"):
        of_rig(ann).channels["Reach"].active_body = hand
        goals = _goals(ann, hand)
        np.testing.assert_allclose(_path(ann).line, goals, atol=1e-5)


def test_a_body_that_follows_another_is_drawn_where_that_one_goes(ann: bpy.types.Object) -> None:
    action = bpy.data.actions.new("Scratch")
    definitions.add(action, Channel("Head", Context(Capability.HEAD)))
    hand = Channel("Hand", Context(Capability.GRASPER, side=Side.LEFT), Movement(secondary_relative=True))
    definitions.add(
        action, Channel(**(vars(hand) | {"target": TargetKind.CONTEXT, "secondary": Context(Capability.HEAD)}))
    )
    cast.add(ann, action)
    of_action(action).active_channel = 1
    _key(ann, "Head", {1: (0, 0, 0), 20: (0.05, -0.1, -0.1)})
    _key(ann, "Hand", {1: (0, 0, 0), 20: (1, 0, 0)})
    goals = _goals(ann, "leftHand")
    found = _path(ann)
    np.testing.assert_allclose(found.line, goals, atol=1e-5)
    np.testing.assert_allclose(found.target, found.line[-1], atol=1e-5)


def test_points_for_scripts_are_in_the_world(own: MORPHRETARGET_PG_action, ann: bpy.types.Object) -> None:
    member = cast.member(ann)
    graph = bpy.context.evaluated_depsgraph_get()
    entry = paths.entry_shown(member, ann)
    points = paths.path_points(member, ann, entry, FRAMES, stage.targets_of(member, ann, graph))
    assert points.shape == (20, 3)
    rest = ann.matrix_world @ ann.data.bones["leftHand"].head_local
    np.testing.assert_allclose(points[0], rest, atol=1e-6)
    del own


def test_the_active_bone_is_the_one_that_is_drawn(own: MORPHRETARGET_PG_action, ann: bpy.types.Object) -> None:
    assert abs(_path(ann).line[0, 0] - ann.data.bones["leftHand"].head_local.x) < 1e-5
    of_rig(ann).channels["Reach"].active_body = "rightHand"
    assert abs(_path(ann).line[0, 0] - ann.data.bones["rightHand"].head_local.x) < 1e-5
    bpy.ops.object.mode_set(mode="POSE")
    ann.data.bones.active = ann.data.bones["leftHand"]
    assert abs(_path(ann).line[0, 0] - ann.data.bones["leftHand"].head_local.x) < 1e-5
    ann.data.bones.active = ann.data.bones["head"]
    assert abs(_path(ann).line[0, 0] - ann.data.bones["rightHand"].head_local.x) < 1e-5
    del own


def test_keys_are_marked_where_they_are(own: MORPHRETARGET_PG_action, ann: bpy.types.Object) -> None:
    found = _path(ann)
    np.testing.assert_allclose(found.keyed, found.line[[0, 9, 19]], atol=1e-6)
    del own


def test_the_path_is_found_anew_only_when_something_has_changed(
    own: MORPHRETARGET_PG_action, ann: bpy.types.Object
) -> None:
    def line() -> Array:
        return _path(ann).line.base

    item, curve = own.channels[0], keys.curves(own.id_data)[keys.path("Reach", "position"), 2]
    before = line()
    bpy.context.scene.frame_set(12)
    assert line() is before
    changes = [
        lambda: setattr(curve.keyframe_points[1], "co", (10, 2.0)),
        lambda: setattr(curve.keyframe_points[1], "interpolation", "CONSTANT"),
        lambda: curve.modifiers.new("NOISE"),
        lambda: setattr(item, "scale", "none"),
        lambda: setattr(bpy.context.scene, "frame_end", 15),
        lambda: setattr(of_rig(ann).channels["Reach"], "active_body", "rightHand"),
    ]
    for change in changes:
        change()
        after = line()
        assert after is not before
        assert line() is after
        before = after


def test_a_path_bends_with_its_target(own: MORPHRETARGET_PG_action, ann: bpy.types.Object) -> None:
    item, fruit = own.channels[0], scenes.empty_object("Fruit")
    own.remap = False  # the keys are meant for the target
    item.target, item.secondary_relative = "external", True
    assert paths.path_of(ann, bpy.context.scene, bpy.context.evaluated_depsgraph_get()) is None
    of_rig(ann).channels["Reach"].target = fruit
    for place in ((1.5, 1.5, 1.2), (0.5, 1.7, 0.2)):
        fruit.location = place
        found = _path(ann)
        at_target = ann.matrix_world.inverted() @ fruit.location
        np.testing.assert_allclose(found.target, at_target, atol=1e-5)
        np.testing.assert_allclose(found.line[-1], at_target, atol=1e-5)


def test_very_long_ranges_are_drawn_in_steps(own: MORPHRETARGET_PG_action) -> None:
    scene = bpy.context.scene
    scene.frame_end = 100_000
    assert len(paths.frames_of_scene(scene)) == paths.MOST
    scene.use_preview_range, scene.frame_preview_start, scene.frame_preview_end = True, 5, 8
    assert paths.frames_of_scene(scene).tolist() == [5, 6, 7, 8]
    del own


def test_where_nothing_is_placed_nothing_is_drawn(own: MORPHRETARGET_PG_action, ann: bpy.types.Object) -> None:
    graph = bpy.context.evaluated_depsgraph_get()
    own.channels[0].poses_position = False
    assert paths.path_of(ann, bpy.context.scene, graph) is None
    assert paths.path_of(scenes.figure("Bob"), bpy.context.scene, graph) is None
