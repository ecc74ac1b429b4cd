"""Rigs and clips that others have made: all are read, and what is given to them holds the measures."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions, retarget, rig, sampling
from morph_retarget.blender.io import load
from morph_retarget.blender.io.load import Request
from morph_retarget.blender.retarget import Outcome, Source
from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from tests import truth
from tests.blender import scenes
from tests.blender.imported import Imported
from tests.conftest import DATA

HUMANOIDS = (
    "cesium_man.glb",
    "kaykit_anim_movement_advanced.glb",
    "kaykit_knight.glb",
    "m2m_rig_human.glb",
    "m2m_zombie.glb",
    "quaternius_cyberpunk.glb",
    "quaternius_modular_man.glb",
    "quaternius_modular_woman.glb",
    "quaternius_zombie.fbx",
    "rigify_def_ymca.glb",
    "sketchbook_boxman.glb",
    "vrm0_sphere.vrm",
)
CLIPS = ("cmu_02_01_walk.bvh", "cmu_09_11_run.fbx")
CREATURES = (
    ("khronos_fox.glb", "Walk", "quaternius_wolf.glb"),
    ("khronos_fox.glb", "Run", "m2m_fox_anim.glb"),
    ("quaternius_wolf.glb", "Walk", "khronos_fox.glb"),
    ("quaternius_wolf.glb", "Walk", "m2m_fox_anim.glb"),
    ("m2m_fox_anim.glb", "Walk", "quaternius_wolf.glb"),
    ("quaternius_trex.glb", "TRex_Walk", "m2m_kaiju_anim.glb"),
)
"""Source, action and target."""


def _files(folder: str) -> list[str]:
    """Return the names of the files there are, for the names of tests; one that is missing when there are none."""
    return sorted(path.name for path in (DATA / folder).glob("*.*")) or ["none"]


def _own_clip(ob: bpy.types.Object, name: str | None = None) -> Source | None:
    """Return an armature with a motion that it came with, None when it has none."""
    found = actions.of_armature(ob)
    named = [pair for pair in found if name in (None, pair[0].name, pair[0].name.rpartition("|")[2])]
    if not named:
        return None
    return retarget.run(retarget.read_source(rig.read(ob), *named[0], bpy.context.scene))


@pytest.fixture(scope="module")
def clip(data: Path, imported: Imported) -> Callable[[str, str | None], Source]:
    """Return a function that reads a motion from a file, once."""
    known: dict[tuple[str, str | None], Source] = {}

    def read(name: str, action: str | None = None) -> Source:
        if (name, action) not in known:
            folder = "mocap" if name in CLIPS else "rigs"
            source = _own_clip(imported.open(data / folder / name)[0], action)
            assert source is not None, f"{name} should have an action {action!r}"
            known[name, action] = source
        return known[name, action]

    return read


def _truth(data: Path) -> dict[str, truth.Table]:
    return {Path(table["file"]).name: table for table in truth.tables(data) if table.get("file")}


# --- reading ---


@pytest.mark.parametrize("name", _files("rigs"))
def test_every_rig_is_read_and_known(data: Path, imported: Imported, name: str) -> None:
    ob = imported.open(data / "rigs" / name)[0]
    own = rig.read(ob)
    source = _own_clip(ob)
    found = retarget.character_of(own, clip=source.clip if source else None)
    assert set(own.skeleton.names) == set(ob.data.bones.keys())
    assert found.humanoid == (name in HUMANOIDS)
    assert found.frame.up.tolist() == [0.0, 0.0, 1.0]
    assert found.bone("hips") is not None
    rests = np.array([ob.matrix_world @ ob.data.bones[bone].head_local for bone in own.skeleton.names])
    assert scenes.apart(own.placement.points(own.skeleton.rest_positions), rests) < 1e-4 * found.frame.height


@pytest.mark.parametrize("name", _files("mocap"))
def test_every_clip_is_read_and_known(data: Path, imported: Imported, name: str) -> None:
    ob = imported.open(data / "mocap" / name)[0]
    place = np.array(ob.matrix_world)
    source = _own_clip(ob)
    assert source is not None
    found, clip = source.character, source.clip
    assert found.humanoid
    assert all(found.bone(f"{side}{joint}") is not None for side in ("left", "right") for joint in ("Hand", "Foot"))
    assert clip.stepped == ()
    assert len(clip.frames) == len(clip.pose)
    assert len(clip.frames) > 50
    # What was read from curves is what Blender shows.
    some = np.linspace(0, len(clip.frames) - 1, 4).astype(int)
    seen = scenes.heads(ob, found.skeleton.names, clip.frames[some])
    said = clip.pose.positions[some] @ place[:3, :3].T + place[:3, 3]
    assert scenes.apart(said, seen) < 1e-4 * found.frame.height


@pytest.mark.parametrize("name", ["rigs/m2m_fox_anim.glb", "rigs/quaternius_zombie.fbx", "mocap/cmu_02_01_walk.bvh"])
def test_what_was_kept_of_an_import_is_what_was_imported(data: Path, imported: Imported, name: str) -> None:
    """Tests of real files rest on this."""
    imported.open(data / name)
    kept = imported.open(data / name)[0]
    found = _all_of(kept)
    assert found == _all_of(load.load(Request(data / name))[0])
    assert len(found[-1]) > 0


def _all_of(ob: bpy.types.Object) -> tuple[object, ...]:
    """Return what can be seen of a rig and of its file."""
    scene, data = bpy.context.scene, ob.animation_data
    bones = [(bone.name, bone.parent and bone.parent.name, *np.ravel(bone.matrix_local)) for bone in ob.data.bones]
    playing = (data.action and data.action.name, data.action_slot and data.action_slot.identifier)
    times = (scene.render.fps, scene.render.fps_base, scene.frame_start, scene.frame_end)
    keys = {action.name: scenes.keys_of(action) for action in bpy.data.actions}
    return ob.name, np.array(ob.matrix_world).tolist(), bones, playing, times, sorted(bpy.data.objects.keys()), keys


# --- giving ---


@dataclass(frozen=True, eq=False)
class _Before:
    """All of a rig that must outlive a retarget."""

    rests: Array
    place: Array
    keys: dict[str, dict[tuple[str, str, int], tuple[bytes, ...]]]

    @classmethod
    def of(cls, ob: bpy.types.Object, but: tuple[bpy.types.Action, ...] = ()) -> "_Before":
        return cls(
            np.array([bone.matrix_local for bone in ob.data.bones]),
            np.array(ob.matrix_world),
            {action.name: scenes.keys_of(action) for action in bpy.data.actions if action not in but},
        )


@dataclass(frozen=True, eq=False)
class _Given:
    """A retarget onto a rig from a file."""

    ob: bpy.types.Object
    outcome: Outcome
    before: _Before
    frames: tuple[float, float]
    """First and last frame of the clip."""


def _give(source: Source, ob: bpy.types.Object) -> _Given:
    """Give a rig that was opened a clip, at the clip's own rate."""
    # Rigs with many actions differ in nothing but their number.
    for action, _ in actions.of_armature(ob)[6:]:
        if action != ob.animation_data.action:
            bpy.data.actions.remove(action)
    render = bpy.context.scene.render
    render.fps = max(round(1.0 / source.clip.seconds_per_frame), 1)
    render.fps_base = render.fps * source.clip.seconds_per_frame
    before = _Before.of(ob)
    frames = source.clip.frames
    return _Given(ob, scenes.give(source, ob), before, (frames[0], frames[-1]))


