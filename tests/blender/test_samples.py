"""The sample actions on the sample characters, as they are committed."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender.morph import cast, definitions, perform, stage, telling
from morph_retarget.blender.properties import of_rig
from morph_retarget.core import play
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.play import Played
from tools import acting, acts, pictures
from tools import stage as stages
from tools.acting import Act
from tools.pictures import EVERYONE, SAMPLES

HANDED = ("biped", "asura", "lopside", "sprout")
NEAR = 0.05
"""Share of a character's size within which something is reached."""
BEYOND = {
    "Punch": "its size is that of the limb, and a neck cannot stretch by its whole length",
    "Pick Up by Mouth": "necks of some do not reach the ground, however low their chests are",
    "Bow on All Fours": "a chest that sinks straight down would need a longer trunk",
    "Sit on Haunches": "a chest that stays where it is would need a longer trunk",
    "Paw to Mouth": "short legs",
    "Jump": "arms are swept up with the jump, whatever their length",
}
"""Acts whose goals may lie out of reach, and why."""

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def written() -> dict[str, bpy.types.Action]:
    """Return the committed actions, by name."""
    with bpy.data.libraries.load(str(SAMPLES / "actions.blend")) as (theirs, ours):
        ours.actions = list(theirs.actions)
    return {action.name: action for action in ours.actions}


def _fitting(ob: bpy.types.Object) -> list[Act]:
    movements = dict.fromkeys(act.movement or act.name for act in acts.ACTS)
    found = [acting.fitting(acts.ACTS, movement, ob) for movement in movements]
    return [act for act in found if act is not None]


def _played(ob: bpy.types.Object, act: Act, count: int | None = None) -> Played:
    """Return a character over all frames of the act that it plays, or over fewer from the first to the last."""
    member = cast.member(ob)
    values = stage.values_over(member, ob, np.linspace(1.0, act.frames, count or act.frames))
    targets = stage.targets_of(member, ob, bpy.context.evaluated_depsgraph_get())
    return play.evaluate(member.part, values, targets)


def _give(ob: bpy.types.Object, written: dict[str, bpy.types.Action], name: str) -> Act:
    act = acts.named(name)
    acting.play(ob, written[name], act, stages.fruit(ob))
    return act


def _at(played: Played, frame: int, bodies: Bodies, name: str) -> Array:
    return played.pose.positions[frame - 1, bodies.names.index(name)]


def test_the_file_holds_what_the_tables_describe(written: dict[str, bpy.types.Action]) -> None:
    assert set(written) == {act.name for act in acts.ACTS}
    for act in acts.ACTS:
        action = written[act.name]
        assert definitions.read(action).channels == tuple(track.channel for track in act.tracks)
        assert definitions.read(action).branch == act.branch
        assert action.use_frame_range
        assert (action.frame_start, action.frame_end) == (1.0, act.frames)
        assert {marker.name: marker.frame for marker in action.pose_markers} == act.events


def test_samples_are_small() -> None:
    assert sum(path.stat().st_size for path in SAMPLES.rglob("*") if path.is_file()) < 5e6


@pytest.mark.parametrize("name", EVERYONE)
def test_every_movement_plays_on_every_character(name: str, written: dict[str, bpy.types.Action]) -> None:
    ob = pictures.character(name)
    fruit = stages.fruit(ob)
    found = _fitting(ob)
    assert len(found) >= 11
    for act in found:
        acting.play(ob, written[act.name], act, fruit)
        played = _played(ob, act, 15)
        assert np.isfinite(played.basis).all(), act.name
        assert np.isfinite(played.shift).all(), act.name
        member = cast.member(ob)
        bodies, plan = member.bodies, member.part.binding.plan
        assert len(plan.goals), act.name
        if act.name != "Jump":
            assert _slip(played, bodies) < 0.01, act.name
        if act.name not in BEYOND:
            away = np.linalg.norm(played.pose.positions[:, played.goals.bodies] - played.goals.positions, axis=-1)
            assert (away * played.goals.position_influence).max(initial=0.0) < NEAR * bodies.size, act.name
        assert np.ptp(played.basis, axis=0).max() > 0.02, act.name
        if not act.cyclic:
            np.testing.assert_allclose(played.pose.positions[-1], bodies.positions, atol=1e-3 * bodies.size)
    bpy.context.scene.frame_set(20)
    assert not cast.problems
    assert perform.shown(ob) is not None


def _slip(played: Played, bodies: Bodies) -> float:
    """Return how far feet that stand go at most, as a share of the character's size."""
    feet = bodies.with_capability(Capability.FOOT)
    standing = [
        (goal, body)
        for goal, body in enumerate(played.goals.bodies.tolist())
        if body in feet and np.allclose(played.goals.positions[:, goal], bodies.positions[body], atol=1e-9)
    ]
    moved = [played.pose.positions[:, body] - bodies.positions[body] for _, body in standing]
    return max((float(np.linalg.norm(way, axis=-1).max()) for way in moved), default=0.0) / bodies.size


