"""Jiggles of retargeted motions: loose parts of the target follow, keyed by the same code as in the window."""

import json
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions, jiggle_bake, retarget, rig
from morph_retarget.blender.batch import jobs
from morph_retarget.blender.io import load
from morph_retarget.blender.laying import Lay
from morph_retarget.blender.properties import of_rig, of_scene
from morph_retarget.blender.retarget import Options, Source
from morph_retarget.core.arrays import Array
from morph_retarget.core.errors import MotionError
from morph_retarget.core.solve.jiggle_kinds import JiggleSettings
from tests.blender import results, scenes
from tests.blender.command import Command
from tests.blender.files import Files

FACE = ("Chin", "Nose")
LOOSE = Options(jiggles=JiggleSettings())

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture(scope="module")
def beast(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a file with a real rig that walks on two legs and has a tail, which its own action moves."""
    scenes.empty()
    load.add(load.Request(data / "rigs" / "m2m_kaiju_anim.glb"))
    bpy.data.batch_remove([ob for ob in bpy.data.objects if ob.type != "ARMATURE"])
    return scenes.save(tmp_path_factory.mktemp("beast") / "kaiju.blend")


def _added(beast: Path) -> bpy.types.Object:
    return load.add(load.Request(beast))[0]


def _at_rest(ob: bpy.types.Object) -> bpy.types.Object:
    """Return an armature that plays nothing and stands at rest."""
    actions.assign(ob, None, None)
    for bone in ob.pose.bones:
        bone.matrix_basis.identity()
    return ob


def _shown(ob: bpy.types.Object) -> Array:
    return scenes.evaluated(ob, ob.pose.bones.keys(), scenes.SHOWN)


def test_jiggles_come_as_if_they_were_baked_afterwards(walk: Source, beast: Path) -> None:
    ob = _at_rest(_added(beast))
    plain = scenes.give(walk, ob)
    jiggled = scenes.give(walk, ob, LOOSE)
    at_once = _shown(ob)
    actions.assign(_at_rest(ob), plain.action, plain.slot)
    retarget.run(jiggle_bake.bake(ob, plain.action, plain.slot, bpy.context.scene))
    assert np.abs(_shown(ob) - at_once).max() < 1e-5
    assert [name for name in jiggled.report["jiggles"] if not name.startswith("Tail")] == []
    assert len(jiggled.report["jiggles"]) == 5
    assert plain.report["jiggles"] == []


def test_the_body_moves_as_without_them_and_the_tail_lags(walk: Source, beast: Path) -> None:
    ob = _added(beast)
    scenes.give(walk, ob)
    plain = _shown(ob)
    outcome = scenes.give(walk, ob, LOOSE)
    shown, names = _shown(ob), ob.pose.bones.keys()
    below = {c.name for bone in outcome.report["jiggles"] for c in ob.pose.bones[bone].children_recursive}
    body = [i for i, name in enumerate(names) if name not in {*outcome.report["jiggles"], *below}]
    assert np.abs(shown[:, body] - plain[:, body]).max() < 1e-5
    tail = names.index(outcome.report["jiggles"][-1])
    hips = np.linalg.inv(shown[:, names.index(ob.pose.bones[outcome.report["jiggles"][0]].parent.name)])
    seen = (hips @ shown[:, tail])[:, :3, 3]
    assert np.ptp(seen, axis=0).max() > 1e-3 * np.ptp(shown[..., :3, 3])
    for name in outcome.report["jiggles"]:
        curves = [c for (path, _), c in scenes.curves_of(ob).items() if f'"{name}"' in path and "rotation" in path]
        assert {len(c.keyframe_points) for c in curves} == {scenes.COUNT}


def test_what_the_old_action_did_to_the_tail_gives_way_and_the_face_keeps_it(walk: Source, beast: Path) -> None:
    playing, resting = _added(beast), _at_rest(_added(beast))
    old = {path for path, _ in scenes.curves_of(playing)}
    bones = scenes.give(walk, playing, LOOSE).report["jiggles"]
    scenes.give(walk, resting, LOOSE)
    places = [playing.pose.bones.find(name) for name in bones]
    assert any(f'"{bones[0]}"' in path for path in old)
    assert np.abs(_shown(playing)[:, places] - _shown(resting)[:, places]).max() < 1e-4
    assert {path for path, _ in scenes.curves_of(playing)} & old >= {f'pose.bones["{name}"].scale' for name in FACE}


def test_a_stashed_motion_has_its_jiggles_while_the_target_plays_on(walk: Source, beast: Path) -> None:
    ob = _added(beast)
    own = actions.assigned(ob)
    outcome = scenes.give(walk, ob, Options(jiggles=JiggleSettings(), lay=Lay.STASH))
    assert actions.assigned(ob) == own
    replaced = scenes.give(walk, ob, LOOSE)
    names = {slot.identifier for action in (outcome.action, replaced.action) for slot in action.slots}
    assert len(names) == 1
    assert scenes.keys_of(outcome.action) == scenes.keys_of(replaced.action)


def test_a_motion_that_is_added_to_another_has_none(walk: Source) -> None:
    with pytest.raises(MotionError, match="leave them out, or replace or stash"):
        scenes.give(walk, scenes.sprout(), Options(jiggles=JiggleSettings(), lay=Lay.ADD))
    with pytest.raises(MotionError, match="leave them out"):
        jobs.check_options({"jiggles": True, "lay": "add"})


def test_chosen_bones_alone_jiggle(walk: Source, beast: Path) -> None:
    ob = _at_rest(_added(beast))
    every = scenes.give(walk, ob, LOOSE).report["jiggles"]
    chosen = frozenset((*every[1:], "Hips", *(b.name for b in ob.pose.bones if "Spine" in b.name)))
    outcome = scenes.give(walk, _at_rest(ob), Options(jiggles=JiggleSettings(), only=chosen))
    assert outcome.report["jiggles"] == every[1:]


def test_a_target_without_loose_parts_is_said_and_gets_the_motion(walk: Source) -> None:
    ob = scenes.sprout()
    outcome = scenes.give(walk, ob, LOOSE)
    assert [w for w in outcome.warnings if "nothing jiggles on 'Sprout'" in w]
    assert scenes.apart(scenes.played(ob), scenes.played_plainly(walk)) < 1e-6


def test_a_retarget_that_is_stopped_among_its_jiggles_leaves_everything_as_it_was(walk: Source, beast: Path) -> None:
    ob = _added(beast)
    head = ob.pose.bones["Head"] if "Head" in ob.pose.bones else ob.pose.bones[-1]
    head.constraints.new("LIMIT_ROTATION").owner_space = "LOCAL"  # so that frames are stepped
    before, own = actions.assigned(ob), rig.read(ob)
    count = len(bpy.data.actions)
    steps = retarget.in_steps(walk, own, retarget.character_of(own), LOOSE, bpy.context.scene)
    while len(bpy.data.actions) == count:
        next(steps)
    steps.close()
    assert actions.assigned(ob) == before
    assert len(bpy.data.actions) == count


def test_the_panel_lets_the_targets_own_settings_count(walk: Source, beast: Path) -> None:
    assert walk.clip.frames[0] == 1.0
    ob, settings = _at_rest(_added(beast)), of_scene(bpy.context.scene)
    settings.source, settings.target, settings.jiggles = scenes.walker(), ob, True
    seen = []
    for amount in (1.0, 0.0):
        of_rig(ob).jiggles.amount = amount
        assert bpy.ops.morph_retarget.retarget() == {"FINISHED"}
        seen.append(_shown(ob))
    settings.jiggles = False
    bpy.ops.morph_retarget.retarget()
    plain = _shown(ob)
    assert np.abs(seen[0] - plain).max() > 0.01
    assert np.abs(seen[1] - plain).max() < 1e-5


def test_the_command_line_keys_them_and_reports_them(cli: Command, files: Files, beast: Path, out: Path) -> None:
    keyed = []
    for given in ([], ["--jiggles"]):
        report = out / "r.json"
        said = cli("retarget", files.clip(), beast, "-o", out / "o.blend", "--report", report, *given)
        assert said.status == 0, said.errors
        (entry,) = json.loads(report.read_text(encoding="utf-8"))
        results.reload(out / "o.blend")
        keyed.append(entry["jiggles"])
    assert keyed[0] == []
    assert len(keyed[1]) == 5
    assert all("Tail" in name for name in keyed[1])
