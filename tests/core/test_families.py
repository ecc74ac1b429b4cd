"""Presets of common families: whole, found by themselves, and of use where a rest is bent."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.character import families, map_file, named_body
from morph_retarget.core.character.analysis import Overrides, analyze
from morph_retarget.core.character.anatomy import collect
from morph_retarget.core.character.bone_names import BoneNames
from morph_retarget.core.errors import MappingError
from morph_retarget.core.skeleton import Skeleton
from tests import truth
from tests.skeletons import bent, skeleton_of
from tools.figure import Bone, Build, humanoid

FAMILIES = families.shipped()


def _called(family: families.Family, prefix: str | None = None, fingers: int = 5) -> Skeleton:
    """Return a figure whose bones are called like a family's, as far as it has names for them."""
    own = family.joints
    if prefix is not None:
        own = {joint: prefix + bone.removeprefix(family.prefix or "") for joint, bone in own.items()}
    bones = _renamed(humanoid(build=Build(fingers=fingers)), own)
    further = set(family.needs) - {bone.name for bone in bones}
    return skeleton_of([*bones, *(Bone(name, own["head"], (0, 0.1, 1.7), (0, 0.1, 1.8)) for name in sorted(further))])


def _renamed(bones: list[Bone], names: Mapping[str, str]) -> list[Bone]:
    new = {b.name: names.get(b.name, b.name + "_") for b in bones}
    return [replace(b, name=new[b.name], parent=None if b.parent is None else new[b.parent]) for b in bones]


# --- the presets ---


@pytest.mark.parametrize("family", FAMILIES, ids=lambda own: own.name)
def test_a_preset_is_a_map_of_a_whole_body_and_its_mirror_image(family: families.Family) -> None:
    assert map_file.parse(family.path.read_text(encoding="utf-8"), family.name) == family.joints
    assert set(families.BODY) <= family.joints.keys()
    assert len(set(family.joints.values())) == len(family.joints), "no bone comes twice"
    lefts = {joint.removeprefix("left") for joint in family.joints if joint.startswith("left")}
    assert lefts == {joint.removeprefix("right") for joint in family.joints if joint.startswith("right")}
    assert family.about
    assert family.prefix is None or all(bone.startswith(family.prefix) for bone in family.joints.values())


@pytest.mark.parametrize("family", FAMILIES, ids=lambda own: own.name)
def test_a_rig_of_a_family_is_known_by_its_names(family: families.Family) -> None:
    best = families.fitting(_called(family).names)[0]
    assert best.family == family
    assert best.joints.items() >= {joint: family.joints[joint] for joint in families.BODY}.items()


def test_the_documentation_lists_all_presets() -> None:
    text = (Path(__file__).resolve().parents[2] / "docs" / "retargeting.md").read_text(encoding="utf-8")
    rows = text.partition("### Presets of common families")[2].partition("\n## ")[0]
    for family in FAMILIES:
        assert f"| {family.name} | {family.about} |" in rows


def test_presets_agree_with_the_truth_about_real_rigs(data: Path) -> None:
    for table in truth.tables(data):
        own = truth.rig(data, table)
        fits = families.fitting(own.skeleton.names)
        if table["kind"] == "creature":
            assert not fits, table["id"]
        elif fits:
            known = table["ground_truth"]
            for joint in families.BODY:
                bone = fits[0].joints[joint]
                assert bone in {known["canonical"][joint], *known["acceptable_alternates"].get(joint, [])}, table["id"]


# --- finding them ---


def test_a_rig_without_one_bone_of_the_body_belongs_to_no_family() -> None:
    names = _called(families.named("Mixamo")).names
    for joint in families.BODY:
        bone = families.named("Mixamo").joints[joint]
        assert not families.fitting([name for name in names if name != bone]), joint


@pytest.mark.parametrize("prefix", ["", "mixamorig7:", "mixamorig_", "Hero:mixamorig:"])
def test_what_stands_before_names_may_differ_where_the_family_says_so(prefix: str) -> None:
    fit = families.fitting(_called(families.named("Mixamo"), prefix).names)[0]
    assert fit.family.name == "Mixamo"
    assert fit.joints["leftHand"] == f"{prefix}LeftHand"