def _check_untouched(given: _Given) -> None:
    """Check that rest, object and old actions are as they were."""
    after = _Before.of(given.ob, (given.outcome.action,))
    assert np.array_equal(after.rests, given.before.rests)
    assert np.array_equal(after.place, given.before.place)
    assert after.keys == given.before.keys


def _check_keys(given: _Given) -> None:
    """Check that the keys make the pose that was meant, both as they are sampled and as Blender evaluates them."""
    plan, motion = given.outcome.plan, given.outcome.result.motion
    target, links = plan.target, plan.links.target
    near = 1e-4 * target.frame.height
    place = np.array(given.ob.matrix_world)
    first, last = given.frames
    clip = retarget.run(
        sampling.sample(
            rig.read(given.ob), given.outcome.action, given.outcome.slot, bpy.context.scene, (int(first), int(last))
        )
    )
    assert scenes.apart(target.local_to_character.points(clip.pose.positions[:, links]), motion.points) < near
    assert np.array_equal(place, np.array(given.ob.matrix_world))
    # Orientations: each link's turn from rest.
    rests = target.skeleton.rest_rotations[links]
    turns = target.local_to_character.turns(quat.multiply(clip.pose.rotations[:, links], quat.conjugate(rests)))
    carried = [i for i, extra in enumerate(plan.links.twists) if not extra]
    assert np.degrees(quat.angle_between(turns[:, carried], motion.turns[:, carried]).max()) < 0.1
    some = np.linspace(0, len(clip.frames) - 1, 4).astype(int)
    seen = scenes.heads(given.ob, [target.skeleton.names[bone] for bone in links], clip.frames[some])
    assert scenes.apart(target.world_to_character.points(seen), motion.points[some]) < near


