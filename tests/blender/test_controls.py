"""Rigs with controls: what deform bones do is what was meant, as Blender evaluates it."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from morph_retarget.blender import actions, retarget, rig
from morph_retarget.blender.controls.task import Onto
from morph_retarget.blender.io import load
from morph_retarget.blender.io.load import Request
from morph_retarget.blender.properties import of_rig, of_scene
from morph_retarget.blender.retarget import Options, Outcome, Source
from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.control_given import Reaching
from morph_retarget.core.errors import MappingError, RigError
from morph_retarget.core.mocap.plan import RetargetSettings
from morph_retarget.core.mocap.root_motion import RootMotion
from tests.blender import control_rigs, scenes, window
from tests.blender.command import Command
from tests.blender.control_rigs import Reach
from tests.blender.files import Files
from tools.figure import blender

LAST = 12
"""Rigs with controls take their time for each frame: these are enough for a leg to swing."""
FRAMES = range(1, LAST + 1, 3)
HOUND = Path(__file__).parents[2] / "sample_blends" / "characters" / "hound.blend"


@pytest.fixture(scope="module")
def walk() -> Source:
    """Return the first frames of the usual clip."""
    scenes.empty()
    return scenes.source_of(scenes.walker(), frames=(1, LAST))


@pytest.fixture
def rigify(walk: Source, rigify_file: Path) -> bpy.types.Object:  # noqa: ARG001 - it must be read before
    bpy.ops.wm.open_mainfile(filepath=str(rigify_file))
    bpy.context.scene.render.fps = scenes.FPS
    return scenes.only_armature()


def off(ob: bpy.types.Object, outcome: Outcome) -> Array:
    """Return by how much segments of the deform bones point elsewhere than was meant [deg], shape (frame, segment)."""
    plan, links = outcome.plan, outcome.plan.links
    names = [plan.target.skeleton.names[bone] for bone in links.target]
    found = plan.target.world_to_character.points(scenes.heads(ob, names, FRAMES))
    meant = outcome.result.motion.points[np.array(FRAMES) - 1]
    own = np.flatnonzero(links.after >= 0)
    a, b = (quat.unit(points[:, links.after[own]] - points[:, own]) for points in (found, meant))
    return np.degrees(2.0 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=-1) / 2.0, 0.0, 1.0)))


def away(ob: bpy.types.Object, outcome: Outcome) -> float:
    """Return how far joints of the deform bones are from where they were meant to be, at most [heights]."""
    plan = outcome.plan
    names = [plan.target.skeleton.names[bone] for bone in plan.links.target]
    found = plan.target.world_to_character.points(scenes.heads(ob, names, FRAMES))
    return scenes.apart(found, outcome.result.motion.points[np.array(FRAMES) - 1]) / plan.target.frame.height


def value(ob: bpy.types.Object, bone: str, prop: str) -> float:
    """Return a custom property as it is evaluated."""
    bpy.context.scene.frame_set(FRAMES[1])
    return float(ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).pose.bones[bone][prop])


# --- a generated rig ---


def test_controls_that_turn_parts_bring_deform_bones_where_they_were_meant(
    walk: Source, rigify: bpy.types.Object
) -> None:
    outcome = scenes.give(walk, rigify, Options(onto=Onto.FK))
    assert off(rigify, outcome).max() < 0.01
    assert away(rigify, outcome) < 1e-4
    told = outcome.report["controls"]
    assert (told["family"], told["onto"]) == ("Rigify", "fk")
    assert told["deform_error_deg"]["max"] < 0.01
    assert value(rigify, "thigh_parent.L", "IK_FK") == 1.0
    assert not any(path.startswith('pose.bones["DEF-') for path, _ in scenes.curves_of(rigify))


def test_controls_that_reach_bring_hands_and_feet_to_their_places(walk: Source, rigify: bpy.types.Object) -> None:
    outcome = scenes.give(walk, rigify, Options(onto=Onto.IK))
    assert off(rigify, outcome).mean() < 1.0
    plan = outcome.plan
    ends = ["DEF-foot.L", "DEF-foot.R", "DEF-hand.L", "DEF-hand.R"]
    found = plan.target.world_to_character.points(scenes.heads(rigify, ends, FRAMES))
    rows = [plan.links.index(name) for name in ("leftFoot", "rightFoot", "leftHand", "rightHand")]
    meant = outcome.result.motion.points[np.array(FRAMES) - 1][:, rows]
    assert scenes.apart(found, meant) < 2e-3 * plan.target.frame.height
    assert value(rigify, "thigh_parent.L", "IK_FK") == 0.0
    assert value(rigify, "upper_arm_parent.R", "pole_vector") == 1.0


def test_legs_that_stand_on_toes_reach_with_their_paws(walk: Source, tmp_path: Path) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(control_rigs.rigify(tmp_path / "beast.blend", "basic_quadruped")))
    bpy.context.scene.render.fps = scenes.FPS
    ob = scenes.only_armature()
    outcome = scenes.give(walk, ob, Options(onto=Onto.IK))
    keyed = {path.split('"')[1] for path, _ in scenes.curves_of(ob)}
    assert {"foot_ik.L", "foot_heel_ik.L", "thigh_ik_target.L", "toe.L"} <= keyed
    assert value(ob, "thigh_parent.L", "IK_FK") == 0.0
    told = outcome.report["controls"]["deform_error_deg"]
    assert told["mean"] < 0.3
    assert told["max"] < 3.0
    names = [outcome.plan.target.skeleton.names[bone] for bone in outcome.plan.links.target]
    rows = [names.index(name) for name in ("DEF-toe.L", "DEF-toe.R")]
    found = outcome.plan.target.world_to_character.points(scenes.heads(ob, [names[row] for row in rows], [1, 6, 11]))
    meant = outcome.result.motion.points[[0, 5, 10]][:, rows]
    assert scenes.apart(found, meant) < 2e-3 * outcome.plan.target.frame.height


def wagging() -> Source:
    """Return a hound that holds its tail high, bends it and wags it."""
    scenes.empty()
    (ob,) = load.load(Request.parse(str(HOUND)))
    phase = np.linspace(0.0, 2.0 * np.pi, 9)
    turns = quat.from_rotation_vector(np.stack([np.full(9, 0.4), 0.0 * phase, 0.5 * np.sin(phase)], axis=-1))
    tail = [bone for bone in ob.pose.bones if bone.name.startswith("Tail")]
    scenes.key(ob, "Wag", {bone.path_from_id("rotation_quaternion"): turns for bone in tail})
    return scenes.source_of(ob)


def test_controls_that_hang_on_each_other_over_mechanisms_settle_one_after_the_other(horse_file: Path) -> None:
    source = wagging()
    bpy.ops.wm.open_mainfile(filepath=str(horse_file))
    outcome = scenes.give(source, scenes.only_armature())
    assert outcome.report["controls"]["deform_error_deg"]["max"] < 0.01
    names = outcome.plan.target.skeleton.names
    tail = [i for i, b in enumerate(outcome.plan.links.target) if "tail" in names[b].lower()]
    moved = outcome.result.motion.turns[:, tail]
    assert len(tail) >= 3
    assert np.degrees(quat.angle_between(moved[:1], moved)).max() > 30.0


def test_a_rig_with_controls_gets_them_by_itself_and_one_without_does_not(
    walk: Source, rigify: bpy.types.Object
) -> None:
    assert scenes.give(walk, rigify).report["controls"]["onto"] == "fk"
    assert "controls" not in scenes.give(walk, scenes.sprout()).report


def test_bones_are_keyed_where_that_is_asked_for(walk: Source, rigify: bpy.types.Object) -> None:
    outcome = scenes.give(walk, rigify, Options(onto=Onto.NONE))
    assert any(path.startswith('pose.bones["DEF-') for path, _ in scenes.curves_of(rigify))
    assert any("constraint" in text for text in outcome.warnings)


@pytest.mark.parametrize("kind", list(RootMotion))
def test_wherever_travel_goes_deform_bones_do_what_was_meant(
    walk: Source, rigify: bpy.types.Object, kind: RootMotion
) -> None:
    outcome = scenes.give(walk, rigify, Options(RetargetSettings(root_motion=kind)))
    assert outcome.report["controls"]["deform_error_deg"]["max"] < 0.01
    assert off(rigify, outcome).max() < (0.01 if kind is not RootMotion.IN_PLACE else 90.0)
    if kind is not RootMotion.IN_PLACE:
        assert away(rigify, outcome) < 1e-4


def test_controls_keep_their_rotation_modes(walk: Source, rigify: bpy.types.Object) -> None:
    for i, bone in enumerate(rigify.pose.bones):
        bone.rotation_mode = ("XYZ", "AXIS_ANGLE", "ZXY")[i % 3]
    modes = [bone.rotation_mode for bone in rigify.pose.bones]
    assert off(rigify, scenes.give(walk, rigify)).max() < 0.01
    assert [bone.rotation_mode for bone in rigify.pose.bones] == modes


def test_how_controls_were_posed_and_switched_before_does_not_show(walk: Source, rigify: bpy.types.Object) -> None:
    turn = quat.from_rotation_vector(np.array([0.3, -0.4, 0.5]))
    before = {
        rigify.pose.bones[name].path_from_id("location"): np.tile([0.2, 0.1, 0.3], (2, 1))
        for name in ("chest", "hips", "tweak_spine.001")
    }
    before['pose.bones["thigh_parent.L"]["IK_FK"]'] = np.zeros((2, 1))
    before['pose.bones["upper_arm_parent.L"]["FK_limb_follow"]'] = np.ones((2, 1))
    for bone in rigify.pose.bones:
        if bone.rotation_mode == "QUATERNION":
            bone.rotation_quaternion = turn
    scenes.key(rigify, "Before", before)
    bpy.context.scene.frame_set(1)
    outcome = scenes.give(walk, rigify)
    assert off(rigify, outcome).max() < 0.01
    assert bpy.data.actions["Before"].use_fake_user


def test_a_clip_of_another_rate_is_keyed_on_whole_frames(rigify: bpy.types.Object) -> None:
    source = scenes.source_of(scenes.walker(fps=scenes.FPS))
    bpy.context.scene.render.fps = 24
    outcome = scenes.give(source, rigify, Options(resample=True))
    keys = scenes.curves_of(rigify)['pose.bones["torso"].location', 0].keyframe_points
    assert all(key.co[0] == round(key.co[0]) for key in keys)
    assert outcome.report["controls"]["deform_error_deg"]["mean"] < 0.3


def test_nothing_else_of_the_file_is_touched(walk: Source, rigify: bpy.types.Object) -> None:
    scene = bpy.context.scene
    scene.frame_set(7)
    known = {kind: len(getattr(bpy.data, kind)) for kind in ("scenes", "objects", "armatures", "actions")}
    scenes.give(walk, rigify)
    assert scene.frame_current == 7
    assert {kind: len(getattr(bpy.data, kind)) for kind in known} == known | {"actions": known["actions"] + 1}


def test_work_that_is_closed_before_its_end_leaves_everything_as_it_was(walk: Source, rigify: bpy.types.Object) -> None:
    own = rig.read(rigify)
    steps = retarget.in_steps(walk, own, retarget.character_of(own), Options(), bpy.context.scene)
    while len(bpy.data.scenes) == 1:  # up to the midst of finding what controls do
        next(steps)
    steps.close()
    assert len(bpy.data.scenes) == 1
    assert actions.assigned(rigify) == (None, None)
    assert len(bpy.data.actions) == 0


# --- other families, and rigs of no family ---

_PARTS = {
    "hips": "Hips", "spine": "Spine1", "chest": "Spine2", "upperChest": "Chest", "neck": "Neck", "head": "Head",
    "Shoulder": "Shoulder", "UpperArm": "UpperArm", "LowerArm": "Forearm", "Hand": "Wrist",
    "UpperLeg": "Thigh", "LowerLeg": "Shin", "Foot": "Foot", "Toes": "Toes",
}  # fmt: skip


def _part(joint: str) -> str:
    for side, end in (("left", ".L"), ("right", ".R")):
        if joint.startswith(side):
            return f"{_PARTS.get(joint.removeprefix(side), joint.removeprefix(side))}{end}"
    return _PARTS.get(joint, joint)


def _arp(joint: str) -> str:
    table = {
        "hips": "root.x", "spine": "spine_01.x", "chest": "spine_02.x", "upperChest": "spine_03.x", "neck": "neck.x",
        "head": "head.x", "Shoulder": "shoulder", "UpperArm": "arm_stretch", "LowerArm": "forearm_stretch",
        "Hand": "hand", "UpperLeg": "thigh_stretch", "LowerLeg": "leg_stretch", "Foot": "foot", "Toes": "toes_01",
    }  # fmt: skip
    for side, end in (("left", ".l"), ("right", ".r")):
        if joint.startswith(side):
            return f"{table.get(joint.removeprefix(side), joint.removeprefix(side))}{end}"
    return table.get(joint, joint)


def _arp_control(joint: str) -> str:
    part, _, end = _arp(joint).rpartition(".")
    part = part.removesuffix("_stretch").removesuffix("_01") if end != "x" else part
    turned = ("arm", "forearm", "hand", "thigh", "leg", "foot", "toes")
    return f"c_{part}_fk.{end}" if part in turned else f"c_{part}.{end}"


@pytest.mark.parametrize(
    ("family", "names", "controls"),
    [
        ("CloudRig", lambda j: f"DEF-{_part(j)}", lambda j: f"FK-{_part(j)}"),
        ("Auto-Rig Pro", _arp, _arp_control),
        ("Constraints", blender, lambda j: f"Anim {_part(j)}"),
    ],
)
def test_families_are_known_by_their_names_and_others_by_their_constraints(
    walk: Source, family: str, names: Callable[[str], str], controls: Callable[[str], str]
) -> None:
    ob = control_rigs.controlled(names, controls)
    outcome = scenes.give(walk, ob, Options(onto=Onto.FK))
    assert outcome.report["controls"]["family"] == family
    assert off(ob, outcome).max() < 0.01
    assert away(ob, outcome) < 1e-4


def _arp_reach() -> Reach:
    def control(end: str) -> str:
        return f"c_{end[len(_side(end)) :].lower()}_ik.{_side(end)[0]}"

    def pole(upper: str) -> str:
        return f"{'c_arms_pole' if 'Arm' in upper else 'c_leg_pole'}.{_side(upper)[0]}"

    return Reach(control, pole, control, lambda _: "ik_fk_switch", turned=1.0)


def _side(joint: str) -> str:
    return "left" if joint.startswith("left") else "right"


def _limb(end: str) -> str:
    return "arm" if "Hand" in end else "leg"


CLOUD_REACH = Reach(
    lambda end: f"IK-MSTR-{_part(end)}",
    lambda upper: f"IK-POLE-{_part(upper)}",
    lambda _: "Properties",
    lambda end: f"ik_{_side(end)}_{_limb(end)}",
)
CLOUD_REACH_SINCE = Reach(
    lambda end: f"IK-{_part(end)}",
    lambda upper: f"POLE-{_part(upper)}",
    lambda _: "Properties",
    lambda end: f"ik_{_side(end)}_{_part('leftUpperArm' if 'Hand' in end else 'leftUpperLeg')[:-2].lower()}",
)
OWN_REACH = Reach(
    lambda end: f"Grab {_part(end)}",
    lambda upper: f"Aim {_part(upper)}",
    lambda _: "Properties",
    lambda end: f"Mode {end}",
)


def _cloud(joint: str) -> str:
    return f"DEF-{_part(joint)}"


def _cloud_control(joint: str) -> str:
    return f"FK-{_part(joint)}"


@pytest.mark.parametrize("onto", [Onto.FK, Onto.IK])
@pytest.mark.parametrize(
    ("family", "names", "controls", "reach"),
    [
        ("Auto-Rig Pro", _arp, _arp_control, _arp_reach()),
        ("CloudRig", _cloud, _cloud_control, CLOUD_REACH),
        ("CloudRig", _cloud, _cloud_control, CLOUD_REACH_SINCE),
        ("Constraints", blender, lambda j: f"Anim {_part(j)}", OWN_REACH),
    ],
    ids=["Auto-Rig Pro", "CloudRig", "CloudRig since", "unknown"],
)
def test_limbs_of_other_families_are_switched_and_reach(
    walk: Source,
    onto: Onto,
    family: str,
    names: Callable[[str], str],
    controls: Callable[[str], str],
    reach: Reach,
) -> None:
    ob = control_rigs.controlled(names, controls, reach=reach)
    outcome = scenes.give(walk, ob, Options(onto=onto))
    told = outcome.report["controls"]
    assert (told["family"], told["onto"]) == (family, onto.value)
    keyed = {path.split('"')[1] for path, _ in scenes.curves_of(ob)}
    ends = ("leftHand", "rightHand", "leftFoot", "rightFoot")
    reached = onto is Onto.IK
    assert {reach.control(end) in keyed for end in ends} == {reached or reach.holder("leftHand") != "Properties"}
    for end in ends:
        assert value(ob, reach.holder(end), reach.prop(end)) == (1.0 - reach.turned if reached else reach.turned)
    assert off(ob, outcome).max() < (1.5 if reached else 0.01)
    assert away(ob, outcome) < (2e-3 if reached else 1e-4)


def test_limbs_that_nothing_but_inverse_kinematics_moves_reach_unasked(walk: Source) -> None:
    ob = control_rigs.controlled(blender, lambda j: f"Anim {_part(j)}", reach=replace(OWN_REACH, holder=None))
    outcome = scenes.give(walk, ob)
    assert outcome.report["controls"]["onto"] == "fk"
    assert {"Grab Foot.L", "Aim Thigh.L"} <= {path.split('"')[1] for path, _ in scenes.curves_of(ob)}
    assert off(ob, outcome).max() < 1.5
    assert away(ob, outcome) < 2e-3


def test_feet_of_a_body_without_other_controls_are_taken_by_what_its_legs_aim_at(walk: Source) -> None:
    ob = scenes.sprout()
    control_rigs.pull(ob, ("UpperLeg.L", "LowerLeg.L", "Foot.L"), "Grab", "Aim")
    outcome = scenes.give(walk, ob)
    keyed = {path.split('"')[1] for path, _ in scenes.curves_of(ob)}
    assert {"Grab", "Aim", "UpperLeg.R", "Hips"} <= keyed
    assert not {"UpperLeg.L", "LowerLeg.L", "Foot.L"} & keyed
    assert off(ob, outcome).max() < 1.5
    assert away(ob, outcome) < 2e-3


def test_a_switch_that_is_driven_itself_is_set_where_users_set_it(walk: Source) -> None:
    ob = control_rigs.controlled(blender, lambda j: f"Anim {_part(j)}", reach=OWN_REACH)
    dial = ob.pose.bones["Anim Head"]
    dial["Arms and Legs"] = 0.0
    for end in ("leftHand", "rightHand", "leftFoot", "rightFoot"):
        driver = ob.driver_add(f'pose.bones["Properties"]["{OWN_REACH.prop(end)}"]').driver
        driver.type = "AVERAGE"
        read = driver.variables.new()
        read.targets[0].id, read.targets[0].data_path = ob, 'pose.bones["Anim Head"]["Arms and Legs"]'
    outcome = scenes.give(walk, ob, Options(onto=Onto.IK))
    assert value(ob, "Anim Head", "Arms and Legs") == 1.0
    assert off(ob, outcome).max() < 1.5


def test_bones_that_share_a_turn_are_no_controls(walk: Source) -> None:
    ob = scenes.sprout()
    for side in ("L", "R"):
        for part, other, influence in (("LowerArm", "Hand", 0.5), ("UpperArm", "Shoulder", 1.0)):
            twist = ob.pose.bones[f"{part}.{side}"].constraints.new("COPY_ROTATION")
            twist.target, twist.subtarget, twist.influence = ob, f"{other}.{side}", influence
    assert "controls" not in scenes.give(walk, ob).report


def test_controls_can_be_named(walk: Source) -> None:
    """A driver moves a bone by another, which nothing in names or constraints tells."""
    ob = control_rigs.controlled(blender, lambda joint: f"Anim {_part(joint)}")
    named = {"hips": "Anim Hips", "leftUpperArm": "Anim UpperArm.L"}
    outcome = scenes.give(walk, ob, Options(controls=named))
    assert off(ob, outcome).max() < 0.01
    with pytest.raises(MappingError, match="'Nobody', which the armature does not have"):
        scenes.give(walk, ob, Options(controls={"hips": "Nobody"}))


def hide_arm(ob: bpy.types.Object) -> dict[str, Reaching]:
    """Let a left arm reach for an object, and be switched over the object itself: return what its user has to say."""
    grip = scenes.empty_object("Grip")
    grip.parent, grip.parent_type, grip.parent_bone = ob, "BONE", f"IKM-{blender('leftHand')}"
    grip.matrix_parent_inverse = Matrix.Translation((0.0, -ob.data.bones[grip.parent_bone].length, 0.0))
    pull = ob.pose.bones[f"IKM-{blender('leftLowerArm')}"].constraints[0]
    pull.target = grip
    ob["Mode"] = 0.0
    for curve in ob.animation_data.drivers:
        for variable in curve.driver.variables:
            if OWN_REACH.prop("leftHand") in variable.targets[0].data_path:
                variable.targets[0].data_path = '["Mode"]'
    driver = ob.driver_add('["Mode"]').driver
    driver.type = "AVERAGE"
    read = driver.variables.new()
    prop = OWN_REACH.prop("leftHand")
    read.targets[0].id, read.targets[0].data_path = ob, f'pose.bones["Properties"]["{prop}"]'
    return {"leftHand": Reaching("Grab Wrist.L", "Aim UpperArm.L", f'Properties["{prop}"] = 1')}


def test_what_brings_hands_to_places_can_be_named(walk: Source) -> None:
    ob = control_rigs.controlled(blender, lambda joint: f"Anim {_part(joint)}", reach=OWN_REACH)
    said = hide_arm(ob)
    found = scenes.give(walk, ob, Options(onto=Onto.IK))
    assert any(f"{blender('leftHand')} of 'Puppet' have no control that reaches" in text for text in found.warnings)
    outcome = scenes.give(walk, ob, Options(onto=Onto.IK, reaches=said))
    assert not any("no control that reaches" in text for text in outcome.warnings)
    assert value(ob, "Properties", OWN_REACH.prop("leftHand")) == 1.0
    assert off(ob, outcome).max() < 1.5
    assert away(ob, outcome) < 2e-3


def test_the_command_line_reads_what_brings_hands_to_places(cli: Command, files: Files, out: Path) -> None:
    ob = control_rigs.controlled(blender, lambda joint: f"Anim {_part(joint)}", reach=OWN_REACH)
    (said,) = hide_arm(ob).values()
    path = scenes.save(out / "puppet.blend")
    named = {"leftHand": {"reach": said.control, "pole": said.pole, "switch": said.switch}}
    (out / "map.json").write_text(json.dumps(named))
    ran = cli(
        "retarget", files.clip("blend"), path, "-o", out / "o.blend", "--controls", "ik", "--map", out / "map.json"
    )
    assert ran.status == 0, ran.errors
    assert not any("no control that reaches" in text for text in ran.errors)
    bpy.ops.wm.open_mainfile(filepath=str(out / "o.blend"))
    keyed = {path for path, _ in scenes.curves_of(scenes.only_armature())}
    assert 'pose.bones["Grab Wrist.L"].location' in keyed


def test_controls_are_named_in_the_list_of_joints_and_kept_by_analyses_and_presets(tmp_path: Path) -> None:
    with window.registered():
        ob = control_rigs.controlled(blender, lambda joint: f"Anim {_part(joint)}")
        settings = of_scene(bpy.context.scene)
        settings.source, settings.target = scenes.walker(), ob
        ops = bpy.ops.morph_retarget
        ops.analyze(rig=ob.name)
        of_rig(ob).joints["hips"].control = "Anim Hips"
        said = {"leftHand": Reaching("Anim Wrist.L", "Anim Head", 'Anim Head["Mode"] = 0')}
        of_rig(ob).joints["leftHand"].hold(said["leftHand"])
        ops.analyze(rig=ob.name)
        assert of_rig(ob).controls() == {"hips": "Anim Hips"}
        assert of_rig(ob).reaches() == said
        ops.export_map(filepath=str(tmp_path / "map.json"), rig=ob.name)
        of_rig(ob).joints["hips"].control = "Nobody"
        of_rig(ob).joints["leftHand"].hold(Reaching())
        with pytest.raises(RuntimeError, match="'Nobody', which the armature does not have"):
            ops.retarget()
        ops.import_map(filepath=str(tmp_path / "map.json"), rig=ob.name)
        assert of_rig(ob).controls() == {"hips": "Anim Hips"}
        assert of_rig(ob).reaches() == said
        of_rig(ob).joints["leftHand"].hold(Reaching())
        ops.retarget()
        assert any(path.startswith('pose.bones["Anim Hips"]') for path, _ in scenes.curves_of(ob))


def test_controls_that_are_not_there_are_asked_for_in_vain(walk: Source) -> None:
    ob = scenes.sprout()
    with pytest.raises(RigError, match="'Sprout' has no controls"):
        scenes.give(walk, ob, Options(onto=Onto.FK))
    assert len(bpy.data.scenes) == 1