@pytest.mark.parametrize(
    ("name", "pairs"),
    [("biped", ["Hand"]), ("asura", ["Hand", "Hand2"]), ("sprout", ["Hand"])],
)
def test_hands_clap_on_the_plane_of_symmetry(name: str, pairs: list[str], written: dict[str, bpy.types.Action]) -> None:
    ob = pictures.character(name)
    act = _give(ob, written, "Clap")
    played = _played(ob, act)
    bodies = cast.member(ob).bodies
    for frame in act.events.values():
        for pair in pairs:
            left, right = (_at(played, frame, bodies, f"{pair}.{side}") for side in "LR")
            assert np.linalg.norm(left - right) < NEAR * bodies.size
            assert abs(0.5 * (left + right)[0]) < 0.01 * bodies.size


@pytest.mark.parametrize("name", HANDED)
def test_a_hand_ends_at_the_mouth(name: str, written: dict[str, bpy.types.Action]) -> None:
    ob = pictures.character(name)
    act = _give(ob, written, "Hand to Mouth")
    played = _played(ob, act)
    assert _from_mouth(ob, played, 1) > 0.15
    assert _from_mouth(ob, played, 34) < NEAR


def _from_mouth(ob: bpy.types.Object, played: Played, frame: int) -> float:
    """Return how far the hand that plays, or a finger of it, is from the mouth, as a share of the size."""
    member = cast.member(ob)
    bodies, binding = member.bodies, member.part.binding
    entry = next(e for e in binding.entries if binding.action.channels[e.channel].name == "To Mouth")
    hand = [entry.body, *bodies.tree.below(entry.body)]
    places = played.pose.positions[frame - 1]
    return float(np.linalg.norm(places[hand] - places[entry.target], axis=-1).min()) / bodies.size


@pytest.mark.parametrize("name", HANDED)
def test_the_fruit_is_taken_and_then_eaten(name: str, written: dict[str, bpy.types.Action]) -> None:
    ob = pictures.character(name)
    act = _give(ob, written, "Eat Fruit")
    played = _played(ob, act)
    member = cast.member(ob)
    fruit = of_rig(ob).channels["Reach"].target
    target = stage.to_character(member, np.array(ob.matrix_world), np.array(fruit.matrix_world.translation))
    (hand,) = {e.body for e in member.part.binding.entries if e.position and e.target >= 0}
    taken = played.pose.positions[act.events["take"] - 1, hand]
    assert np.linalg.norm(taken - target) < 0.01 * member.bodies.size
    assert _from_mouth(ob, played, act.events["bite"]) < NEAR


def test_who_has_no_hands_takes_the_fruit_with_the_mouth(written: dict[str, bpy.types.Action]) -> None:
    ob = pictures.character("hound")
    act = _give(ob, written, "Eat Fruit")
    played = _played(ob, act)
    member = cast.member(ob)
    fruit = of_rig(ob).channels["Reach"].target
    target = stage.to_character(member, np.array(ob.matrix_world), np.array(fruit.matrix_world.translation))
    jaw = _at(played, act.events["take"], member.bodies, "Jaw")
    assert np.linalg.norm(jaw - target) < NEAR * member.bodies.size


def test_two_shake_hands_between_them(written: dict[str, bpy.types.Action]) -> None:
    ann, bob = pictures.character("biped"), pictures.character("biped")
    bob.location, bob.rotation_euler = (0.0, -0.95, 0.0), (0.0, 0.0, np.pi)
    act = acts.named("Shake Hands")
    for ob, partner in ((ann, bob), (bob, ann)):
        acting.play(ob, written[act.name], act)
        stages.meet(ob, partner)
    size = cast.member(ann).bodies.size
    for frame in range(act.events["clasp"], act.events["let go"], 6):
        bpy.context.scene.frame_set(frame)
        bpy.context.view_layer.update()
        hands = [np.array(ob.matrix_world @ ob.pose.bones["Hand.R"].head) for ob in (ann, bob)]
        assert np.linalg.norm(hands[0] - hands[1]) < NEAR * size
        assert abs(hands[0][1] + 0.475) < NEAR * size


def test_the_stage_plays_whatever_action_is_chosen() -> None:
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLES / "stage.blend"))
    scene = bpy.context.scene
    found = cast.performers(scene)
    assert {ob.name for ob in found} == set(stages.PLACES)
    assert all(bpy.data.actions[act.name].use_fake_user for act in acts.ACTS)
    for name in (stages.FIRST_ACT, "Clap", "Shake Hands"):
        for ob in found:
            cast.add(ob, bpy.data.actions[name])
        for frame in (scene.frame_start, 30):
            scene.frame_set(frame)
        assert not cast.problems
        for ob in found:
            told = telling.tell(ob)
            assert not any("has no target" in text or "not for this character" in text for text in told), told
            shown = perform.shown(ob)
            assert shown is not None
            assert np.isfinite(shown.played.basis).all()


def test_the_stage_keeps_targets_in_the_file() -> None:
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLES / "stage.blend"))
    biped = bpy.data.objects["Biped"]
    values = of_rig(biped).channels
    assert values["Reach"].target == bpy.data.objects["Fruit of Biped"]
    assert (values["Shake"].target, values["Shake"].target_bone) == (
        bpy.data.objects["Asura"],
        values["Shake"].target_bone,
    )
    assert values["Shake"].target_bone in bpy.data.objects["Asura"].pose.bones
    assert "open" in values["Mouths"].deforms
    assert Path(bpy.data.filepath).name == "stage.blend"