@pytest.mark.parametrize("target", HUMANOIDS)
@pytest.mark.parametrize("name", CLIPS)
def test_every_humanoid_takes_a_real_clip(
    data: Path, imported: Imported, clip: Callable[[str], Source], name: str, target: str
) -> None:
    given = _give(clip(name), imported.open(data / "rigs" / target)[0])
    report, plan = given.outcome.report, given.outcome.plan
    assert plan.plants == (plan.target.bone("leftFoot") is not None)
    assert report["joints_mapped"] >= 11
    assert report["bone_direction_error_deg"]["median"] <= 5.0
    assert report["ground_penetration_m"]["max"] <= 0.01 * plan.target.frame.height / 1.75
    assert report["pose_jump_deg"]["max"] <= 1.5 * report["pose_jump_deg"]["source_max"]
    _check_keys(given)
    _check_untouched(given)


@pytest.mark.parametrize(("source", "action", "target"), CREATURES)
def test_a_creature_takes_another_creatures_motion(
    data: Path, imported: Imported, clip: Callable[[str, str], Source], source: str, action: str, target: str
) -> None:
    given = _give(clip(source, action), imported.open(data / "rigs" / target)[0])
    report, plan = given.outcome.report, given.outcome.plan
    assert len(plan.links.legs) == len(plan.source.legs) == len(plan.target.legs)
    assert report["ground_penetration_m"]["max"] <= 0.01 * plan.target.frame.height / 1.75
    assert report["pose_jump_deg"]["max"] <= 1.5 * report["pose_jump_deg"]["source_max"]
    # Each leg swings on the target when it does on the source.
    ours, theirs = given.outcome.result.motion.points, given.outcome.result.source.points
    for leg in plan.links.legs:
        swings = [points[:, leg.end, 1] - points[:, leg.chain[0], 1] for points in (ours, theirs)]
        assert np.corrcoef(*swings)[0, 1] > 0.8, leg.name
    _check_keys(given)
    _check_untouched(given)


def test_a_clip_onto_the_body_that_made_it_is_itself(
    data: Path, imported: Imported, clip: Callable[[str], Source]
) -> None:
    """The run on its own skeleton, free of feet: what comes out is what went in."""
    source = clip(CLIPS[1])
    ob = imported.open(data / "mocap" / CLIPS[1])[0]
    ob.name = "Again"
    settings = retarget.Options(replace(retarget.Options().settings, plant_feet=False))
    outcome = scenes.give(source, ob, settings)
    assert outcome.report["bone_direction_error_deg"]["max"] < 1e-3
    assert (
        scenes.apart(outcome.result.motion.points, outcome.result.source.points) < 1e-4 * source.character.frame.height
    )