def test_further_bones_tell_families_with_the_same_names_apart() -> None:
    older, newer = families.named("Unreal Engine 4"), families.named("Unreal Engine 5")
    assert families.fitting(_called(newer).names)[0].family == newer
    assert [fit.family for fit in families.fitting(_called(older).names)] == [older]


def test_beasts_with_the_names_of_people_are_no_people() -> None:
    metarig = families.named("Rigify Metarig")
    names = _called(metarig).names
    assert families.fitting(names)[0].family == metarig
    assert not families.fitting([*names, "tail.001"])


def test_an_unknown_preset_is_refused_with_those_there_are() -> None:
    assert families.named("mixamo").name == "Mixamo"
    with pytest.raises(MappingError, match=r"there is no preset 'Mixomo': choose one of 3ds Max Biped, "):
        families.named("Mixomo")


def test_names_are_found_without_namespace_case_and_dots_only_where_that_is_clear() -> None:
    own = BoneNames(["Rig:Upper_Arm.L", "hand", "A:toe", "B:toe"])
    assert own.find("upper_arm_l") == "Rig:Upper_Arm.L"
    assert own.find("Hand") == "hand"
    assert own.find("toe") is None, "it may be either"
    assert own.find("A:toe") == "A:toe"
    assert own.first(["foot", "HAND"]) == "hand"


# --- what they are good for ---


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("name", ["Mixamo", "Unreal Engine 4", "Rigify Deform"])
def test_bodies_of_a_family_are_found_however_their_rest_is_bent(name: str, seed: int) -> None:
    family = families.named(name)
    found = analyze(bent(_called(family), 0.6, seed))
    assert found.humanoid
    wrong = {joint: match.bone for joint, match in found.joints.items() if match.bone != family.joints.get(joint)}
    assert not wrong
    assert set(families.BODY) <= found.joints.keys()


def test_a_rest_that_is_a_body_is_left_to_the_analysis() -> None:
    skeleton = _called(families.named("Mixamo"))
    assert {match.by for match in analyze(skeleton).joints.values()} <= {"name", "topology", "geometry"}


def test_a_bent_body_keeps_the_front_that_its_hips_have() -> None:
    skeleton = bent(_called(families.named("Mixamo")), 0.0, 0)
    lying = quat.from_rotation_vector(np.array([0.0, 0.0, np.pi / 2]))
    about = quat.from_rotation_vector(np.array([np.pi / 2 * 0.9, 0.0, 0.0]))
    turn = quat.multiply(lying, about)  # bent forward to the level, then turned to +X
    upper = {name for name in skeleton.names if not any(word in name for word in ("Leg", "Foot", "Toe"))}
    heads = skeleton.rest_positions.copy()
    hips = heads[skeleton.index["mixamorig:Hips"]]
    for name in skeleton.names:
        own = turn if name in upper else lying
        heads[skeleton.index[name]] = hips + quat.rotate(own, heads[skeleton.index[name]] - hips)
    found = analyze(replace(skeleton, rest_positions=heads, rest_tails=heads))
    assert found.humanoid
    assert np.allclose(found.frame.forward, [1.0, 0.0, 0.0], atol=1e-6)
    assert found.joints["leftHand"].bone == "mixamorig:LeftHand"


def test_corrections_count_more_than_a_preset() -> None:
    skeleton = bent(_called(families.named("Mixamo")), 0.6, 1)
    found = analyze(skeleton, None, Overrides(joints={"head": "mixamorig:Neck", "neck": ""}))
    assert found.joints["head"].bone == "mixamorig:Neck"
    assert "neck" not in found.joints


def test_names_that_the_tree_contradicts_tell_nothing() -> None:
    skeleton = _called(families.named("Mixamo"))
    parents = skeleton.parents.copy()
    evidence = collect(skeleton, skeleton.rest_positions, skeleton.rest_tails)
    assert named_body.find(evidence) is not None
    swapped = {"mixamorig:LeftArm": "mixamorig:LeftHand", "mixamorig:LeftHand": "mixamorig:LeftArm"}
    names = tuple(swapped.get(name, name) for name in skeleton.names)
    odd = replace(skeleton, names=names, parents=parents)
    assert named_body.find(collect(odd, odd.rest_positions, odd.rest_tails)) is None
