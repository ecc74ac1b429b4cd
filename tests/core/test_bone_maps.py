"""Bone maps of other tools: read as plain data, placed on rigs, and written."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from morph_retarget.core.character import families
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.bone_maps import names_alone, pair_maps, rokoko
from morph_retarget.core.character.bone_maps.bone_map import EXPY_KIT, KEEMAP, MWNI, OURS, ROKOKO, BoneMap, Pair
from morph_retarget.core.character.bone_maps.placing import place
from morph_retarget.core.character.bone_maps.reading import read
from morph_retarget.core.character.character import Character
from morph_retarget.core.character.joints import PARENTS
from morph_retarget.core.errors import MappingError
from tests import truth
from tests.fuzzing import CORPUS
from tests.skeletons import skeleton_of
from tools.figure import Bone, Build, blender, humanoid

FACE = ("jaw", "leftEye", "rightEye")


def _hero() -> Character:
    return analyze(skeleton_of(humanoid(build=Build(fingers=5), names=blender)))


def _keemap(pairs: dict[str, str]) -> str:
    bones = [
        {"name": a, "SourceBoneName": a, "DestinationBoneName": b, "CorrectionFactorX": 0.5} for a, b in pairs.items()
    ]
    return json.dumps({"bones": bones, "source_rig_name": "A", "destination_rig_name": "B"})


def _mwni(pairs: dict[str, str]) -> str:
    unit = np.eye(4).ravel().tolist()
    return json.dumps(
        {
            "mappings": [{"source": a, "target": b, "rest": unit, "offset": unit} for a, b in pairs.items()],
            "ik_limbs": [],
        }
    )


def _from_mixamo(hero: Character) -> dict[str, str]:
    """Return pairs of Mixamo's bones and a hero's."""
    names = families.named("Mixamo").joints
    return {names[joint]: match.bone for joint, match in hero.joints.items() if joint in names}


def _corpus(name: str) -> str:
    return (CORPUS / "map" / name).read_text(encoding="utf-8")


# --- reading ---


@pytest.mark.parametrize(
    ("name", "tool"),
    [
        ("keemap.json", KEEMAP),
        ("animation_retargeting.json", MWNI),
        ("rokoko.json", ROKOKO),
        ("expy_kit.txt", EXPY_KIT),
        ("plain.json", OURS),
    ],
)
def test_the_tool_is_seen_from_what_is_in_the_file(name: str, tool: str) -> None:
    assert read(_corpus(name), name).tool == tool
    assert read("\ufeff" + _corpus(name), name).tool == tool, "with a byte order mark too"


def test_pairs_without_a_partner_are_left_out_and_told() -> None:
    found = read(_corpus("keemap.json"), "map")
    assert Pair("Hips", "pelvis") in found.pairs
    assert found.left_out == ("'Neck' has no partner",)


def test_naming_schemes_hold_joints_and_pairs() -> None:
    found = read(_corpus("rokoko.json"), "map")
    assert found.joints == {
        "hips": ("pelvis", "root"),
        "leftUpperArm": ("upperarm_l",),
        "leftThumbProximal": ("thumb_02_l",),
    }
    assert found.pairs == (Pair("tail", "tail_01"),)
    assert found.left_out == ("'nose' is none of Rokoko's joints",)


def test_presets_of_expy_kit_are_read_as_text() -> None:
    assert read(_corpus("expy_kit.txt"), "map").joints == {
        "hips": ("pelvis",),
        "spine": ("spine_01",),
        "chest": ("spine_02",),
        "leftEye": ("eye.L", "Eye_L"),
        "leftUpperArm": ("upperarm_l",),
        "leftThumbMetacarpal": ("thumb_01_l",),
    }


@pytest.mark.parametrize(
    "line",
    [
        "import os",
        "import bpy, os",
        "os.system('rm')",
        "skeleton.spine.head = open('x').read()",
        "skeleton.spine.head = 'a' + 'b'",
        "skeleton.spine.head = f'{1}'",
        "skeleton.spine.head = 'a' if print() else 'b'",
        "skeleton.spine.head = '\\N{nothing}'",
        "skeleton.spine.head = 'a'; print('b')",
        "skeleton.spine.head = " + "'" + 500 * "a" + "'",
        "skeleton['spine'] = 'a'",
        "for i in range(9): pass",
    ],
)
def test_python_that_does_anything_else_is_refused_and_nothing_of_it_is_run(line: str) -> None:
    text = f"import bpy\nskeleton = bpy.context.object.data.expykit_retarget\n\n{line}\n"
    with pytest.raises(MappingError, match=r"^preset.py: line 4 gives no name to a bone .*never run$"):
        read(text, "preset.py")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"bones": [{"SourceBoneName": "a"}]}, r"f: bones\[0\] has no DestinationBoneName: give it the name of a bone"),
        ({"bones": [{"SourceBoneName": 3, "DestinationBoneName": "a"}]}, r"f: bones\[0\].SourceBoneName is 3: give"),
        ({"bones": [[]]}, r"f: bones\[0\] is \[\]: save the map again with KeeMap"),
        ({"mappings": [{"source": "a", "target": "b"}, {"target": "b"}]}, r"f: mappings\[1\] has no source: give it"),
        ({"rokoko_custom_names": True}, r"f: has no table 'bones': export the naming scheme again"),
        ({"rokoko_custom_names": True, "bones": {"hip": "a"}}, r"f: bones\['hip'\] is 'a': make it a list of names"),
        ({"rokoko_custom_names": True, "bones": {"hip": [1]}}, r"f: bones\['hip'\] is \[1\]: make it a list of names"),
    ],
)
def test_what_is_not_as_it_must_be_is_refused_with_its_place(data: dict[str, Any], message: str) -> None:
    with pytest.raises(MappingError, match=message):
        read(json.dumps(data), "f")


def test_broken_json_is_refused_with_its_line() -> None:
    with pytest.raises(MappingError, match=r"^f: line 2 is no JSON"):
        read('{"bones": [\n}', "f")


# --- placing: pairs ---


@pytest.mark.parametrize("write", [_keemap, _mwni])
def test_pairs_become_joints_by_the_names_of_the_other_rig(write: Any) -> None:
    hero = _hero()
    found = place(read(write(_from_mixamo(hero)), "map"), hero)
    assert found.joints == {joint: match.bone for joint, match in hero.joints.items()}
    assert not found.controls
    assert not found.left_out


def test_the_other_rig_itself_tells_more_than_its_names() -> None:
    hero, bones = _hero(), humanoid(build=Build(fingers=5))
    names = {bone.name: f"b{i}" for i, bone in enumerate(bones)}
    actor = analyze(skeleton_of([Bone(names[b.name], names.get(b.parent or ""), b.head, b.tail) for b in bones]))
    pairs = {match.bone: hero.joints[joint].bone for joint, match in actor.joints.items()}
    found = place(read(_keemap(pairs), "map"), hero, actor)
    assert found.joints == {joint: match.bone for joint, match in hero.joints.items() if joint in actor.joints}
    with pytest.raises(MappingError, match=r"map: fits no bone of this rig \(.*: 'b0' is no joint"):
        place(read(_keemap(pairs), "map"), hero)


def test_the_rig_may_stand_at_either_end_of_pairs() -> None:
    hero = _hero()
    turned = {ours: theirs for theirs, ours in _from_mixamo(hero).items()}
    found = place(read(_keemap(turned), "map"), hero)
    assert found.joints == {joint: match.bone for joint, match in hero.joints.items()}


def test_the_first_bone_of_a_joint_counts_and_others_are_told() -> None:
    hero = _hero()
    pairs = [Pair("LeftArm", "UpperArm.L"), Pair("LeftArm", "Hand.L"), Pair("Spine", "Chest"), Pair("Spine1", "Chest")]
    pairs += [Pair("LeftForeArm", "Ghost.L"), Pair("Camera", "Hips")]
    found = place(BoneMap(KEEMAP, "map", pairs=tuple(pairs)), hero)
    assert found.joints == {"leftUpperArm": "UpperArm.L", "spine": "Chest"}
    assert found.left_out == (
        "'Hand.L' for leftUpperArm, which is 'UpperArm.L'",
        "'Chest' for chest too",
        "'Ghost.L' is not in the rig",
        "'Hips': 'Camera' is no joint",
    )
    assert found.told(2) == f"4 of its entries left out: {found.left_out[0]}, {found.left_out[1]} and 2 more"


def test_a_map_for_another_rig_is_refused() -> None:
    with pytest.raises(MappingError, match=r"^map: fits no bone of this rig .*'ghost' is not in the rig"):
        place(read(_keemap({"Pelvis": "ghost"}), "map"), _hero())
    with pytest.raises(MappingError, match=r"^map: fits no bone of this rig: choose a map that was made for it"):
        place(read('{"bones": []}', "map"), _hero())


def test_bones_that_move_no_mesh_are_the_controls_of_joints() -> None:
    bones = humanoid(names=blender)
    controls = [Bone(f"c_{b.name}", None, b.head, b.tail) for b in bones if b.name.startswith(("Hand", "UpperArm"))]
    skeleton = skeleton_of([*bones, *controls])
    skeleton = replace(skeleton, deform=np.array([not name.startswith("c_") for name in skeleton.names]))
    hero = analyze(skeleton)
    pairs = {
        "LeftArm": "c_UpperArm.L",
        "LeftHand": "c_Hand.L",
        "RightHand": "Hand.R",
        "Hips": hero.joints["hips"].bone,
    }
    found = place(read(_keemap(pairs), "map"), hero)
    assert found.controls == {"leftUpperArm": "c_UpperArm.L", "leftHand": "c_Hand.L"}
    assert found.joints == {"rightHand": "Hand.R", "hips": hero.joints["hips"].bone}


# --- placing: names ---


def test_names_in_lower_case_mean_the_bones_of_the_rig() -> None:
    hero = _hero()
    names = {joint: match.bone for joint, match in hero.joints.items()}
    found = place(read(rokoko.write(names), "map"), hero)
    assert found.joints == {joint: bone for joint, bone in names.items() if joint in rokoko.JOINTS.values()}
    assert set(names) - set(found.joints) == {"upperChest"}


def test_our_own_maps_are_taken_to_the_letter() -> None:
    found = place(read('{"joints": {"hips": "Nothing", "jaw": ""}}', "map"), _hero())
    assert found.joints == {"hips": "Nothing", "jaw": ""}, "what is missing is told by those who use them"


def test_presets_of_families_are_placed_whatever_stands_before_names() -> None:
    biped = families.named("3ds Max Biped")
    names = {joint: bone.replace("Bip001", "Hero") for joint, bone in biped.joints.items()}
    bones = [bone for bone in humanoid(build=Build(fingers=5)) if bone.name in names]
    own = analyze(skeleton_of([Bone(names[b.name], names.get(b.parent or ""), b.head, b.tail) for b in bones]))
    assert place(biped, own).joints == {joint: bone for joint, bone in names.items() if bone in own.skeleton.index}
    assert not place(biped, own).left_out
    with pytest.raises(MappingError, match=r"^preset 'SMPL-X': fits no bone of this rig \('pelvis' for hips is not in"):
        place(families.named("SMPL-X"), own)


# --- names alone ---


def test_names_alone_tell_joints_in_most_conventions(data: Path) -> None:
    right = known = wrong = 0
    for table in truth.tables(data):
        if table["kind"] == "humanoid":
            canonical, others = table["ground_truth"]["canonical"], table["ground_truth"]["acceptable_alternates"]
            wanted = {joint: bone for joint, bone in canonical.items() if joint not in FACE}
            found = {joint: bone for bone, joint in names_alone.joints_of([*wanted.values()]).items()}
            good = [joint for joint, bone in found.items() if bone in {wanted.get(joint), *others.get(joint, [])}]
            right, known, wrong = right + len(good), known + len(wanted), wrong + len(found) - len(good)
    assert right >= 0.97 * known, (right, known)
    assert wrong <= 0.01 * known


@pytest.mark.parametrize("write", [str, "{} (copy)".format, "Rig_{}".format])
def test_names_of_no_family_are_read_word_by_word(write: Any) -> None:
    names = {joint: write(blender(joint)) for joint in PARENTS if joint not in FACE}
    found = names_alone.joints_of([*names.values()])
    assert {joint: bone for bone, joint in found.items()}.items() >= {
        joint: bone for joint, bone in names.items() if joint in families.BODY
    }.items()


# --- writing ---


def test_what_is_written_for_keemap_is_read_back() -> None:
    hero = _hero()
    mixamo = families.named("Mixamo").joints
    pairs = pair_maps.paired(mixamo, {joint: match.bone for joint, match in hero.joints.items()} | {"head": ""})
    assert list(pairs) == [joint for joint in hero.joints if joint in mixamo and joint != "head"]
    text = pair_maps.write_keemap(pairs, "Actor", "Hero")
    data = json.loads(text)
    assert (data["source_rig_name"], data["destination_rig_name"]) == ("Actor", "Hero")
    assert [bone["set_bone_position"] for bone in data["bones"]].count(True) == 1
    assert read(text, "map").pairs == tuple(pairs.values())
